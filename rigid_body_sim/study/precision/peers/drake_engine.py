# SPDX-License-Identifier: Apache-2.0
"""Drake: a continuous MultibodyPlant under Runge-Kutta of 5th and 3rd order with error control.

Contact uses its discrete solver.
"""

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.study.precision.peers import ball, body, given, pendulum, plane
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner, steps_for

NAME = 'Drake'
ACCURACIES = tuple(10.0 ** -k for k in range(1, 13))
MAX_STEP = 0.1
"""Default of Drake, s."""
CONTACT = 'kSap', 'kLagged', 'kTamsi'
DEEP, CREEP = 1e-5, 1e-4
"""How far a body with a surface sinks, over its size; at what speed friction holds it, m/s."""


def version():
    """Return the version that is installed."""
    import importlib.metadata

    import pydrake.multibody.plant  # noqa: F401
    return importlib.metadata.version('drake')


def runners(problem, reference):
    """Yield Drake with two of its methods; for contact, with its solvers at fixed steps."""
    if plane.has_surface(problem.scene):
        numbers, steps = plane.of(problem.scene), steps_for(problem, reference)
        for solver in CONTACT:
            yield Runner(NAME, 'step', steps,
                         lambda step, solver=solver: _touching(numbers, step, solver), True,
                         solver)
        return
    numbers = given.of(problem)
    if isinstance(numbers, ball.Ball):
        steps = steps_for(problem, reference)
        yield Runner(f'{NAME} discrete', 'step', steps,
                     lambda step: _run(problem.scene, numbers, step, None, None), True)
        return
    if isinstance(numbers, body.Body):
        numbers.refuse_what_joints_lack()
    for label, scheme in (('RK5', 'runge_kutta5'), ('RK3', 'runge_kutta3')):
        yield Runner(
            f'{NAME} {label}', 'accuracy', ACCURACIES,
            lambda accuracy, scheme=scheme: _run(problem.scene, numbers, 0.0, scheme, accuracy),
            True)


def _run(scene, numbers, step, scheme, accuracy):
    """Return the Run of a scene.

    More than forty lines: what builds the model, and what runs it, share the objects of the peer.
    """
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
    from pydrake.systems.framework import DiagramBuilder
    kind, gravity = scene.constraint.kind, scene.effect('gravity')
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, step)
    if isinstance(numbers, body.Body):
        inertia, arm = numbers.about_center(scene)
    else:
        inertia, arm = scene.body.about_center.matrix, np.array(scene.body.center_of_mass)
    turning = plant.AddRigidBody('body', _spatial(scene.body.mass, arm, inertia))
    g = numbers.g if kind == 'table' else gravity.g if gravity and kind != 'free' else 0.0
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -g])
    joint = _joined(plant, turning, scene, numbers)
    plant.Finalize()
    force = _drive(builder, plant, turning, numbers)
    diagram = builder.Build()
    simulator = Simulator(diagram)
    if scheme:
        ResetIntegratorFromFlags(simulator, scheme, MAX_STEP).set_target_accuracy(accuracy)
    whole = simulator.get_mutable_context()
    context = plant.GetMyMutableContextFromRoot(whole)
    force(whole)

    def state():
        if isinstance(numbers, pendulum.Pendulum):
            return numbers.state((joint.get_angle(context), joint.get_angular_rate(context)))
        return numbers.state(_turned(plant, context, turning, isinstance(numbers, ball.Ball)))
    return _advancing(simulator, diagram, _beginning(plant, context, turning, joint, numbers),
                      state)


def _turned(plant, context, turning, in_world):
    """Return q, and omega in axes of the world or of the body."""
    pose = plant.EvalBodyPoseInWorld(context, turning)
    quaternion = pose.rotation().ToQuaternion()
    spin = plant.EvalBodySpatialVelocityInWorld(context, turning).rotational()
    omega = spin if in_world else pose.rotation().matrix().T @ spin
    return quaternion.x(), quaternion.y(), quaternion.z(), quaternion.w(), *omega


