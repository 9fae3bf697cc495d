# SPDX-License-Identifier: Apache-2.0
"""MuJoCo: RK4, and its default semi-implicit Euler.

All steps run in one call, so the loop is in C. A ball meets the table by MuJoCo's own contact.
"""

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.study.precision.peers import ball, body, given, pendulum
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner, steps_for

NAME = 'MuJoCo'
SCENE = """<mujoco><compiler angle="radian"/>\
<option integrator="{integrator}" timestep="{step!r}" \
gravity="0 0 {gravity!r}" cone="elliptic">
<flag contact="{contact}"/></option><worldbody>{table}
<body pos="{origin}" quat="{attitude}">{joint}\
<inertial pos="{place}" mass="{mass!r}" fullinertia="{inertia}"/>{shape}</body>
{anchor}</worldbody>{tendon}</mujoco>"""
SITE = '<site name="{0}" pos="{1}"/>'
TENDON = ('<tendon><spatial stiffness="{0!r}" springlength="{1!r}"><site site="at"/>'
          '<site site="anchor"/></spatial></tendon>')
TABLE = '<geom type="plane" size="0 0 1" friction="{0!r} 0 0"/>'
BALL = '<geom type="sphere" size="{1!r}" friction="{0!r} 0 0"/>'


def version():
    """Return the version that is installed."""
    import mujoco
    return mujoco.__version__


def runners(problem, reference):
    """Yield MuJoCo with both of its methods."""
    numbers = given.of(problem)
    if isinstance(numbers, body.Body):
        numbers.refuse_what_joints_lack()
    steps = steps_for(problem, reference)
    for label, integrator in (('RK4', 'RK4'), ('default (Euler)', 'Euler')):
        yield Runner(
            f'{NAME} {label}', 'step', steps,
            lambda step, integrator=integrator: _run(problem.scene, numbers, integrator, step),
            True)


def _text(scene, numbers, integrator, step):
    """Return the text of the model.

    Its body frame is that of the peer's numbers, which for a hinge and a ball is the scene's.
    """
    kind, gravity = scene.constraint.kind, scene.effect('gravity')
    g = (gravity.g if gravity and kind in ('pivot', 'hinge') else numbers.g if kind == 'table'
         else 0.0)
    attitude, origin, table, shape = (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), '', ''
    anchor, tendon = '', ''
    if isinstance(numbers, body.Body):
        inertia, arm = numbers.about_center(scene)
        joint = f'<joint type="{"free" if kind == "free" else "ball"}"/>'
        if numbers.tie:
            at, place, stiffness, length = numbers.tie
            shape, anchor = SITE.format('at', _spaced(at)), SITE.format('anchor', _spaced(place))
            tendon = TENDON.format(stiffness, length)
    else:
        inertia, arm = scene.body.about_center.matrix, np.array(scene.body.center_of_mass)
        joint = '<joint type="free"/>'
    if kind == 'hinge':
        attitude = numbers.orientation
        joint = (f'<joint type="hinge" axis="{_spaced(numbers.axis)}" '
                 f'pos="{_spaced(scene.constraint.through)}" damping="{numbers.friction!r}" '
                 f'stiffness="{numbers.stiffness!r}" springref="{numbers.slack!r}"/>')
    elif kind == 'table':
        origin, table, shape = (
            (0.0, 0.0, numbers.radius),
            TABLE.format(numbers.mu),
            BALL.format(numbers.mu, numbers.radius),
        )
    return SCENE.format(
        integrator=integrator, step=step, gravity=-g,
        contact='enable' if kind == 'table' else 'disable', table=table, joint=joint, shape=shape,
        anchor=anchor, tendon=tendon,
        mass=scene.body.mass, origin=_spaced(origin),
        attitude=_spaced((attitude[3], *attitude[:3])), place=_spaced(arm),
        inertia=_spaced(inertia[pair]
                        for pair in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))))


def _spaced(values):
    return ' '.join(repr(float(value)) for value in values)


def _run(scene, numbers, integrator, step):
    """Return the Run of a scene.

    More than forty lines: what builds the model, and what runs it, share the objects of the peer.
    """
    import mujoco
    try:
        model = mujoco.MjModel.from_xml_string(_text(scene, numbers, integrator, step))
    except ValueError as error:
        raise RefusedError(f'it refuses the body: {str(error).splitlines()[0]}') from None
    data = mujoco.MjData(model)
    # otherwise MuJoCo writes a file into the current folder
    mujoco.set_mju_user_warning(lambda text: None)
    turns = isinstance(numbers, body.Body)
    if turns:
        model.dof_damping[-3:] = numbers.damping[0, 0]
    done = 0

    def begin():
        nonlocal done
        mujoco.mj_resetData(model, data)
        if turns:
            x, y, z, w = numbers.start[:4]
            data.qpos[-4:] = w, x, y, z
            data.qvel[-3:] = numbers.start[4:]
            data.qfrc_applied[-3:] = numbers.torque
            data.xfrc_applied[1, 3:] = numbers.push
        elif isinstance(numbers, pendulum.Pendulum):
            data.qvel[0] = numbers.start[1]
            data.qfrc_applied[0] = numbers.torque
        else:
            x, y, z, w, *omega = numbers.start[:7]
            data.qpos[3:] = w, x, y, z
            data.qvel[:] = *numbers.start[7:], 0.0, *rotate_back(x, y, z, w, *omega)
        done = 0

    def to(time):
        nonlocal done
        steps = body.whole_steps(time, step)
        mujoco.mj_step(model, data, nstep=steps - done)
        done = steps
        if data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number:
            raise NotConverged(
                f'{NAME}: at a step of {step:.3g} s it finds NaN and starts anew from its first '
                'pose, with a warning')

    def state():
        if isinstance(numbers, pendulum.Pendulum):
            return numbers.state((data.qpos[0], data.qvel[0]))
        w, x, y, z = data.qpos[-4:]
        omega = data.qvel[-3:]
        return numbers.state((
            x, y, z, w,
            *(rotate(x, y, z, w, *omega) if isinstance(numbers, ball.Ball) else omega)))
    return Run(begin, to, state)
