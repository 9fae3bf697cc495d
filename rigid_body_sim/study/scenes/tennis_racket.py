# SPDX-License-Identifier: Apache-2.0
"""Check of a racket about its middle axis.

Notes, "Intermediate Axis Theorem = Tennis Racket Theorem": growth rate, growing direction, flips.
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes.free_body import flips
from rigid_body_sim.study.scenes.limits import limit
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import asymmetric_top as theory

SEEDS = (0.004, 0.002, 0.001)       # size of the growing solution at the start, over omega0


def check(run):
    """Yield the quantities of a body that rotates about its middle axis with a small seed."""
    moments = np.array(run.scene.body.about_center.moments)
    middle = int(np.argsort(moments)[1])
    omega0 = float(run.at(0.0).angular_velocity[middle])
    if len(set(moments)) < 3 or not omega0:
        raise BadInput(run.scene.name, f'moments {moments.tolist()}',
                       'needs three different moments and rotation about the middle one')
    # the axis of rotation is the third of the formulas: the cyclic order keeps their signs
    cyclic = [(middle + 1) % 3, (middle + 2) % 3, middle]
    I1, I2, I3 = moments[cyclic]
    rate, ratio = (
        theory.growth_rate(omega0, I1, I2, I3), theory.growing_ratio(I1, I2, I3) * np.sign(omega0))
    growth, direction = [], []
    span = 1.0 / rate
    for seed in SEEDS:
        omega = np.zeros(3)
        omega[cyclic] = np.array([seed, seed * ratio, 1.0]) * abs(omega0)
        omega[middle] = omega0
        states = run.variant({'initial.angular_velocity': omega}).states([0.0, span])
        eta = states.angular_velocity[:, cyclic[:2]]
        growth.append(np.log(eta[1, 0] / eta[0, 0]) / span)
        direction.append(eta[1, 1] / eta[1, 0] / ratio)
    yield from limit(
        'growth rate sqrt(-Omega^2)', 'the seed', SEEDS, np.array(growth) / rate, 2, 0.05, 1e-8,
        np.sqrt(-theory.frequency_squared_as_written(omega0, I1, I2, I3)) / rate)
    yield Quantity(
        'eta2/eta1 while it grows, over the formula', 1.0, direction[-1], 10.0 * SEEDS[-1] ** 2)
    yield from flips(run, 40.0)
