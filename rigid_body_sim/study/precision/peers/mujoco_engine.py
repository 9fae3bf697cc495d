"""MuJoCo: RK4, and its default semi-implicit Euler; all steps in one call, so the loop runs in C."""

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.study.precision.peers import body
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner, steps_for

NAME = 'MuJoCo'
SCENE = """<mujoco><option integrator="{integrator}" timestep="{step!r}" gravity="0 0 {gravity!r}"><flag contact="disable"/></option><worldbody>
<body><joint type="{joint}"/><inertial pos="{place}" mass="{mass!r}" fullinertia="{inertia}"/></body></worldbody></mujoco>"""


def version():
    """Return the version that is installed."""
    import mujoco
    return mujoco.__version__


def runners(problem, reference):
    """Yield MuJoCo with both of its methods."""
    given = body.of(problem)
    if given.inner:
        raise RefusedError('internal dissipation: it has no such effect')
    if np.abs(given.damping - given.damping[0, 0] * np.eye(3)).max() > 0.0:
        raise RefusedError('drag on the centre of mass of a pivoted body: its joints damp all axes alike')
    steps = steps_for(problem, reference)
    for label, integrator in (('RK4', 'RK4'), ('default (Euler)', 'Euler')):
        yield Runner(f'{NAME} {label}', 'step', steps, lambda step, integrator=integrator: _run(problem, given, integrator, step), True)


def _run(problem, given, integrator, step):
    import mujoco
    scene, free = problem.scene, problem.scene.constraint.kind == 'free'
    gravity = scene.effect('gravity')
    mass, inertia, arm = scene.body.mass, *given.about_center(scene)
    text = SCENE.format(
        integrator=integrator, step=step, gravity=0.0 if free or not gravity else -gravity.g, joint='free' if free else 'ball', mass=mass,
        place=' '.join(map(repr, arm.tolist())),
        inertia=' '.join(repr(float(inertia[pair])) for pair in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))))
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        raise RefusedError(f'it refuses the body: {str(error).splitlines()[0]}') from None
    data = mujoco.MjData(model)
    mujoco.set_mju_user_warning(lambda text: None)    # else it writes a file into the present folder
    model.dof_damping[-3:] = given.damping[0, 0]
    x, y, z, w = given.start[:4]
    done = 0

    def begin():
        nonlocal done
        mujoco.mj_resetData(model, data)
        data.qpos[-4:] = w, x, y, z
        data.qvel[-3:] = given.start[4:]
        data.qfrc_applied[-3:] = given.torque
        data.xfrc_applied[1, 3:] = given.push
        done = 0

    def to(time):
        nonlocal done
        steps = body.whole_steps(time, step)
        mujoco.mj_step(model, data, nstep=steps - done)
        done = steps
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
            raise NotConverged(f'{NAME}: at a step of {step:.3g} s it finds NaN and starts anew from its first pose, with a warning')

    def state():
        w, x, y, z = data.qpos[-4:]
        return given.state((x, y, z, w, *data.qvel[-3:]))
    return Run(begin, to, state)
