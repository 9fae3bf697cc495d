# SPDX-License-Identifier: Apache-2.0
"""Taylor series of a rotating body in fixed point, the reference for all but the table.

It serves free, pivoted and hinged bodies under every effect that a scene may list. The equations
hold in axes fixed in the body (principal about the point of reference; for a hinge the body's
own):

    q' = q (omega + u) / 2,    g_j' = g_j x (omega + u),
    m' = m x (omega + u) + torque,    m = I omega,    u = c m x omega

q is the attitude (x, y, z, w); g_j are the directions fixed in the world that a torque needs (the
vertical; the direction of a torque given in world axes); u is internal dissipation;
torque = K + D omega + sum of A_j g_j: couples in the body, drag, weight and couples in the world.
Drag by squares adds -c (omega . M omega)^(1/2) M omega; a spring of stiffness k and length l from
a point a to an anchor b (in the body's axes) adds k (1 - l/d) a x b with d = |a - b|. At a hinge
only n . torque acts, and a torsion spring pulls by the angle: phi' = n . omega. The motion of the
centre of mass of a free body does not act back on its rotation. Nothing here uses a
closed form.

Numbers are integers in units of 2^-bits, so that a coefficient of the series, a convolution, is
one loop of exact integer products.
"""

import math
from operator import mul

from mpmath import mp, mpf

from rigid_body_sim.study.precision.inputs import (
    ZERO,
    cross,
    dot,
    product,
    turned,
    turned_back,
    unit,
)


