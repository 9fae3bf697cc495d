# SPDX-License-Identifier: Apache-2.0
"""References with 30 digits of bodies that roll on a plane, by their reduced closed forms.

::

    python test/data/make_convex_body.py

Rolling disk and hoop (P. Appell, D. J. Korteweg, 1900; A. V. Borisov, I. S. Mamaev, A. A. Kilin,
Regul. Chaotic Dyn. 8 (2003) 201): with theta from the vertical to the axis, A and C the moments
across and along it, s = phi' sin(theta) and w3 the spin,

    dw3/dtheta = kappa s,  kappa = m R^2/(C + m R^2),
    w3 = c1 P_nu(cos theta) + c2 P_nu(-cos theta),  nu (nu + 1) = -kappa C/A,
    2 E = (A + m R^2) theta'^2 + A s^2 + (C + m R^2) w3^2 + 2 m g R sin(theta),

and the time from one turning point of theta to the other is one quadrature.

Routh's sphere: a ball of radius R whose centre of mass lies l below its middle. Jellett's integral
J and Routh's w3 sqrt(I1 I3 + m r . I r) give s and w3 as functions of theta, E gives theta'.
"""

import json
import pathlib

import mpmath as mp

mp.mp.dps = 45        # a share of the digits goes where theta' vanishes
POINTS = 48, 64
G = mp.mpf('9.81')


def disk(A, C, m, R, theta0, s0, w0):
    """Return half a period and the other turning point of a disk that starts at theta' = 0."""
    A, C, m, R, theta0, s0, w0 = map(mp.mpf, (A, C, m, R, theta0, s0, w0))
    kappa = m * R * R / (C + m * R * R)
    nu = (-1 + mp.sqrt(1 - 4 * kappa * C / A)) / 2

    def legendre(nu, x):
        return mp.hyp2f1(-nu, nu + 1, 1, (1 - x) / 2)

    def both(x):
        return mp.re(legendre(nu, x)), mp.re(legendre(nu, -x))

    def slopes(x):
        # (1 - x^2) P' = (nu + 1)(x P_nu - P_{nu + 1})
        def one(x):
            return mp.re((nu + 1) * (x * legendre(nu, x) - legendre(nu + 1, x))
                         / (1 - x * x))
        return one(x), -one(-x)

    x0 = mp.cos(theta0)
    (p, q), (dp, dq) = both(x0), slopes(x0)
    slope = -kappa * s0 / mp.sin(theta0)    # dw3/dx
    det = p * dq - q * dp
    c1, c2 = (w0 * dq - q * slope) / det, (p * slope - w0 * dp) / det

    def fall(theta):
        """Return (A + m R^2) theta'^2."""
        x = mp.cos(theta)
        (p, q), (dp, dq) = both(x), slopes(x)
        w3, s = c1 * p + c2 * q, -mp.sin(theta) * (c1 * dp + c2 * dq) / kappa
        return energy - A * s * s - (C + m * R * R) * w3 * w3 - 2 * m * G * R * mp.sin(theta)

    energy = A * s0 * s0 + (C + m * R * R) * w0 * w0 + 2 * m * G * R * mp.sin(theta0)
    return _half_period(fall, A + m * R * R, theta0)


def routh_sphere(I1, I3, m, R, offset, theta0, s0, w0):
    """Return half a period and the other turning point of a Routh sphere from theta' = 0."""
    I1, I3, m, R, l, theta0, s0, w0 = map(mp.mpf, (I1, I3, m, R, offset, theta0, s0, w0))
    # r = -R n + l e3 in the plane of n and e3: across the axis -R sin, along it l - R cos

    def jellett(theta, s, w3):
        return -I1 * s * R * mp.sin(theta) + I3 * w3 * (l - R * mp.cos(theta))

    def root(theta):
        return mp.sqrt(I1 * I3 + m * (I1 * (R * mp.sin(theta)) ** 2
                                      + I3 * (l - R * mp.cos(theta)) ** 2))

    J, D = jellett(theta0, s0, w0), w0 * root(theta0)

    def fall(theta):
        w3 = D / root(theta)
        s = (I3 * w3 * (l - R * mp.cos(theta)) - J) / (I1 * R * mp.sin(theta))
        return energy - 2 * level(theta, s, w3)

    def level(theta, s, w3):
        """Return the energy without theta'."""
        v = -s * (l - R * mp.cos(theta)) - w3 * R * mp.sin(theta)
        return (I1 * s * s + I3 * w3 * w3 + m * v * v) / 2 + m * G * (R - l * mp.cos(theta))

    energy = 2 * level(theta0, s0, w0)

    def inertia(theta):
        return I1 + m * (R * R + l * l - 2 * R * l * mp.cos(theta))

    return _half_period(fall, inertia, theta0)


def _half_period(fall, inertia, theta0):
    """Return (half a period, the other turning point) of inertia theta'^2 = fall(theta)."""
    step = mp.mpf('0.02')
    sign = 1 if fall(theta0 + step / 1000) > 0 else -1
    a = theta0 + sign * step
    while fall(a + sign * step) > 0:
        a += sign * step
    theta1 = mp.findroot(fall, (a, a + sign * step), tol=1e-70)
    middle, width = (theta0 + theta1) / 2, abs(theta1 - theta0) / 2

    def share(u):
        theta = middle + width * mp.sin(u)
        size = inertia(theta) if callable(inertia) else inertia
        return width * mp.cos(u) * mp.sqrt(size / fall(theta))

    # as a function of u the integrand has the period 2 pi: the midpoint rule converges
    # exponentially
    coarse, fine = (mp.pi / n * mp.fsum(share(mp.pi * (k + mp.mpf(1) / 2) / n - mp.pi / 2)
                                        for k in range(n)) for n in POINTS)
    assert abs(coarse / fine - 1) < mp.mpf('1e-22'), (coarse, fine)
    return fine, theta1


CASES = {
    'disk': (disk, ('0.25', '0.5', '1', '1', '1.2', '0.5', '2.5')),
    'hoop': (disk, ('0.5', '1', '1', '1', '1.3', '0.2', '2.5')),
    'routh_sphere': (routh_sphere, ('0.4', '0.3', '1', '1', '-0.1', '0.8', '1.5', '6')),
}


def main():
    """Write convex_body.json."""
    found = {}
    for name, (make, numbers) in CASES.items():
        half, theta = make(*numbers)
        found[name] = {'numbers': [float(x) for x in numbers], 'half_period': mp.nstr(half, 30),
                       'theta': mp.nstr(theta, 30)}
        print(name, found[name])
    path = pathlib.Path(__file__).with_name('convex_body.json')
    path.write_text(json.dumps(found, indent=1) + '\n')


if __name__ == '__main__':
    main()
