# SPDX-License-Identifier: Apache-2.0
"""Check of the free symmetric top (notes, "Symmetric top (no gravity)").

It measures omega round the axis, the axis round L, and the three cones.
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import symmetric_top as theory

TURNS = 5


def check(run):
    """Yield the quantities of a free body with I1 = I2."""
    I1, I2, I3 = run.scene.body.about_center.moments
    start = run.at(0.0).angular_velocity.copy()
    across = float(np.hypot(start[0], start[1]))
    if I1 != I2 or I1 == I3 or not across * start[2]:
        raise BadInput(run.scene.name, f'moments {[I1, I2, I3]}, omega {start.tolist()}',
                       'needs I1 = I2, a different I3 and an oblique omega')
    yield from round_the_axis(run, theory.precession_rate(start[2], I1, I3),
                              theory.precession_rate_as_written(start[2], I1, I3))
    times = np.linspace(0.0, 20.0, 101)
    states = run.states(times)
    first = np.arctan2(start[1], start[0])
    wave = theory.angular_velocity(
        times, np.hypot(across, start[2]), np.arctan2(across, start[2]), I1, I3)
    turned = np.stack([wave[:, 0] * np.cos(first) - wave[:, 1] * np.sin(first),
                       wave[:, 0] * np.sin(first) + wave[:, 1] * np.cos(first), wave[:, 2]],
                      axis=1)
    yield Quantity(
        'omega at 101 times', turned.ravel(), states.angular_velocity.ravel(), 1e-11, 'rad/s')
    yield from cones(run, times, 1e-12)
    # e3 seen along L goes round at L/I1
    L = run.read(instruments.momentum_in_world((I1, I2, I3)), [0.0])[0]
    rate = theory.precession_rate_in_space(np.linalg.norm(L), I1)
    upright = np.cross(L, np.eye(3)[np.argmin(np.abs(L))])
    rises = run.crossings(lambda s: instruments.axes(s)[:, :, 2] @ upright, 0.0,
                          (TURNS + 1.1) * 2.0 * np.pi / rate, 40 * TURNS, rising=True)
    yield Quantity('rate of e3 about L in space', rate,
                   2.0 * np.pi * (len(rises) - 1) / (rises[-1] - rises[0]), 1e-11, 'rad/s')


def round_the_axis(run, Omega, as_written, tolerance=1e-11):
    """Yield the rate at which omega goes round e3 in the body.

    It is found from crossings of omega1; the sign of omega2 there tells the sense.
    """
    period = 2.0 * np.pi / abs(Omega)
    rises = run.crossings(
        instruments.omega(0), 0.0, (TURNS + 1.1) * period, 40 * TURNS, rising=True)
    after = run.states(rises[:1]).angular_velocity[0, 1]
    # where omega1 rises through zero, omega2 < 0 for a turn from 1 to 2
    measured = -np.sign(after) * 2.0 * np.pi * (len(rises) - 1) / (rises[-1] - rises[0])
    yield Quantity('Omega of omega round e3 in the body', Omega, measured, tolerance, 'rad/s',
                   as_written=as_written)


def cones(run, times, tolerance):
    """Yield the half-angles of the cones, with the largest miss over some times."""
    I1, I2, I3 = run.scene.body.about_center.moments
    states = run.states(times)
    across, along = np.hypot(*states.angular_velocity[0, :2]), states.angular_velocity[0, 2]
    e3, omega = instruments.axes(states)[:, :, 2], instruments.omega_in_world(states)
    L = instruments.momentum_in_world((I1, I2, I3))(states)
    for name, predicted, measured in (
        (
            'body cone: omega to e3',
            theory.body_cone(across, along),
            instruments.angle_between(omega, e3),
        ),
        (
            'axis cone: e3 to L',
            theory.axis_cone(across, along, I1, I3),
            instruments.angle_between(e3, L),
        ),
        (
            'space cone: omega to L',
            theory.space_cone(across, along, I1, I3),
            instruments.angle_between(omega, L),
        ),
    ):
        yield Quantity(f'half-angle of the {name}', np.full(len(times), predicted), measured,
                       tolerance, 'rad')