class Turning:
    """The motion of one body from its start.

    Parameters
    ----------
    inputs : inputs.Inputs
    bits : int
        Number of bits after the binary point.
    """

    def __init__(self, inputs, bits):
        self.bits, self.order = bits, max(24, bits * 3 // 10)
        self._given = inputs
        self._hinged = inputs.kind == 'hinge'
        self._frame = (mpf(0), mpf(0), mpf(0), mpf(1)) if self._hinged else inputs.axes
        self._arm = turned_back(self._frame, inputs.arm)
        if self._hinged:
            n = turned_back(inputs.axes, inputs.axis)
            across = cross(inputs.axis, self._arm)
            self._moment = (dot(n, [i * x for i, x in zip(inputs.moments, n)])
                            + inputs.mass * dot(across, across))
        self._strikes, self._angle = list(inputs.strikes), mpf(0)
        self.time = 0.0
        self._q, self._omega = (
            product(inputs.orientation, self._frame), turned_back(self._frame, inputs.omega))
        self._breaks = sorted({time for times, _, _ in inputs.couples
                               for time in times if time > 0.0})

    def state(self):
        """Return the attitude of the body (unit quaternion) and omega in body axes, mpf."""
        x, y, z, w = self._frame
        return unit(product(self._q, (-x, -y, -z, w))), turned(self._frame, self._omega)

    def go(self, time):
        """Go on to a time (s, a double, not before the present); strikes at it have acted."""
        with mp.workprec(self.bits + 64):
            while True:
                stops = ([t for t in self._breaks if self.time < t <= time]
                         + [strike[0] for strike in self._strikes if strike[0] <= time])
                until = min([*stops, time])
                self._march(until)
                while self._strikes and self._strikes[0][0] <= until:
                    self._strike(*self._strikes.pop(0)[1:])
                if until == time:
                    return self.state()

    def _march(self, until):
        if until <= self.time:
            return
        self._prepare()
        now, end = self._fixed(mpf(self.time) / self._unit), self._fixed(mpf(until) / self._unit)
        values = [
            *self._q,
            *(w * self._unit for w in self._omega),
            *(x for direction in self._directions for x in direction),
            self._angle,
        ]
        state = [self._fixed(x) for x in values]
        while now < end:
            series = self._series(state)
            step = min(self._step(series), end - now)
            state = [self._at(coefficients, step) for coefficients in series]
            now += step
        numbers = [mp.ldexp(mpf(x), -self.bits) for x in state]
        self._q, self._omega, self.time = (
            unit(numbers[:4]),
            tuple(w / self._unit for w in numbers[4:7]),
            until,
        )
        self._angle = numbers[-1]

    def _strike(self, impulse, lever, _, frame):
        """Change omega by an impulse of force at a point."""
        lever = tuple(r + x for r, x in zip(self._arm, turned_back(self._frame, lever)))
        force = (turned_back(self._frame, impulse) if frame == 'body'
                 else turned_back(self._q, impulse))
        self._omega = tuple(w + x for w, x in zip(self._omega, self._answer(cross(lever, force))))

    def _answer(self, torque):
        """Return I^-1 torque, for the directions in which the body can turn."""
        if self._hinged:
            n = self._given.axis
            return tuple(x * dot(n, torque) / self._moment for x in n)
        return tuple(t / i if i else mpf(0) for t, i in zip(torque, self._given.moments))

    def _fixed(self, x):
        return int(mp.nint(mp.ldexp(mpf(x), self.bits)))

    def _prepare(self):
        """Set unit of time, constants and directions of the interval that begins now.

        More than forty lines: each number of the series once, in the order of the equations.
        """
        given, fixed = self._given, self._fixed
        constant, columns, self._directions = ZERO, [], []
        for times, values, frame in given.couples:
            place = sum(time <= self.time for time in times) - 1
            if place < 0 or not any(values[place]):
                continue
            if frame == 'body':
                constant = tuple(
                    a + b for a, b in zip(constant, turned_back(self._frame, values[place])))
            else:
                size = mp.sqrt(dot(values[place], values[place]))
                self._directions.append(turned_back(self._q, unit(values[place])))
                columns.append(_matrix(lambda e, size=size: [size * x for x in e]))
        if given.g and any(self._arm) and given.kind in ('pivot', 'hinge'):
            self._directions.append(turned_back(self._q, (mpf(0), mpf(0), mpf(1))))
            columns.append(_matrix(lambda e: [-given.mass * given.g * x
                                              for x in cross(self._arm, e)]))
        twist = ZERO
        if given.stiffness:
            twist = tuple(-given.stiffness * x for x in given.axis)
            constant = tuple(a - given.slack * b for a, b in zip(constant, twist))
        held = given.linear if given.kind in ('pivot', 'hinge') else mpf(0)
        damping = _matrix(lambda e: [-given.angular * a - held * b
                                     for a, b in zip(e, cross(self._arm, cross(e, self._arm)))])
        ties = [tie for tie in given.ties if any(tie[1]) and any(tie[0])]
        for at, anchor, stiffness, _ in ties:
            at, far = turned_back(self._frame, at), mp.sqrt(dot(anchor, anchor))
            self._directions.append(turned_back(self._q, unit(anchor)))
            columns.append(_matrix(lambda e, at=at, size=stiffness * far: [
                size * x for x in cross(at, e)]))
        weight = max((abs(x) for matrix in columns for row in matrix for x in row),
                     default=mpf(0)) + max(map(abs, constant)) + given.stiffness
        heavy = [i for i in ([self._moment] if self._hinged else given.moments) if i]
        # in this unit of time rates are of order one
        fastest = (mp.sqrt(dot(self._omega, self._omega))
                   + mp.sqrt(weight / sorted(heavy)[len(heavy) // 2]))
        self._unit = U = mpf(2) ** (-int(mp.ceil(mp.log(fastest, 2)))) if fastest else mpf(1)

        def answered(matrix, factor):
            rows = zip(*(self._answer(column) for column in zip(*matrix)))
            return [[fixed(factor * x) for x in row] for row in rows]
        self._constant = [fixed(U * U * x) for x in self._answer(constant)]
        self._twist = [fixed(U * U * x) for x in self._answer(twist)] if given.stiffness else None
        self._axis = [fixed(x) for x in given.axis or ZERO]
        self._damping = answered(damping, U) if any(x for row in damping for x in row) else None
        self._pull = [answered(matrix, U * U) for matrix in columns]
        # the square of d and the share l of each spring: its direction, numbers, and l
        self._tied = []
        for place, (at, anchor, _, length) in enumerate(ties, len(columns) - len(ties)):
            if length:
                at = turned_back(self._frame, at)
                far = mp.sqrt(dot(anchor, anchor))
                self._tied.append((place, [fixed(-2 * far * x) for x in at],
                                   fixed(dot(at, at) + dot(anchor, anchor)), fixed(length)))
        of_arm = _matrix(lambda e: cross(self._arm, cross(e, self._arm)))
        self._squares = [
            ([[fixed(x) for x in row] for row in form],
             answered([[-c * x for x in row] for row in form], 1))
            for c, form in ((given.quadratic, of_arm),
                            (given.angular_quadratic, _matrix(lambda e: e))) if c]
        i1, i2, i3 = given.moments
        self._gyro = ([0, 0, 0] if self._hinged else [fixed(d / i) if i else 0 for d, i in zip(
            (i2 - i3, i3 - i1, i1 - i2), given.moments)])
        self._inner = ([fixed(given.inner * d / U) for d in (i2 - i3, i3 - i1, i1 - i2)]
                       if given.inner else None)
        self._lag = [[fixed(a / i) if i else 0 for a in pair]
                     for pair, i in zip(((i2, i3), (i3, i1), (i1, i2)), given.moments)]

    def _series(self, state):
        """Return the Taylor coefficients of q, omega and the directions.

        More than forty lines: one recurrence, in which every series needs the others.
        """
        bits, order = self.bits, self.order
        half = bits + 1
        series = [[x] for x in state]
        qx, qy, qz, qw, *omega = series[:7]
        directions = [series[k:k + 3] for k in range(7, len(series) - 1, 3)]
        angle = series[-1]
        lag = [[], [], []]                          # u
        back, turn = [[], [], []], [[], [], []]     # omega and omega + u, newest coefficient first
        speeds = [[] for _ in self._squares]        # (omega . M omega)^(1/2)
        squares, inverses = [[] for _ in self._tied], [[] for _ in self._tied]    # d^2, 1/d

        def times(x, b):
            return sum(map(mul, x, b))

        for k in range(order):
            n = k + 1
            for one, rate in zip(back, omega):
                one.insert(0, rate[k])
            products = [
                times(omega[1], back[2]) >> bits,
                times(omega[2], back[0]) >> bits,
                times(omega[0], back[1]) >> bits,
            ]
            rates = [g * p for g, p in zip(self._gyro, products)]
            if self._inner:
                for one, c, p in zip(lag, self._inner, products):
                    one.insert(0, c * p >> bits)
                for one, rate, u in zip(turn, omega, lag):
                    one.insert(0, rate[k] + u[0])
                for i in range(3):
                    j, l = (i + 1) % 3, (i + 2) % 3
                    a, b = self._lag[i]
                    rates[i] += (a * (times(omega[j], lag[l]) >> bits)
                                 - b * (times(omega[l], lag[j]) >> bits))
            else:
                turn = back
            if k == 0:
                rates = [rate + (c << bits) for rate, c in zip(rates, self._constant)]
            for matrix, vector in zip((self._damping, *self._pull), (omega, *directions)):
                if matrix:
                    x, y, z = vector[0][k], vector[1][k], vector[2][k]
                    rates = [rate + a * x + b * y + c * z
                             for rate, (a, b, c) in zip(rates, matrix)]
            if self._twist:
                rates = [rate + a * angle[k] for rate, a in zip(rates, self._twist)]
            for speed, (form, matrix) in zip(speeds, self._squares):
                square = sum(form[i][j] * (times(omega[i], back[j]) >> bits)
                             for i in range(3) for j in range(3)) >> bits
                speed.append(_root(speed, square, bits))
                x, y, z = (times(speed, b) >> bits for b in back)
                rates = [rate + a * x + b * y + c * z for rate, (a, b, c) in zip(rates, matrix)]
            for square, inverse, (place, arm, constant, length) in zip(
                    squares, inverses, self._tied):
                direction = directions[place]
                square.append((sum(a * g[k] for a, g in zip(arm, direction)) >> bits)
                              + (constant if k == 0 else 0))
                inverse.append(_inverse_root(inverse, square, bits))
                newest = inverse[::-1]
                x, y, z = (-length * (times(g, newest) >> bits) >> bits for g in direction)
                rates = [rate + a * x + b * y + c * z
                         for rate, (a, b, c) in zip(rates, self._pull[place])]
            b1, b2, b3 = turn
            new = [(times(qw, b1) + times(qy, b3) - times(qz, b2)) // n >> half,
                   (times(qw, b2) + times(qz, b1) - times(qx, b3)) // n >> half,
                   (times(qw, b3) + times(qx, b2) - times(qy, b1)) // n >> half,
                   -(times(qx, b1) + times(qy, b2) + times(qz, b3)) // n >> half,
                   *(rate // n >> bits for rate in rates)]
            for x, y, z in directions:
                new += [
                    (times(y, b3) - times(z, b2)) // n >> bits,
                    (times(z, b1) - times(x, b3)) // n >> bits,
                    (times(x, b2) - times(y, b1)) // n >> bits,
                ]
            new.append(sum(a * rate[k] for a, rate in zip(self._axis, omega)) // n >> bits)
            for coefficients, x in zip(series, new):
                coefficients.append(x)
        return series

    def _step(self, series):
        """Return a step after which the last terms of every series are below four units.

        Several terms are tested, because a pair of singularities may make single ones small.
        """
        longest = 4.0
        for k in range(self.order - 7, self.order + 1):
            largest = max(abs(coefficients[k]) for coefficients in series)
            if largest:
                longest = min(longest, 2.0 ** ((2.0 - largest.bit_length()) / k))
        return max(1, math.floor(longest * 2.0 ** 40) << (self.bits - 40))

    def _at(self, coefficients, step):
        total = 0
        for c in reversed(coefficients):
            total = c + (total * step >> self.bits)
        return total


def _root(root, square, bits):
    """Return the next coefficient of the root of a series, from the same one of the square."""
    if not root:
        return math.isqrt(square << bits)
    return ((square << bits) - sum(map(mul, root[1:], root[:0:-1]))) // (2 * root[0])


def _inverse_root(root, square, bits):
    """Return the next coefficient of 1/sqrt of a series: 2 r' s + r s' = 0."""
    k = len(root)
    if not root:
        return (1 << 2 * bits) // math.isqrt(square[0] << bits)
    total = sum((2 * k - j) * square[j] * root[k - j] for j in range(1, k + 1))
    return -total // (2 * k * square[0])


def _matrix(image):
    """Return the rows of the matrix of a linear map."""
    columns = [image([mpf(int(i == k)) for i in range(3)]) for k in range(3)]
    return [list(row) for row in zip(*columns)]
