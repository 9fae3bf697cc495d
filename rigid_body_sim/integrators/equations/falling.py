"""How the centre of mass of a free body moves under a constant force and a drag in proportion to its velocity, in closed form.

    M v' = F - c v:    v = v0 e^(-z) + a t phi1(z),    x = x0 + v0 t phi1(z) + a t^2 phi2(z),    a = F/M,  z = c t/M

with phi1(z) = (1 - e^(-z))/z and phi2(z) = (1 - phi1(z))/z, which are 1 and 1/2 where there is no drag.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.integrators.equations.euler import DRIFT, FIXED, PLACE, START, write_state
from rigid_body_sim.numerics.exponential import decay

FALL, SLOWING = FIXED, FIXED + 3    # a, c/M
END = SLOWING + 1
TERMS = tuple(1.0 / math.factorial(k) for k in range(19, 1, -1))
SMALL = 1.0    # of z, up to which phi2 is its Taylor series: 18 terms, and no difference of nearly equal numbers


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
def fallen(x, y, z, vx, vy, vz, ax, ay, az, slowing, t):
    """Return place and velocity after a time t (s) from those at its beginning; a = F/M (m/s^2), slowing = c/M (1/s)."""
    left, first, second = phi(slowing * t)
    first, second = t * first, t * t * second
    return (x + (first * vx + second * ax), y + (first * vy + second * ay), z + (first * vz + second * az),
            left * vx + first * ax, left * vy + first * ay, left * vz + first * az)


@compiled
def write(p, time, y, out):
    """Fill out, the state vector of a body that turns as in turning.py and falls."""
    x1, x2, x3, vx, vy, vz = fallen(p[PLACE], p[PLACE + 1], p[PLACE + 2], p[DRIFT], p[DRIFT + 1], p[DRIFT + 2], p[FALL], p[FALL + 1],
                                  p[FALL + 2], p[SLOWING], time - p[START])
    write_state(p, time, y[0], y[1], y[2], y[3], y[4], y[5], y[6], x1, x2, x3, vx, vy, vz, out)
