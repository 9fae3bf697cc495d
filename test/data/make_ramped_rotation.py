# SPDX-License-Identifier: Apache-2.0
"""Make ramped_rotation.json: turns under the angular velocity (c + w t, p, 0), to 34 digits.

They are Taylor series in 80-digit arithmetic. Every step covers 20 rad of half-angle, so the terms
grow to e^20 before they shrink: 80 digits leave more than 60.

    python test/data/make_ramped_rotation.py
"""

import json
import pathlib

from mpmath import hypot, mp, mpf, nstr, sqrt

mp.dps = 80
HALF_ANGLE = 20
OUT = pathlib.Path(__file__).with_name('ramped_rotation.json')

# (c, p, w, time), doubles; in units of sqrt(w) the rim lies at c^2 + (pi/2) p^2 = 100
CASES = {
    'about one axis': (3.0, 0.0, 2.0, 5.0),
    'hardly out of the axis': (-3.0, 1e-12, 2.0, 5.0),
    'short': (4.0, 3.0, 100.0, 1e-6),
    'from rest along the ramp': (0.0, 1.0, 1.0, 9.0),
    'inside, through the middle': (-5.0, 2.0, 1.0, 9.0),
    'inside, back': (5.0, 2.0, 1.0, -9.0),
    'across the disc': (-30.0, 0.5, 1.0, 62.0),
    'across the disc, back': (31.0, 3.0, 1.0, -60.0),
    'past the disc': (-20.0, 9.0, 1.0, 41.0),
    'close past the disc': (-20.0, 8.0, 1.0, 41.0),
    'just inside': (-20.0, 7.9, 1.0, 41.0),
    'outside, on the rim': (10.1, 0.3, 1.0, 6.0),
    'outside, wide': (0.0, 8.1, 1.0, 3.0),
    'outside to inside': (-14.0, 1.0, 1.0, 10.0),
    'outside, long': (100.0, 40.0, 1.0, 60.0),
    'outside, long, back': (-40.0, 12.0, 1.0, -80.0),
    'slow ramp': (0.3, 0.4, 1e-7, 300.0),
    'hardly any ramp': (0.3, 0.4, 1e-300, 300.0),
    'billiard ball': (0.0, 80.0, 171.65354330708658, 0.58),
    'thousands of radians': (-3000.0, 50.0, 300.0, 12.0),
}


def turn(c, p, w, time):
    """Return the turn (x, y, z, w) as mpf."""
    c, p, w, time = mpf(c), mpf(p), mpf(w), mpf(time)
    total, remaining, direction = (
        [mpf(0), mpf(0), mpf(0), mpf(1)], abs(time), 1 if time > 0 else -1)
    while remaining > 0:
        speed = hypot(c, p)
        step = min(4 * HALF_ANGLE / (speed + sqrt(speed * speed + 4 * w * HALF_ANGLE)), remaining)
        remaining -= step
        step *= direction
        a, b, ramp = c * step / 2, p * step / 2, w * step * step / 2
        before, now, n = [mpf(0)] * 4, total, 0
        while n < 4 * HALF_ANGLE or sum(abs(value) for value in (*now, *before)) > mpf(10) ** -75:
            n += 1
            (x, y, z, s), (bx, by, bz, bs) = now, before
            before, now = now, [(a * s + b * z + ramp * bs) / n, (b * s - a * z - ramp * bz) / n,
                                (a * y - b * x + ramp * by) / n, (-a * x - b * y - ramp * bx) / n]
            total = [one + two for one, two in zip(total, now, strict=True)]
        c += w * step
    return total


if __name__ == '__main__':
    records = []
    for name, case in CASES.items():
        records.append({'name': name, 'case': [value.hex() for value in case],
                        'turn': [nstr(value, 36) for value in turn(*case)]})
        print(name, flush=True)
    OUT.write_text(json.dumps(records, indent=1) + '\n')
