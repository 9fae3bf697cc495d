# SPDX-License-Identifier: Apache-2.0
"""Make pendulum.json: bodies on hinges from phi'' = -Omega^2 sin(phi), by Taylor series.

The series have order 60 and 70-digit arithmetic. Nothing of the closed form is used: no elliptic
function, no energy. Long times are reduced by the period, which the same integration finds: twice
the time between two turning points, or the time of one turn. Cases without a period are integrated
all the way. Once per case the state is also integrated from the quaternion's equation with the
torque of the weight, in which no angle occurs.

    python test/data/make_pendulum.py
"""

import json
import multiprocessing
import pathlib

from mpmath import atan2, cos, mp, mpf, nstr, pi, sin, sqrt

mp.dps = 70
ORDER = 60
ANGLE = mpf('0.15')          # rad a step
OUT = pathlib.Path(__file__).with_name('pendulum.json')

KATER = {'mass': 2.0, 'moments': [0.48, 0.48, 0.002], 'center_of_mass': [0.0, 0.0, -0.4],
         'axis': [0.0, 1.0, 0.0], 'g': 9.81}
# Omega = 3 exactly
UNIT = {'mass': 1.0, 'moments': [0.5, 0.0, 0.5], 'center_of_mass': [0.0, 0.0, -0.5],
        'axis': [1.0, 0.0, 0.0], 'g': 13.5}
SKEW = {'mass': 1.7, 'moments': [0.3, 0.45, 0.6],
        'axes': [0.18257418583505536, 0.3651483716701107, 0.5477225575051661, 0.7302967433402214],
        'center_of_mass': [0.3, -0.2, 0.25], 'axis': [0.6, 0.48, 0.64],
        'through': [-0.1, 0.4, 0.7], 'g': 9.81}
HANGING, UPRIGHT = [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]
ANYHOW = [0.1, -0.5, 0.7, 0.5]
SHORT = [0.37, -2.5, 11.0]
LONG = [*SHORT, 1000.125, 1e6, -777777.7]

# name: description of body and hinge, orientation, rate about the axis (rad/s), times (s); all
# are doubles
ENDLESS = ('separatrix', 'separatrix, back')
# the period depends on the 300th digit at the other side
TOO_LONG = ('rests 1e-300 from upright', 'leaves upright, back')
CASES = {
    'kater': (KATER, [0.0, 0.04997916927067833, 0.0, 0.9987502603949663], 0.0, LONG),
    'kater from p': ({**KATER, 'through': [0.0, 0.0, -1.0]},
                     [0.0, 0.9987502603949663, 0.0, -0.04997916927067833], 0.0, LONG),
    'wide swing': (KATER, [0.0, 0.997494986604, 0.0, 0.0707372016677], 0.25, LONG),
    'wide swing, k = 0.6': (KATER, [0.0, 0.0, 0.0, 1.0], -3.75, LONG),
    'skew swing': (SKEW, ANYHOW, -1.5, LONG),
    'skew turning over': (SKEW, ANYHOW, 9.0, LONG),
    'skew turning back over': (SKEW, ANYHOW, -9.0, LONG),
    'slow turning over': (KATER, HANGING, 6.3, LONG),
    'fast': (SKEW, ANYHOW, 1e6, [1e-6, 0.37, 1e6]),
    'fast, back': (SKEW, ANYHOW, -1e3, [0.003, 11.0, 1e6, -777777.7]),
    'hardly any weight': ({**SKEW, 'g': 1e-12}, ANYHOW, 0.01, LONG),
    'swing of a nearly vertical hinge': (
        {**SKEW, 'axis': [0.0, 1e-5, 1.0], 'through': [0.0, 0.0, 0.0]}, HANGING, 1e-3, LONG),
    'tiny swing': (KATER, [0.0, 1e-300, 0.0, 1.0], 3e-300, LONG),
    'tiny rate': (KATER, HANGING, 1e-300, LONG),
    'small swing': (KATER, [0.0, 1e-9, 0.0, 1.0], 1e-8, LONG),
    'separatrix': (UNIT, HANGING, 6.0, [0.5, 4.0, 12.5, -4.0]),
    'separatrix, back': (UNIT, HANGING, -6.0, [0.5, 4.0, 12.5, -4.0]),
    'an ulp below the separatrix': (UNIT, HANGING, 5.999999999999999, LONG),
    'an ulp above the separatrix': (UNIT, HANGING, 6.000000000000001, LONG),
    '1e-6 below the separatrix': (UNIT, HANGING, 5.999994, LONG),
    '1e-6 above the separatrix': (UNIT, HANGING, -6.000006, LONG),
    'rests an ulp from upright': (
        UNIT, [1.0, 0.0, 0.0, 1.1e-16], 0.0, [1.0, 11.0, 12.5, 13.0, 1e4]),
    'rests 1e-300 from upright': (UNIT, [-1.0, 0.0, 0.0, 1e-300], 0.0, [1.0, 100.0, 231.0, 231.5]),
    'leaves upright': (UNIT, UPRIGHT, 1e-12, [1.0, 9.5, 10.0, 1e4]),
    'leaves upright, back': (UNIT, UPRIGHT, -1e-200, [1.0, 154.0, 155.0]),
    'rises to upright and past it': (UNIT, [1.0, 0.0, 0.0, 1e-8], 6.1e-8, [1.0, 7.0, 8.0, 1e4]),
    'rises nearly to upright': (UNIT, [1.0, 0.0, 0.0, -1e-8], 5.9e-8, [1.0, 7.0, 8.0, 1e4]),
}


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b, strict=True))


