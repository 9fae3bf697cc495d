# SPDX-License-Identifier: Apache-2.0
"""Billiard ball, from slipping to rolling (notes, "Billiard ball slipping -> rolling").

Symbols: a radius (m), mu coefficient of friction, g gravity (m/s^2), h height of the cue above the
middle of the ball (m, negative is below), v0 speed just after the strike (m/s), omega0 spin just
after it (rad/s, positive rolls forward), t time since the strike (s). The ball is solid, I = (2/5)
M a^2, and runs straight.

Errata: above h = 2 a/5 the notes' time of sliding lacks a factor 1/7
(`onset_of_rolling_above_as_written`).
"""

import numpy as np


def spin_after_strike(v0, h, a):
    """Return omega0 = M v0 h/I = (5/2) h v0/a^2, rad/s."""
    return 2.5 * h * v0 / a**2


def height_of_natural_roll(a):
    """Return the height h = 2 a/5 at which the ball rolls at once, m."""
    return 2.0 * a / 5.0


def friction_direction(h, a):
    """Return the sign of the friction: -1 for h < 2 a/5, +1 for h > 2 a/5, 0 at equality.

    A negative sign means that friction slows the ball down.
    """
    return np.sign(h - height_of_natural_roll(a))


def acceleration(h, a, mu, g):
    """Return x'' while sliding, m/s^2: -mu g if struck below 2 a/5, +mu g above."""
    return friction_direction(h, a) * mu * g


def angular_acceleration(h, a, mu, g):
    """Return phi'' while sliding, rad/s^2.

    It is (5/2) mu g/a if struck below 2 a/5, -(5/2) mu g/a above and zero at 2 a/5.
    """
    return -friction_direction(h, a) * 2.5 * mu * g / a


def sliding_time(slip, mu, g, share=2.0 / 5.0):
    """Return the sliding time of a ball whose lowest point slips at the speed `slip` (m/s), s.

    The time is 2 slip/(7 mu g) for a solid ball; `share` = I/(M a^2) of another ball.
    """
    return slip * share / ((1.0 + share) * mu * g)


def speed_when_rolling(speed, rim_speed, share=2.0 / 5.0):
    """Return the speed of a rolling ball that began with `speed` and `rim_speed` = a omega, m/s.

    For a solid ball it is (5/7) (speed + (2/5) rim_speed); `share` = I/(M a^2) of another ball.
    Friction does not enter: the angular momentum about a point of the table is conserved.
    """
    return (speed + share * rim_speed) / (1.0 + share)


def onset_of_rolling(v0, h, a, mu, g):
    """Return the time when rolling begins, on both sides of 2 a/5, s.

    t = 2 |v0 - a omega0|/(7 mu g). For h = 0 it is 2 v0/(7 mu g), and below 2 a/5 it is
    2 v0/(7 mu g) (1 - 5 h/(2 a)), as the notes correctly say.
    """
    return sliding_time(np.abs(v0 - a * spin_after_strike(v0, h, a)), mu, g)


def onset_of_rolling_above_as_written(v0, h, a, mu, g):
    """Return the notes' time for h > 2 a/5, 2 v0/(mu g) (5 h/(2 a) - 1), s.

    It is seven times too long.
    """
    return 2.0 * v0 / (mu * g) * (2.5 * h / a - 1.0)


def sliding_speed(t, v0, h, a, mu, g):
    """Return x' before the onset of rolling, m/s."""
    return v0 + acceleration(h, a, mu, g) * t


def sliding_spin(t, v0, h, a, mu, g):
    """Return phi' before the onset of rolling, rad/s."""
    return spin_after_strike(v0, h, a) + angular_acceleration(h, a, mu, g) * t


def sliding_distance(t, v0, h, a, mu, g):
    """Return x before the onset of rolling, m."""
    return v0 * t + 0.5 * acceleration(h, a, mu, g) * t**2


def rolling_speed(v0, h, a):
    """Return the final speed, (5/7) v0 (1 + h/a), m/s; friction does not enter."""
    return speed_when_rolling(v0, a * spin_after_strike(v0, h, a))
