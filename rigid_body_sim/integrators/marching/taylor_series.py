# SPDX-License-Identifier: Apache-2.0
"""Taylor series of a turning body: a step of taylor as a recurrence for eight lanes (lanes.py).

    q' = q omega/2,
    omega_1' = ((I2 - I3)/I1) omega_2 omega_3 + Gamma_1/I1 and cyclically,
    f' = f x omega

Gamma = constant + arm x f + c - D omega, where f and c are the components in the frame of a force
and a couple that keep their direction in the world, and D is the matrix of drag; a scene that
lacks one has no f, no c or no D. All right-hand sides are products of two unknowns or linear, so
that the series follow from Cauchy's products:

    (a b)_k = sum over i of a_i b_(k - i),    q_(k + 1) = (q omega)_k/(2 (k + 1)),  ...

As soon as the coefficients k are known, what they give with those of order 0 ... 7 is added to the
sums of the orders k ... k + 7, eight lanes at once: up to order 16 no pair is left out.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.lanes import IN_HALVES, LANES, compiled_lanes
from rigid_body_sim.compilation.layout import Quaternion, Vector, layout

ORDER = 2 * LANES
# number of sums side by side: waiting for one long sum would cost more than joining these
CHAINS = 3


class Turning(NamedTuple):
    """The unknowns; also how they change, what their sums lost, or the coefficients of an order.

    The coefficients of an order stand in LANES places; the last one is not used.
    """

    q: Quaternion    # frame -> world
    omega: Vector    # frame components, rad/s


TURNING = layout(Turning)
OMEGA, UNKNOWNS = TURNING.part('omega').first, TURNING.size


class Series:
    """Coefficients of one unknown: as numbers, and spread over all lanes.

    The first eight also stand side by side, as far as they are known.
    """

    def __init__(self, operations, start):
        self._operations = operations
        self.coefficients, self.spread, self.low = [], [], []
        self.add(start)

    def add(self, coefficient):
        """Append the next coefficient."""
        o, k = self._operations, len(self.coefficients)
        before = self.low[-1] if k else o.none()
        self.coefficients.append(coefficient)
        self.spread.append(o.everywhere(coefficient))
        self.low.append(o.with_lane(before, k, coefficient) if k < LANES else before)


class Products:
    """A sum of products of series with signs, [(sign, a, b), ...].

    `b` should be the one whose coefficients are known first.

    None stands for a series that is zero throughout: its products are left out.
    """

    def __init__(self, operations, *terms):
        self._operations, self._terms, self._sums = (
            operations,
            [term for term in terms if None not in term],
            None,
        )

    def at(self, k):
        """Return the coefficient k; calls come in turn, when the series are known to order k."""
        o = self._operations
        if not self._terms:
            return o.number(0.0)
        pairs = [(sign, b.spread[k], a.low[k - 1]) for sign, a, b in self._terms if k] + [
            (sign, a.spread[k], b.low[k]) for sign, a, b in self._terms]
        # only the lanes of orders that are found are asked for
        sums = [o.keep(o.next(self._sums), ORDER - k)] if k else []
        for place, (sign, factor, low) in enumerate(pairs):
            factor = self._signed(sign, factor)
            if place < CHAINS and place >= len(sums):
                sums.append(o.keep(o.times(factor, low), ORDER - k))
            else:
                sums[place % len(sums)] = o.gather(factor, low, sums[place % len(sums)])
        while len(sums) > 1:
            first, second, *rest = sums
            sums = [*rest, o.plus(first, second)]
        self._sums = sums[0]
        return o.first(self._sums)

    def _signed(self, sign, factor):
        return factor if sign > 0 else self._operations.minus(factor)


def _world(numbers):
    """Return (the components of a vector of the world, what makes omega' of them)."""
    x, y, z, *shares = numbers
    return [x, y, z], shares


def _rows(numbers, width):
    """Return the rows of a matrix, row by row; none of no numbers."""
    return list(zip(*[iter(numbers)] * width, strict=True))


def _turned(o, f, w):
    """Return the products of f' = f x omega."""
    return [Products(o, (1, f[i - 2], w[i - 1]), (-1, f[i - 1], w[i - 2])) for i in range(3)]


def _turning(o, q, w):
    """Return the products of 2 q' = q omega."""
    x, y, z, s = q
    return (
        Products(o, (1, s, w[0]), (1, y, w[2]), (-1, z, w[1])),
        Products(o, (1, s, w[1]), (1, z, w[0]), (-1, x, w[2])),
        Products(o, (1, s, w[2]), (1, x, w[1]), (-1, y, w[0])),
        Products(o, (-1, x, w[0]), (-1, y, w[1]), (-1, z, w[2])),
    )


def expansion(pushed, coupled, dragged, hinged):
    """Return the kernel that fills S with the coefficients of y, order by order.

    Its signature is ``(S, (y, euler, constant, push, couple, drag)) -> ()``.
    More than forty lines: the recurrence is one closure over the four switches.

    Parameters
    ----------
    pushed, coupled, dragged : bool
        Whether there is a force on an arm, and a couple, that keep their direction in the world,
        and drag.
    hinged : bool
        Whether omega keeps to the third axis; the coefficients of its other components stay as
        they are in S.

    Notes
    -----
    euler holds (I2 - I3)/I1 ..., constant a torque's part in omega', push (if `pushed`) f at the
    start and the six numbers that make omega' of it: omega_1' = u_1 f_2 + u_2 f_3, omega_2' = u_3
    f_3 + u_4 f_1, omega_3' = u_5 f_1 + u_6 f_2; couple (if `coupled`) holds c at the start and
    1/I1 ...; drag (if `dragged`) -D_11/I1, -D_12/I1 ..., row by row.
    """
    def recurrence(o, S, y, euler, constant, push, couple, drag):
        turns = (2,) if hinged else (0, 1, 2)
        q, w = (
            [Series(o, value) for value in y[:OMEGA]],
            [Series(o, y[OMEGA + i]) if i in turns else None for i in range(3)],
        )
        force, pull = _world(push) if pushed else ((), ())
        turning, inverse = _world(couple) if coupled else ((), ())
        f, c = [Series(o, value) for value in force], [Series(o, value) for value in turning]
        u, D = _rows(pull, 2), _rows(drag, 3)
        gyroscopic = [Products(o, (1, w[i - 2], w[i - 1])) for i in range(3)]
        products = [
            *_turning(o, q, w),
            *(_turned(o, f, w) if f else ()),
            *(_turned(o, c, w) if c else ()),
        ]
        shares = [0.5] * 4 + [1.0] * (len(f) + len(c))
        unknowns = [(place, one) for place, one in enumerate(q + w) if one]
        for place, one in unknowns:
            o.store(one.coefficients[0], S, place)
        for k in range(ORDER):
            rates = []
            for i in turns:
                driven = constant[i] if k == 0 else None
                if f:
                    near, far = f[i - 2].coefficients[k], f[i - 1].coefficients[k]
                    by_near, by_far = u[i]
                    pull = o.gather(by_near, near, o.times(by_far, far))
                    driven = pull if driven is None else o.plus(driven, pull)
                if c:
                    turn = c[i].coefficients[k]
                    driven = (
                        o.times(inverse[i], turn)
                        if driven is None
                        else o.gather(inverse[i], turn, driven)
                    )
                for share, one in zip(D[i], w, strict=True) if D else ():
                    if one:
                        turn = one.coefficients[k]
                        driven = (
                            o.times(share, turn)
                            if driven is None
                            else o.gather(share, turn, driven)
                        )
                own = gyroscopic[i].at(k)
                rates.append(
                    o.times(euler[i], own) if driven is None else o.gather(euler[i], own, driven)
                )
            following = [o.times(o.number(1.0 / (k + 1)), rate) for rate in rates]
            others = [
                o.times(o.number(share / (k + 1)), product.at(k))
                for share, product in zip(shares, products, strict=True)
            ]
            for one, coefficient in zip(
                [*(w[i] for i in turns), *q, *f, *c], [*following, *others], strict=True
            ):
                one.add(coefficient)
            for place, one in unknowns:
                o.store(one.coefficients[k + 1], S, LANES * (k + 1) + place)
        return []
    return compiled_lanes(recurrence, 0, narrow=IN_HALVES)


def _along(o, S, h):
    """Return by how much the unknowns change in a time h.

    Neighbours are joined, then neighbours of these, and so on.
    """
    terms, power = [o.load(S, LANES * k) for k in range(1, ORDER + 1)], o.everywhere(h)
    step = power
    while len(terms) > 1:
        terms = [
            o.gather(after, power, before)
            for before, after in zip(terms[::2], terms[1::2], strict=True)
        ]
        power = o.times(power, power)
    # the sign of a coefficient of zero is not the same everywhere (lanes.Halves)
    change = o.plus(o.times(terms[0], step), o.everywhere(o.number(0.0)))
    found = []
    for _ in range(UNKNOWNS):
        found.append(o.first(change))
        change = o.next(change)
    return found


along = compiled_lanes(_along, UNKNOWNS)
