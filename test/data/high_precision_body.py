# SPDX-License-Identifier: Apache-2.0
"""The free rigid body with any number of digits, in two ways.

The number is mpmath's, and neither way shares code with the package. `closed_form` is the textbook
solution: Jacobi's functions for omega, Euler angles z-x-z about L and Legendre's incomplete
integral of the third kind for the precession (Whittaker, Analytical Dynamics, section 69).
`taylor` integrates Euler's equations and the quaternion by power series.
"""

import mpmath as mp


def rotation_matrix(q):
    """Return the 3 x 3 matrix of a quaternion (x, y, z, w), which need not be normalised."""
    x, y, z, w = q
    n = x * x + y * y + z * z + w * w
    return mp.matrix([
        [(w * w + x * x - y * y - z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n],
        [2 * (x * y + w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z - w * x) / n],
        [2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, (w * w - x * x - y * y + z * z) / n]])


def quaternion(R):
    """Return the quaternion (x, y, z, w) of a rotation matrix, by its largest component."""
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    squares = [
        1 + 2 * R[0, 0] - trace, 1 + 2 * R[1, 1] - trace, 1 + 2 * R[2, 2] - trace, 1 + trace]
    largest = max(range(4), key=lambda k: squares[k])
    rows = [[squares[0], R[0, 1] + R[1, 0], R[0, 2] + R[2, 0], R[2, 1] - R[1, 2]],
            [R[0, 1] + R[1, 0], squares[1], R[1, 2] + R[2, 1], R[0, 2] - R[2, 0]],
            [R[0, 2] + R[2, 0], R[1, 2] + R[2, 1], squares[2], R[1, 0] - R[0, 1]],
            [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1], squares[3]]]
    scale = 2 * mp.sqrt(squares[largest])
    return [entry / scale for entry in rows[largest]]


