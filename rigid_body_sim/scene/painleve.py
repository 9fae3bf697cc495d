# SPDX-License-Identifier: Apache-2.0
"""Painleve's paradox: the coefficient of friction below which every slip has a solution.

Source: F. Genot and B. Brogliato, Eur. J. Mech. A 18 (1999) 653.
"""

import math

from rigid_body_sim.compilation.jit import inlined
from rigid_body_sim.numerics.functions import cos, sin
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus, plus, scaled

LATITUDES, LONGITUDES = 64, 64    # attitudes at which the bound is looked for


@inlined
def inverse_of(matrix):
    """Return the inverse of a symmetric 3 x 3 matrix, by its cofactors."""
    a, b, c = matrix
    first, second, third = cross(b, c), cross(c, a), cross(a, b)
    share = 1.0 / dot(a, first)
    return scaled(share, first), scaled(share, second), scaled(share, third)


def may_meet_paradox(body, mu):
    """Return whether a coefficient of friction reaches mu_P; infinite ones roll and meet none.

    The quotients of the eigenvalues of G are at most k = 1 + m |r|^2/I_1, with the least moment
    I_1, so that mu_P is at least 2 sqrt(k)/(k - 1), as for the end of a rod. No attitude is looked
    at where mu is below that.
    """
    surface, least = body.surface, min(body.about_center.moments)
    off = minus(surface.center, body.center_of_mass)
    a, b, c = surface.size
    reach = a + b + c + math.sqrt(dot(off, off))
    spread = body.mass * reach * reach / least if least > 0.0 else math.inf
    if mu == math.inf or mu * spread < 2.0 * math.sqrt(1.0 + spread) < math.inf:
        return False
    return mu >= painleve_bound(body)


def painleve_bound(body):
    """Return mu_P: below this coefficient of friction the force of every slip has one solution.

    It is the least of G_nn/|G_nt| over the attitudes, with G of mechanics/contact/laws.py, found
    on a grid and refined; infinite for a sphere about its centre of mass.
    """
    surface = body.surface
    inverse = inverse_of(tuple(map(tuple, body.about_center.matrix.tolist())))

    def quotient(z, angle):
        level = math.sqrt(max(0.0, 1.0 - z * z))
        n = level * cos(angle), level * sin(angle), z
        r = minus(surface.lowest(n), body.center_of_mass)
        pushed = plus(scaled(1.0 / body.mass, n), cross(apply(inverse, cross(r, n)), r))
        along = dot(pushed, n)
        across = minus(pushed, scaled(along, n))
        size = math.sqrt(dot(across, across))
        return along / size if size > 1e-12 * along else math.inf

    step_z, step_angle = 2.0 / LATITUDES, 2.0 * math.pi / LONGITUDES
    least, z, angle = min(
        (quotient((k + 0.5) * step_z - 1.0, n * step_angle), (k + 0.5) * step_z - 1.0,
         n * step_angle) for k in range(LATITUDES) for n in range(LONGITUDES))
    while step_z > 1e-9 and least < math.inf:
        tries = [(quotient(max(-1.0, min(1.0, z + i * step_z)), angle + j * step_angle),
                  max(-1.0, min(1.0, z + i * step_z)), angle + j * step_angle)
                 for i in (-1, 0, 1) for j in (-1, 0, 1)]
        found = min(tries)
        if found[0] < least:
            least, z, angle = found
        else:
            step_z, step_angle = 0.5 * step_z, 0.5 * step_angle
    return least
