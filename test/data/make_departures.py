# SPDX-License-Identifier: Apache-2.0
"""Make departures.json: free bodies with internal dissipation that leave an axis, with 30 digits.

    q' = q (omega + u)/2,    m' = m x (omega + u),    u = c m x omega,    m = I omega

By Gragg's method with Bulirsch and Stoer's extrapolation to order 18; nothing here is linear.
``python test/data/make_departures.py`` takes minutes.
"""

import json
import pathlib

from mpmath import mp, mpf

CASES = {
    'the smallest axis': ((1, 2, 3), 6, (2, 1e-9, 1e-9), 2.85, 400),
    'the middle axis': ((1, 2, 3), 2, (1e-12, 2, 1e-12), 3.0, 600),
    'the largest axis': ((1, 2, 2.5), 1, (1e-10, 1e-11, 3), 2.0, 200),
    'the smallest axis, softly': ((1, 2, 2.5), 0.1, (3, 1e-11, 2e-11), 9.0, 500),
    'no axis': ((1, 2, 3), 20, (2, 0.3, 0.1), 0.5, 400),
}
"""Name -> moments, coefficient, omega, duration (s), steps."""
COLUMNS = 9


def rates(I, c, y):
    """Return the rates of q and omega."""
    (x, b, z, s), w = y[:4], y[4:]
    m = [I[k] * w[k] for k in range(3)]

    def cross(a, b):
        return [a[k - 2] * b[k - 1] - a[k - 1] * b[k - 2] for k in range(3)]
    turn = [w[k] + c * part for k, part in enumerate(cross(m, w))]
    h = [part / 2 for part in turn]
    return [s * h[0] + b * h[2] - z * h[1], s * h[1] + z * h[0] - x * h[2],
            s * h[2] + x * h[1] - b * h[0], -(x * h[0] + b * h[1] + z * h[2]),
            *(part / I[k] for k, part in enumerate(cross(m, turn)))]


def moved(I, c, omega, time, steps):
    """Return q and omega after a time from q = 1."""
    I, c, size = [mpf(x) for x in I], mpf(c), mpf(time) / steps
    y = [mpf(0)] * 3 + [mpf(1)] + [mpf(x) for x in omega]
    for _ in range(steps):
        rows = []
        for j in range(1, COLUMNS + 1):
            h = size / (2 * j)
            before, here = y, [a + h * b for a, b in zip(y, rates(I, c, y), strict=True)]
            for _ in range(2 * j - 1):
                after = [a + 2 * h * b for a, b in zip(before, rates(I, c, here), strict=True)]
                before, here = here, after
            last = rates(I, c, here)
            row = [[(a + b + h * d) / 2 for a, b, d in zip(here, before, last, strict=True)]]
            for k in range(1, j):
                share = (mpf(j) / (j - k)) ** 2 - 1
                row.append([x + (x - p) / share
                            for x, p in zip(row[k - 1], rows[-1][k - 1], strict=True)])
            rows.append(row)
        y = rows[-1][-1]
    norm = mp.sqrt(mp.fsum(x * x for x in y[:4]))
    return [x / norm for x in y[:4]] + y[4:]


def main():
    """Write the file."""
    mp.dps, found = 30, {}
    for name, (I, c, omega, time, steps) in CASES.items():
        fine, coarse = moved(I, c, omega, time, steps), moved(I, c, omega, time, steps * 4 // 5)
        assert max(abs(a - b) for a, b in zip(fine, coarse, strict=True)) < 1e-20
        found[name] = {'moments': I, 'coefficient': c, 'angular_velocity': omega, 'time': time,
                       'orientation_after': [float(x) for x in fine[:4]],
                       'angular_velocity_after': [float(x) for x in fine[4:]]}
    text = json.dumps(found, indent=1) + '\n'
    pathlib.Path(__file__).with_name('departures.json').write_text(text)


if __name__ == '__main__':
    main()
