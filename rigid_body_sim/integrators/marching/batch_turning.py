# SPDX-License-Identifier: Apache-2.0
"""Eight bodies at once by their quaternions, where all torques turn with the body.

The unknowns are q, in the first four places of the attitude, and omega:

    q' = q omega/2,    omega_1' = ((I2 - I3)/I1) omega_2 omega_3 + (constant + D omega)_1

and cyclically, where D is the matrix of drag. There are 15 products of two series for each order,
as many as by directions (batch_directions.py), but nothing has to be found from them after the
step.
"""

from functools import partial
from itertools import chain

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.integrators.marching.batch_lane import (
    COARSE,
    CONSTANT,
    DRAG,
    EULER,
    GYROSCOPIC,
    OMEGA,
    ORDER,
    UNKNOWNS,
    Unknowns,
)
from rigid_body_sim.integrators.marching.batch_step import (
    Form,
    advance_of,
    between_of,
    restored,
    square_of,
)

OF_Q = X, Y, Z, W = range(4)
OF_OMEGA = range(OMEGA, UNKNOWNS)
# q' is half the sum of what is added and what is subtracted: places in q, in omega. Each term has
# a sum of its own: one that takes three products in turn would wait for each of them
RATES = (((W, X), (Y, Z)), ((Z, Y),)), (((W, Y), (Z, X)), ((X, Z),)), \
    (((W, Z), (X, Y)), ((Y, X),)), ((), ((X, X), (Y, Y), (Z, Z)))
*OF_VECTOR, OF_SCALAR = [[(a, OMEGA + b) for terms in signs for a, b in terms] for signs in RATES]
PORTIONS = [[*chain.from_iterable(OF_VECTOR)], [*OF_SCALAR, *GYROSCOPIC]]
COUNTS = 8.0    # a term of q counts so many times: bodies err about as they do alone


@compiled
def unknowns(q, omega):
    """Return the Unknowns of an attitude and an angular velocity."""
    return Unknowns((*q, 0.0, 0.0), omega)


def _next_order(o, row, k, sums, newest, constant, dragged=False):
    """Return the next coefficients, with drag or without."""
    share = row.share(k)
    half, terms, found = o.times(o.everywhere(o.number(0.5)), share), iter(sums), []
    for signs in RATES:
        added, subtracted = (_total(o, [next(terms) for _ in one]) for one in signs)
        rate = o.minus(subtracted)
        if added is not None:
            rate = o.plus(added, rate)
        found.append(o.times(half, rate))
    for i, own in enumerate(terms):
        rate = row(CONSTANT + i) if constant else o.none()
        for j in range(3) if dragged else ():
            rate = o.gather(row(DRAG + 3 * i + j), newest[OMEGA + j], rate)
        rate = o.gather(row(EULER + i), own, rate)
        found.append(o.times(share, rate))
    return found


def _total(o, values):
    """Return the sum of some values, None of none."""
    total = None
    for value in values:
        total = value if total is None else o.plus(total, value)
    return total


def _unit(o, values, lost):
    """Return the unknowns with q of length 1, and what they lost."""
    values, lost = list(values), list(lost)
    short = o.times(o.everywhere(o.number(-0.5)),
                    square_of(o, values[:len(OF_Q)], o.everywhere(o.number(-1.0))))
    for i in OF_Q:
        values[i], lost[i] = restored(o, values[i], o.gather(short, values[i], lost[i]), lost[i])
    return values, lost


def _attitude(o, row, values, h):
    return values[:len(OF_Q)]


FORM = Form((*OF_Q, *OF_OMEGA), PORTIONS, ORDER, COUNTS * COUNTS, _next_order, _unit, _attitude)
advance, coarse_advance = advance_of(FORM, ORDER), advance_of(FORM, COARSE)
DRAGGED = FORM._replace(next_order=partial(_next_order, dragged=True))
advance_with_drag, coarse_advance_with_drag = (
    advance_of(DRAGGED, ORDER), advance_of(DRAGGED, COARSE))
between, coarse_between = between_of(FORM, ORDER), between_of(FORM, COARSE)
