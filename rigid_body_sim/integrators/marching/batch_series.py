# SPDX-License-Identifier: Apache-2.0
"""A step of eight bodies at once by their Taylor series.

Each lane (lanes.py) is a body with its own time and step.

The unknowns are two directions of the world seen in the body, e1 and e2, and omega:

    e' = e x omega,
    omega_1' = ((I2 - I3)/I1) omega_2 omega_3 + (constant + U e1 + V e2 + D omega)_1

and cyclically, where e1 lies along a force and e2 in the plane of it and a couple, both fixed
in the world, and D is the matrix of drag; so one form serves all scenes of the method, by 15
products of two series for each order (4 on a hinge; drag and hinge have kernels of their own).
Their Cauchy sums are loops; the two terms with the newest coefficients are added after the loop,
so that it need not wait for them.

The quaternion follows from e1 and e2 up to its sign, which is chosen by continuity: the one nearer
to the result of integrating omega alone.
"""

from functools import partial
from typing import NamedTuple

from rigid_body_sim.compilation.lanes import LANES, compiled_lanes
from rigid_body_sim.compilation.layout import Pair, Vector, layout
from rigid_body_sim.integrators.marching.batch_lane import (
    CONSTANT,
    DIRECTIONS,
    DRAG,
    END,
    EULER,
    FOLLOWING,
    FOUND,
    INVERSES,
    LOST,
    ORDER,
    QUATERNION,
    SCALE,
    SERIES,
    SINCE,
    SOUND,
    STEP,
    TIME,
    UNKNOWNS,
    U,
    V,
)
from rigid_body_sim.integrators.marching.taylor_march import GROWTH, NOTHING, UNMOVED

LOW = 8             # orders of omega that decide a sign
ON_HINGE = 0, 1, 3, 4, 8    # the unknowns that change there


class Sums(NamedTuple):
    """The sums of `_products`: of e x omega what is added and what is subtracted, then omega'."""

    e1: tuple[Pair, Pair, Pair]
    e2: tuple[Pair, Pair, Pair]
    gyroscopic: Vector


SUMS, GYROSCOPIC = layout(Sums).size, layout(Sums).part('gyroscopic').first
# of each component of e1 and e2: places of what is added, and of what is subtracted
SIGNED = [[[layout(Sums).part(name).part(i).part(sign).first for sign in (0, 1)]
           for i in range(3)] for name in ('e1', 'e2')]
AXIS = 2    # the component of omega along a hinge


def _directions(e):
    """Return e1 and e2 of their six components."""
    x1, y1, z1, x2, y2, z2 = e
    return (x1, y1, z1), (x2, y2, z2)


def _products(o, sums, e, w, others, hinged):
    """Return the 15 sums, those of e x omega by sign, with one more pair of orders.

    Added are the products of e and w of one order with omega of the other. On a hinge, along the
    third axis, all others are 0.
    """
    made = list(sums)
    for vector, places in zip(_directions(e), SIGNED, strict=True):
        for i, (added, subtracted) in enumerate(places):
            j, k = (i + 1) % 3, (i + 2) % 3
            for place, a, b in ((added, j, k), (subtracted, k, j)):
                if not hinged or b == AXIS:
                    made[place] = o.gather(vector[a], others[b], made[place])
    if hinged:
        return made
    for i in range(3):
        at = GYROSCOPIC + i
        made[at] = o.gather(w[(i + 1) % 3], others[(i + 2) % 3], made[at])
    return made


