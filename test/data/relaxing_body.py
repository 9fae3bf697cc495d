# SPDX-License-Identifier: Apache-2.0
"""High-precision reference for a body with a constant torque and linear drag: Taylor series.

    q' = q omega/2,     I omega' = N - D omega - omega x I omega

q attitude (x, y, z, w) and omega in body axes, which are principal; N constant in the body, D a
diagonal matrix. Nothing here knows of a closed form. A torque that is constant in the world is
given to a sphere as minus that in the body, on the inverse rotation. Numbers are those of mpmath
at its present precision.
"""

from mpmath import mp, mpf

ORDER = 45
REACH = 0.5     # of the angle that a step may turn over, rad


def _convolved(a, b, n):
    return mp.fdot(a[:n + 1], b[n::-1]) if n else a[0] * b[0]


def turned(q, omega, time, moments, torque=(0, 0, 0), drag=(0, 0, 0)):
    """Return (q, omega) after a time of either sign."""
    q, omega = [mpf(x) for x in q], [mpf(x) for x in omega]
    norm = mp.sqrt(mp.fsum(x * x for x in q))
    q = [x / norm for x in q]
    moments, drag = [mpf(x) for x in moments], [mpf(x) for x in drag]
    torque, left = [mpf(x) for x in torque], mpf(time)
    least = min(I for I in moments if I)
    while left:
        rate = mp.norm(omega) + max(
            c / I if I else mpf(0) for c, I in zip(drag, moments, strict=True)
        )
        rate += mp.sqrt(mp.norm(torque) / least)
        step = REACH / rate if rate else abs(left)
        step = min(step, abs(left)) * (1 if left > 0 else -1)
        qs, ws = _series(q, omega, moments, torque, drag)
        q = [mp.polyval(series[::-1], step) for series in qs]
        omega = [mp.polyval(series[::-1], step) for series in ws]
        left -= step
    return q, omega


def _series(q, omega, moments, torque, drag):
    qs, ws = [[x] for x in q], [[w] for w in omega]
    x, y, z, s = qs
    for n in range(ORDER):
        w1, w2, w3 = ws

        def of(a, b, n=n):
            return _convolved(a, b, n)
        turning = [of(s, w1) + of(y, w3) - of(z, w2), of(s, w2) + of(z, w1) - of(x, w3),
                   of(s, w3) + of(x, w2) - of(y, w1), -of(x, w1) - of(y, w2) - of(z, w3)]
        given = [N if n == 0 else mpf(0) for N in torque]
        I1, I2, I3 = moments
        pushes = [given[0] - drag[0] * w1[n] + (I2 - I3) * of(w2, w3),
                  given[1] - drag[1] * w2[n] + (I3 - I1) * of(w3, w1),
                  given[2] - drag[2] * w3[n] + (I1 - I2) * of(w1, w2)]
        for series, push, I in zip(ws, pushes, moments, strict=True):
            series.append(push / I / (n + 1) if I else mpf(0))
        for series, turn in zip(qs, turning, strict=True):
            series.append(turn / 2 / (n + 1))
    return qs, ws


def sphere_turned(q, omega, time, moment, couple):
    """Return (q, omega) of a sphere under a torque that is constant in the world.

    The inverse rotation p = 1/q has p' = -omega_world-in-reverse p/2: with the roles of body and
    world swapped it is that of a sphere turning with -omega_world, under minus the torque.
    """
    from high_precision_body import rotation_matrix
    q = [mpf(x) for x in q]
    norm = mp.sqrt(mp.fsum(x * x for x in q))
    q = [x / norm for x in q]
    world = rotation_matrix(q) * mp.matrix([mpf(w) for w in omega])
    p, rate = turned([-q[0], -q[1], -q[2], q[3]], [-w for w in world], time, [moment] * 3,
                     torque=[-mpf(T) for T in couple])
    q = [-p[0], -p[1], -p[2], p[3]]
    return q, list(rotation_matrix(q).T * mp.matrix([-w for w in rate]))


def flown(position, velocity, force, slowing, time):
    """Return place and velocity of a centre of mass; force and slowing over the mass."""
    t, r = mpf(time), mpf(slowing)
    with mp.workdps(3 * mp.dps + 320):    # r may be 1e-300
        if r:
            f1 = -mp.expm1(-r * t) / r
            f2 = (t - f1) / r
        else:
            f1, f2 = t, t * t / 2
        e = mp.exp(-r * t)
        place = [
            mpf(p) + mpf(v) * f1 + mpf(g) * f2
            for p, v, g in zip(position, velocity, force, strict=True)
        ]
        speed = [mpf(v) * e + mpf(g) * f1 for v, g in zip(velocity, force, strict=True)]
    return [+p for p in place], [+v for v in speed]
