# SPDX-License-Identifier: Apache-2.0
"""Bodies on a plane: errors beside those of MuJoCo, Drake, PyBullet and Exudyn, by time.

    PYTHONPATH=. .venv-peers/bin/python bench/plane_peers.py [--case NAME ...] [--peer NAME ...]
        [--json FILE]

The scenes are the rolling disk and Routh's sphere, which roll without slip, and the tippe top,
which slips. The truth has 34 digits (test/data/plane_scenes.json). Each program runs with its own
contact, over steps from coarse to fine and over what its users set for contacts: the table gives
the setting with the least error at the end, and its errors of the attitude, and of the inclination
of the body's axis, after a fifth of the time and at the end. Steps get no finer where a run takes
more than LIMIT of CPU time.
Engines have no ideal rolling, but for Exudyn: a coefficient of friction of STICKY stands for it.
Peers that are not installed are passed over: requirements/peers.in names them.
"""

import argparse
import itertools
import json
import pathlib
import time

import numpy as np

from rigid_body_sim.numerics.rotations import angles_between, matrix, rotate
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

TRUTH = json.loads(
    (pathlib.Path(__file__).parents[1] / 'test/data/plane_scenes.json').read_text())
CASES = 'rolling_disk', 'routh_sphere', 'tippe_top'
LIMIT = 2.5      # s
STICKY = 1e3
STEPS = 2e-3, 1e-3, 5e-4, 1e-4, 5e-5, 1e-5
THICK = 2e-4     # half the thickness of a disk over its radius


class Body:
    """A scene's numbers, about the centre of mass.

    Attributes
    ----------
    radius, mu, g, mass : float
    moments : list of 3 floats
    middle : array (3,)
        Centre of mass -> middle of the surface, body axes.
    q : list of 4 floats
    omega, place, velocity : arrays (3,)
        World axes; of the centre of mass.
    disk : bool
    """

    def __init__(self, scene):
        body = scene.body
        self.radius, self.disk = body.surface.size[0], body.surface.kind == 'disk'
        self.mu = min(scene.contact.mu, STICKY)
        self.ideal = scene.contact.mu > STICKY
        self.g, self.mass = scene.effect('gravity').g, body.mass
        self.moments = [float(x) for x in body.about_center.moments]
        center = np.array(body.center_of_mass)
        self.middle = np.array(body.surface.center) - center
        start = scene.initial
        self.q = [float(x) for x in start.orientation]
        self.omega = np.array(rotate(*self.q, *start.angular_velocity))
        arm = np.array(rotate(*self.q, *center))
        self.place = np.array(start.position) + arm
        self.velocity = np.array(start.velocity) + np.cross(self.omega, arm)


def _spaced(values):
    return ' '.join(repr(float(value)) for value in values)


def mujoco(body, times):
    """Yield (setting, run) of MuJoCo."""
    import mujoco as engine
    shape = (f'type="cylinder" size="{body.radius} {THICK * body.radius}"' if body.disk
             else f'type="sphere" size="{body.radius}"')

    def run(step, integrator, stiff, ratio):
        model = engine.MjModel.from_xml_string(
            f'<mujoco><option integrator="{integrator}" timestep="{step}" cone="elliptic" '
            f'gravity="0 0 {-body.g}" impratio="{ratio}" tolerance="0"/><worldbody>'
            f'<geom type="plane" size="0 0 1" friction="{body.mu} 0 0" condim="3" '
            f'solref="{stiff * step} 1" solimp="0.99 0.9999 1e-5"/><body><freejoint/>'
            f'<inertial pos="0 0 0" mass="{body.mass}" diaginertia="{_spaced(body.moments)}"/>'
            f'<geom {shape} pos="{_spaced(body.middle)}" friction="{body.mu} 0 0" condim="3" '
            f'solref="{stiff * step} 1" solimp="0.99 0.9999 1e-5"/></body></worldbody></mujoco>')
        data = engine.MjData(model)
        engine.set_mju_user_warning(lambda text: None)
        x, y, z, w = body.q
        data.qpos[:] = *body.place, w, x, y, z
        data.qvel[:3] = body.velocity
        data.qvel[3:] = np.array(matrix(*body.q)).T @ body.omega
        done = 0
        for moment in times:
            steps = round(moment / step)
            engine.mj_step(model, data, steps - done)
            done = steps
            w, x, y, z = data.qpos[3:]
            yield x, y, z, w
    for integrator, stiff, ratio in itertools.product(
            ('RK4', 'implicitfast'), (2.0, 10.0), (1.0, 100.0)):
        for step in STEPS:
            yield (f'{integrator}, step {step:g} s, solref {stiff:g} steps, impratio {ratio:g}',
                   lambda step=step, a=integrator, b=stiff, c=ratio: run(step, a, b, c))