def _series(o, W, dragged, hinged):
    """Fill the coefficients of orders 1 ... ORDER, with drag or without, on a hinge or free.

    More than forty lines: an order is what the functions within make of the rows of the lower
    ones, and all of them share the rows.
    """
    turns, moving = ((2,), ON_HINGE) if hinged else ((0, 1, 2), range(UNKNOWNS))

    def row(place):
        return o.load(W, LANES * place)

    def rows(order, first, count):
        return [
            o.load(W, o.place(LANES * (SERIES + first + k), LANES * UNKNOWNS, order))
            for k in range(count)
        ]

    def e_of(order):
        return rows(order, 0, DIRECTIONS)

    def omega_of(order):
        return rows(order, DIRECTIONS, 3)

    def next_order(k, sums, constant):
        e, w = e_of(k), omega_of(k) if dragged else ()
        e1, e2 = _directions(e)
        changes = [o.plus(sums[added], o.minus(sums[subtracted]))
                   for places in SIGNED for added, subtracted in places]
        for i in turns:
            # terms that are known first come first
            rate = (
                o.gather(row(V + i), e2[i], row(CONSTANT + i))
                if constant
                else o.times(row(V + i), e2[i])
            )
            for j in range(3):
                rate = o.gather(row(U + 3 * i + j), e1[j], rate)
            for j in turns if dragged else ():
                rate = o.gather(row(DRAG + 3 * i + j), w[j], rate)
            own = sums[GYROSCOPIC + i]
            changes.append(rate if hinged else o.gather(row(EULER + i), own, rate))
        share = o.load(W, o.place(LANES * INVERSES, LANES, k))
        if hinged:
            changes = [*(changes[i] for i in ON_HINGE[:-1]), changes[-1]]
        for i, change in zip(moving, changes, strict=True):
            o.put(
                o.times(share, change),
                W,
                o.place(LANES * (SERIES + UNKNOWNS + i), LANES * UNKNOWNS, k),
            )

    none = [o.none()] * SUMS
    first, first_rates = e_of(0), omega_of(0)
    next_order(0, _products(o, none, first, first_rates, first_rates, hinged), True)

    def order(k, _):
        def pair(i, sums):
            rest = o.place(k, -1, i)
            return _products(o, sums, e_of(i), omega_of(i), omega_of(rest), hinged)
        sums = o.repeat(1, k, none, pair)
        newest = omega_of(k)
        sums = _products(o, sums, e_of(0), omega_of(0), newest, hinged)
        next_order(k, _products(o, sums, e_of(k), newest, omega_of(0), hinged), False)
        return []
    o.repeat(1, ORDER, [], order)


def _longest(o, W, row, tolerance2, scale):
    """Return the step at which the larger of the last two terms is what the tolerance allows.

    The lower one counts as it would at the step before; a step grows by GROWTH at most.
    """
    def square(order, weight):
        e, w = o.none(), o.none()
        for k in range(UNKNOWNS):
            value = row(SERIES + UNKNOWNS * order + k)
            if k < DIRECTIONS:
                e = o.gather(value, value, e)
            else:
                w = o.gather(value, value, w)
        return o.gather(weight, w, e)
    nothing, last = o.everywhere(o.number(NOTHING)), row(STEP)
    weight = o.where_less(nothing, scale, o.divided(o.everywhere(o.number(1.0)), scale), o.none())
    # the first step: a radian
    last = o.where_less(
        o.none(),
        last,
        last,
        o.where_less(nothing, scale, o.root(weight), o.everywhere(o.number(UNMOVED))),
    )
    final, before = o.times(square(ORDER, weight), o.times(last, last)), square(ORDER - 1, weight)
    larger = o.where_less(final, before, before, final)
    step = o.power(
        o.divided(o.everywhere(tolerance2), o.where_less(larger, nothing, nothing, larger)),
        0.5 / (ORDER - 2),
    )
    most = o.times(o.everywhere(o.number(GROWTH)), last)
    return o.where_less(step, most, step, most)


def _turned(o, q, angle):
    """Return q turned by about the rotation vector: its size in cos and sin counts to 8 rad."""
    half = [o.times(o.everywhere(o.number(0.5)), component) for component in angle]
    square = o.gather(half[0], half[0], o.gather(half[1], half[1], o.times(half[2], half[2])))
    cosine, sine = o.none(), o.none()
    for c, s in (
        (1 / 40320, 1 / 362880),
        (-1 / 720, -1 / 5040),
        (1 / 24, 1 / 120),
        (-1 / 2, -1 / 6),
        (1.0, 1.0),
    ):
        cosine, sine = (
            o.gather(cosine, square, o.everywhere(o.number(c))),
            o.gather(sine, square, o.everywhere(o.number(s))),
        )
    return _quaternion_product(o, q, [*(o.times(sine, component) for component in half), cosine])


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


def _moved(o, coefficient, h, moving=range(UNKNOWNS)):
    """Return the change of the unknowns in a time h, and the integral of omega over it.

    Those that are not `moving` do not change. The series are those of
    ``coefficient(order, unknown)``.
    """
    changes = []
    for i in range(UNKNOWNS):
        if i not in moving:
            changes.append(o.none())
            continue
        change = coefficient(ORDER, i)
        for k in range(ORDER - 1, 0, -1):
            change = o.gather(change, h, coefficient(k, i))
        changes.append(o.times(change, h))
    angle = []
    for i in range(DIRECTIONS, UNKNOWNS):
        turn = o.times(coefficient(LOW, i), o.everywhere(o.number(1.0 / (LOW + 1))))
        for k in range(LOW - 1, -1, -1):
            turn = o.gather(
                turn, h, o.times(coefficient(k, i), o.everywhere(o.number(1.0 / (k + 1))))
            )
        angle.append(o.times(turn, h))
    return changes, angle


