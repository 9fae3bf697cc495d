"""Pinocchio: its articulated-body algorithm under the semi-implicit Euler step of its users, and under RK4 on the group, looped from Python."""

import numpy as np

from rigid_body_sim.rotations import rotate_back
from rigid_body_sim.study.precision.peers import body
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner, steps_for

NAME = 'Pinocchio'


def version():
    """Return the version that is installed."""
    import pinocchio
    return pinocchio.__version__


def runners(problem, reference):
    """Yield both loops."""
    given = body.of(problem)
    if given.inner:
        raise RefusedError('internal dissipation: it has no such effect')
    for label, step_of in (('RK4', _rk4), ('semi-implicit Euler', _euler)):
        yield Runner(f'{NAME} {label}', 'step', steps_for(problem, reference),
                     lambda step, step_of=step_of: _run(problem, given, step_of, step), True)


def _run(problem, given, step_of, step):
    import pinocchio
    scene, free = problem.scene, problem.scene.constraint.kind == 'free'
    inertia, arm = given.about_center(scene)
    gravity = scene.effect('gravity')
    model = pinocchio.Model()
    joint = model.addJoint(0, pinocchio.JointModelSpherical(), pinocchio.SE3.Identity(), 'pivot')
    model.appendBodyToJoint(joint, pinocchio.Inertia(scene.body.mass, arm, inertia), pinocchio.SE3.Identity())
    model.gravity.linear = np.array([0.0, 0.0, 0.0 if free or not gravity else -gravity.g])
    data = model.createData()
    still = not (np.any(given.torque) or np.any(given.push) or np.any(given.damping))
    nothing = np.zeros(3)

    def rate(q, v):
        torque = nothing if still else given.torque + rotate_back(*q, *given.push) - given.damping @ v
        return pinocchio.aba(model, data, q, v, torque)
    q, v, done = given.start[:4].copy(), given.start[4:].copy(), 0

    def begin():
        nonlocal q, v, done
        q, v, done = given.start[:4].copy(), given.start[4:].copy(), 0

    def to(time):
        nonlocal q, v, done
        steps = body.whole_steps(time, step)
        for _ in range(steps - done):
            q, v = step_of(pinocchio, model, rate, q, v, step)
        done = steps
    return Run(begin, to, lambda: given.state((*q, *v)))


def _euler(pinocchio, model, rate, q, v, h):
    v = v + h * rate(q, v)
    return pinocchio.integrate(model, q, h * v), v


def _rk4(pinocchio, model, rate, q, v, h):
    """Return the state after a Runge-Kutta-Munthe-Kaas step of order 4 with the commutator corrections of Owren and Marthinsen."""
    a1, k1 = rate(q, v), v
    v2 = v + 0.5 * h * a1
    a2, k2 = rate(pinocchio.integrate(model, q, 0.5 * h * k1), v2), v2
    v3 = v + 0.5 * h * a2
    turn = 0.5 * h * k2 + 0.125 * h * h * np.cross(k1, k2)
    a3, k3 = rate(pinocchio.integrate(model, q, turn), v3), v3
    v4 = v + h * a3
    a4, k4 = rate(pinocchio.integrate(model, q, h * k3), v4), v4
    whole = h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4) + h * h / 12.0 * np.cross(k1, k4)
    return pinocchio.integrate(model, q, whole), v + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)
