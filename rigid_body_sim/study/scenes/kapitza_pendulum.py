# SPDX-License-Identifier: Apache-2.0
"""Check of Kapitza's pendulum: the threshold by two theories, the slow swing, the fall below."""

import math

import numpy as np

from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import kapitza as theory

SMALL = 1e-7    # a tilt, rad, whose square is lost in the tolerance
SLIGHTLY = 0.002


def numbers(run):
    """Return A (m), w (rad/s), g (m/s^2) and the reduced length l (m)."""
    body, parameters = run.scene.body, run.scene.mapping['parameters']
    # it tilts about the body's y axis
    moment, arm = body.about_origin.moments[1], body.center_of_mass[2]
    return (parameters['A'], parameters['w'], run.scene.effect('gravity').g,
            moment / (body.mass * arm))


def check(run):
    """Yield the trace of Mathieu's equation, both sides of its edge, and the slow swing."""
    A, w, g, l = numbers(run)
    period = 2.0 * math.pi / w
    yield Quantity('trace of the map of small tilts over a period of the drive',
                   theory.trace(A, w, g, l), _trace(run, period), 1e-9)
    edge = theory.edge(w, g, l)
    for share in (1.0 + SLIGHTLY, 1.0 - SLIGHTLY):
        measured = _trace(run.variant({'parameters.A': share * edge}), period)
        yield Quantity(f'trace at {share:.3f} of the edge by Mathieu, below 2 it stands',
                       theory.trace(share * edge, w, g, l), measured, 1e-9)
    yield Quantity('the edge A w: averaged, by Mathieu', theory.threshold(g, l), edge * w, 5e-3,
                   'm/s')
    yield from _slow_swing(run, A, w, g, l)
    fallen = run.variant({'parameters.A': 0.5 * edge})
    times = np.linspace(0.0, 2.0, 401)
    yield Quantity('a right angle less the largest tilt at half the edge: it falls', 0.0,
                   0.5 * math.pi - fallen.read(instruments.beta, times).max(), 0.0, 'rad',
                   bound=True)
    run.simulation.advance(1000)
    yield Quantity('residual of the energy with the work of the drive, 1 s', 1e-12,
                   abs(run.simulation.ledger()['energy_residual']), 0.0, bound=True)


def _trace(run, period):
    """Return the trace of the map of small tilts over a period of the drive."""
    tilted = run.variant({'initial.tilt': SMALL}).at(period)
    pushed = run.variant({'initial.tilt': 0.0, 'initial.angular_velocity': [0.0, SMALL, 0.0]})
    return (2.0 * tilted.orientation[1] + pushed.at(period).angular_velocity[1]) / SMALL


def _slow_swing(run, A, w, g, l):
    """Yield half the period of the slow swing: the averaged formula, to the order of A/l."""
    rate = theory.slow_rate(A, w, g, l)
    # the slow swing passes through upright a quarter of its period after the start; the shaking
    # moves that by a part of its own period
    small = run.variant({'initial.tilt': 0.01})

    def tilt(states):
        return 2.0 * states.orientation[:, 1]
    times = np.linspace(0.0, 2.0 * math.pi / rate, 2001)
    slow = small.read(tilt, times)
    window = np.ones(_count(times, 2.0 * math.pi / w))
    smooth = np.convolve(slow, window / len(window), 'valid')
    middle = times[:len(smooth)] + 0.5 * (len(window) - 1) * (times[1] - times[0])
    first, second = middle[:-1][np.diff(np.sign(smooth)) != 0][:2]
    yield Quantity('half the period of the slow swing', math.pi / rate, second - first, 0.05,
                   's')


def _count(times, span):
    return max(1, round(span / (times[1] - times[0])))
