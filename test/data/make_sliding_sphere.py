# SPDX-License-Identifier: Apache-2.0
"""Make sliding_sphere.json: a ball on a table from its equations of motion alone, to 34 digits.

While the lowest point slips, the whole right-hand side (v' = -mu g u/|u|,
k a omega' = mu g z x u/|u|, x' = v, q' = omega q/2) is solved by Gragg's extrapolated midpoint
rule in 46-digit arithmetic; nothing of the closed form is used. The onset of rolling is where the
slip of the integrated motion vanishes, found by secants. From there on v and omega are constant,
which is solved by hand.

    python test/data/make_sliding_sphere.py
"""

import json
import pathlib

from mpmath import cos, mp, mpf, nstr, sin, sqrt

mp.dps = 46
COLUMNS = 18
ANGLE = 0.5    # rad a step

# name: radius, k = I/(M a^2), mu, g, orientation, angular velocity (body), velocity (x, y); all
# are doubles
CASES = {
    'struck at the centre': (0.028575, 0.4, 0.2, 9.81, (0, 0, 0, 1), (0, 0, 0), (1.5, 0)),
    'struck low': (0.028575, 0.4, 0.2, 9.81, (0, 0, 0, 1), (0, -30.0, 0), (1.5, 0)),
    'struck high': (0.028575, 0.4, 0.2, 9.81, (0, 0, 0, 1), (0, 95.0, 0), (1.5, 0)),
    'draw shot': (0.028575, 0.4, 0.2, 9.81, (0, 0, 0, 1), (60.0, -175.0, 0), (1.0, 0.25)),
    'side spin': (0.028575, 0.4, 0.2, 9.81, (0, 0, 0, 1), (0, 0, 80.0), (2.0, 0)),
    'faint side spin': (0.028575, 0.4, 0.2, 9.81, (0, 0, 0, 1), (0, 0, 1e-6), (2.0, 0)),
    'masse': (0.028575, 0.4, 0.2, 9.81, (0.5, -0.5, 0.1, 0.7), (-60.0, 90.0, 50.0), (1.2, -0.4)),
    'masse, shell': (
        0.11, 2 / 3, 0.3, 9.81, (-0.2, 0.4, 0.8, 0.4), (20.0, 15.0, -40.0), (3.0, 2.0)),
    'fast spin': (0.05, 0.4, 0.1, 1.62, (0, 0.6, 0, 0.8), (-150.0, 2.0, 60.0), (0.6, 0.1)),
}
FRACTIONS = (-0.5, 0.1, 0.45, 0.97, 1.0, 1.3, 3.0)    # of the time of sliding
OUT = pathlib.Path(__file__).with_name('sliding_sphere.json')


def right_side(case, y):
    """Return y' for y = (q, omega, x, v), omega in world axes."""
    a, k, mu, g = case
    qx, qy, qz, qw, wx, wy, wz, _, _, vx, vy = y
    ux, uy = vx - a * wy, vy + a * wx
    push = mu * g / sqrt(ux * ux + uy * uy)
    return [(wx * qw + wy * qz - wz * qy) / 2, (wy * qw + wz * qx - wx * qz) / 2,
            (wz * qw + wx * qy - wy * qx) / 2, -(wx * qx + wy * qy + wz * qz) / 2,
            -push * uy / (k * a), push * ux / (k * a), mpf(0), vx, vy, -push * ux, -push * uy]


def step(case, y, h):
    """Return y after h by Gragg's midpoint rule, extrapolated from 2 to 2 COLUMNS substeps."""
    rows = []
    start = right_side(case, y)
    for row in range(COLUMNS):
        count = 2 * (row + 1)
        small = h / count
        before, now = y, [value + small * rate for value, rate in zip(y, start, strict=True)]
        for _ in range(count - 1):
            before, now = now, [value + 2 * small * rate
                                for value, rate in zip(before, right_side(case, now), strict=True)]
        rate = right_side(case, now)
        rows.append([[(one + two + small * slope) / 2
                      for one, two, slope in zip(before, now, rate, strict=True)]])
        for column in range(row):
            ratio = mpf(row + 1) / (row - column)
            rows[row].append([better + (better - worse) / (ratio * ratio - 1)
                              for better, worse in zip(
                                  rows[row][column], rows[row - 1][column], strict=True)])
    return rows[-1][-1]


