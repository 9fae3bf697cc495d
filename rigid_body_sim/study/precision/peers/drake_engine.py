"""Drake: a continuous MultibodyPlant under its 5th-order Runge-Kutta with error control, and its default of 3rd order."""

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.study.precision.peers import body
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner

NAME = 'Drake'
ACCURACIES = tuple(10.0 ** -k for k in range(1, 13))
MAX_STEP = 0.1
"""Drake's own default, s."""


def version():
    """Return the version that is installed."""
    import importlib.metadata

    import pydrake.multibody.plant  # noqa: F401
    return importlib.metadata.version('drake')


def runners(problem, reference):
    """Yield Drake with two of its methods."""
    given = body.of(problem)
    if given.inner:
        raise RefusedError('internal dissipation: it has no such effect')
    if np.any(given.torque) or np.any(given.push) or np.any(given.damping):
        raise RefusedError('a torque or drag on a free body: its user writes a system in Python for it, which would be what is timed')
    for label, scheme in (('RK5', 'runge_kutta5'), ('RK3', 'runge_kutta3')):
        yield Runner(f'{NAME} {label}', 'accuracy', ACCURACIES, lambda accuracy, scheme=scheme: _run(problem, given, scheme, accuracy), True)


def _run(problem, given, scheme, accuracy):
    from pydrake.math import RollPitchYaw, RotationMatrix
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import BallRpyJoint, RotationalInertia, SpatialInertia, UnitInertia
    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
    scene, free = problem.scene, problem.scene.constraint.kind == 'free'
    inertia, arm = given.about_center(scene)
    mass = scene.body.mass
    plant = MultibodyPlant(time_step=0.0)
    about = np.asarray(inertia) + (mass * (arm @ arm * np.eye(3) - np.outer(arm, arm)))
    unit = UnitInertia().SetFromRotationalInertia(RotationalInertia(*np.diag(about), about[0, 1], about[0, 2], about[1, 2]), mass)
    try:
        turning = plant.AddRigidBody('body', SpatialInertia(mass, arm, unit))
    except RuntimeError as error:
        raise RefusedError(f'it refuses the body: {str(error).splitlines()[0]}') from None
    gravity = scene.effect('gravity')
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0 if free or not gravity else -gravity.g])
    joint = None if free else plant.AddJoint(BallRpyJoint('pivot', plant.world_frame(), turning.body_frame()))
    plant.Finalize()
    simulator = Simulator(plant)
    integrator = ResetIntegratorFromFlags(simulator, scheme, MAX_STEP)
    integrator.set_target_accuracy(accuracy)
    context = simulator.get_mutable_context()
    q, omega = given.start[:4], given.start[4:]
    rotation = RotationMatrix(_matrix(q))
    angles = RollPitchYaw(rotation).vector()

    def begin():
        context.SetTime(0.0)
        if free:
            positions = np.zeros(7)
            positions[:4] = q[3], *q[:3]
            plant.SetPositions(context, positions)
            plant.SetVelocities(context, np.concatenate([rotation.matrix() @ omega, np.zeros(3)]))
        else:
            joint.set_angles(context, angles)
            joint.set_angular_velocity(context, rotation.matrix() @ omega)
        simulator.Initialize()

    def to(time):
        try:
            simulator.AdvanceTo(time)
        except RuntimeError as error:
            raise NotConverged(f'{NAME}: {str(error).splitlines()[0]}') from None

    def state():
        pose = plant.EvalBodyPoseInWorld(context, turning)
        quaternion = pose.rotation().ToQuaternion()
        spin = plant.EvalBodySpatialVelocityInWorld(context, turning).rotational()
        return given.state((quaternion.x(), quaternion.y(), quaternion.z(), quaternion.w(), *(pose.rotation().matrix().T @ spin)))
    return Run(begin, to, state)


def _matrix(q):
    x, y, z, w = q
    return np.array([[1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
                     [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
                     [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)]])
