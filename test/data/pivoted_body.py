"""High-precision reference for a body with a fixed point or a fixed axis in a uniform field: Taylor series of the full equations of motion.

    q' = q omega / 2,   gamma' = gamma x omega,   I omega' = I omega x omega - M g c x gamma      (fixed point)
    q' = q omega / 2,   gamma' = gamma x omega,   I_n omega' = -M g n . (c x gamma) n             (fixed axis n)

q attitude (x, y, z, w), omega and gamma (the vertical) in body axes, c centre of mass from the fixed point. Nothing here knows of a closed
form.
Numbers are integers in units of 2^-bits, so that a convolution is one loop of integer products: every product is exact, only its sum is cut.
"""

from operator import mul

from mpmath import mp, mpf


class Arithmetic:
    """Fixed-point numbers with a number of bits after the point, and the order of the series that reaches them."""

    def __init__(self, bits):
        self.bits = bits
        self.order = max(24, bits * 3 // 10)

    def fixed(self, x):
        """Return an exact number (mpf, float) as an integer in units of 2^-bits."""
        with mp.workprec(4 * self.bits + 2200):
            return int(mp.nint(mp.ldexp(mpf(x), self.bits)))

    def number(self, x):
        """Return a fixed-point number as an mpf."""
        with mp.workprec(self.bits):
            return mp.ldexp(mpf(x), -self.bits)


class Flow:
    """The flow of one body.

    Parameters
    ----------
    arithmetic : Arithmetic
    moments : 3 numbers, kg m^2
        About the fixed point; a zero moment means no spin about that axis.
    weight_arm : 3 numbers, N m
        M g c.
    axis : 3 numbers, optional
        Fixed axis (unit vector, body axes); moments is then the one moment about it.
    """

    def __init__(self, arithmetic, moments, weight_arm, axis=None):
        self.arithmetic = arithmetic
        self.moments, self.weight_arm, self.axis = moments, weight_arm, axis

    def integrate(self, q, omega, times):
        """Return [(q, omega)] at increasing times of one sign (exact numbers, s), from q and omega at time 0 (mpf)."""
        arithmetic = self.arithmetic
        bits = arithmetic.bits
        with mp.workprec(2 * bits + 2200):
            q = [mpf(x) for x in q]
            norm = mp.sqrt(mp.fsum(x * x for x in q))
            q = [x / norm for x in q]
            gamma = [2 * (q[0] * q[2] - q[3] * q[1]), 2 * (q[1] * q[2] + q[3] * q[0]), 1 - 2 * (q[0] ** 2 + q[1] ** 2)]
            omega = [mpf(w) for w in omega]
            # unit of time: rates are of order one in it
            fastest = mp.sqrt(mp.fsum(w * w for w in omega)) + mp.sqrt(self._gravity_rate_squared())
            unit = mpf(2) ** (-int(mp.ceil(mp.log(fastest, 2))))
            self._scale(unit)
            y = [arithmetic.fixed(x) for x in (*q, *gamma, *(w * unit for w in omega))]
            # exact times in units of 2^-(bits): ends of the spans
            ends = [arithmetic.fixed(mpf(t) / unit) for t in times]
        found, now = [], 0
        sign = -1 if ends and ends[-1] < 0 else 1
        for end in ends:
            while now != end:
                series = self._series(y)
                step = sign * min(self._step(series), abs(end - now))
                y = [self._at(coefficients, step) for coefficients in series]
                now += step
            with mp.workprec(bits + 64):
                numbers = [arithmetic.number(x) for x in y]
                found.append((numbers[:4], [w / unit for w in numbers[7:]]))
        return found

    def _gravity_rate_squared(self):
        smallest = min(m for m in self.moments if m > 0)
        return mp.sqrt(mp.fsum(mpf(x) ** 2 for x in self.weight_arm)) / smallest

    def _scale(self, unit):
        """Prepare the constants of the equations in units of time `unit`."""
        fixed = self.arithmetic.fixed
        i1, i2, i3 = (mpf(m) for m in (self.moments if self.axis is None else (1, 1, 1)))
        arm = [mpf(x) for x in self.weight_arm]
        inverse = [1 / i if i > 0 else mpf(0) for i in (i1, i2, i3)]
        self.gyro = [fixed((i2 - i3) * inverse[0]), fixed((i3 - i1) * inverse[1]), fixed((i1 - i2) * inverse[2])]
        pull = unit * unit
        if self.axis is None:
            # omega' = ... - (arm x gamma) / I
            rows = [[0, arm[2] * inverse[0], -arm[1] * inverse[0]],
                    [-arm[2] * inverse[1], 0, arm[0] * inverse[1]],
                    [arm[1] * inverse[2], -arm[0] * inverse[2], 0]]
        else:
            n = [mpf(x) for x in self.axis]
            across = [n[1] * arm[2] - n[2] * arm[1], n[2] * arm[0] - n[0] * arm[2], n[0] * arm[1] - n[1] * arm[0]]    # n x arm
            rows = [[-n[i] * across[j] / mpf(self.moments[0]) for j in range(3)] for i in range(3)]
            self.gyro = [0, 0, 0]
        self.pull = [[fixed(x * pull) for x in row] for row in rows]

    def _series(self, y):
        """Return the Taylor coefficients of the ten unknowns."""
        bits = self.arithmetic.bits
        series = [[x] for x in y]
        qx, qy, qz, qw, g1, g2, g3, w1, w2, w3 = series
        back = [[] for _ in range(3)]       # omega, newest coefficient first
        b1, b2, b3 = back
        for k in range(self.arithmetic.order):
            b1.insert(0, w1[k])
            b2.insert(0, w2[k])
            b3.insert(0, w3[k])

            def times(x, b):
                return sum(map(mul, x, b))
            half = bits + 1
            n = k + 1
            new = (
                (times(qw, b1) + times(qy, b3) - times(qz, b2)) // n >> half,
                (times(qw, b2) + times(qz, b1) - times(qx, b3)) // n >> half,
                (times(qw, b3) + times(qx, b2) - times(qy, b1)) // n >> half,
                -(times(qx, b1) + times(qy, b2) + times(qz, b3)) // n >> half,
                (times(g2, b3) - times(g3, b2)) // n >> bits,
                (times(g3, b1) - times(g1, b3)) // n >> bits,
                (times(g1, b2) - times(g2, b1)) // n >> bits,
                self._omega_dot(0, times(w2, b3), series, k) // n >> bits,
                self._omega_dot(1, times(w3, b1), series, k) // n >> bits,
                self._omega_dot(2, times(w1, b2), series, k) // n >> bits)
            for coefficients, x in zip(series, new):
                coefficients.append(x)
        return series

    def _omega_dot(self, i, product, series, k):
        pull = self.pull[i]
        return (self.gyro[i] * (product >> self.arithmetic.bits)
                + pull[0] * series[4][k] + pull[1] * series[5][k] + pull[2] * series[6][k])

    def _step(self, series):
        """Return a step (fixed point) whose last two terms are below the last bit, times 4."""
        bits = self.arithmetic.bits
        order = self.arithmetic.order
        step = float('inf')
        for k in (order - 1, order):
            largest = max(abs(coefficients[k]) for coefficients in series)
            if largest:
                step = min(step, 2.0 ** ((2.0 - (largest.bit_length())) / k))
        return max(1, int(min(step, 4.0) * 2.0 ** 40) << (bits - 40))

    def _at(self, coefficients, step):
        bits = self.arithmetic.bits
        total = 0
        for c in reversed(coefficients):
            total = c + (total * step >> bits)
        return total