def _row(o, W, place):
    return o.load(W, LANES * place)


def _coefficient(o, W, order, i):
    return o.load(W, LANES * (SERIES + UNKNOWNS * order + i))


def _advance(o, W, tolerance2, dragged=False, hinged=False):
    """Make the series of the point and from them the point that follows it.

    The square of the tolerance is for a second. More than forty lines: one straight recipe for the
    vector unit, in which every value is named once.
    """
    row, coefficient = partial(_row, o, W), partial(_coefficient, o, W)

    def put(value, place):
        o.put(value, W, LANES * place)
    _series(o, W, dragged, hinged)
    w, pull, scale = o.none(), o.none(), row(SCALE)
    for i in range(DIRECTIONS, UNKNOWNS):
        w, pull = (
            o.gather(coefficient(0, i), coefficient(0, i), w),
            o.gather(coefficient(1, i), coefficient(1, i), pull),
        )
    # a body that hardly turns yet is measured by the rate that omega' gives it
    pull = o.root(pull)
    for other in (w, pull):
        scale = o.where_less(scale, other, other, scale)
    t, end, step = row(TIME), row(END), _longest(o, W, row, tolerance2, scale)
    t1 = o.where_less(o.gather(o.everywhere(o.number(1.1)), step, t), end, o.plus(t, step), end)
    h = o.plus(t1, o.minus(t))
    changes, angle = _moved(o, coefficient, h, ON_HINGE if hinged else range(UNKNOWNS))
    y = [coefficient(0, i) for i in range(UNKNOWNS)]
    d = [o.plus(change, row(LOST + i)) for i, change in enumerate(changes)]
    y1 = [o.plus(a, b) for a, b in zip(y, d, strict=True)]
    lost = [
        o.plus(b, o.minus(o.plus(after, o.minus(a)))) for a, b, after in zip(y, d, y1, strict=True)
    ]
    # e1 and e2 are brought back to length 1 and to a right angle
    half, e = o.everywhere(o.number(-0.5)), y1[:DIRECTIONS]
    e1, e2 = _directions(e)

    def product(a, b, start):
        return o.gather(a[0], b[0], o.gather(a[1], b[1], o.gather(a[2], b[2], start)))
    one = o.everywhere(o.number(-1.0))
    n1, n2, s = (
        o.times(half, x)
        for x in (
            product(e1, e1, one),
            product(e2, e2, one),
            product(e1, e2, o.none()),
        )
    )
    for i, (n, own, other) in enumerate(zip((n1, n1, n1, n2, n2, n2), e, (*e2, *e1), strict=True)):
        back = o.gather(n, own, o.gather(s, other, lost[i]))
        y1[i] = o.plus(own, back)
        lost[i] = o.plus(back, o.minus(o.plus(y1[i], o.minus(own))))
    q = _attitude(o, y1[:DIRECTIONS], _turned(o, [row(QUATERNION + i) for i in range(4)], angle))
    sound = o.none()
    for value in y1:
        sound = o.gather(value, value, sound)
    put(sound, SOUND)
    for place, value in (
        (TIME, t1),
        (STEP, h),
        (SCALE, scale),
        *((LOST + i, value) for i, value in enumerate(lost)),
        *((QUATERNION + i, value) for i, value in enumerate(q)),
        *((SERIES + i, value) for i, value in enumerate(y1)),
    ):
        put(value, FOLLOWING + place)
    return []


def _between(o, W):
    """Find quaternion and omega of each lane at its own time since the point, by its series."""
    row, coefficient = partial(_row, o, W), partial(_coefficient, o, W)
    changes, angle = _moved(o, coefficient, row(SINCE))
    y = [o.plus(coefficient(0, i), change) for i, change in enumerate(changes)]
    q = _attitude(o, y[:DIRECTIONS], _turned(o, [row(QUATERNION + i) for i in range(4)], angle))
    for i, value in enumerate((*q, *y[DIRECTIONS:])):
        o.put(value, W, LANES * (FOUND + i))
    return []


advance = compiled_lanes(_advance, 0)
advance_with_drag = compiled_lanes(partial(_advance, dragged=True), 0)
advance_on_hinge = compiled_lanes(partial(_advance, dragged=True, hinged=True), 0)
between = compiled_lanes(_between, 0)
