# SPDX-License-Identifier: Apache-2.0
"""A billiard ball on a plane, by the engines among the peers, and by heyoka.

Engines use their own contact: they get the ball lying on a plane, friction mu between them, and
nothing else that brakes.
"""

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.study.hard_cases.beside import STEP, TOLERANCE
from rigid_body_sim.study.hard_cases.sliding_ball import MASS, A, Equations, G, rates


class Heyoka(Equations):
    """Taylor series of the equations."""

    def __init__(self, shot):
        import heyoka
        super().__init__(shot)
        names = heyoka.make_vars('vx', 'vy', 'awx', 'awy')
        right = (rates(names, self.drive, heyoka.sqrt) if self.drive
                 else [0.0 * name for name in names])
        self._integrator = heyoka.taylor_adaptive(
            list(zip(names, right, strict=True)), self.y, tol=TOLERANCE)

    def to(self, time):
        """Go on to a time, s."""
        if time > self.time:
            self._integrator.state[:] = self.y
            outcome = self._integrator.propagate_until(time)[0]
            if 'time_limit' not in str(outcome):
                raise NotConverged(f'{outcome} at {self._integrator.time:.4g} s')
            self.time, self.y = time, self._integrator.state.copy()


class Mujoco:
    """The ball and the plane in MuJoCo."""

    SCENE = """<mujoco><option timestep="{step}" gravity="0 0 -{g}" cone="elliptic"/><worldbody>
<geom type="plane" size="100 100 1" friction="{mu} 0 0" condim="3"/>
<body pos="0 0 {a}"><freejoint/>\
<geom type="sphere" size="{a}" mass="{mass}" friction="{mu} 0 0" condim="3"/>\
</body></worldbody></mujoco>"""

    def __init__(self, shot):
        import mujoco
        mujoco.set_mju_user_warning(lambda text: None)
        model = mujoco.MjModel.from_xml_string(self.SCENE.format(
            step=STEP, g=G, mu=shot.mu, a=A, mass=MASS))
        self._data, self._done = mujoco.MjData(model), 0
        # the body's axes coincide with the world's at first
        self._data.qvel[:] = *shot.v, 0.0, *shot.omega
        self._steps = lambda count: mujoco.mj_step(model, self._data, nstep=count)

    def to(self, time):
        """Go on to a time, s."""
        steps = round(time / STEP)
        if steps > self._done:
            self._steps(steps - self._done)
        self._done = steps

    def push(self, change):
        """Change the velocity by (x, y), m/s."""
        self._data.qvel[:2] += change

    def velocities(self):
        """Return (x, y) of the velocity, m/s, and of the angular velocity, rad/s."""
        world = self._data.xmat[1].reshape(3, 3) @ self._data.qvel[3:6]
        return tuple(self._data.qvel[:2]), tuple(world[:2])


class Bullet:
    """The ball and the plane in PyBullet."""

    def __init__(self, shot):
        import pybullet as engine
        self._engine, self._done = engine, 0
        engine.connect(engine.DIRECT)
        engine.setPhysicsEngineParameter(fixedTimeStep=STEP, numSubSteps=0)
        engine.setGravity(0.0, 0.0, -G)
        plane = engine.createMultiBody(0.0, engine.createCollisionShape(engine.GEOM_PLANE))
        self._ball = engine.createMultiBody(
            MASS, engine.createCollisionShape(engine.GEOM_SPHERE, radius=A),
            basePosition=[0.0, 0.0, A])
        # PyBullet multiplies the two coefficients
        for body, mu in ((plane, 1.0), (self._ball, shot.mu)):
            engine.changeDynamics(
                body, -1, lateralFriction=mu, rollingFriction=0.0, spinningFriction=0.0,
                restitution=0.0, linearDamping=0.0, angularDamping=0.0, maxJointVelocity=1e9)
        engine.resetBaseVelocity(self._ball, [*shot.v, 0.0], list(shot.omega))

    def to(self, time):
        """Go on to a time, s."""
        steps = round(time / STEP)
        for _ in range(steps - self._done):
            self._engine.stepSimulation()
        self._done = steps

    def push(self, change):
        """Change the velocity by (x, y), m/s."""
        v, w = self._engine.getBaseVelocity(self._ball)
        self._engine.resetBaseVelocity(self._ball, [v[0] + change[0], v[1] + change[1], v[2]], w)

    def velocities(self):
        """Return (x, y) of the velocity, m/s, and of the angular velocity, rad/s."""
        v, w = self._engine.getBaseVelocity(self._ball)
        return v[:2], w[:2]


class Drake:
    """The ball and the plane in Drake."""

    def __init__(self, shot):
        from pydrake.geometry import HalfSpace, Sphere
        from pydrake.math import RigidTransform
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, CoulombFriction
        from pydrake.multibody.tree import SpatialInertia, UnitInertia
        from pydrake.systems.analysis import Simulator
        from pydrake.systems.framework import DiagramBuilder
        builder = DiagramBuilder()
        self._plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=STEP)
        friction = CoulombFriction(shot.mu, shot.mu)
        self._plant.RegisterCollisionGeometry(
            self._plant.world_body(), RigidTransform(), HalfSpace(), 'table', friction)
        self._ball = self._plant.AddRigidBody(
            'ball', SpatialInertia(MASS, np.zeros(3), UnitInertia.SolidSphere(A)))
        self._plant.RegisterCollisionGeometry(
            self._ball, RigidTransform(), Sphere(A), 'ball', friction)
        self._plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -G])
        self._plant.Finalize()
        self._simulator = Simulator(builder.Build())
        self._context = self._plant.GetMyMutableContextFromRoot(
            self._simulator.get_mutable_context())
        self._plant.SetPositions(self._context, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, A])
        self._plant.SetVelocities(self._context, [*shot.omega, *shot.v, 0.0])

    def to(self, time):
        """Go on to a time, s."""
        self._simulator.AdvanceTo(time)

    def push(self, change):
        """Change the velocity by (x, y), m/s."""
        velocities = self._plant.GetVelocities(self._context)
        velocities[3:5] += change
        self._plant.SetVelocities(self._context, velocities)

    def velocities(self):
        """Return (x, y) of the velocity, m/s, and of the angular velocity, rad/s."""
        found = self._plant.GetVelocities(self._context)
        return tuple(found[3:5]), tuple(found[:2])
