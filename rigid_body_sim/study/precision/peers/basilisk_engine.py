# SPDX-License-Identifier: Apache-2.0
"""Basilisk: a spacecraft hub under RK4, and under RKF78 with error control.

Its attitude is in modified Rodrigues parameters; all steps run in C++.
"""

import importlib.metadata
import math

import numpy as np

from rigid_body_sim.study.precision.peers import body
from rigid_body_sim.study.precision.runner import GRID, RefusedError, Run, Runner, steps_for

NAME = 'Basilisk'
NANOSECONDS = 10**9
HELD = {'pivot': 'a fixed point', 'hinge': 'a fixed axis', 'table': 'a table and its friction'}


def version():
    """Return the version that is installed."""
    import Basilisk  # noqa: F401
    return importlib.metadata.version('bsk')


def runners(problem, reference):
    """Yield both methods; steps are whole nanoseconds, which its clock counts."""
    kind = problem.scene.constraint.kind
    if kind != 'free':
        raise RefusedError(f'{HELD[kind]}: its hub flies free')
    given = body.of(problem.scene)
    if given.inner or np.any(given.damping) or np.any(given.push) or given.angular_quadratic:
        raise RefusedError('drag, internal dissipation or a torque fixed in the world: '
                           'modules of its own would have to be written')
    steps = tuple(dict.fromkeys(_whole(problem.duration, step)
                                for step in steps_for(problem, reference)))
    yield Runner(f'{NAME} RK4', 'step', steps,
                 lambda step: _run(problem, given, 'svIntegratorRK4', step, None), True)
    yield Runner(f'{NAME} RKF78', 'tolerance', tuple(10.0**-k for k in range(2, 16)),
                 lambda tolerance: _run(
                     problem, given, 'svIntegratorRKF78', problem.duration / GRID, tolerance),
                 True)


def _whole(duration, step):
    """Return the nearest step of whole nanoseconds that divides the reference's intervals."""
    grid = round(duration / GRID * NANOSECONDS)
    count = max(1, round(duration / GRID / step))
    return (grid // min((k for k in range(1, 2 * count + 1) if grid % k == 0),
                        key=lambda k: abs(math.log(k / count))) / NANOSECONDS)


def _run(problem, given, method, step, tolerance):
    """Return the Run of a scene.

    More than forty lines: what builds the model, and what runs it, share the objects of the peer.
    """
    from Basilisk.architecture import bskLogging
    from Basilisk.simulation import extForceTorque, spacecraft, svIntegrators
    from Basilisk.utilities import SimulationBaseClass
    bskLogging.setDefaultLogLevel(bskLogging.BSK_ERROR)
    simulation = SimulationBaseClass.SimBaseClass()
    process = simulation.CreateNewProcess('process')
    ticks = max(1, round(step * NANOSECONDS))
    process.addTask(simulation.CreateNewTask('task', ticks))
    hub = spacecraft.Spacecraft()
    hub.hub.mHub = problem.scene.body.mass
    hub.hub.r_BcB_B = [[0.0], [0.0], [0.0]]
    hub.hub.IHubPntBc_B = np.diag(given.moments).tolist()
    integrator = getattr(svIntegrators, method)(hub)
    if tolerance:
        integrator.relTol = integrator.absTol = tolerance
    hub.setIntegrator(integrator)
    simulation.AddModelToTask('task', hub)
    push = None
    if np.any(given.torque):
        push = extForceTorque.ExtForceTorque()
        push.extTorquePntB_B = [[x] for x in given.torque]
        hub.addDynamicEffector(push)
        simulation.AddModelToTask('task', push)
    x, y, z, w = given.start[:4]
    sigma = np.array([x, y, z]) / (1.0 + abs(w)) * (1.0 if w >= 0.0 else -1.0)

    def begin():
        hub.hub.sigma_BNInit = [[s] for s in sigma]
        hub.hub.omega_BN_BInit = [[w] for w in given.start[4:]]
        simulation.InitializeSimulation()

    def to(time):
        simulation.ConfigureStopTime(round(time / step) * ticks)
        simulation.ExecuteSimulation()

    def state():
        found = hub.scStateOutMsg.read()
        s = np.array(found.sigma_BN)
        square = s @ s
        return given.state((
            *(2.0 * s / (1.0 + square)), (1.0 - square) / (1.0 + square), *found.omega_BN_B))
    run = Run(begin, to, state)
    run.keeps = simulation, process, integrator, push    # C++ holds no references
    return run
