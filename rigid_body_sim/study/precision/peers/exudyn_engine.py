# SPDX-License-Identifier: Apache-2.0
"""Exudyn: explicit Runge-Kutta on the group, at fixed and at controlled steps; generalized alpha.

A run is one call, so the loop is in C++, and so are the laws of drag, as symbolic functions. It is
the build without range checks.
"""

import importlib.metadata
import sys

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.study.precision import inputs
from rigid_body_sim.study.precision.peers import ball, body, given, pendulum, plane
from rigid_body_sim.study.precision.runner import RefusedError, Run, Runner, steps_for

NAME = 'Exudyn'
HELD = 1e30
"""Mass of a body with a fixed point, kg: the point does not move.

The moments are those about it, and the weight is a force at the centre of mass. So no constraint
is needed, which explicit methods solve to second order only.
"""
TOLERANCES = tuple(10.0 ** -k for k in range(1, 13))
FIRST, SHORTEST = 1e-3, 1e-5    # first and smallest step of the control, s
NEWTON = 1e-11, 1e-12    # relative and absolute tolerance of implicit steps


def version():
    """Return the version that is installed."""
    _engine()
    return importlib.metadata.version('exudyn')


def _engine():
    """Return the module, in its fast build."""
    if 'exudyn' not in sys.modules:
        sys.exudynFast = True
    import exudyn
    import exudyn.utilities  # attaches what makes items
    return exudyn


def runners(problem, reference):
    """Yield three of its methods; for a disk that rolls without slip, the implicit one."""
    if plane.has_surface(problem.scene):
        numbers, steps = plane.of(problem.scene), steps_for(problem, reference)
        if not (numbers.rolls and numbers.disk):
            raise RefusedError('ideal rolling of disks only; other contact is by penalties, '
                               'whose sizes are left to its user')
        for radius in (1.0, 0.9):
            yield Runner(f'{NAME} generalized alpha', 'step', steps,
                         lambda step, radius=radius: _rolling(numbers, step, radius), True,
                         f'spectral radius {radius:g}')
        return
    numbers = given.of(problem)
    if isinstance(numbers, ball.Ball):
        raise RefusedError('contact by penalties: their sizes are left to its user')
    if isinstance(numbers, body.Body) and numbers.inner:
        raise RefusedError('internal dissipation: it has no such effect')
    steps = steps_for(problem, reference)
    for label, scheme, control, settings in (
            ('RK67', 'RK67', 'step', steps), ('DOPRI5', 'DOPRI5', 'tolerance', TOLERANCES),
            ('generalized alpha', 'GeneralizedAlpha', 'step', steps)):
        yield Runner(
            f'{NAME} {label}', control, settings,
            lambda setting, scheme=scheme, control=control: _run(
                problem.scene, numbers, scheme, **{control: setting}), True)


def _settings(engine, step, tolerance):
    settings = engine.SimulationSettings()
    settings.solution.file.write = False
    time = settings.timeIntegration
    time.verboseMode = 0
    time.automaticStepSize = step is None
    time.explicit.computeEndOfStepAccelerations = False    # nobody asks for them
    time.generalizedAlpha.spectralRadius = 1.0
    time.newton.relativeTolerance, time.newton.absoluteTolerance = NEWTON
    if step is None:
        time.relativeTolerance = time.absoluteTolerance = tolerance
        time.minimumStepSize = SHORTEST
    return settings


def _run(scene, numbers, scheme, step=None, tolerance=None):
    """Return the Run of a scene.

    More than forty lines: what builds the model, and what runs it, share the objects of the peer.
    """
    engine = _engine()
    container = engine.SystemContainer()
    system = container.AddSystem()
    hinged = isinstance(numbers, pendulum.Pendulum)
    node, laws = (_hinged if hinged else _turning)(engine, system, scene, numbers)
    system.Assemble()
    settings = _settings(engine, step, tolerance)
    begin, to = _solving(engine, system, settings, getattr(engine.DynamicSolverType, scheme), step)

    def value(kind):
        return np.array(system.GetNodeOutput(node, getattr(engine.OutputVariableType, kind)))

    def state():
        if hinged:
            return numbers.state((float(value('Coordinates')), float(value('Coordinates_t'))))
        return numbers.state((*_quaternion(value('RotationMatrix').reshape(3, 3)),
                              *value('AngularVelocityLocal')))
    run = Run(begin, to, state)
    run.keeps = container, laws
    return run


