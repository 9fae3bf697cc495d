# SPDX-License-Identifier: Apache-2.0
"""The operations of expressions that can fail: NaN or infinity, where plain Python would raise."""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics import functions

LEVELS = 11
"""Levels of the continued fraction of tanh, which reach round-off for |x| < 1."""
EVEN = 2.0 ** 53
"""From here on every double is an even integer."""
TWO_TURNS = 4.0 * math.pi
"""rad."""
HALF = 0.5
"""The cosine of a sixth of a turn, half of 2 pi/3."""


@compiled
def divided(a, b):
    """Return a/b; infinity or NaN for b = 0."""
    if b == 0.0:
        return math.nan if not a * a > 0.0 else math.copysign(math.inf, a)
    return a / b


@compiled
def divided_or_zero(a, b):
    """Return a/b; 0 for b = 0."""
    return 0.0 if b == 0.0 else a / b


@compiled
def root(x):
    """Return the square root of x; NaN below 0."""
    return math.sqrt(x) if x >= 0.0 else math.nan


@compiled
def logarithm(x):
    """Return log x; -infinity at 0, NaN below."""
    if x > 0.0:
        return functions.log(x)
    return -math.inf if x == 0.0 else math.nan


@compiled
def raised(x, y):
    """Return x to the power y, for any exponent; NaN where it is not real."""
    if x > 0.0:
        return functions.power(x, y)
    if x != x or y != y:
        return math.nan
    if x == 0.0:
        return 0.0 if y > 0.0 else 1.0 if y == 0.0 else math.inf
    if not abs(y) < EVEN:
        return functions.power(-x, y)
    if y != math.floor(y):
        return math.nan
    size = functions.power(-x, y)
    return size if 2.0 * math.floor(0.5 * y) == y else -size


@compiled
def raised_beyond(beyond, x, y):
    """Return x to the power y; beyond a kink -|x|^y for x < 0.

    Steps look beyond the kink at which they end: there abs(x)^1.5 goes on as an odd function.
    """
    return -raised(-x, y) if beyond and x < 0.0 else raised(x, y)


@compiled
def root_beyond(beyond, x):
    """Return the square root of x; beyond a kink -sqrt(|x|) for x < 0."""
    return -root(-x) if beyond and x < 0.0 else root(x)


@compiled
def tangent(x):
    """Return tan x."""
    sine, cosine = functions.sin_cos(x)
    return divided(sine, cosine)


@compiled
def hyperbolic_tangent(x):
    """Return tanh x: Lambert's continued fraction where |x| < 1, else by exp(-2 |x|)."""
    if abs(x) < 1.0:
        square, below = x * x, 2.0 * LEVELS + 1.0
        for k in range(LEVELS, 0, -1):
            below = (2.0 * k - 1.0) + square / below
        return x / below
    small = functions.exp(-2.0 * abs(x))
    return math.copysign((1.0 - small) / (1.0 + small), x)


@compiled
def wound(mode, s, c):
    """Return the angle (rad) with the half-angle's sine s and cosine c, and its switch.

    It is from -2 pi to 2 pi. With the mode 1 it is continued: from -4 pi/3 to 8 pi/3, with -1 from
    -8 pi/3 to 4 pi/3. The switch has the sign of the angle, but with a mode that of the mode up to
    2 pi/3 beyond 0: so both places where it changes are 2 pi/3 from an end of what is continued.
    """
    angle = 2.0 * functions.atan2(s, c)
    if c > HALF:
        return angle, mode if mode != 0.0 else math.copysign(1.0, s)
    return angle + mode * TWO_TURNS if c < -HALF and mode * s < 0.0 else angle, s


@compiled
def side(mode, switch):
    """Return the mode 1 or -1 if one is given, else the sign of the switch (0 at 0)."""
    if mode != 0.0:
        return mode
    return 1.0 if switch > 0.0 else -1.0 if switch < 0.0 else 0.0
