"""PyBullet: its step is one call from Python, there is no other way; damping is switched off."""

import importlib.metadata

import numpy as np

from rigid_body_sim.rotations import rotate, rotate_back
from rigid_body_sim.study.precision.peers import body
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner, steps_for

NAME = 'PyBullet'


def version():
    """Return the version that is installed."""
    import pybullet  # noqa: F401
    return importlib.metadata.version('pybullet')


def runners(problem, reference):
    """Yield the one method there is."""
    given = body.of(problem)
    if given.inner or np.any(given.damping):
        raise RefusedError('drag or internal dissipation: its damping is a factor a step, another law')
    yield Runner(NAME, 'step', steps_for(problem, reference), lambda step: _run(problem, given, step), True)


def _run(problem, given, step):
    import pybullet as engine
    scene, free = problem.scene, problem.scene.constraint.kind == 'free'
    inertia, arm = given.about_center(scene)
    if np.abs(inertia - np.diag(np.diag(inertia))).max() > 1e-12 * inertia.max():
        raise RefusedError('the principal axes about the centre of mass are not those about the pivot: it takes three moments only')
    gravity = scene.effect('gravity')
    client = engine.connect(engine.DIRECT)
    engine.setPhysicsEngineParameter(fixedTimeStep=step, numSubSteps=0, physicsClientId=client)
    engine.setGravity(0.0, 0.0, 0.0 if free or not gravity else -gravity.g, physicsClientId=client)
    one = engine.createMultiBody(baseMass=scene.body.mass, physicsClientId=client)
    engine.changeDynamics(one, -1, localInertiaDiagonal=np.diag(inertia).tolist(), linearDamping=0.0, angularDamping=0.0, maxJointVelocity=1e9,
                          physicsClientId=client)
    if not free:
        engine.createConstraint(one, -1, -1, -1, engine.JOINT_POINT2POINT, [0, 0, 0], (-arm).tolist(), [0, 0, 0], physicsClientId=client)
    q, omega = given.start[:4], given.start[4:]
    spin = rotate(*q, *omega)
    place = np.array(rotate(*q, *arm))
    done = 0

    def begin():
        nonlocal done
        engine.resetBasePositionAndOrientation(one, place.tolist(), q.tolist(), physicsClientId=client)
        engine.resetBaseVelocity(one, np.cross(spin, place).tolist(), list(spin), physicsClientId=client)
        done = 0

    def to(time):
        nonlocal done
        steps = body.whole_steps(time, step)
        driven = np.any(given.torque) or np.any(given.push)
        for _ in range(steps - done):
            if driven:
                now = engine.getBasePositionAndOrientation(one, physicsClientId=client)[1]
                torque = np.add(rotate(*now, *given.torque), given.push).tolist()
                engine.applyExternalTorque(one, -1, torque, engine.WORLD_FRAME, physicsClientId=client)
            engine.stepSimulation(physicsClientId=client)
        done = steps

    def state():
        _, q = engine.getBasePositionAndOrientation(one, physicsClientId=client)
        _, spin = engine.getBaseVelocity(one, physicsClientId=client)
        return given.state((*q, *rotate_back(*q, *spin)))
    return Run(begin, to, state)
