# SPDX-License-Identifier: Apache-2.0
"""Check of a free body near a stable axis (notes, "Asymmetric Top").

It measures small oscillations: their frequency, eta3, and the terms of the linear equations.
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.limits import limit
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import asymmetric_top as theory

SMALL = (0.08, 0.04, 0.02)          # eta1/omega0
TURNS = 4


def check(run):
    """Yield the quantities of a body that rotates about axis 3 with a small eta."""
    I1, I2, I3 = run.scene.body.about_center.moments
    start = run.at(0.0).angular_velocity.copy()
    omega0 = start[2]
    if not theory.frequency_squared(omega0, I1, I2, I3) > 0.0:
        raise BadInput(run.scene.name, f'moments {[I1, I2, I3]}, omega3 {omega0:g}',
                       'needs rotation about axis 3, with the least or the largest moment')
    measured = [run.derivative(instruments.omega(k), 0.02, 0.02) for k in range(2)]
    eta = run.at(0.02).angular_velocity
    yield Quantity("eta1', eta2' of the linear equations",
                   theory.linear_rates(eta, eta[2], I1, I2, I3)[:2], measured, 1e-10, 'rad/s^2',
                   as_written=theory.linear_rates_as_written(eta, eta[2], I1, I2, I3)[:2])
    runs = [run.variant({'initial.angular_velocity': [small * omega0, 0.0, omega0]})
            for small in SMALL]
    Omega = theory.frequency(omega0, I1, I2, I3)
    written = np.sqrt(theory.frequency_squared_as_written(omega0, I1, I2, I3)) / Omega
    yield from limit('Omega', 'eta1/omega0', SMALL,
                     [_frequency(one, Omega) / Omega for one in runs], 2, 0.02, 1e-8, written)
    # eta3 = 0 to first order: its change is of second order in eta
    changes = []
    for one in runs:
        rate = one.read(instruments.omega(2), np.linspace(0.0, 2.0 * np.pi / Omega, 201))
        changes.append((rate.max() - rate.min()) / omega0)
    shown = ', '.join(f'{change:.3g} at {small:.3g}'
                      for small, change in zip(SMALL, changes, strict=True))
    yield Quantity(
        'change of eta3: its order in eta1/omega0', 2.0, np.log2(changes[1] / changes[2]), 0.02,
        absolute=True, detail=f'change over omega0 {shown}')


def _frequency(run, guess):
    rises = run.crossings(
        instruments.omega(1), 0.0, (TURNS + 1.3) * 2.0 * np.pi / guess, 40 * TURNS, rising=True)
    return 2.0 * np.pi * (len(rises) - 1) / (rises[-1] - rises[0])