def _solving(engine, system, settings, solver, step):
    """Return `start` and `to` of the Run of an assembled system; step is None if controlled."""
    data, first = system.systemData, engine.ConfigurationType.Initial
    kinds = 'ODE2Coordinates', 'ODE2Coordinates_t', 'ODE2Coordinates_tt', 'AECoordinates'
    start = {kind: getattr(data, f'Get{kind}')(first) for kind in kinds}
    now, done = 0.0, 0

    def begin():
        nonlocal now, done
        for kind, values in start.items():
            getattr(data, f'Set{kind}')(values, first)
        now, done = 0.0, 0

    def to(time):
        nonlocal now, done
        integration = settings.timeIntegration
        integration.startTime, integration.endTime = now, time
        if step is None:
            integration.numberOfSteps = 1    # the largest step is the whole time
            integration.initialStepSize = min(FIRST, time - now)
        else:
            steps = body.whole_steps(time, step)
            integration.numberOfSteps, done = steps - done, steps
        try:
            system.SolveDynamic(settings, solverType=solver, updateInitialValues=True)
        except engine.ExudynError as error:
            raise NotConverged(f'{NAME}: {str(error).splitlines()[0]}') from None
        now = time
    return begin, to


def _rolling(numbers, step, radius):
    """Return the Run of a disk that rolls without slip; `radius` is the spectral one."""
    from exudyn.utilities import RigidBodyInertia
    engine = _engine()
    container = engine.SystemContainer()
    system = container.AddSystem()
    ground = system.CreateGround()
    q, omega = numbers.start[:4], numbers.start[4:]
    one = system.CreateRigidBody(
        inertia=RigidBodyInertia(mass=numbers.mass, inertiaTensor=numbers.inertia),
        nodeType=engine.NodeType.RotationEulerParameters, referencePosition=numbers.place.tolist(),
        referenceRotationMatrix=np.array(matrix(*q)), initialVelocity=numbers.velocity.tolist(),
        initialAngularVelocity=omega.tolist(), gravity=[0.0, 0.0, -numbers.g])
    system.CreateRollingDisc(
        bodyNumbers=[ground, one], axisPosition=numbers.middle.tolist(), axisVector=[0, 0, 1],
        planePosition=[0, 0, 0], planeNormal=[0, 0, 1], discRadius=numbers.radius)
    system.Assemble()
    settings = _settings(engine, step, None)
    settings.timeIntegration.generalizedAlpha.spectralRadius = radius
    # where Newton's method fails at a coarse step, ever shorter ones would take hours
    settings.timeIntegration.adaptiveStep = False
    begin, to = _solving(
        engine, system, settings, engine.DynamicSolverType.GeneralizedAlpha, step)

    def state():
        def value(kind):
            return np.array(system.GetObjectOutputBody(
                one, getattr(engine.OutputVariableType, kind)))
        return numbers.state((*_quaternion(value('RotationMatrix').reshape(3, 3)),
                              *value('AngularVelocity')))
    run = Run(begin, to, state)
    run.keeps = container
    return run


def _turning(engine, system, scene, numbers):
    """Add a free or pivoted body in its principal axes; return its node, and what is to be kept.

    Rotations of the node are those of the group, and its angular velocity is in body axes.
    """
    from scipy.spatial.transform import Rotation
    items = engine.itemInterface
    pivoted, gravity = scene.constraint.kind == 'pivot', scene.effect('gravity')
    arm = numbers.about_center(scene)[1]
    node = system.AddNode(items.NodeRigidBodyRotVecLG(
        referenceCoordinates=[0.0] * 6,
        initialCoordinates=[0.0] * 3 + Rotation.from_quat(numbers.start[:4]).as_rotvec().tolist(),
        initialVelocities=[0.0] * 3 + numbers.start[4:].tolist()))
    one = system.AddObject(items.ObjectRigidBody(
        nodeNumber=node, physicsMass=HELD if pivoted else scene.body.mass,
        physicsInertia=[*numbers.moments.tolist(), 0.0, 0.0, 0.0]))

    def marker(place):
        return system.AddMarker(items.MarkerBodyRigid(bodyNumber=one, localPosition=list(place)))
    if pivoted and gravity:
        system.AddLoad(items.LoadForceVector(
            markerNumber=marker(arm), loadVector=[0.0, 0.0, -scene.body.mass * gravity.g]))
    for torque, fixed in ((numbers.torque, True), (numbers.push, False)):
        if torque.any():
            system.AddLoad(items.LoadTorqueVector(
                markerNumber=marker(np.zeros(3)), loadVector=torque.tolist(), bodyFixed=fixed))
    ground = system.CreateGround()
    if numbers.tie:
        at, anchor, stiffness, length = numbers.tie
        system.CreateSpringDamper(
            bodyNumbers=[ground, one], localPosition0=anchor.tolist(),
            localPosition1=at.tolist(), referenceLength=length, stiffness=stiffness)
    base = system.AddMarker(items.MarkerBodyRigid(bodyNumber=ground))
    return node, _resisted(
        engine, system, scene, base, marker, arm if pivoted else np.zeros(3))


