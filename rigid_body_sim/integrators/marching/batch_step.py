# SPDX-License-Identifier: Apache-2.0
"""A step of eight bodies at once by their Taylor series, whatever their unknowns.

Each lane (lanes.py) is a body with its own time and step. A Form has the unknowns, the recurrences
of their series, and the way back to an attitude of length 1: batch_directions.py for bodies under
forces and couples of the world, batch_turning.py where all torques turn with the body,
batch_hinge.py for bodies on a hinge.
"""

from collections.abc import Callable
from functools import partial
from itertools import chain
from typing import NamedTuple

from rigid_body_sim.compilation.lanes import IN_TURN, LANES, compiled_lanes
from rigid_body_sim.integrators.marching.batch_lane import (
    BEFORE_Q,
    BEFORE_SERIES,
    BEFORE_TIME,
    END,
    FOUND,
    INVERSES,
    LOST,
    OMEGA,
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
    portions : list of lists of (int, int)
        Of each Cauchy sum the two unknowns whose products it takes, the second one a component of
        omega. A portion is what sixteen registers hold; all sums if there is one.
    order : int
        Of the series: ORDER or COARSE.
    counts : float
        Factor on the square of a term of the attitude's unknowns. It makes a body err about as it
        does alone with the same tolerance, which is what `auto` has tried.
    next_order : function (o, row, k, sums, newest, constant)
        Returns the coefficients of the order k + 1 of the unknowns that move, of the sums and of
        the coefficients of the order k by unknown; `constant` says whether k is 0.
    unit : function (o, values, lost)
        Returns the unknowns brought back to unit length, and what their sums have lost.
    attitude : function (o, row, values, h)
        Returns the quaternion of the unknowns a time h after the point.
    """

    moving: tuple
    portions: list
    order: int
    counts: float
    next_order: Callable
    unit: Callable
    attitude: Callable


class Rows:
    """The rows of lanes, by what stands in them; quaternion and order 0 are those of the point.

    `of_before` takes those of the point before, from which the higher orders were found.
    """

    def __init__(self, o, W, order, of_before=False):
        self.o, self._W, self.order = o, W, order
        self._q, self._start = (
            (BEFORE_Q, BEFORE_SERIES) if of_before else (QUATERNION, SERIES))

    def __call__(self, place):
        """Return a row of eight numbers."""
        return self.o.load(self._W, LANES * place)

    def put(self, value, place):
        """Write a row."""
        self.o.put(value, self._W, LANES * place)

    def coefficient(self, order, unknown):
        """Return a coefficient of the series of an unknown."""
        return self((SERIES + UNKNOWNS * order if order else self._start) + unknown)

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
        return [self(self._q + i) for i in range(4)]

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


def fill(o, row, form):
    """Fill the coefficients of all orders from 1 on by Cauchy sums, which are loops.

    The four terms with the two newest coefficients are added after a loop, so that it need not
    wait for them; the newest ones are handed on, since reading what was just written takes time.
    """
    groups = o.groups(form.portions)

    def coefficients(k):
        return dict(zip(form.moving, row.coefficients(k, form.moving), strict=True))

    def products(pairs, sums, one, other):
        """Return the sums with the products of an order with omega of the other."""
        return [o.gather(one[a], other[b], known)
                for (a, b), known in zip(pairs, sums, strict=True)]

    def both(pairs, sums, one, other):
        """Return the sums with the products of two orders, and the other way round."""
        return products(pairs, products(pairs, sums, one, other), other, one)

    def following(k, newest, sums_of, constant=False):
        sums = [*chain.from_iterable(
            sums_of(pairs, [o.none()] * len(pairs)) for pairs in groups)]
        found = form.next_order(o, row, k, sums, newest, constant)
        for unknown, value in zip(form.moving, found, strict=True):
            row.put_coefficient(value, k, unknown)
        return dict(zip(form.moving, found, strict=True))

    zeroth = coefficients(0)
    first = following(
        0, zeroth, lambda pairs, none: products(pairs, none, zeroth, zeroth), constant=True)
    second = following(1, first, lambda pairs, none: both(pairs, none, zeroth, first))
    third = following(2, second, lambda pairs, none: both(
        pairs, products(pairs, none, first, first), zeroth, second))

    def order(k, values):
        newest = dict(zip(form.moving, values, strict=True))

        def sums_of(pairs, none):
            sums = o.repeat(2, o.place(k, 1, -1), none, lambda i, sums: products(
                pairs, sums, coefficients(i), coefficients(o.place(k, -1, i))))
            sums = both(pairs, sums, coefficients(1), coefficients(o.place(k, 1, -1)))
            return both(pairs, sums, coefficients(0), newest)
        return [*following(k, newest, sums_of).values()]
    o.repeat(3, row.order, [*third.values()], order)


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
    final = o.times(square(form.order, weight), o.times(last, last))
    before = square(form.order - 1, weight)
    larger = o.where_less(final, before, before, final)
    step = o.power(
        o.divided(o.everywhere(tolerance2), o.where_less(larger, nothing, nothing, larger)),
        0.5 / (form.order - 2),
    )
    most = o.times(o.everywhere(o.number(GROWTH)), last)
    return o.where_less(step, most, step, most)


def changes(o, row, h, form):
    """Return the change of each unknown that moves in a time h, by its series."""
    found = []
    for i in form.moving:
        change = row.coefficient(form.order, i)
        for k in range(form.order - 1, 0, -1):
            change = o.gather(change, h, row.coefficient(k, i))
        found.append(o.times(change, h))
    return found


def advance(o, W, tolerance2, form):
    """Make the series of the point, and put the point that follows in its place.

    The square of the tolerance is for a second. More than forty lines: one straight recipe for the
    vector unit, in which every value is named once.
    """
    row = Rows(o, W, form.order)
    fill(o, row, form)
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
    q, q1 = row.q, form.attitude(o, row, y1, h)
    # what was before comes first: in plain Python what was loaded is a view of its row
    for place, value in (
        (BEFORE_TIME, t),
        *((BEFORE_Q + i, value) for i, value in enumerate(q)),
        *((BEFORE_SERIES + i, value) for i, value in zip(form.moving, y, strict=True)),
        (TIME, t1),
        (STEP, h),
        (SCALE, scale),
        (SOUND, square_of(o, y1)),
        *((LOST + i, value) for i, value in zip(form.moving, lost, strict=True)),
        *((QUATERNION + i, value) for i, value in enumerate(q1)),
        *((SERIES + i, value) for i, value in zip(form.moving, y1, strict=True)),
    ):
        row.put(value, place)
    return []


def restored(o, own, back, lost):
    """Return a sum of a value, what brings it back to unit length and what was lost; and its loss.

    `back` holds what was lost already.
    """
    total = o.plus(own, back)
    return total, o.plus(back, o.minus(o.plus(total, o.minus(own))))


def between(o, W, form):
    """Find quaternion and omega of each lane at its own time since the point before.

    They are found by its series.
    """
    row = Rows(o, W, form.order, of_before=True)
    h = row(SINCE)
    y = [o.plus(row.coefficient(0, i), change)
         for i, change in zip(form.moving, changes(o, row, h, form), strict=True)]
    for i, value in enumerate(form.attitude(o, row, y, h)):
        row.put(value, FOUND + i)
    for i, value in zip(form.moving, y, strict=True):
        if i >= OMEGA:
            row.put(value, FOUND + 4 + i - OMEGA)
    return []


def advance_of(form, order):
    """Return the kernel (W, (tolerance2,)) of a step of a form, with series of an order."""
    return _kernel(advance, form, order)


def between_of(form, order):
    """Return the kernel (W, ()) of what is between points, with series of an order."""
    return _kernel(between, form, order)


def _kernel(recurrence, form, order):
    return compiled_lanes(partial(recurrence, form=form._replace(order=order)), 0,
                          narrow=IN_TURN if len(form.portions) > 1 else None)
