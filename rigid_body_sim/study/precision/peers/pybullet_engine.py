# SPDX-License-Identifier: Apache-2.0
"""PyBullet: each step is one call from Python, for lack of another way.

Its own damping is switched off.
"""

import importlib.metadata
import tempfile

import numpy as np

from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.study.precision.peers import ball, body, given, pendulum, plane
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner, steps_for

NAME = 'PyBullet'
URDF = """<robot name="pendulum"><link name="base"/>
<link name="body"><inertial><origin xyz="{place}"/><mass value="{mass!r}"/>\
<inertia {inertia}/></inertial></link>
<joint name="hinge" type="continuous"><parent link="base"/><child link="body"/>\
<axis xyz="{axis}"/><origin xyz="{through}"/></joint></robot>"""


def version():
    """Return the version that is installed."""
    import pybullet  # noqa: F401
    return importlib.metadata.version('pybullet')


def runners(problem, reference):
    """Yield its only method; for a body with a surface, with what users set."""
    if plane.has_surface(problem.scene):
        numbers, steps = plane.of(problem.scene), steps_for(problem, reference)
        for erp in (0.0, 0.2):
            yield Runner(NAME, 'step', steps,
                         lambda step, erp=erp: _touching(numbers, step, erp), True, f'erp {erp:g}')
        return
    numbers = given.of(problem)
    if isinstance(numbers, body.Body) and numbers.inner:
        raise RefusedError('internal dissipation: it has no such effect')
    made = {body.Body: _turning, pendulum.Pendulum: _swinging, ball.Ball: _rolling}[type(numbers)]
    yield Runner(NAME, 'step', steps_for(problem, reference),
                 lambda step: made(problem.scene, numbers, step), True)


def _engine(step, g):
    """Return the module, and the keywords that select a world of its own."""
    import pybullet as engine
    world = {'physicsClientId': engine.connect(engine.DIRECT)}
    engine.setPhysicsEngineParameter(fixedTimeStep=step, numSubSteps=0, **world)
    engine.setGravity(0.0, 0.0, -g, **world)
    return engine, world


def _spaced(values):
    return ' '.join(repr(float(value)) for value in values)


def _undamped(engine, world, one, moments, **more):
    engine.changeDynamics(
        one, -1, localInertiaDiagonal=list(map(float, moments)), linearDamping=0.0,
        angularDamping=0.0, maxJointVelocity=1e9, **more, **world)


def _stepping(engine, world, step, again, push, state):
    """Return the Run of a loop of steps.

    `again` goes back to the start; `push`, if any, applies what is not part of the world.
    """
    done = 0

    def begin():
        nonlocal done
        again()
        done = 0

    def to(time):
        nonlocal done
        steps = body.whole_steps(time, step)
        for _ in range(steps - done):
            if push:
                push()
            engine.stepSimulation(**world)
        done = steps
    return Run(begin, to, state)


def _turning(scene, numbers, step):
    free, gravity = scene.constraint.kind == 'free', scene.effect('gravity')
    inertia, arm = numbers.about_center(scene)
    if np.abs(inertia - np.diag(np.diag(inertia))).max() > 1e-12 * inertia.max():
        raise RefusedError(
            'the principal axes about the centre of mass are not those about the pivot: '
            'it takes three moments only')
    engine, world = _engine(step, 0.0 if free or not gravity else gravity.g)
    one = engine.createMultiBody(baseMass=scene.body.mass, **world)
    _undamped(engine, world, one, np.diag(inertia))
    if not free:
        engine.createConstraint(one, -1, -1, -1, engine.JOINT_POINT2POINT, [0, 0, 0],
                                (-arm).tolist(), [0, 0, 0], **world)
    q, omega = numbers.start[:4], numbers.start[4:]
    spin, place = rotate(*q, *omega), np.array(rotate(*q, *arm))
    torques = numbers.torques()

    def again():
        engine.resetBasePositionAndOrientation(one, place.tolist(), q.tolist(), **world)
        engine.resetBaseVelocity(one, np.cross(spin, place).tolist(), list(spin), **world)

    def push():
        now = engine.getBasePositionAndOrientation(one, **world)[1]
        omega = np.array(rotate_back(*now, *engine.getBaseVelocity(one, **world)[1]))
        torque = rotate(*now, *sum(one(now, omega) for one in torques))
        engine.applyExternalTorque(one, -1, torque, engine.WORLD_FRAME, **world)

    def state():
        q = engine.getBasePositionAndOrientation(one, **world)[1]
        return numbers.state((*q, *rotate_back(*q, *engine.getBaseVelocity(one, **world)[1])))
    return _stepping(engine, world, step, again, push if torques else None, state)


