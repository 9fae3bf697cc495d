# SPDX-License-Identifier: Apache-2.0
"""Check of the Earth, were it rigid (notes, "Chandler wobble").

It measures the period and the amplitude of the wobble over three periods.
"""

import numpy as np

from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import chandler_wobble as theory

PERIODS = 3
# distance of the pole of rotation from the pole of figure, radius of the Earth at the pole, m
OFFSET = 6.0, 6.356e6


def check(run):
    """Yield the quantities of three wobbles."""
    I1, _, I3 = run.scene.body.about_center.moments
    day = 2.0 * np.pi / run.at(0.0).angular_velocity[2]
    ellipticity = (I3 - I1) / I1
    predicted = theory.period_in_sidereal_days(ellipticity)
    rises = run.crossings(
        instruments.omega(0), 0.0, (PERIODS + 1.1) * predicted * day, 200, rising=True)
    measured = (rises[-1] - rises[0]) / (len(rises) - 1) / day
    written = theory.period_in_sidereal_days_as_written(ellipticity)
    yield Quantity('period of the wobble', predicted, measured, 1e-9, 'turns of the Earth',
                   as_written=written)
    yield Quantity('period of the wobble',
                   theory.period_in_solar_days(ellipticity) * day / theory.SIDEREAL_DAY,
                   measured * day / theory.SOLAR_DAY, 1e-9, 'days',
                   as_written=written * day / theory.SOLAR_DAY)
    times = np.linspace(0.0, PERIODS * predicted * day, 301)
    omega = run.states(times).angular_velocity
    amplitude = np.hypot(omega[:, 0], omega[:, 1])
    yield Quantity('amplitude at 301 times over 3 periods', np.full(len(times), amplitude[0]),
                   amplitude, 1e-9, 'rad/s')
    yield Quantity('omega3 at 301 times over 3 periods', np.full(len(times), omega[0, 2]),
                   omega[:, 2], 1e-14, 'rad/s')
    lambda_ = theory.wobble_angle(*OFFSET)
    if np.isclose(amplitude[0] / omega[0, 2], lambda_, rtol=1e-6):
        yield Quantity(
            'lambda = 6 m/6356 km', lambda_, np.arctan2(amplitude[-1], omega[-1, 2]), 1e-9, 'rad')
