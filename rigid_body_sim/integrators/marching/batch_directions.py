# SPDX-License-Identifier: Apache-2.0
"""Eight bodies at once by directions of the world: under forces and couples fixed in it.

The unknowns are two directions of the world seen in the body, e1 and e2, and omega:

    e' = e x omega,
    omega_1' = ((I2 - I3)/I1) omega_2 omega_3 + (constant + U e1 + V e2 + D omega)_1

and cyclically, where e1 lies along a force and e2 in the plane of it and a couple, both fixed
in the world, and D is the matrix of drag, by 15 products of two series for each order.

The quaternion follows from e1 and e2 up to its sign, which is chosen by continuity: the one nearer
to the result of integrating omega alone.
"""

from functools import partial

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.integrators.marching.batch_lane import (
    COARSE,
    CONSTANT,
    DIRECTIONS,
    DRAG,
    EULER,
    GYROSCOPIC,
    OMEGA,
    ORDER,
    UNKNOWNS,
    U,
    Unknowns,
    V,
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


def _turning(e):
    """Return the pairs of e x omega: of each component what is added and what is subtracted."""
    return [(e + a, OMEGA + b) for j, k in ((1, 2), (2, 0), (0, 1)) for a, b in ((j, k), (k, j))]


PORTIONS = [_turning(0), [*_turning(3), *GYROSCOPIC]]


@compiled
def unknowns(q, omega):
    """Return the Unknowns of an attitude and an angular velocity."""
    e1, e2 = rotate_back(*q, 1.0, 0.0, 0.0), rotate_back(*q, 0.0, 1.0, 0.0)
    return Unknowns((*e1, *e2), omega)


def _directions(e):
    """Return e1 and e2 of their six components."""
    x1, y1, z1, x2, y2, z2 = e
    return (x1, y1, z1), (x2, y2, z2)


def _next_order(o, row, k, sums, newest, constant, dragged=False):
    """Return the next coefficients, with drag or without."""
    e1, e2 = _directions([newest[i] for i in range(DIRECTIONS)])
    terms = iter(sums)
    changes = [o.plus(next(terms), o.minus(next(terms))) for _ in range(DIRECTIONS)]
    for i, own in enumerate(terms):
        # terms that are known first come first
        rate = (
            o.gather(row(V + i), e2[i], row(CONSTANT + i))
            if constant
            else o.times(row(V + i), e2[i])
        )
        for j in range(3):
            rate = o.gather(row(U + 3 * i + j), e1[j], rate)
        for j in range(3) if dragged else ():
            rate = o.gather(row(DRAG + 3 * i + j), newest[OMEGA + j], rate)
        changes.append(o.gather(row(EULER + i), own, rate))
    share = row.share(k)
    return [o.times(share, change) for change in changes]


def _unit(o, values, lost):
    """Return the unknowns with e1 and e2 of length 1 and at a right angle, and what they lost."""
    half, e = o.everywhere(o.number(-0.5)), values[:DIRECTIONS]
    e1, e2 = _directions(e)
    one, values, lost = o.everywhere(o.number(-1.0)), list(values), list(lost)
    slant = o.none()
    for a, b in zip(e1, e2, strict=True):
        slant = o.gather(a, b, slant)
    n1, n2, s = (o.times(half, x) for x in (square_of(o, e1, one), square_of(o, e2, one), slant))
    for i, (n, own, other) in enumerate(zip((n1, n1, n1, n2, n2, n2), e, (*e2, *e1), strict=True)):
        back = o.gather(n, own, o.gather(s, other, lost[i]))
        values[i], lost[i] = restored(o, own, back, lost[i])
    return values, lost


def _turned(o, q, angle):
    """Return q turned by about the rotation vector: its size in cos and sin counts to 8 rad."""
    vector, scalar = half_turn(o, angle)
    return _quaternion_product(o, q, [*vector, scalar])


def _quaternion_product(o, p, q):
    """Return the quaternion of the rotation q followed by p."""
    def sum_of(*terms):
        found = o.times(terms[0][1], terms[0][2])
        for sign, a, b in terms[1:]:
            found = o.gather(a if sign > 0 else o.minus(a), b, found)
        return found
    return [sum_of((1, p[3], q[0]), (1, p[0], q[3]), (1, p[1], q[2]), (-1, p[2], q[1])),
            sum_of((1, p[3], q[1]), (1, p[1], q[3]), (1, p[2], q[0]), (-1, p[0], q[2])),
            sum_of((1, p[3], q[2]), (1, p[2], q[3]), (1, p[0], q[1]), (-1, p[1], q[0])),
            sum_of((1, p[3], q[3]), (-1, p[0], q[0]), (-1, p[1], q[1]), (-1, p[2], q[2]))]


def _attitude(o, e, guess):
    """Return the quaternion of the rotation whose matrix has the rows e1, e2, e1 x e2.

    Of its two signs the one nearer to a guess.

    4 q q^T is linear in the matrix.
    """
    a, b = _directions(e)
    c = [o.gather(a[i - 2], b[i - 1], o.minus(o.times(a[i - 1], b[i - 2]))) for i in range(3)]
    one = o.everywhere(o.number(1.0))
    together, apart = o.plus(b[1], c[2]), o.plus(b[1], o.minus(c[2]))
    up, down = o.plus(one, a[0]), o.plus(one, o.minus(a[0]))
    xy, xz, yz = o.plus(a[1], b[0]), o.plus(a[2], c[0]), o.plus(b[2], c[1])
    xw, yw, zw = (
        o.plus(c[1], o.minus(b[2])),
        o.plus(a[2], o.minus(c[0])),
        o.plus(b[0], o.minus(a[1])),
    )
    table = (
        (o.plus(up, o.minus(together)), xy, xz, xw),
        (xy, o.plus(down, apart), yz, yw),
        (xz, yz, o.plus(down, o.minus(apart)), zw),
        (xw, yw, zw, o.plus(up, together)),
    )
    found = [
        o.gather(
            line[0],
            guess[0],
            o.gather(line[1], guess[1], o.gather(line[2], guess[2], o.times(line[3], guess[3]))),
        )
        for line in table
    ]
    square = o.gather(
        found[0],
        found[0],
        o.gather(found[1], found[1], o.gather(found[2], found[2], o.times(found[3], found[3]))),
    )
    scale = o.divided(one, o.root(square))
    return [o.times(scale, component) for component in found]


def _attitude_of(o, row, values, h):
    return _attitude(o, values[:DIRECTIONS], _turned(o, row.q, row.angle(h)))


FORM = Form(tuple(range(UNKNOWNS)), PORTIONS, ORDER, 1.0, _next_order, _unit, _attitude_of)
advance, coarse_advance = advance_of(FORM, ORDER), advance_of(FORM, COARSE)
DRAGGED = FORM._replace(next_order=partial(_next_order, dragged=True))
advance_with_drag, coarse_advance_with_drag = (
    advance_of(DRAGGED, ORDER), advance_of(DRAGGED, COARSE))
between, coarse_between = between_of(FORM, ORDER), between_of(FORM, COARSE)
