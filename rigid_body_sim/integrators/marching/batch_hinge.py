# SPDX-License-Identifier: Apache-2.0
"""Eight bodies at once that turn on a hinge, about the third axis of their frames.

The unknowns are the direction e = (x, y, 0) of the world across the hinge, seen in the body, and
the rate omega_3:

    x' = y omega_3,    y' = -x omega_3,    omega_3' = constant + U_1 x + U_2 y + D omega_3

so that x = cos(angle) and y = -sin(angle), by two products of two series for each order.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.integrators.marching.batch_lane import (
    COARSE,
    CONSTANT,
    DRAG,
    OMEGA,
    ORDER,
    U,
    Unknowns,
)
from rigid_body_sim.integrators.marching.batch_step import (
    Form,
    advance_of,
    between_of,
    half_turn,
    restored,
    square_of,
)
from rigid_body_sim.numerics.rotations import rotate_back

AXIS = 2    # the component of omega along the hinge
MOVING = X, Y, RATE = 0, 1, OMEGA + AXIS
PORTIONS = [[(Y, RATE), (X, RATE)]]    # of x', of -y'
COUNTS = 4.0    # a term of the direction counts so many times: bodies err about as they do alone
PULL, TORQUE, SLOWING = U + 3 * AXIS, CONSTANT + AXIS, DRAG + 3 * AXIS + AXIS


@compiled
def unknowns(q, omega):
    """Return the Unknowns of an attitude and an angular velocity."""
    x, y, _ = rotate_back(*q, 1.0, 0.0, 0.0)
    return Unknowns((x, y, 0.0, 0.0, 0.0, 0.0), omega)


def _next_order(o, row, k, sums, newest, constant):
    """Return the next coefficients."""
    (to_x, to_y), share = sums, row.share(k)
    change = row(TORQUE) if constant else o.none()
    for place, unknown in zip((PULL, PULL + 1, SLOWING), MOVING, strict=True):
        change = o.gather(row(place), newest[unknown], change)
    return [o.times(share, change) for change in (to_x, o.minus(to_y), change)]


def _unit(o, values, lost):
    """Return the unknowns with the direction of length 1, and what they lost."""
    (*e, rate), (*gone, rate_lost) = values, lost
    short = o.times(o.everywhere(o.number(-0.5)), square_of(o, e, o.everywhere(o.number(-1.0))))
    kept = [restored(o, own, o.gather(short, own, left), left)
            for own, left in zip(e, gone, strict=True)]
    return [*(value for value, _ in kept), rate], [*(left for _, left in kept), rate_lost]


def _attitude(o, row, values, h):
    """Return the quaternion of the direction, of its two signs the one nearer to a guess.

    The guess integrates the rate alone. 2 q q^T is linear in cosine and sine of the angle.
    """
    cosine, sine = values[X], o.minus(values[Y])
    (turn,), scalar = half_turn(o, row.angle(h, (AXIS,)))
    _, _, z, w = row.q
    z, w = (o.gather(w, turn, o.times(z, scalar)),
            o.gather(w, scalar, o.minus(o.times(z, turn))))
    one = o.everywhere(o.number(1.0))
    found = [o.gather(o.plus(one, o.minus(cosine)), z, o.times(sine, w)),
             o.gather(o.plus(one, cosine), w, o.times(sine, z))]
    scale = o.divided(one, o.root(square_of(o, found)))
    return [o.none(), o.none(), *(o.times(scale, component) for component in found)]


FORM = Form(MOVING, PORTIONS, ORDER, COUNTS * COUNTS, _next_order, _unit, _attitude)
advance, coarse_advance = advance_of(FORM, ORDER), advance_of(FORM, COARSE)
between, coarse_between = between_of(FORM, ORDER), between_of(FORM, COARSE)