def matrix(q):
    """Return the rotation matrix of a quaternion of any norm."""
    x, y, z, w = q
    norm = dot(q, q)
    rows = [[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]]
    return [[entry / norm for entry in row] for row in rows]


def times(rows, v):
    return [dot(row, v) for row in rows]


def product(p, q):
    """Return the quaternion of the rotation q followed by p."""
    u = cross(p[:3], q[:3])
    return [p[3] * q[k] + q[3] * p[k] + u[k] for k in range(3)] + [p[3] * q[3] - dot(p[:3], q[:3])]


class Hinged:
    """Numbers of a case."""

    def __init__(self, body, orientation, rate):
        axis = [mpf(x) for x in body['axis']]
        self.n = [x / sqrt(dot(axis, axis)) for x in axis]
        self.through = [mpf(x) for x in body.get('through', [0.0] * 3)]
        self.r = [mpf(c) - t for c, t in zip(body['center_of_mass'], self.through, strict=True)]
        mass, self.q = mpf(body['mass']), [mpf(x) for x in orientation]
        self.q = [x / sqrt(dot(self.q, self.q)) for x in self.q]
        principal = times(
            zip(*matrix([mpf(x) for x in body.get('axes', HANGING)]), strict=True), self.n)
        lever = cross(self.n, self.r)
        moment = (sum(mpf(m) * x * x for m, x in zip(body['moments'], principal, strict=True))
                  + mass * dot(lever, lever))
        self.pull, self.lever = mass * mpf(body['g']) / moment, lever
        # rounded: the start is a vector of doubles
        self.omega = [mpf(rate * x) for x in body['axis']]
        self.rate = dot(self.omega, self.n)
        gamma = matrix(self.q)[2]
        across = [a - b * dot(self.n, self.r) for a, b in zip(self.r, self.n, strict=True)]
        sine, cosine = dot(lever, gamma), -dot(across, gamma)
        # phi counts from the lowest position or, with the sign of Omega^2 changed, from the
        # highest, so that 1e-300 from there is not lost
        self.side = 1 if cosine > 0 else -1
        self.square, self.phi = (self.side * self.pull * sqrt(sine * sine + cosine * cosine),
                                 atan2(self.side * sine, self.side * cosine))

    def swings(self):
        height = cos(self.phi / 2) if self.side > 0 else sin(self.phi / 2)
        return self.rate ** 2 < 4 * abs(self.square) * height ** 2

    def step(self, phi, rate, h):
        """Return phi and phi' after h by Taylor series."""
        f, s, c = [phi, rate], [sin(phi)], [cos(phi)]
        for n in range(ORDER):
            f.append(-self.square * s[n] / ((n + 1) * (n + 2)))
            s.append(sum((j + 1) * f[j + 1] * c[n - j] for j in range(n + 1)) / (n + 1))
            c.append(-sum((j + 1) * f[j + 1] * s[n - j] for j in range(n + 1)) / (n + 1))
        return mp.polyval(f[::-1], h), mp.polyval([k * a for k, a in enumerate(f)][:0:-1], h)

    def longest(self, rate):
        return ANGLE / max(sqrt(abs(self.square)), abs(rate))

    def follow(self, time):
        """Return phi and phi' at a time."""
        phi, rate, left = self.phi, self.rate, mpf(time)
        while left:
            h = max(-self.longest(rate), min(self.longest(rate), left))
            phi, rate = self.step(phi, rate, h)
            left -= h
        return phi, rate

    def reach(self, phi, rate, gap, slope):
        """Return the time until gap(phi, phi') changes its sign, and phi and phi' there.

        `slope` is the rate of `gap`.
        """
        time, before = mpf(0), gap(phi, rate)
        while True:
            h = self.longest(rate)
            end = self.step(phi, rate, h)
            if gap(*end) * before < 0:
                break
            phi, rate, time, before = *end, time + h, gap(*end)
        part = h / 2
        for _ in range(200):
            end = self.step(phi, rate, part)
            change = gap(*end) / slope(*end)
            part -= change
            if abs(change) < mpf(10) ** (5 - mp.dps) * h:
                return time + part, *self.step(phi, rate, part)
        raise ArithmeticError('no crossing')

    def period(self, swings):
        """Return the period of a swing or of one turn, and by how much phi grows in it."""
        if swings:
            _, phi, _ = self.reach(
                self.phi, self.rate, lambda _, rate: rate, lambda phi, _: -self.square * sin(phi))
            half, _, _ = self.reach(*self.step(phi, mpf(0), self.longest(0)), lambda _, rate: rate,
                                    lambda phi, _: -self.square * sin(phi))
            return 2 * (half + self.longest(0)), mpf(0)
        turn = mp.sign(self.rate) * 2 * pi
        time, _, _ = self.reach(
            self.phi, self.rate, lambda phi, _: phi - self.phi - turn, lambda _, rate: rate)
        return time, turn

    def state(self, phi, rate):
        """Return q, omega (body axes), position and velocity of the body's origin.

        The origin starts at (0, 0, 0).
        """
        half = (phi - self.phi) / 2
        q = product(self.q, [x * sin(half) for x in self.n] + [cos(half)])
        return q + [rate * x for x in self.n] + self.origin(q, rate)

    def origin(self, q, rate):
        arms = [times(matrix(attitude), self.through) for attitude in (self.q, q)]
        spin = times(matrix(q), [rate * x for x in cross(self.n, self.through)])
        return [a - b for a, b in zip(*arms, strict=True)] + [-x for x in spin]

    def by_quaternion(self, time):
        """Return the state from q' = q omega/2 and the torque of the weight.

        It is a Taylor series in q and phi'.
        """
        q, rate, left = self.q, self.rate, mpf(time)
        while left:
            h = max(-self.longest(rate), min(self.longest(rate), left))
            series, rates = [[x] for x in q], [rate]
            turned = [product([series[k][0] for k in range(4)], [*self.n, mpf(0)])]
            for n in range(ORDER):
                for k in range(4):
                    series[k].append(sum(turned[j][k] * rates[n - j] for j in range(n + 1))
                                     / (2 * (n + 1)))
                xz, wy, yz, wx, zz, ww, xx, yy = (
                    sum(series[a][j] * series[b][n - j] for j in range(n + 1))
                    for a, b in ((0, 2), (3, 1), (1, 2), (3, 0), (2, 2), (3, 3), (0, 0), (1, 1)))
                gamma = [2 * (xz - wy), 2 * (yz + wx), zz + ww - xx - yy]
                rates.append(-self.pull * dot(self.lever, gamma) / (n + 1))
                turned.append(product([series[k][n + 1] for k in range(4)], [*self.n, mpf(0)]))
            q, rate = [mp.polyval(x[::-1], h) for x in series], mp.polyval(rates[::-1], h)
            left -= h
        return q + [rate * x for x in self.n] + self.origin(q, rate)


