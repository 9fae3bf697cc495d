# SPDX-License-Identifier: Apache-2.0
"""A step of eight bodies at once by their Taylor series, whatever their unknowns.

Each lane (lanes.py) is a body with its own time and step. A Form has the unknowns, the recurrences
of their series, and the way back to an attitude of length 1: batch_directions.py for bodies under
forces and couples of the world, batch_turning.py where all torques turn with the body,
batch_hinge.py for bodies on a hinge.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.integrators.marching.batch_lane import (
    END,
    FOLLOWING,
    FOUND,
    INVERSES,
    LOST,
    OMEGA,
    ORDER,
    QUATERNION,
    SCALE,
    SERIES,
    SINCE,
    SOUND,
    STEP,
    TIME,
    UNKNOWNS,
)
from rigid_body_sim.integrators.marching.taylor_march import GROWTH, NOTHING, UNMOVED

LOW = 8             # orders of omega that decide the sign of a quaternion


class Form(NamedTuple):
    """What the bodies of a scene are followed by.

    Attributes
    ----------
    moving : tuple of int
        The unknowns that change; the others stay 0.
    counts : float
        Factor on the square of a term of the attitude's unknowns. It makes a body err about as it
        does alone with the same tolerance, which is what `auto` has tried.
    fill : function (o, row)
        Fills the coefficients of orders 1 ... ORDER.
    unit : function (o, values, lost)
        Returns the unknowns brought back to unit length, and what their sums have lost.
    attitude : function (o, row, values, h)
        Returns the quaternion of the unknowns a time h after the point.
    """

    moving: tuple
    counts: float
    fill: Callable
    unit: Callable
    attitude: Callable


class Rows:
    """The rows of lanes, by what stands in them."""

    def __init__(self, o, W):
        self.o, self._W = o, W

    def __call__(self, place):
        """Return a row of eight numbers."""
        return self.o.load(self._W, LANES * place)

    def put(self, value, place):
        """Write a row."""
        self.o.put(value, self._W, LANES * place)

    def coefficient(self, order, unknown):
        """Return a coefficient of the series of an unknown."""
        return self(SERIES + UNKNOWNS * order + unknown)

    def coefficients(self, order, unknowns):
        """Return those of some unknowns; the order may be the variable of a loop."""
        return [self.o.load(self._W, self.o.place(LANES * (SERIES + k), LANES * UNKNOWNS, order))
                for k in unknowns]

    def put_coefficient(self, value, order, unknown):
        """Write a coefficient of the order after a given one."""
        self.o.put(value, self._W, self.o.place(
            LANES * (SERIES + UNKNOWNS + unknown), LANES * UNKNOWNS, order))

    def share(self, order):
        """Return 1/(order + 1), which makes the next coefficient of a rate's."""
        return self.o.load(self._W, self.o.place(LANES * INVERSES, LANES, order))

    @property
    def q(self):
        """The quaternion of the point."""
        return [self(QUATERNION + i) for i in range(4)]

    def angle(self, h, axes=(0, 1, 2)):
        """Return the integral of components of omega over h, by orders up to LOW."""
        o, found = self.o, []
        for i in axes:
            turn = o.times(self.coefficient(LOW, OMEGA + i), o.everywhere(o.number(1 / (LOW + 1))))
            for k in range(LOW - 1, -1, -1):
                mean = o.times(self.coefficient(k, OMEGA + i), o.everywhere(o.number(1 / (k + 1))))
                turn = o.gather(turn, h, mean)
            found.append(o.times(turn, h))
        return found


def fill(o, row, attitude, omega, count, products, next_order):
    """Fill the coefficients of orders 1 ... ORDER by Cauchy sums, which are loops.

    The two terms with the newest coefficients are added after a loop, so that it need not wait for
    them.

    Parameters
    ----------
    attitude, omega : sequence of int
        Unknowns whose coefficients the products take.
    count : int
        How many sums there are.
    products : function (o, sums, attitude, omega, others)
        Returns the sums with the products of attitude and omega of one order with omega of the
        other, `others`.
    next_order : function (k, sums, constant)
        Writes the coefficients of the order k + 1; `constant` says whether k is 0.
    """
    def attitude_of(order):
        return row.coefficients(order, attitude)

    def omega_of(order):
        return row.coefficients(order, omega)
    none, first = [o.none()] * count, omega_of(0)
    next_order(0, products(o, none, attitude_of(0), first, first), True)

    def order(k, _):
        def pair(i, sums):
            rest = o.place(k, -1, i)
            return products(o, sums, attitude_of(i), omega_of(i), omega_of(rest))
        sums = o.repeat(1, k, none, pair)
        newest = omega_of(k)
        sums = products(o, sums, attitude_of(0), omega_of(0), newest)
        next_order(k, products(o, sums, attitude_of(k), newest, omega_of(0)), False)
        return []
    o.repeat(1, ORDER, [], order)


