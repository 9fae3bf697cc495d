# SPDX-License-Identifier: Apache-2.0
"""The motion of the centre of mass under a constant force and linear drag, in closed form.

    M v' = F - c v:    v = v0 e^(-z) + a t phi1(z),    x = x0 + v0 t phi1(z) + a t^2 phi2(z)

    a = F/M,    z = c t/M

with phi1(z) = (1 - e^(-z))/z and phi2(z) = (1 - phi1(z))/z, which are 1 and 1/2 where there is no
drag.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Vector, layout
from rigid_body_sim.integrators.equations.euler import (
    OMEGA,
    PLACE,
    EquationParameters,
    load_start,
    write_state,
)
from rigid_body_sim.numerics.exponential import decay
from rigid_body_sim.numerics.vectors import plus, scaled


class Fall(NamedTuple):
    """The constant force and the drag of a fall, over the mass."""

    a: Vector          # F/M, m/s^2
    slowing: float     # c/M, 1/s


class FallingParameters(NamedTuple):
    """The parameters of a body that turns and falls."""

    equation: EquationParameters
    fall: Fall


NONE = Fall((0.0, 0.0, 0.0), 0.0)
FALLING = layout(FallingParameters)
load_fall = FALLING.part('fall').load
TERMS = tuple(1.0 / math.factorial(k) for k in range(19, 1, -1))
# phi2 is its Taylor series of 18 terms up to this z: no difference of nearly equal numbers
SMALL = 1.0


@compiled
def phi(z):
    """Return e^(-z), phi1(z) and phi2(z) for z >= 0."""
    if z == 0.0:
        return 1.0, 1.0, 0.5
    if z <= SMALL:
        second = 0.0
        for term in TERMS:
            second = term - z * second
        first = 1.0 - z * second
        return 1.0 - z * first, first, second
    left = decay(z)
    first = (1.0 - left) / z
    return left, first, (1.0 - first) / z


@compiled
def fallen(place, velocity, a, slowing, t):
    """Return place and velocity after a time t (s) from those at its beginning.

    a = F/M (m/s^2), slowing = c/M (1/s).
    """
    left, first, second = phi(slowing * t)
    first, second = t * first, t * t * second
    return (plus(place, plus(scaled(first, velocity), scaled(second, a))),
            plus(scaled(left, velocity), scaled(first, a)))


@compiled
def write(p, time, y, out):
    """Fill `out`, the state vector of a body that turns as in turning.py and falls."""
    begin, fall = load_start(p), load_fall(p)
    place, velocity = fallen(begin.place, begin.drift, fall.a, fall.slowing, time - begin.time)
    write_state(p, time, y[:OMEGA], y[OMEGA:PLACE], place, velocity, out)