def _swinging(scene, numbers, step):
    """Return the Run of a revolute joint on a fixed base, from a URDF file as users write it."""
    gravity, body_, through = scene.effect('gravity'), scene.body, scene.constraint.through
    engine, world = _engine(step, gravity.g if gravity else 0.0)
    inertia = body_.about_center.matrix
    text = URDF.format(axis=_spaced(numbers.axis), through=_spaced(through),
                       place=_spaced(np.subtract(body_.center_of_mass, through)), mass=body_.mass,
                       inertia=' '.join(f'i{"xyz"[i]}{"xyz"[j]}="{float(inertia[i, j])!r}"'
                                        for i in range(3) for j in range(i, 3)))
    with tempfile.NamedTemporaryFile('w', suffix='.urdf') as file:
        file.write(text)
        file.flush()
        one = engine.loadURDF(file.name, baseOrientation=list(map(float, numbers.orientation)),
                              useFixedBase=True, flags=engine.URDF_USE_INERTIA_FROM_FILE, **world)
    engine.changeDynamics(one, 0, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0,
                          maxJointVelocity=1e9, **world)
    # otherwise a motor brakes it
    engine.setJointMotorControl2(one, 0, engine.VELOCITY_CONTROL, force=0.0, **world)

    def push():
        angle, rate = engine.getJointState(one, 0, **world)[:2]
        torque = (numbers.torque + numbers.stiffness * (numbers.slack - angle)
                  - numbers.friction * rate)
        engine.setJointMotorControl2(one, 0, engine.TORQUE_CONTROL, force=torque, **world)

    return _stepping(engine, world, step,
                     lambda: engine.resetJointState(one, 0, 0.0, float(numbers.start[1]), **world),
                     push if numbers.torque or numbers.friction or numbers.stiffness else None,
                     lambda: numbers.state(engine.getJointState(one, 0, **world)[:2]))


def _rolling(scene, numbers, step):
    """Return the Run of a sphere on a plane, with PyBullet's own contact.

    It multiplies the two coefficients of friction.
    """
    engine, world = _engine(step, numbers.g)
    shape = engine.createCollisionShape(engine.GEOM_SPHERE, radius=numbers.radius, **world)
    start = [0.0, 0.0, numbers.radius], [*numbers.start[7:], 0.0]
    return _on_a_table(engine, world, step, numbers, shape, scene.body.mass,
                       scene.body.about_center.moments, start)


def _touching(numbers, step, erp):
    """Return the Run of a body with a surface.

    `erp` is the share of an error of the contact that a step corrects. More iterations of its
    solver than the default change no error.
    """
    engine, world = _engine(step, numbers.g)
    engine.setPhysicsEngineParameter(erp=erp, contactERP=erp, frictionERP=erp, **world)
    a = numbers.radius
    settings = {'radius': a, 'collisionFramePosition': numbers.middle.tolist(), **world}
    shape = (engine.createCollisionShape(
                 engine.GEOM_CYLINDER, height=2.0 * plane.THICK * a, **settings)
             if numbers.disk else engine.createCollisionShape(engine.GEOM_SPHERE, **settings))
    return _on_a_table(engine, world, step, numbers, shape, numbers.mass,
                       np.diag(numbers.inertia), (numbers.place, numbers.velocity))


def _on_a_table(engine, world, step, numbers, shape, mass, moments, start):
    """Return the Run of a shape on a plane, from its place and its velocity (start)."""
    table = engine.createMultiBody(
        0.0, engine.createCollisionShape(engine.GEOM_PLANE, **world), **world)
    engine.changeDynamics(table, -1, lateralFriction=1.0, restitution=0.0, **world)
    one = engine.createMultiBody(mass, shape, **world)
    _undamped(engine, world, one, moments, lateralFriction=numbers.mu, rollingFriction=0.0,
              spinningFriction=0.0, restitution=0.0)
    place, velocity = ([float(x) for x in vector] for vector in start)
    q, omega = numbers.start[:4].tolist(), numbers.start[4:7].tolist()

    def again():
        engine.resetBasePositionAndOrientation(one, place, q, **world)
        engine.resetBaseVelocity(one, velocity, omega, **world)

    def state():
        return numbers.state((*engine.getBasePositionAndOrientation(one, **world)[1],
                              *engine.getBaseVelocity(one, **world)[1]))
    return _stepping(engine, world, step, again, None, state)
