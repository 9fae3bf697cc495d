# SPDX-License-Identifier: Apache-2.0
"""Make language.json: two scenes that mix effects of the scene language, to 34 digits.

The laws are written here anew, in mpmath, from the tables of docs/reference/effects.md; nothing of
the package computes. Gragg's midpoint rule is extrapolated in steps of 1/40 s, and once more in
steps of 1/60 s, which gives the same 34 digits.

::

    PYTHONPATH=. python test/data/make_language.py
"""

import json
import pathlib

from mpmath import mp, mpf

mp.dps = 50
I = [mpf(0.05), mpf(0.08), mpf(0.11)]
M, C = mpf(1.3), [mpf(0.02), mpf(-0.03), mpf(0.1)]
START = [mpf(0.1), mpf(-0.4), mpf(0.2), mpf(0.888)]
COLUMNS = 18


def vector(*texts):
    return [mpf(float(text)) for text in texts]


def add(*vectors):
    return [mp.fsum(parts) for parts in zip(*vectors, strict=True)]


def times(a, v):
    return [a * part for part in v]


def minus(a, b):
    return add(a, times(-1, b))


def dot(a, b):
    return mp.fsum(x * y for x, y in zip(a, b, strict=True))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def turned(q, v, sign=1):
    u, w = times(sign, q[:3]), q[3]
    once = cross(u, v)
    return add(v, times(2 * w, once), times(2, cross(u, once)))


def attitude_rate(q, w):
    x, y, z, s = q
    a, b, c = times(mpf(1) / 2, w)
    return [s * a + y * c - z * b, s * b + z * a - x * c, s * c + x * b - y * a,
            -(x * a + y * b + z * c)]


def tensor(w):
    return [moment * part for moment, part in zip(I, w, strict=True)]


def over_tensor(m):
    return [part / moment for moment, part in zip(I, m, strict=True)]


def free(t, y):
    """Return the rates of a free body: q, omega, place and velocity of the centre of mass."""
    q, w, X, V = y[:4], y[4:7], y[7:10], y[10:13]
    force = vector(0, 0, '-9.81')
    force = times(M, force)
    point = minus(vector('0.1', 0, '0.3'), C)
    d = minus(add(X, turned(q, point)), vector(0, 0, 1))
    v = add(V, turned(q, cross(w, point)))
    length = mp.sqrt(dot(d, d))
    pull = add(times(-4 * (length - mpf(0.2)) / length, d),
               times(-mpf(0.1) * dot(d, v) / dot(d, d), d))
    force = add(force, pull, times(-mpf(0.1), V))
    torque = add(cross(point, turned(q, pull, -1)), times(-mpf(0.01), w),
                 [-mpf(0.1) * w[0] ** 3, mpf(0.02) * mp.sin(3 * t) * q[0],
                  mpf(0.01) * mp.tanh(turned(q, w)[2])])
    growth = over_tensor(minus(torque, cross(w, tensor(w))))
    return [*attitude_rate(q, w), *growth, *V, *times(1 / M, force)]


def carried(t, y):
    """Return the rates of a body on a moving pivot: q and omega."""
    q, w = y[:4], y[4:7]
    at = vector('0.1', '0.02', '-0.05')
    arm = minus(C, at)
    place = [mpf(0.3) * mp.sin(2 * t), mpf(0), mpf(0.05) * mp.cos(20 * t)]
    accelerated = [-4 * mpf(0.3) * mp.sin(2 * t), mpf(0), -400 * mpf(0.05) * mp.cos(20 * t)]
    force = times(M, minus(vector(1, 2, '-9.8'), accelerated))
    origin = minus(place, turned(q, at))
    moment = vector(0, '0.1', '0.5')
    in_world = turned(q, moment)
    field = [mpf(0.2), mpf(0.1) * origin[0], mpf(0.3)]
    drawn = [mpf(0.1) * in_world[1], mpf(0), mpf(0)]    # grad (m . B)
    h = times(mpf(0.1) / mp.sqrt(14), vector(1, 2, 3))
    torque = add(cross(arm, turned(q, force, -1)), cross(moment, turned(q, field, -1)),
                 cross(times(-1, at), turned(q, drawn, -1)), [-mpf(0.02) * w[0], mpf(0), mpf(0)],
                 times(-1, cross(w, h)))
    # I about the pivot: I w + M r x (w x r)
    rows = [add(tensor(e), times(M, cross(arm, cross(e, arm)))) for e in
            ([1, 0, 0], [0, 1, 0], [0, 0, 1])]
    spun = [dot(row, w) for row in rows]
    growth = mp.lu_solve(mp.matrix(rows), mp.matrix(minus(torque, cross(w, spun))))
    return [*attitude_rate(q, w), *growth]


def stepped(rates, t, y, step):
    """Return the unknowns a step later: the midpoint rule, extrapolated in the squared step."""
    rows = []
    for k in range(1, COLUMNS + 1):
        h = step / (2 * k)
        before, now = y, add(y, times(h, rates(t, y)))
        for i in range(1, 2 * k):
            before, now = now, add(before, times(2 * h, rates(t + i * h, now)))
        smooth = times(mpf(1) / 2, add(before, now, times(h, rates(t + step, now))))
        row = [smooth]
        for j in range(1, k):
            share = 1 / ((mpf(k) / (k - j)) ** 2 - 1)
            row.append(add(row[-1], times(share, minus(row[-1], rows[-1][j - 1]))))
        rows.append(row)
    return rows[-1][-1]


def run(rates, y, count):
    """Return the unknowns after a second in so many steps."""
    for k in range(count):
        y = stepped(rates, mpf(k) / count, y, mpf(1) / count)
    return y


def main():
    norm = mp.sqrt(dot(START, START))
    # the start is made of doubles, as the package makes it: q is normalised there
    q = [mpf(float(part / norm)) for part in START]
    w = vector(1, -2, 3)
    X, V = turned(q, C), turned(q, cross(w, C))
    found = {}
    for name, rates, start in (('mixed, free', free, [*q, *w, *X, *V]),
                               ('mixed, on a moving pivot', carried, [*q, *w])):
        coarse, fine = run(rates, start, 40), run(rates, start, 60)
        norm = mp.sqrt(dot(fine[:4], fine[:4]))
        error = max(abs(one - other) for one, other in zip(coarse, fine, strict=True))
        print(name, mp.nstr(error, 3), mp.nstr(norm - 1, 3))
        assert error < mpf('1e-34')
        found[name] = [mp.nstr(part, 34) for part in fine[:7]]
    pathlib.Path(__file__).with_name('language.json').write_text(json.dumps(found, indent=1)
                                                                 + '\n')


if __name__ == '__main__':
    main()