def _advancing(simulator, diagram, again, state):
    """Return the Run of a simulator; `again` goes back to the start."""
    whole = simulator.get_mutable_context()

    def begin():
        whole.SetTime(0.0)
        again()
        simulator.Initialize()

    def to(time):
        try:
            simulator.AdvanceTo(time)
        except RuntimeError as error:
            raise NotConverged(f'{NAME}: {str(error).splitlines()[0]}') from None
    run = Run(begin, to, state)
    run.keeps = simulator, diagram
    return run


def _touching(numbers, step, solver):
    """Return the Run of a body with a surface."""
    from pydrake.geometry import Cylinder, HalfSpace, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import (
        AddMultibodyPlantSceneGraph,
        ContactModel,
        CoulombFriction,
        DiscreteContactApproximation,
    )
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder
    builder, a = DiagramBuilder(), numbers.radius
    friction = CoulombFriction(numbers.mu, numbers.mu)
    plant, _ = AddMultibodyPlantSceneGraph(builder, step)
    plant.set_contact_model(ContactModel.kPoint)
    plant.set_discrete_contact_approximation(getattr(DiscreteContactApproximation, solver))
    turning = plant.AddRigidBody('body', _spatial(numbers.mass, np.zeros(3), numbers.inertia))
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -numbers.g])
    shape = Cylinder(a, 2.0 * plane.THICK * a) if numbers.disk else Sphere(a)
    plant.RegisterCollisionGeometry(
        plant.world_body(), RigidTransform(), HalfSpace(), 'table', friction)
    plant.RegisterCollisionGeometry(
        turning, RigidTransform(numbers.middle), shape, 'body', friction)
    plant.Finalize()
    plant.set_penetration_allowance(DEEP * a)
    plant.set_stiction_tolerance(CREEP)
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    x, y, z, w = numbers.start[:4]

    def again():
        plant.SetPositions(context, np.array([w, x, y, z, *numbers.place]))
        plant.SetVelocities(context, np.array([*numbers.start[4:], *numbers.velocity]))
    return _advancing(simulator, diagram, again, lambda: numbers.state(
        _turned(plant, context, turning, True)))


def _spatial(mass, arm, inertia):
    from pydrake.multibody.tree import RotationalInertia, SpatialInertia, UnitInertia
    about = np.asarray(inertia) + (mass * (arm @ arm * np.eye(3) - np.outer(arm, arm)))
    try:
        unit = UnitInertia().SetFromRotationalInertia(
            RotationalInertia(*np.diag(about), about[0, 1], about[0, 2], about[1, 2]), mass)
        return SpatialInertia(mass, arm, unit)
    except RuntimeError as error:
        raise RefusedError(f'it refuses the body: {str(error).splitlines()[0]}') from None


def _joined(plant, turning, scene, numbers):
    """Add and return the joint that holds the body, with its damping; for a ball the table too."""
    from pydrake.geometry import HalfSpace, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import CoulombFriction
    from pydrake.multibody.tree import (
        BallRpyJoint,
        FixedOffsetFrame,
        LinearSpringDamper,
        QuaternionFloatingJoint,
        RevoluteJoint,
        RevoluteSpring,
    )
    world, frame = plant.world_frame(), turning.body_frame()
    if isinstance(numbers, pendulum.Pendulum):
        through = np.array(scene.constraint.through)
        held = plant.AddFrame(FixedOffsetFrame('held', frame, RigidTransform(through)))
        turn = _rotation(numbers.orientation)
        base = plant.AddFrame(FixedOffsetFrame(
            'base', world, RigidTransform(turn, turn.matrix() @ through)))
        joint = plant.AddJoint(RevoluteJoint('hinge', base, held, numbers.axis, numbers.friction))
        plant.AddJointActuator('motor', joint)
        if numbers.stiffness:
            plant.AddForceElement(RevoluteSpring(joint, numbers.slack, numbers.stiffness))
        return joint
    if isinstance(numbers, ball.Ball):
        friction = CoulombFriction(numbers.mu, numbers.mu)
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(), HalfSpace(), 'table', friction)
        plant.RegisterCollisionGeometry(
            turning, RigidTransform(), Sphere(numbers.radius), 'ball', friction)
        return plant.AddJoint(QuaternionFloatingJoint('flight', world, frame))
    damping = numbers.damping[0, 0]
    if numbers.tie:
        at, anchor, stiffness, length = numbers.tie
        plant.AddForceElement(LinearSpringDamper(
            plant.world_body(), anchor, turning, at, length, stiffness, 0.0))
    if scene.constraint.kind == 'free':
        return plant.AddJoint(QuaternionFloatingJoint('flight', world, frame, damping))
    return plant.AddJoint(BallRpyJoint('pivot', world, frame, damping))


