# SPDX-License-Identifier: Apache-2.0
"""The peers' billiard ball, with steps of 1 ms or tolerances of 1e-12.

Engines use their own contact: they get the ball lying on a plane, friction mu between them, and
nothing else that brakes. Integrators get Coulomb's law as their user writes it: v' = -mu g e and
a omega' = (5/2) mu g (-e_y, e_x), where e = u/|u| is the direction of the slip
u = v + omega x (-a z), or zero where u is zero.
"""

import math
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.study.hard_cases.beside import STEP, TOLERANCE
from rigid_body_sim.study.hard_cases.case import Question

A, MASS, G = 0.028575, 0.17, 9.81


@dataclass(frozen=True)
class Shot:
    """A shot: the start of the ball, one push on the way, and its end.

    Attributes
    ----------
    mu : float
    v : tuple of 2 floats
        Initial velocity, m/s.
    omega : tuple of 3 floats
        Initial angular velocity, world axes, rad/s.
    end : float
        Last time, s.
    expected : tuple of 2 floats
        Velocity at the end, m/s.
    push : tuple
        Time (s) and change of v (m/s).
    """

    mu: float
    v: tuple
    omega: tuple
    end: float
    expected: tuple
    push: tuple = (0.0, (0.0, 0.0))


def question(shot):
    """Return the Question for the error of v at the end plus the slip left then (m/s).

    The slip counts if the ball should roll by then.
    """
    def ask(module):
        if module.NAME not in PEERS:
            return ''
        ball = PEERS[module.NAME](shot)
        ball.to(shot.push[0])
        ball.push(shot.push[1])
        ball.to(shot.end)
        (vx, vy), (wx, wy) = ball.velocities()
        slip = math.hypot(vx - A * wy, vy + A * wx) if shot.mu else 0.0
        return math.hypot(vx - shot.expected[0], vy - shot.expected[1]) + slip
    return Question(shot.end, 'm/s', ask)


def rates(y, drive, root=math.sqrt):
    """Return (v', a omega') at y = (vx, vy, a wx, a wy) for drive = mu g."""
    ux, uy = y[0] - y[3], y[1] + y[2]
    slip = root(ux * ux + uy * uy)
    ex, ey = (ux / slip, uy / slip) if slip != 0.0 else (0.0, 0.0)
    return [-drive * ex, -drive * ey, -2.5 * drive * ey, 2.5 * drive * ex]


class _Equations:
    """Base of the integrators, with the unknowns (vx, vy, a wx, a wy)."""

    def __init__(self, shot):
        self.drive, self.time = shot.mu * G, 0.0
        self.y = np.array([*shot.v, A * shot.omega[0], A * shot.omega[1]])

    def push(self, change):
        self.y[:2] += change

    def velocities(self):
        return (self.y[0], self.y[1]), (self.y[2] / A, self.y[3] / A)


class _Rk4(_Equations):
    def to(self, time):
        def rate(y):
            return np.array(rates(y, self.drive))
        for _ in range(round((time - self.time) / STEP)):
            y, h = self.y, STEP
            k1 = rate(y)
            k2 = rate(y + 0.5 * h * k1)
            k3 = rate(y + 0.5 * h * k2)
            self.y = y + h / 6.0 * (k1 + 2.0 * (k2 + k3) + rate(y + h * k3))
        self.time = time


class _Scipy(_Equations):
    def to(self, time):
        from scipy.integrate import solve_ivp
        if time > self.time:
            found = solve_ivp(lambda _, y: rates(y, self.drive), (self.time, time), self.y,
                              'DOP853', rtol=TOLERANCE, atol=TOLERANCE)
            if not found.success:
                raise NotConverged(found.message)
            self.time, self.y = time, found.y[:, -1].copy()


class _Heyoka(_Equations):
    def __init__(self, shot):
        import heyoka
        super().__init__(shot)
        names = heyoka.make_vars('vx', 'vy', 'awx', 'awy')
        right = (rates(names, self.drive, heyoka.sqrt) if self.drive
                 else [0.0 * name for name in names])
        self._integrator = heyoka.taylor_adaptive(
            list(zip(names, right, strict=True)), self.y, tol=TOLERANCE)

    def to(self, time):
        if time > self.time:
            self._integrator.state[:] = self.y
            outcome = self._integrator.propagate_until(time)[0]
            if 'time_limit' not in str(outcome):
                raise NotConverged(f'{outcome} at {self._integrator.time:.4g} s')
            self.time, self.y = time, self._integrator.state.copy()


class _Mujoco:
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
        steps = round(time / STEP)
        if steps > self._done:
            self._steps(steps - self._done)
        self._done = steps

    def push(self, change):
        self._data.qvel[:2] += change

    def velocities(self):
        world = self._data.xmat[1].reshape(3, 3) @ self._data.qvel[3:6]
        return tuple(self._data.qvel[:2]), tuple(world[:2])


class _Bullet:
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
        steps = round(time / STEP)
        for _ in range(steps - self._done):
            self._engine.stepSimulation()
        self._done = steps

    def push(self, change):
        v, w = self._engine.getBaseVelocity(self._ball)
        self._engine.resetBaseVelocity(self._ball, [v[0] + change[0], v[1] + change[1], v[2]], w)

    def velocities(self):
        v, w = self._engine.getBaseVelocity(self._ball)
        return v[:2], w[:2]


class _Drake:
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
        self._simulator.AdvanceTo(time)

    def push(self, change):
        velocities = self._plant.GetVelocities(self._context)
        velocities[3:5] += change
        self._plant.SetVelocities(self._context, velocities)

    def velocities(self):
        found = self._plant.GetVelocities(self._context)
        return tuple(found[3:5]), tuple(found[:2])


PEERS = {
    'heyoka': _Heyoka,
    'numba RK4': _Rk4,
    'SciPy DOP853': _Scipy,
    'MuJoCo': _Mujoco,
    'Drake': _Drake,
    'PyBullet': _Bullet,
}
"""Classes by the NAME of the peer's module; RK4 is plain Python here, with the same numbers."""
