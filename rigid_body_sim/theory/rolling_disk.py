# SPDX-License-Identifier: Apache-2.0
"""A disk or hoop that rolls without slip, and the end of one that is slowed by its contour.

Symbols: m mass (kg), R radius (m), A moment across the axis, C along it (kg m^2), theta from the
vertical to the axis (rad), s = phi' sin(theta) with phi' the precession, w3 the spin (rad/s), g
gravity (m/s^2).

Sources: P. Appell, Rend. Circ. Mat. Palermo 14 (1900) 1; D. J. Korteweg, ibid. 2; A. V. Borisov,
I. S. Mamaev, A. A. Kilin, Regul. Chaotic Dyn. 8 (2003) 201 (the constants); H. K. Moffatt, Nature
404 (2000) 833 (the end).
"""

import math


def legendre_constants(theta, s, w3, A, C, m, R):
    """Return (c1, c2) of w3 = c1 P_nu(cos theta) + c2 P_nu(-cos theta), rad/s.

    nu (nu + 1) = -kappa C/A with kappa = m R^2/(C + m R^2), and dw3/dtheta = kappa s.
    """
    import mpmath
    kappa = m * R * R / (C + m * R * R)
    nu = (mpmath.sqrt(1.0 - 4.0 * kappa * C / A) - 1.0) / 2.0
    x, slope = mpmath.cos(theta), -kappa * s / math.sin(theta)

    def legendre(nu, x):
        return mpmath.hyp2f1(-nu, nu + 1, 1, (1 - x) / 2)

    def derivative(x):
        return mpmath.re((nu + 1) * (x * legendre(nu, x) - legendre(nu + 1, x)) / (1 - x * x))

    p, q = mpmath.re(legendre(nu, x)), mpmath.re(legendre(nu, -x))
    dp, dq = derivative(x), -derivative(-x)
    determinant = p * dq - q * dp
    return float((w3 * dq - q * slope) / determinant), float((p * slope - w3 * dp) / determinant)


def speed_of_upright_stability(A, C, m, R, g):
    """Return the speed (m/s) above which a disk rolls upright stably: v^2 = g R/3, hoop g R/4.

    Linear in the tilt, upright rolling is stable if C (C + m R^2) w3^2 > A m g R.
    """
    return R * math.sqrt(A * m * g * R / (C * (C + m * R * R)))


def rate_of_upright_stability(A, m, R, g):
    """Return the rate (rad/s) above which a disk spins upright stably about the vertical.

    W^2 = 4 g/(5 R), hoop 2 g/(3 R). Linear in the tilt x = pi/2 - theta, rolling gives w3 =
    -kappa W x, and Appell's equation about the horizontal diameter becomes (A + m R^2) (x'' +
    W^2 x) = m g R x.
    """
    return math.sqrt(m * g * R / (A + m * R * R))


def precession_with_centre_at_rest(theta, A, m, R, g):
    """Return the precession (rad/s) at which the centre rests and w3 = 0.

    W^2 = m g R/(A sin(theta)); for a disk that lies almost flat 4 g/(R theta).
    """
    return math.sqrt(m * g * R / (A * math.sin(theta)))


def time_to_end_viscous(a, m, c):
    """Return the time (s) in which the inclination a (rad) falls to 0, 3 m a^2/(16 c).

    The force -c u (c in N s/m) acts against the velocity u of the point of contact.
    """
    return 3.0 * m * a * a / (16.0 * c)
