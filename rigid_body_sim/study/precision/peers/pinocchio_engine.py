# SPDX-License-Identifier: Apache-2.0
"""Pinocchio: its articulated-body algorithm in loops from Python.

The methods are the semi-implicit Euler step of its users, and RK4 on the group.
"""

import numpy as np

from rigid_body_sim.study.precision.peers import body, given
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner, steps_for

NAME = 'Pinocchio'


def version():
    """Return the version that is installed."""
    import pinocchio
    return pinocchio.__version__


def runners(problem, reference):
    """Yield both loops."""
    if problem.scene.constraint.kind == 'table':
        raise RefusedError('contact with friction: the solver that steps it is left to its user')
    numbers = given.of(problem)
    if isinstance(numbers, body.Body) and numbers.inner:
        raise RefusedError('internal dissipation: it has no such effect')
    made = _turning if isinstance(numbers, body.Body) else _swinging
    for label, step_of in (('RK4', _rk4), ('semi-implicit Euler', _euler)):
        yield Runner(
            f'{NAME} {label}', 'step', steps_for(problem, reference),
            lambda step, step_of=step_of: made(problem.scene, numbers, step_of, step), True)


def _model(scene, joint, placement, arm, inertia):
    import pinocchio
    kind, gravity = scene.constraint.kind, scene.effect('gravity')
    model = pinocchio.Model()
    one = model.addJoint(0, joint, placement, 'joint')
    model.appendBodyToJoint(
        one, pinocchio.Inertia(scene.body.mass, arm, inertia), pinocchio.SE3.Identity())
    model.gravity.linear = np.array([
        0.0, 0.0, 0.0 if kind == 'free' or not gravity else -gravity.g])
    return pinocchio, model, model.createData()


def _turning(scene, numbers, step_of, step):
    import pinocchio
    inertia, arm = numbers.about_center(scene)
    pinocchio, model, data = _model(
        scene, pinocchio.JointModelSpherical(), pinocchio.SE3.Identity(), arm, inertia)
    torques, nothing = numbers.torques(), np.zeros(3)

    def rate(q, v):
        torque = sum((one(q, v) for one in torques), nothing)
        return pinocchio.aba(model, data, q, v, torque)
    return _looped(pinocchio, model, rate, numbers.start[:4], numbers.start[4:], step_of, step,
                   lambda q, v: numbers.state((*q, *v)))


def _swinging(scene, numbers, step_of, step):
    """Return the Run of a revolute joint, whose frame is the body's, moved to the hinge."""
    import pinocchio
    through = np.array(scene.constraint.through)
    turn = pinocchio.Quaternion(np.array(numbers.orientation)).matrix()
    pinocchio, model, data = _model(
        scene, pinocchio.JointModelRevoluteUnaligned(*numbers.axis),
        pinocchio.SE3(turn, turn @ through), np.subtract(scene.body.center_of_mass, through),
        scene.body.about_center.matrix)

    def rate(q, v):
        pull = numbers.stiffness * (numbers.slack - q)
        return pinocchio.aba(model, data, q, v, numbers.torque + pull - numbers.friction * v)
    return _looped(pinocchio, model, rate, numbers.start[:1], numbers.start[1:], step_of, step,
                   lambda q, v: numbers.state((q[0], v[0])))


def _looped(pinocchio, model, rate, start_q, start_v, step_of, step, state):
    q, v, done = start_q.copy(), start_v.copy(), 0

    def begin():
        nonlocal q, v, done
        q, v, done = start_q.copy(), start_v.copy(), 0

    def to(time):
        nonlocal q, v, done
        steps = body.whole_steps(time, step)
        for _ in range(steps - done):
            q, v = step_of(pinocchio, model, rate, q, v, step)
        done = steps
    return Run(begin, to, lambda: state(q, v))


def _euler(pinocchio, model, rate, q, v, h):
    v = v + h * rate(q, v)
    return pinocchio.integrate(model, q, h * v), v


def _rk4(pinocchio, model, rate, q, v, h):
    """Return the state after a Runge-Kutta-Munthe-Kaas step of order 4.

    It has the commutator corrections of Owren and Marthinsen.
    """
    a1, k1 = rate(q, v), v
    v2 = v + 0.5 * h * a1
    a2, k2 = rate(pinocchio.integrate(model, q, 0.5 * h * k1), v2), v2
    v3 = v + 0.5 * h * a2
    turn = 0.5 * h * k2 + 0.125 * h * h * _commutator(k1, k2)
    a3, k3 = rate(pinocchio.integrate(model, q, turn), v3), v3
    v4 = v + h * a3
    a4, k4 = rate(pinocchio.integrate(model, q, h * k3), v4), v4
    whole = h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4) + h * h / 12.0 * _commutator(k1, k4)
    return pinocchio.integrate(model, q, whole), v + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)


def _commutator(a, b):
    """Return a x b, or 0 for rates about one axis, which commute."""
    return np.cross(a, b) if len(a) == 3 else 0.0