def sliding(case, y, time):
    """Return y after a time of sliding."""
    speed = (sqrt(y[4] ** 2 + y[5] ** 2 + y[6] ** 2)
             + case[2] * case[3] * abs(time) / (case[1] * case[0]))
    count = max(1, int(speed * abs(time) / ANGLE) + 1)
    for _ in range(count):
        y = step(case, y, time / count)
    return y


def slip(case, y):
    """Return the speed of the lowest point."""
    a = case[0]
    return sqrt((y[9] - a * y[5]) ** 2 + (y[10] + a * y[4]) ** 2)


def onset(case, y):
    """Return when the slip vanishes, and y there."""
    at, first = mpf(0), slip(case, y)
    next_at = first / (case[2] * case[3] * (1 + 1 / case[1])) * mpf('0.9')
    later = sliding(case, y, next_at)
    while slip(case, later) > first * mpf(10) ** -40:
        rate = (slip(case, y) - slip(case, later)) / (next_at - at)
        at, y, next_at = next_at, later, next_at + slip(case, later) / rate * (1 - mpf(10) ** -10)
        later = sliding(case, y, next_at - at)
    return next_at, later


def rolling(y, time):
    """Return y after a time of rolling: constant v and omega."""
    rate = sqrt(y[4] ** 2 + y[5] ** 2 + y[6] ** 2)
    sine, cosine = sin(rate * time / 2) / rate, cos(rate * time / 2)
    x, z, w = [sine * y[4], sine * y[5], sine * y[6]], y[:4], cosine
    turned = [w * z[0] + x[0] * z[3] + x[1] * z[2] - x[2] * z[1],
              w * z[1] - x[0] * z[2] + x[1] * z[3] + x[2] * z[0],
              w * z[2] + x[0] * z[1] - x[1] * z[0] + x[2] * z[3],
              w * z[3] - x[0] * z[0] - x[1] * z[1] - x[2] * z[2]]
    return [*turned, *y[4:7], y[7] + y[9] * time, y[8] + y[10] * time, *y[9:]]


def rotate(q, v, sign):
    """Return v turned by q (sign 1) or back (-1)."""
    u = [sign * part for part in q[:3]]
    t = [2 * (u[1] * v[2] - u[2] * v[1]), 2 * (u[2] * v[0] - u[0] * v[2]),
         2 * (u[0] * v[1] - u[1] * v[0])]
    return [v[0] + q[3] * t[0] + u[1] * t[2] - u[2] * t[1],
            v[1] + q[3] * t[1] + u[2] * t[0] - u[0] * t[2],
            v[2] + q[3] * t[2] + u[0] * t[1] - u[1] * t[0]]


def made(case):
    """Return the record of a case; its start is in doubles, the same for every reader."""
    numbers, q = [mpf(value) for value in case[:4]], [mpf(value) for value in case[4]]
    norm = sqrt(sum(value * value for value in q))
    q = [value / norm for value in q]
    start = [*q, *rotate(q, [mpf(value) for value in case[5]], 1), mpf(0), mpf(0),
             *[mpf(value) for value in case[6]]]
    begins, there = onset(numbers, start)
    states = []
    for fraction in FRACTIONS:
        time = mpf(float(begins * mpf(fraction)))
        y = sliding(numbers, start, time) if time < begins else rolling(there, time - begins)
        states.append({
            'time': float(time).hex(),
            'state': [nstr(value, 36) for value in [*y[:4], *rotate(y[:4], y[4:7], -1), *y[7:]]]})
    return {'radius': case[0], 'ratio': case[1], 'mu': case[2], 'g': case[3],
            'orientation': case[4], 'angular_velocity': case[5], 'velocity': case[6],
            'onset': nstr(begins, 36), 'states': states}


if __name__ == '__main__':
    records = {}
    for name, case in CASES.items():
        records[name] = made(case)
        print(name, records[name]['onset'], flush=True)
    OUT.write_text(json.dumps(records, indent=1) + '\n')