def half_turn(o, angle):
    """Return the vector part of the quaternion of a rotation vector, and its scalar part.

    The size of the vector counts in its cosine and sine to 8 rad.
    """
    half = [o.times(o.everywhere(o.number(0.5)), component) for component in angle]
    square = o.none()
    for component in half:
        square = o.gather(component, component, square)
    cosine, sine = o.none(), o.none()
    for c, s in ((1 / 40320, 1 / 362880), (-1 / 720, -1 / 5040), (1 / 24, 1 / 120),
                 (-1 / 2, -1 / 6), (1.0, 1.0)):
        cosine, sine = (o.gather(cosine, square, o.everywhere(o.number(c))),
                        o.gather(sine, square, o.everywhere(o.number(s))))
    return [o.times(sine, component) for component in half], cosine


def square_of(o, values, start=None):
    """Return the sum of the squares of some values, added to a start."""
    total = o.none() if start is None else start
    for value in values:
        total = o.gather(value, value, total)
    return total


def longest(o, row, tolerance2, scale, form):
    """Return the step at which the larger of the last two terms is what the tolerance allows.

    The lower one counts as it would at the step before; a step grows by GROWTH at most.
    """
    def square(order, weight):
        attitude = [row.coefficient(order, k) for k in form.moving if k < OMEGA]
        omega = [row.coefficient(order, k) for k in form.moving if k >= OMEGA]
        angle = square_of(o, attitude)
        if form.counts != 1.0:
            angle = o.times(o.everywhere(o.number(form.counts)), angle)
        return o.gather(weight, square_of(o, omega), angle)
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


def changes(o, row, h, form):
    """Return the change of each unknown that moves in a time h, by its series."""
    found = []
    for i in form.moving:
        change = row.coefficient(ORDER, i)
        for k in range(ORDER - 1, 0, -1):
            change = o.gather(change, h, row.coefficient(k, i))
        found.append(o.times(change, h))
    return found


def advance(o, W, tolerance2, form):
    """Make the series of the point and from them the point that follows it.

    The square of the tolerance is for a second. More than forty lines: one straight recipe for the
    vector unit, in which every value is named once.
    """
    row = Rows(o, W)
    form.fill(o, row)
    omega = [i for i in form.moving if i >= OMEGA]
    scale = row(SCALE)
    w = square_of(o, [row.coefficient(0, i) for i in omega])
    # a body that hardly turns yet is measured by the rate that omega' gives it
    pull = o.root(square_of(o, [row.coefficient(1, i) for i in omega]))
    for other in (w, pull):
        scale = o.where_less(scale, other, other, scale)
    t, end, step = row(TIME), row(END), longest(o, row, tolerance2, scale, form)
    t1 = o.where_less(o.gather(o.everywhere(o.number(1.1)), step, t), end, o.plus(t, step), end)
    h = o.plus(t1, o.minus(t))
    y = [row.coefficient(0, i) for i in form.moving]
    d = [o.plus(change, row(LOST + i))
         for i, change in zip(form.moving, changes(o, row, h, form), strict=True)]
    y1 = [o.plus(a, b) for a, b in zip(y, d, strict=True)]
    lost = [
        o.plus(b, o.minus(o.plus(after, o.minus(a)))) for a, b, after in zip(y, d, y1, strict=True)
    ]
    y1, lost = form.unit(o, y1, lost)
    row.put(square_of(o, y1), SOUND)
    for place, value in (
        (TIME, t1),
        (STEP, h),
        (SCALE, scale),
        *((LOST + i, value) for i, value in zip(form.moving, lost, strict=True)),
        *((QUATERNION + i, value) for i, value in enumerate(form.attitude(o, row, y1, h))),
        *((SERIES + i, value) for i, value in zip(form.moving, y1, strict=True)),
    ):
        row.put(value, FOLLOWING + place)
    return []


def restored(o, own, back, lost):
    """Return a sum of a value, what brings it back to unit length and what was lost; and its loss.

    `back` holds what was lost already.
    """
    total = o.plus(own, back)
    return total, o.plus(back, o.minus(o.plus(total, o.minus(own))))


def between(o, W, form):
    """Find quaternion and omega of each lane at its own time since the point, by its series."""
    row = Rows(o, W)
    h = row(SINCE)
    y = [o.plus(row.coefficient(0, i), change)
         for i, change in zip(form.moving, changes(o, row, h, form), strict=True)]
    for i, value in enumerate(form.attitude(o, row, y, h)):
        row.put(value, FOUND + i)
    for i, value in zip(form.moving, y, strict=True):
        if i >= OMEGA:
            row.put(value, FOUND + 4 + i - OMEGA)
    return []


def step_of(form):
    """Return the recurrence of a step, (o, W, tolerance2), for a form."""
    return partial(advance, form=form)


def between_of(form):
    """Return the recurrence of what is between points, (o, W), for a form."""
    return partial(between, form=form)