def _drive(builder, plant, turning, numbers):
    """Connect the torque on the body; return the function that sets it in the context.

    A couple fixed in the body is a propeller without thrust.
    """
    from pydrake.math import RigidTransform, RotationMatrix
    from pydrake.multibody.math import SpatialForce
    from pydrake.multibody.plant import ExternallyAppliedSpatialForce, Propeller
    if isinstance(numbers, pendulum.Pendulum):
        return lambda whole: plant.get_actuation_input_port().FixValue(
            plant.GetMyMutableContextFromRoot(whole), [numbers.torque])
    if isinstance(numbers, ball.Ball) or not (np.any(numbers.torque) or np.any(numbers.push)):
        return lambda whole: None
    if np.any(numbers.torque) and np.any(numbers.push):
        raise RefusedError('a couple in the body and one in the world at once: '
                           'its one port would have to be fed by a system of its user')
    if np.any(numbers.push):
        applied = ExternallyAppliedSpatialForce()
        applied.body_index, applied.F_Bq_W = (
            turning.index(), SpatialForce(numbers.push, np.zeros(3)))
        port = plant.get_applied_spatial_force_input_port()
        return lambda whole: port.FixValue(plant.GetMyMutableContextFromRoot(whole), [applied])
    place = RigidTransform(RotationMatrix.MakeFromOneVector(numbers.torque, 2), np.zeros(3))
    propeller = builder.AddSystem(Propeller(turning.index(), place, 0.0, 1.0))
    builder.Connect(
        propeller.get_spatial_forces_output_port(), plant.get_applied_spatial_force_input_port())
    builder.Connect(plant.get_body_poses_output_port(), propeller.get_body_poses_input_port())
    size = float(np.linalg.norm(numbers.torque))
    return lambda whole: propeller.get_command_input_port().FixValue(
        propeller.GetMyMutableContextFromRoot(whole), [size])


def _beginning(plant, context, turning, joint, numbers):
    """Return the function that puts the body at its start."""
    from pydrake.math import RollPitchYaw
    if isinstance(numbers, pendulum.Pendulum):
        def hinge():
            joint.set_angle(context, 0.0)
            joint.set_angular_rate(context, numbers.start[1])
        return hinge
    x, y, z, w = numbers.start[:4]
    rotation = _rotation(numbers.start[:4])
    if isinstance(numbers, ball.Ball):
        positions, velocities = (
            np.array([w, x, y, z, 0.0, 0.0, numbers.radius]), np.array([*numbers.start[4:], 0.0]))
    else:
        positions, velocities = (
            np.array([w, x, y, z, 0.0, 0.0, 0.0]),
            np.concatenate([rotation.matrix() @ numbers.start[4:], np.zeros(3)]))
    if plant.num_positions() == 3:
        positions, velocities = RollPitchYaw(rotation).vector(), velocities[:3]

    def again():
        plant.SetPositions(context, positions)
        plant.SetVelocities(context, velocities)
    return again


def _rotation(q):
    from pydrake.math import RotationMatrix
    x, y, z, w = q
    return RotationMatrix(np.array([
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)]]))
