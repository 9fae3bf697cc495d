# SPDX-License-Identifier: Apache-2.0
"""Kapitza's pendulum: upside down on a pivot that shakes along the vertical with A cos(w t).

Symbols: theta the tilt from upright (rad), l = I/(M r) the reduced length (m), I the moment about
the pivot (kg m^2), r the distance (m) from there to the centre of mass, A the amplitude (m) and w
the rate (rad/s) of the shaking, g gravity (m/s^2).

    theta'' = (g/l - (A w^2/l) cos(w t)) sin(theta)

Averaged over the shaking (L. D. Landau, E. M. Lifshitz, Mechanics, section 30) upright is stable
if (A w)^2 > 2 g l, and the pendulum swings slowly: the square of that rate is
(A w)^2/(2 l^2) - g/l. Small tilts obey Mathieu's equation; they are stable where the trace of its
map over a period of the drive is between -2 and 2.
"""

import math


def threshold(g, l):
    """Return the A w above which upright is stable on average, m/s."""
    return math.sqrt(2.0 * g * l)


def slow_rate(A, w, g, l):
    """Return the rate of the slow swing about upright, rad/s."""
    return math.sqrt((A * w) ** 2 / (2.0 * l * l) - g / l)


def trace(A, w, g, l):
    """Return the trace of the map of (theta, theta') over a period of the drive, small tilts."""
    from scipy.integrate import solve_ivp

    def rates(t, y):
        pull = (g - A * w * w * math.cos(w * t)) / l
        return y[2], y[3], pull * y[0], pull * y[1]

    period = 2.0 * math.pi / w
    end = solve_ivp(rates, (0.0, period), (1.0, 0.0, 0.0, 1.0), method='DOP853', rtol=1e-13,
                    atol=1e-15).y[:, -1]
    return float(end[0] + end[3])


def edge(w, g, l):
    """Return the A at which small tilts become stable by Mathieu's equation, m."""
    from scipy.optimize import brentq
    near = threshold(g, l) / w
    return brentq(lambda A: trace(A, w, g, l) - 2.0, 0.9 * near, 1.2 * near, xtol=1e-14)