def _resisted(engine, system, scene, base, marker, arm):
    """Add the drag of a scene between the ground and a body; return what is to be kept."""
    from exudyn.advancedUtilities import CreateSymbolicUserFunction
    items = engine.itemInterface
    linear, angular, quadratic, angular_quadratic = inputs.drags(scene)
    kept = []

    def symbolic(law, name, item):
        kept.append(CreateSymbolicUserFunction(
            system, function=law, userFunctionName=name, itemTypeName=item))
        return kept[-1]

    def moved(mbs, t, itemNumber, displacement, velocity, stiffness, damping, offset):
        return (linear + quadratic * velocity.NormL2()) * velocity

    def turned(mbs, t, itemNumber, displacement, rotation, velocity, angularVelocity, stiffness,
               damping, rotJ0, rotJ1, offset):
        """Return force and torque. More than eight arguments: Exudyn hands them over."""
        c = angular + angular_quadratic * angularVelocity.NormL2()
        return engine.symbolic.Vector([0.0 * c] * 3 + [c * angularVelocity[k] for k in range(3)])
    if arm.any() and (linear or quadratic):
        system.AddObject(items.ObjectConnectorCartesianSpringDamper(
            markerNumbers=[base, marker(arm)], damping=[linear] * 3,
            springForceUserFunction=symbolic(
                moved, 'springForceUserFunction', 'ObjectConnectorCartesianSpringDamper')
            if quadratic else 0))
    if angular or angular_quadratic:
        system.AddObject(items.ObjectConnectorRigidBodySpringDamper(
            markerNumbers=[base, marker(np.zeros(3))],
            damping=np.diag([0.0] * 3 + [angular] * 3),
            springForceTorqueUserFunction=symbolic(
                turned, 'springForceTorqueUserFunction', 'ObjectConnectorRigidBodySpringDamper')
            if angular_quadratic else 0))
    return kept


def _hinged(engine, system, scene, numbers):
    """Add a body on a revolute joint, in minimal coordinates; return its node.

    The joint turns about the z axis of its frame.
    """
    from scipy.spatial.transform import Rotation
    items = engine.itemInterface
    gravity, one = scene.effect('gravity'), scene.body
    frame = Rotation.align_vectors([numbers.axis], [[0.0, 0.0, 1.0]])[0].as_matrix()
    arm = np.subtract(one.center_of_mass, scene.constraint.through)
    node = system.AddNode(items.NodeGenericODE2(
        numberOfODE2Coordinates=1, referenceCoordinates=[0.0], initialCoordinates=[0.0],
        initialCoordinates_t=[float(numbers.start[1])]))
    system.AddObject(items.ObjectKinematicTree(
        nodeNumber=node, jointTypes=[engine.JointType.RevoluteZ], linkParents=[-1],
        jointTransformations=engine.Matrix3DList([np.array(matrix(*numbers.orientation)) @ frame]),
        jointOffsets=engine.Vector3DList([np.zeros(3)]),
        linkInertiasCOM=engine.Matrix3DList([frame.T @ one.about_center.matrix @ frame]),
        linkCOMs=engine.Vector3DList([frame.T @ arm]), linkMasses=[one.mass],
        gravity=[0.0, 0.0, -gravity.g if gravity else 0.0],
        jointForceVector=[numbers.torque], jointPositionOffsetVector=[numbers.slack],
        jointPControlVector=[numbers.stiffness], jointVelocityOffsetVector=[0.0],
        jointDControlVector=[numbers.friction]))
    return node, None


def _quaternion(rotation):
    from scipy.spatial.transform import Rotation
    return Rotation.from_matrix(rotation).as_quat()
