# SPDX-License-Identifier: Apache-2.0
"""Check of a billiard ball struck at any height (notes, "Billiard ball slipping -> rolling")."""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import billiard as theory


def check(run):
    """Yield the quantities of a ball at rest that a cue has just struck along x."""
    scene = run.scene
    strike, friction = scene.effect('strike'), scene.effect('sliding_friction')
    a, mu, g, h = scene.body.radius, friction.mu, friction.g, strike.height
    v0 = strike.impulse[0] / scene.body.mass
    if (not (strike.time == 0.0 and v0 > 0.0 == strike.impulse[1] and mu * g > 0.0)
            or scene.initial.velocity.any() or scene.initial.angular_velocity.any()
            or np.any(scene.initial.orientation != [0.0, 0.0, 0.0, 1.0])):
        raise BadInput(
            scene.name,
            f'impulse {list(strike.impulse)} at {strike.time:g} s, mu g = {mu * g:g} m/s^2',
            'needs a ball at rest, struck along +x at time 0, with friction')
    onset = theory.onset_of_rolling(v0, h, a, mu, g)
    start = run.at(0.0)
    yield Quantity('spin after the strike omega0', theory.spin_after_strike(v0, h, a),
                   start.angular_velocity[1], 1e-14, 'rad/s')
    seen = run.simulation
    seen.advance(int(np.ceil((1.5 * onset + 0.5) * seen.rate)))
    began = [event.time for event in seen.events if event.name == 'rolling began']
    rolls_at_once = onset <= 1e-14 * abs(v0) / (mu * g)
    if rolls_at_once:
        yield Quantity(
            'onset of rolling', 0.0, began[0] if began else 0.0, 0.0, 's', absolute=True)
    else:
        written = (theory.onset_of_rolling_above_as_written(v0, h, a, mu, g)
                   if h > theory.height_of_natural_roll(a) else None)
        yield Quantity('onset of rolling', onset, began[0], 1e-12, 's', as_written=written)
        yield from _while_sliding(run, v0, h, a, mu, g, onset)
    rolling = run.at(1.5 * onset + 0.3)
    yield Quantity('speed when it rolls, over v0', theory.rolling_speed(v0, h, a) / v0,
                   rolling.velocity[0] / v0, 1e-12, absolute=True)
    slip = rolling.velocity[0] - a * _rim(rolling)
    yield Quantity('slip when it rolls, over v0', 0.0, abs(slip / v0), 1e-14, absolute=True)


def _while_sliding(run, v0, h, a, mu, g, onset):
    """Yield the effect of friction before the onset, from two times on the way."""
    first, second = run.at(0.25 * onset), run.at(0.75 * onset)
    elapsed = second.time - first.time
    yield Quantity("x'' while it slips", theory.acceleration(h, a, mu, g),
                   (second.velocity[0] - first.velocity[0]) / elapsed, 1e-11, 'm/s^2')
    yield Quantity("phi'' while it slips", theory.angular_acceleration(h, a, mu, g),
                   (_rim(second) - _rim(first)) / elapsed, 1e-11, 'rad/s^2')
    yield Quantity('speed half-way', theory.sliding_speed(0.5 * onset, v0, h, a, mu, g),
                   run.at(0.5 * onset).velocity[0], 1e-12, 'm/s')
    yield Quantity('distance to the onset', theory.sliding_distance(onset, v0, h, a, mu, g),
                   run.at(onset).position[0], 1e-12, 'm')


def _rim(state):
    """Return the rolling rate phi', the component of omega along y.

    It is the same in world and body axes, because the body turns about y.
    """
    return state.angular_velocity[1]
