# SPDX-License-Identifier: Apache-2.0
"""MuJoCo: RK4, and its default semi-implicit Euler.

All steps run in one call, so the loop is in C. A ball, or a body with a surface, meets the table
by MuJoCo's own contact.
"""

import itertools

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.study.precision.peers import ball, body, given, pendulum, plane
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
SOFT = 2.0
"""Time constant of a contact in steps, the least it takes; the error grows in proportion to it."""
SURFACE = """<mujoco><option integrator="{integrator}" timestep="{step!r}" \
gravity="0 0 {gravity!r}" cone="elliptic" impratio="{ratio!r}"/>
<default><geom friction="{mu!r} 0 0" condim="3" solref="{soft!r} 1" solimp="0.99 0.9999 1e-5"/>\
</default><worldbody><geom type="plane" size="0 0 1"/><body><freejoint/>\
<inertial pos="0 0 0" mass="{mass!r}" fullinertia="{inertia}"/>\
<geom type="{shape}" size="{size}" pos="{middle}"/></body></worldbody></mujoco>"""
BALL = '<geom type="sphere" size="{1!r}" friction="{0!r} 0 0"/>'


def version():
    """Return the version that is installed."""
    import mujoco
    return mujoco.__version__


def runners(problem, reference):
    """Yield MuJoCo with both of its methods; for a body with a surface, with what users set."""
    if plane.has_surface(problem.scene):
        yield from _on_a_plane(plane.of(problem.scene), steps_for(problem, reference))
        return
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
        inertia=_six(inertia))


def _six(inertia):
    return _spaced(inertia[pair] for pair in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))


def _spaced(values):
    return ' '.join(repr(float(value)) for value in values)


def _run(scene, numbers, integrator, step):
    """Return the Run of a scene."""
    model, data = _made(_text(scene, numbers, integrator, step))
    turns = isinstance(numbers, body.Body)
    if turns:
        model.dof_damping[-3:] = numbers.damping[0, 0]

    def again():
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

    def state():
        if isinstance(numbers, pendulum.Pendulum):
            return numbers.state((data.qpos[0], data.qvel[0]))
        return numbers.state(_turned(data, isinstance(numbers, ball.Ball)))
    return _stepping(model, data, step, again, state)


def _on_a_plane(numbers, steps):
    """Yield the Runners of a body with a surface.

    They differ in the integrator and in how much stiffer friction is than the normal force.
    """
    for integrator, ratio in itertools.product(('RK4', 'implicitfast'), (1.0, 100.0)):
        yield Runner(NAME, 'step', steps,
                     lambda step, integrator=integrator, ratio=ratio: _touching(
                         numbers, step, integrator, ratio),
                     True, f'{integrator}, impratio {ratio:g}')


def _touching(numbers, step, integrator, ratio):
    """Return the Run of a body with a surface."""
    a = numbers.radius
    model, data = _made(SURFACE.format(
        integrator=integrator, step=step, gravity=-numbers.g, ratio=ratio,
        mu=numbers.mu, soft=SOFT * step, mass=numbers.mass, inertia=_six(numbers.inertia),
        shape='cylinder' if numbers.disk else 'sphere', middle=_spaced(numbers.middle),
        size=_spaced((a, plane.THICK * a) if numbers.disk else (a,))))
    x, y, z, w = numbers.start[:4]

    def again():
        data.qpos[:] = *numbers.place, w, x, y, z
        data.qvel[:] = *numbers.velocity, *numbers.in_body()
    return _stepping(model, data, step, again, lambda: numbers.state(_turned(data, True)))


def _made(text):
    """Return the model of a text, and its data."""
    import mujoco
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        raise RefusedError(f'it refuses the body: {str(error).splitlines()[0]}') from None
    # otherwise MuJoCo writes a file into the current folder
    mujoco.set_mju_user_warning(lambda text: None)
    return model, mujoco.MjData(model)


def _turned(data, in_world):
    """Return q, and omega in axes of the world or of the body."""
    w, x, y, z = data.qpos[-4:]
    omega = data.qvel[-3:]
    return x, y, z, w, *(rotate(x, y, z, w, *omega) if in_world else omega)


def _stepping(model, data, step, again, state):
    """Return the Run of a loop of steps; `again` goes back to the start."""
    import mujoco
    done = 0

    def begin():
        nonlocal done
        mujoco.mj_resetData(model, data)
        again()
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
    return Run(begin, to, state)