def pybullet(body, times):
    """Yield (setting, run) of PyBullet."""
    import pybullet as engine

    def run(step, erp):
        world = {'physicsClientId': engine.connect(engine.DIRECT)}
        engine.setPhysicsEngineParameter(
            fixedTimeStep=step, numSubSteps=0, numSolverIterations=200, erp=erp, contactERP=erp,
            frictionERP=erp, solverResidualThreshold=0.0, **world)
        engine.setGravity(0.0, 0.0, -body.g, **world)
        table = engine.createMultiBody(
            0.0, engine.createCollisionShape(engine.GEOM_PLANE, **world), **world)
        engine.changeDynamics(table, -1, lateralFriction=1.0, restitution=0.0, **world)
        settings = {'collisionFramePosition': body.middle.tolist()}
        shape = (engine.createCollisionShape(
                     engine.GEOM_CYLINDER, radius=body.radius,
                     height=2.0 * THICK * body.radius, **settings, **world) if body.disk
                 else engine.createCollisionShape(
                     engine.GEOM_SPHERE, radius=body.radius, **settings, **world))
        one = engine.createMultiBody(body.mass, shape, **world)
        engine.changeDynamics(
            one, -1, localInertiaDiagonal=body.moments, linearDamping=0.0, angularDamping=0.0,
            maxJointVelocity=1e9, lateralFriction=body.mu, rollingFriction=0.0,
            spinningFriction=0.0, restitution=0.0, **world)
        engine.resetBasePositionAndOrientation(one, body.place.tolist(), body.q, **world)
        engine.resetBaseVelocity(one, body.velocity.tolist(), body.omega.tolist(), **world)
        done = 0
        for moment in times:
            steps = round(moment / step)
            for _ in range(steps - done):
                engine.stepSimulation(**world)
            done = steps
            yield engine.getBasePositionAndOrientation(one, **world)[1]
        engine.disconnect(**world)
    for erp in (0.0, 0.2):
        for step in STEPS:
            yield f'step {step:g} s, erp {erp:g}', lambda step=step, erp=erp: run(step, erp)


def drake(body, times):
    """Yield (setting, run) of Drake with its discrete contact."""
    from pydrake.geometry import Cylinder, HalfSpace, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import (
        AddMultibodyPlantSceneGraph,
        ContactModel,
        CoulombFriction,
        DiscreteContactApproximation,
    )
    from pydrake.multibody.tree import RotationalInertia, SpatialInertia, UnitInertia
    from pydrake.systems.analysis import Simulator
    from pydrake.systems.framework import DiagramBuilder

    def run(step, kind):
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, step)
        plant.set_contact_model(ContactModel.kPoint)
        plant.set_discrete_contact_approximation(getattr(DiscreteContactApproximation, kind))
        inertia = UnitInertia().SetFromRotationalInertia(
            RotationalInertia(*body.moments), body.mass)
        one = plant.AddRigidBody('body', SpatialInertia(body.mass, np.zeros(3), inertia))
        plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -body.g])
        friction = CoulombFriction(body.mu, body.mu)
        shape = (Cylinder(body.radius, 2.0 * THICK * body.radius) if body.disk
                 else Sphere(body.radius))
        plant.RegisterCollisionGeometry(
            plant.world_body(), RigidTransform(), HalfSpace(), 'table', friction)
        plant.RegisterCollisionGeometry(
            one, RigidTransform(body.middle), shape, 'body', friction)
        plant.Finalize()
        plant.set_penetration_allowance(1e-5 * body.radius)
        plant.set_stiction_tolerance(1e-4)
        diagram = builder.Build()
        simulator = Simulator(diagram)
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        x, y, z, w = body.q
        plant.SetPositions(context, np.array([w, x, y, z, *body.place]))
        plant.SetVelocities(context, np.array([*body.omega, *body.velocity]))
        simulator.Initialize()
        for moment in times:
            simulator.AdvanceTo(moment)
            turned = plant.EvalBodyPoseInWorld(context, one).rotation().ToQuaternion()
            yield turned.x(), turned.y(), turned.z(), turned.w()
    for kind in ('kSap', 'kLagged', 'kTamsi'):
        for step in STEPS:
            yield f'{kind}, step {step:g} s', lambda step=step, kind=kind: run(step, kind)


