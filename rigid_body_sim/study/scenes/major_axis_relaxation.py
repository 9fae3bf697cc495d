# SPDX-License-Identifier: Apache-2.0
"""Check of how a dissipating body turns to its largest axis.

Notes, "Is the Earth's rotation axis unstable?": T falls to its least value at constant L.
"""

import numpy as np

from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import euler_equations
from rigid_body_sim.theory import largest_axis as theory

SAMPLES = 4001


def check(run):
    """Yield the quantities of the way from the smallest axis past the separatrix to the largest.

    The body begins near the smallest axis.
    """
    moments = np.array(run.scene.body.about_center.moments)
    start = moments * run.at(0.0).angular_velocity
    L, c = float(np.linalg.norm(start)), run.scene.effect('internal_dissipation').coefficient
    # 60 times the time of a fall by 1/e on the slower part of the way: away from the smallest
    # axis, or on to the largest
    middle = np.sort(moments)[1]
    rates = (c * L**2
             * np.array([1.0 / moments.min() - 1.0 / middle, 1.0 / middle - 1.0 / moments.max()]))
    seconds = float(60.0 / rates.min())
    times = np.linspace(0.0, seconds, SAMPLES)
    states = run.states(times)
    m = moments * states.angular_velocity
    T, excess = (euler_equations.kinetic_energy(moments, states.angular_velocity),
                 theory.excess_energy(moments, m))
    least, greatest = theory.least_energy(moments, L), theory.greatest_energy(moments, L)
    yield Quantity('T at the start, near the smallest axis', greatest, T[0], 1e-3, 'J',
                   detail='the seed leaves it a little below')
    yield Quantity('T at the end, L^2/(2 I_max)', least, T[-1], 1e-9, 'J')
    yield Quantity('excess of T over L^2/(2 I_max) at the end, over T', 0.0, excess[-1] / T[-1],
                   1e-9, absolute=True)
    yield Quantity('largest rise of the excess between two samples, over T', 0.0,
                   np.diff(excess).max() / T[0], 1e-15, bound=True, absolute=True)
    size = np.linalg.norm(m, axis=1)
    yield Quantity('|L| all the way', np.full(SAMPLES, L), size, 1e-14, 'kg m^2/s')
    momentum = instruments.momentum_in_world(moments)(states)
    yield Quantity(
        'L in the world all the way', np.broadcast_to(momentum[0], momentum.shape).ravel(),
        momentum.ravel(), 1e-12, 'kg m^2/s')
    separatrix = 0.5 * L**2 / middle
    yield Quantity('T passes L^2/(2 I_middle), the separatrix: times', 1.0,
                   float(np.count_nonzero(np.diff(separatrix < T))), 0.0)
    yield Quantity('heat, the integral of c (m x omega)^2, is what T lost', T[0] - T[-1],
                   _heat(run, moments, c, seconds), 1e-11, 'J')


def _heat(run, moments, c, seconds):
    """Return the heat (J) by Gauss-Legendre quadrature of its power.

    The pieces are short compared with a turn of the body.
    """
    points, weights = np.polynomial.legendre.leggauss(10)
    pieces = int(np.ceil(seconds * np.linalg.norm(run.at(0.0).angular_velocity)))
    half = 0.5 * seconds / pieces
    times = ((2.0 * np.arange(pieces)[:, np.newaxis] + 1.0 + points) * half).ravel()
    omega = run.states(times).angular_velocity
    power = c * np.sum(np.cross(moments * omega, omega) ** 2, axis=1)
    return float(power @ np.tile(half * weights, pieces))
