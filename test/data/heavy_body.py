# SPDX-License-Identifier: Apache-2.0
"""High-precision reference for a body with a fixed point in a uniform field, by Taylor series.

    q' = q omega / 2,   gamma' = gamma x omega,   I omega' = (I omega + h) x omega - M g c x gamma

These full equations of motion are solved. q is the attitude (x, y, z, w), omega and gamma (the
vertical) are in body axes, which are principal, c is the centre of mass from the fixed point, and
h the momentum of rotors in the body. No closed form is used. Numbers are integers in units of
2^-bits, so that a convolution is one loop of integer products: every product is exact, and only
the sum is truncated.
"""

from operator import mul

from mpmath import mp, mpf


class Flow:
    """The flow of one body.

    Parameters
    ----------
    bits : int
        After the point, of rates in the flow's unit of time.
    moments : 3 numbers, kg m^2
        About the fixed point; a zero moment means no spin about that axis.
    weight_arm : 3 numbers, N m
        M g c.
    rotor : 3 numbers, kg m^2/s
        h.
    """

    def __init__(self, bits, moments, weight_arm, rotor=(0, 0, 0)):
        self.bits, self.order = bits, max(24, bits * 3 // 10)
        self.moments, self.weight_arm, self.rotor = moments, weight_arm, rotor

    def start(self, q, omega):
        """Go to q (any norm) and omega at time 0."""
        with mp.workprec(4 * self.bits + 2200):
            q = [mpf(x) for x in q]
            norm = mp.sqrt(mp.fsum(x * x for x in q))
            x, y, z, w = q = [component / norm for component in q]
            gamma = [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
            omega = [mpf(rate) for rate in omega]
            # in this unit of time rates are of order one
            pull = mp.sqrt(mp.fsum(mpf(x) ** 2 for x in self.weight_arm)) / sorted(self.moments)[1]
            fastest = (mp.sqrt(mp.fsum(rate * rate for rate in omega)) + mp.sqrt(pull)
                       + max(map(abs, self.rotor)) / sorted(self.moments)[1])
            self.unit = mpf(2) ** (-int(mp.ceil(mp.log(fastest, 2))))
            self._prepare()
            self._state = [self._fixed(x)
                           for x in (*q, *gamma, *(rate * self.unit for rate in omega))]
        self._now = 0
        return self

    def go(self, time):
        """Go to a time (s, any number) from the current one; return q and omega there (mpf)."""
        with mp.workprec(2 * self.bits + 2200):
            end = self._fixed(mpf(time) / self.unit)
        while self._now != end:
            series = self._series(self._state)
            step = min(self._step(series), abs(end - self._now))
            step = step if end > self._now else -step
            self._state = [self._at(coefficients, step) for coefficients in series]
            self._now += step
        with mp.workprec(self.bits + 64):
            numbers = [mp.ldexp(mpf(x), -self.bits) for x in self._state]
            return numbers[:4], [rate / self.unit for rate in numbers[7:]]

    def rise(self, time):
        """Go to a time (s) and return gamma_3' and gamma_3'' there."""
        self.go(time)
        _, first, second, *_ = self._series(self._state)[6]
        with mp.workprec(self.bits + 64):
            return (mp.ldexp(mpf(first), -self.bits) / self.unit,
                    2 * mp.ldexp(mpf(second), -self.bits) / self.unit ** 2)

    def _fixed(self, x):
        return int(mp.nint(mp.ldexp(mpf(x), self.bits)))

    def _prepare(self):
        """Set the constants of the equations in the unit of time."""
        i1, i2, i3 = (mpf(moment) for moment in self.moments)
        x, y, z = (mpf(component) * self.unit ** 2 for component in self.weight_arm)
        u, v, w = (1 / moment if moment > 0 else mpf(0) for moment in (i1, i2, i3))
        self._gyro = [
            self._fixed((i2 - i3) * u), self._fixed((i3 - i1) * v), self._fixed((i1 - i2) * w)]
        # rows of -(M g c x) / I
        rows = ((0, z * u, -y * u), (-z * v, 0, x * v), (y * w, -x * w, 0))
        self._pull = [[self._fixed(entry) for entry in row] for row in rows]
        x, y, z = (mpf(component) * self.unit for component in self.rotor)
        # rows of (h x) / I
        rows = ((0, -z * u, y * u), (z * v, 0, -x * v), (-y * w, x * w, 0))
        self._turn = [[self._fixed(entry) for entry in row] for row in rows]

    def _series(self, state):
        """Return the Taylor coefficients of q, gamma, omega."""
        bits = self.bits
        half = bits + 1
        series = [[x] for x in state]
        qx, qy, qz, qw, g1, g2, g3, w1, w2, w3 = series
        b1, b2, b3 = [], [], []       # omega, newest coefficient first

        def times(x, b):
            return sum(map(mul, x, b))

        def turn(i, product, k):
            a, b, c = self._pull[i]
            d, e, f = self._turn[i]
            return (self._gyro[i] * (product >> bits) + a * g1[k] + b * g2[k] + c * g3[k]
                    + d * w1[k] + e * w2[k] + f * w3[k])

        for k in range(self.order):
            b1.insert(0, w1[k])
            b2.insert(0, w2[k])
            b3.insert(0, w3[k])
            n = k + 1
            new = ((times(qw, b1) + times(qy, b3) - times(qz, b2)) // n >> half,
                   (times(qw, b2) + times(qz, b1) - times(qx, b3)) // n >> half,
                   (times(qw, b3) + times(qx, b2) - times(qy, b1)) // n >> half,
                   -(times(qx, b1) + times(qy, b2) + times(qz, b3)) // n >> half,
                   (times(g2, b3) - times(g3, b2)) // n >> bits,
                   (times(g3, b1) - times(g1, b3)) // n >> bits,
                   (times(g1, b2) - times(g2, b1)) // n >> bits,
                   turn(0, times(w2, b3), k) // n >> bits,
                   turn(1, times(w3, b1), k) // n >> bits,
                   turn(2, times(w1, b2), k) // n >> bits)
            for coefficients, x in zip(series, new):
                coefficients.append(x)
        return series

    def _step(self, series):
        """Return a step after which the last two terms of every series are below four units."""
        longest = 4.0
        for k in (self.order - 1, self.order):
            largest = max(abs(coefficients[k]) for coefficients in series)
            if largest:
                longest = min(longest, 2.0 ** ((2.0 - largest.bit_length()) / k))
        return max(1, int(longest * 2.0 ** 40) << (self.bits - 40))

    def _at(self, coefficients, step):
        total = 0
        for c in reversed(coefficients):
            total = c + (total * step >> self.bits)
        return total


class Nutation:
    """One period of a symmetric body's nutation, which determines the states at all times.

    Turning the start about the vertical and about the body's third axis turns the motion with it,
    and after a period the axis is where it was relative to the vertical. So Cayley's and Klein's
    a = w + i z, b = y - i x are multiplied by constants of modulus 1 in a period.

    Parameters
    ----------
    flow : callable
        () -> Flow at its start.
    step : number
        Time (s), less than a quarter of the period, with which the turning points are looked for.
    """

    def __init__(self, flow, step):
        self._flow, self._bits = flow, flow().bits
        with mp.workprec(self._bits + 64):
            self.turning_points = [self._turning_point(mpf(step) / 8, mpf(step))]
            self.turning_points.append(self._turning_point(
                self.turning_points[0] + mpf(step) / 2, mpf(step)))
            self.period = 2 * (self.turning_points[1] - self.turning_points[0])
            base = self.period / 7
            before, after = (
                self._klein(*flow().go(base)), self._klein(*flow().go(base + self.period)))
            a, b = after[0] / before[0], after[1] / before[1]
            self._turns = [mp.arg(a), mp.arg(b), mp.arg(b * mp.conj(a))]

    def _turning_point(self, after, step):
        """Return the first time later than `after` at which gamma_3' changes its sign."""
        flow = self._flow()
        before, time = flow.rise(after)[0], after + step
        while (flow.rise(time)[0] > 0) == (before > 0):
            time += step
        for _ in range(60):
            slope = flow.rise(time)
            change = slope[0] / slope[1]
            time -= change
            if abs(change) < mp.ldexp(abs(time), -self._bits + 20):
                break
        return time

    @staticmethod
    def _klein(q, omega):
        x, y, z, w = q
        return mp.mpc(w, z), mp.mpc(y, -x), mp.mpc(omega[1], -omega[0])

    def go(self, time):
        """Return q and omega at a time (s)."""
        with mp.workprec(self._bits + 64):
            count = mp.floor(mpf(time) / self.period)
            q, omega = self._flow().go(mpf(time) - count * self.period)
            a, b, o = (f * mp.expj(count * turn)
                       for f, turn in zip(self._klein(q, omega), self._turns))
            return [-b.imag, b.real, a.imag, a.real], [-o.imag, o.real, omega[2]]