def exudyn(body, times):
    """Yield (setting, run) of Exudyn's ideal rolling of a disk."""
    import exudyn as engine
    from exudyn.utilities import RigidBodyInertia, SensorBody
    if not (body.disk and body.ideal):
        return

    def run(step, radius):
        container = engine.SystemContainer()
        system = container.AddSystem()
        ground = system.CreateGround()
        one = system.CreateRigidBody(
            inertia=RigidBodyInertia(mass=body.mass, inertiaTensor=np.diag(body.moments)),
            nodeType=engine.NodeType.RotationEulerParameters,
            referencePosition=body.place.tolist(),
            referenceRotationMatrix=np.array(matrix(*body.q)),
            initialVelocity=body.velocity.tolist(), initialAngularVelocity=body.omega.tolist(),
            gravity=[0.0, 0.0, -body.g])
        system.CreateRollingDisc(
            bodyNumbers=[ground, one], axisPosition=[0, 0, 0], axisVector=[0, 0, 1],
            planePosition=[0, 0, 0], planeNormal=[0, 0, 1], discRadius=body.radius)
        sensor = system.AddSensor(SensorBody(
            bodyNumber=one, storeInternal=True,
            outputVariableType=engine.OutputVariableType.RotationMatrix))
        system.Assemble()
        settings = engine.SimulationSettings()
        settings.timeIntegration.numberOfSteps = round(times[-1] / step)
        settings.timeIntegration.endTime = times[-1]
        settings.solution.file.write = False
        settings.solution.sensors.writePeriod = times[0]
        settings.timeIntegration.generalizedAlpha.spectralRadius = radius
        settings.timeIntegration.newton.relativeTolerance = 1e-11
        settings.timeIntegration.newton.absoluteTolerance = 1e-12
        settings.timeIntegration.verboseMode = 0
        system.SolveDynamic(settings, showHints=False)
        for row in np.atleast_2d(system.GetSensorStoredData(sensor))[1:]:
            yield _quaternion(row[1:].reshape(3, 3))
    for radius in (1.0, 0.9):
        for step in STEPS:
            yield (f'generalized alpha, step {step:g} s, spectral radius {radius:g}',
                   lambda step=step, radius=radius: run(step, radius))


def _quaternion(R):
    from scipy.spatial.transform import Rotation
    return Rotation.from_matrix(R).as_quat()


PEERS = {'MuJoCo': mujoco, 'Drake': drake, 'PyBullet': pybullet, 'Exudyn': exudyn}


def errors(found, true):
    """Return the errors of attitude and inclination (rad), each of shape (n,)."""
    attitude = np.empty(len(true))
    found = np.array(found, dtype=float)
    angles_between(found, true, attitude)
    one, other = (np.arccos(np.clip([matrix(*map(float, q))[2][2] for q in run], -1.0, 1.0))
                  for run in (found, true))
    return attitude, np.abs(one - other)


def measured(run, true):
    """Return the row of a run, or None where it fails."""
    begin = time.process_time()
    try:
        found = list(run())
    except RuntimeError:
        return None
    spent = time.process_time() - begin
    if len(found) != len(true) or not np.all(np.isfinite(np.array(found, dtype=float))):
        return None
    early = len(true) // 5 - 1
    attitude, inclination = errors(found, true)
    return {'cpu': spent, 'attitude': [float(attitude[:early + 1].max()), float(attitude.max())],
            'inclination': [float(inclination[:early + 1].max()), float(inclination.max())]}


def best(program, body, times, true):
    """Return the row with the least error of the attitude at the end; None if nothing ran."""
    rows, slow = [], ''
    for setting, run in program(body, times):
        family = setting.partition('step ')[0] + setting.partition(' s,')[2]
        if family == slow:
            continue    # finer steps would take longer still
        row = measured(run, true)
        if row is None:
            continue
        rows.append(row | {'setting': setting})
        if row['cpu'] > LIMIT:
            slow = family
    return min(rows, key=lambda row: (row['attitude'][1], row['inclination'][1]), default=None)


def ours(name, times, accuracy):
    """Return the run of `auto`; the choice is made before."""
    simulation = Simulation(load_scene(name), 'auto', accuracy, horizon=times[-1])
    simulation.states(times)
    again = Simulation(load_scene(name), 'auto', accuracy, horizon=times[-1],
                       settled=simulation.choice.settled)
    return lambda: again.states(times).orientation


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--case', nargs='*', default=list(CASES), choices=CASES)
    parser.add_argument('--peer', nargs='*', default=list(PEERS), choices=list(PEERS))
    parser.add_argument('--json', metavar='FILE')
    options, results = parser.parse_args(), {}
    for name in options.case:
        case, body = TRUTH[name], Body(load_scene(name))
        times, true = case['times'], np.array(case['orientations'], dtype=float)
        rows = {f'ours, {accuracy:g}': measured(ours(name, times, accuracy), true)
                for accuracy in (1e-3, 1e-9)}
        for peer in options.peer:
            try:
                rows[peer] = best(PEERS[peer], body, times, true)
            except ImportError:
                print(f'{peer} is not installed')
        results[name] = {'times': [times[len(times) // 5 - 1], times[-1]], 'rows': rows}
        print(f'{name}: errors of attitude and inclination, rad, until '
              f'{times[len(times) // 5 - 1]:g} s and until {times[-1]:g} s; CPU s')
        for who, row in rows.items():
            if row is None:
                print(f'  {who:12} cannot do it')
                continue
            cells = '  '.join(f'{a:.0e} {b:.0e}' for a, b in zip(
                row['attitude'], row['inclination'], strict=True))
            print(f'  {who:12} {cells}   {row["cpu"]:.2g}   {row.get("setting", "")}', flush=True)
    if options.json:
        pathlib.Path(options.json).write_text(json.dumps(results, indent=1) + '\n')


if __name__ == '__main__':
    main()