def record(name):
    """Return the record of a case for the JSON file."""
    body, orientation, rate, instants = CASES[name]
    hinged = Hinged(body, orientation, rate)
    swings = name not in ENDLESS and hinged.swings()
    period, turn = hinged.period(swings) if name not in ENDLESS + TOO_LONG else (None, None)
    states = []
    for k, time in enumerate(instants):
        left, whole = mpf(time), 0
        if period is not None and abs(time) > period:
            whole = mp.floor(left / period)
            left -= whole * period
        phi, rate_then = hinged.follow(left)
        state = hinged.state(phi + whole * turn if whole else phi, rate_then)
        if k == 0:
            other = hinged.by_quaternion(time)
            scale = max(abs(rate_then), mpf(10) ** -400)
            assert (max(abs(a - b) for a, b in zip(state, other, strict=True))
                    < mpf(10) ** -45 * max(1, scale)), name
        states.append({'time': time.hex(), 'state': [nstr(x, 36) for x in state]})
    print(name, nstr(period, 12) if period is not None else 'no period', flush=True)
    return {
        **body, 'orientation': orientation, 'angular_velocity': [float(x) for x in hinged.omega],
        'period': nstr(period, 36) if period is not None else None, 'swings': bool(swings),
        'states': states}


if __name__ == '__main__':
    with multiprocessing.Pool() as pool:
        records = pool.map(record, CASES, chunksize=1)
    OUT.write_text(json.dumps(dict(zip(CASES, records, strict=True)), indent=1) + '\n')