def _about_x(angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix([[1, 0, 0], [0, c, -s], [0, s, c]])


def _about_z(angle):
    c, s = mp.cos(angle), mp.sin(angle)
    return mp.matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def _tilt(m, L):
    """Return Rx(theta) Rz(phi) of the frame in which the angular momentum has components m."""
    return _about_x(mp.atan2(mp.hypot(m[0], m[1]), m[2])) * _about_z(mp.atan2(m[0], m[1]))


def closed_form(moments, q, omega, t):
    """Return (quaternion, omega) after the time t; the principal axes are the body's own axes."""
    moments, omega, t = [mp.mpf(x) for x in moments], [mp.mpf(x) for x in omega], mp.mpf(t)
    R = rotation_matrix([mp.mpf(x) for x in q])
    m = [I * w for I, w in zip(moments, omega)]
    across = [m[1] * omega[2] - m[2] * omega[1], m[2] * omega[0] - m[0] * omega[2],
              m[0] * omega[1] - m[1] * omega[0]]
    if not any(across):
        return quaternion(R * _spin(omega, t)), omega
    small, middle, large = sorted(range(3), key=lambda k: moments[k])
    other, polar = ((small, large) if _gap(moments, omega, small, middle, large) >= 0
                    else (large, small))
    P = mp.zeros(3)
    sign = -1 if omega[polar] < 0 else 1
    P[other, 0], P[polar, 2] = 1, sign
    P[middle, 1] = sign if (middle - other) % 3 == 1 else -sign
    I = [moments[other], moments[middle], moments[polar]]
    turned = P.T * mp.matrix(omega)
    psi, after = _in_polar_frame(I, list(turned), t)
    before = [I[k] * turned[k] for k in range(3)]
    L = mp.sqrt(sum(x * x for x in before))
    later = [I[k] * after[k] for k in range(3)]
    frame = R * P * _tilt(before, L).T * _about_z(psi) * _tilt(later, L)
    return quaternion(frame * P.T), list(P * mp.matrix(after))


def _spin(omega, t):
    size = mp.sqrt(sum(w * w for w in omega))
    if size == 0:
        return mp.eye(3)
    s = mp.sin(size * t / 2) / size
    return rotation_matrix([omega[0] * s, omega[1] * s, omega[2] * s, mp.cos(size * t / 2)])


def flip_time(moments, omega, count):
    """Return the time of the count-th (1, 2, ...) sign change of omega along the middle axis.

    It is infinite if there are not so many.
    """
    moments, omega = [mp.mpf(x) for x in moments], [mp.mpf(x) for x in omega]
    small, middle, large = sorted(range(3), key=lambda k: moments[k])
    other, polar = ((small, large) if _gap(moments, omega, small, middle, large) >= 0
                    else (large, small))
    (I1, w1), (I2, w2), (I3, w3) = ((moments[k], omega[k]) for k in (other, middle, polar))
    A3 = mp.sqrt(w3 * w3 + (I2 * (I2 - I1) / (I3 * (I3 - I1)) * w2 * w2))
    A2 = mp.sqrt(w2 * w2 + I1 * (I1 - I3) / (I2 * (I2 - I3)) * w1 * w1)
    rate = mp.sqrt((I1 - I3) * (I2 - I3) / (I1 * I2)) * A3
    kc2 = abs(_gap(moments, omega, small, middle, large) * (I3 - I1) / (I1 * I2 * I3)) / rate ** 2
    # |omega_2| grows if e2 omega_3 omega_1 omega_2 > 0
    grows = ((I3 - I1) * (w3 * w1 if (other, middle, polar) in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
                          else -w3 * w1) * w2 > 0)
    if kc2 == 0:
        return mp.atanh(abs(w2) / A2) / rate if count == 1 and not grows else mp.inf
    k2 = 1 - kc2
    since = mp.ellipf(mp.asin(abs(w2) / A2), k2)       # of a zero of sn
    return ((2 * mp.ellipk(k2) * (count if grows else count - 1) + (-since if grows else since))
            / rate)


def _gap(moments, omega, small, middle, large):
    return (moments[large] * (moments[large] - moments[middle]) * omega[large] ** 2
            - moments[small] * (moments[middle] - moments[small]) * omega[small] ** 2)


def _in_polar_frame(I, omega, t):
    """Return (angle about L, omega) after t in a frame of its own.

    Its third axis is the polar axis, its second one the middle axis.
    """
    I1, I2, I3 = I
    w1, w2, w3 = omega
    L = mp.sqrt((I1 * w1) ** 2 + (I2 * w2) ** 2 + (I3 * w3) ** 2)
    A1 = mp.sqrt(w1 * w1 + I2 * (I2 - I3) / (I1 * (I1 - I3)) * w2 * w2)
    A2 = mp.sqrt(w2 * w2 + I1 * (I1 - I3) / (I2 * (I2 - I3)) * w1 * w1)
    A3 = mp.sqrt(w3 * w3 + (I2 * (I2 - I1) / (I3 * (I3 - I1)) * w2 * w2))
    rate = mp.sqrt((I1 - I3) * (I2 - I3) / (I1 * I2)) * A3
    if I3 < I2:
        # w1' = (I2 - I3)/I1 w2 w3 with w1 = A1 cn, w2 = A2 sn, w3 = A3 dn, all of a growing
        # argument
        A2 = -A2
    phi0 = mp.atan2(w2 / A2, w1 / A1)
    n = 1 - (I2 * A2 / (I1 * A1)) ** 2
    along = L / I1 * t
    if I1 == I2:
        phi = phi0 + rate * t
        return along, [A1 * mp.cos(phi), A2 * mp.sin(phi), w3]
    gap = (I3 * (I3 - I2) * w3 * w3 - I1 * (I2 - I1) * w1 * w1) * (I3 - I1)
    kc2 = gap / (I1 * I2 * I3) / rate ** 2
    if kc2 == 0:
        u0 = mp.atanh(w2 / A2)
        u = u0 + rate * t
        sn, cn, dn = mp.tanh(u), mp.sech(u), mp.sech(u)
        rise = _third_kind_on_separatrix(n, u) - _third_kind_on_separatrix(n, u0)
    else:
        k2 = 1 - kc2
        K, third = mp.ellipk(k2), mp.ellippi(n, k2)
        u = mp.ellipf(phi0, k2) + rate * t
        turns = mp.nint(u / (2 * K))
        rest = u - 2 * K * turns
        sn, cn, dn = (mp.ellipfun(name, rest, m=k2) for name in ('sn', 'cn', 'dn'))
        phi = mp.atan2(sn, cn)
        if turns % 2:
            sn, cn = -sn, -cn
        rise = mp.ellippi(n, phi, k2) + 2 * turns * third - mp.ellippi(n, phi0, k2)
    # integral of sn^2/(1 - n sn^2) is (Pi - u)/n
    along += L * (1 / I2 - 1 / I1) * (1 - n) * (rise / rate - t) / n
    return along, [A1 * cn, A2 * sn, A3 * dn]


def _third_kind_on_separatrix(n, u):
    """Return the integral of du / (1 - n tanh^2 u)."""
    root = mp.sqrt(mp.mpc(n))
    return mp.re((u - root * mp.atanh(root * mp.tanh(u))) / (1 - n))


def taylor(moments, q, omega, t, order=40):
    """Return (quaternion, omega) after t by power series, for up to some hundred radians."""
    I = [mp.mpf(x) for x in moments]
    ratios = [(I[(k + 1) % 3] - I[(k + 2) % 3]) / I[k] if I[k] else mp.mpf(0) for k in range(3)]
    w, q, t = [mp.mpf(x) for x in omega], [mp.mpf(x) for x in q], mp.mpf(t)
    size = mp.sqrt(sum(x * x for x in w))
    steps = max(1, int(mp.ceil(abs(size * t) * 3)))
    h = t / steps
    for _ in range(steps):
        W, Q = [[x] for x in w], [[x] for x in q]
        for n in range(order):
            def product(a, b, n=n):
                return sum(a[k] * b[n - k] for k in range(n + 1))
            rates = [r * product(W[(k + 1) % 3], W[(k + 2) % 3]) for k, r in enumerate(ratios)]
            turns = [product(Q[3], W[0]) + product(Q[1], W[2]) - product(Q[2], W[1]),
                     product(Q[3], W[1]) + product(Q[2], W[0]) - product(Q[0], W[2]),
                     product(Q[3], W[2]) + product(Q[0], W[1]) - product(Q[1], W[0]),
                     -product(Q[0], W[0]) - product(Q[1], W[1]) - product(Q[2], W[2])]
            for series, rate in zip(W + Q, rates + [x / 2 for x in turns]):
                series.append(rate / (n + 1))
        w = [mp.polyval(series[::-1], h) for series in W]
        q = [mp.polyval(series[::-1], h) for series in Q]
    return q, w


def angle(p, q):
    """Return the angle (rad) of the rotation from one attitude to the other."""
    x = p[3] * q[0] - p[0] * q[3] - p[1] * q[2] + p[2] * q[1]
    y = p[3] * q[1] - p[1] * q[3] - p[2] * q[0] + p[0] * q[2]
    z = p[3] * q[2] - p[2] * q[3] - p[0] * q[1] + p[1] * q[0]
    w = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]
    return 2 * mp.atan2(mp.sqrt(x * x + y * y + z * z), abs(w))
