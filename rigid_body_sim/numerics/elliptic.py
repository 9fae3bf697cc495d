# SPDX-License-Identifier: Apache-2.0
"""Elliptic integrals and functions, to round-off also near modulus or parameter 0 and 1.

Names follow the NIST Digital Library of Mathematical Functions (DLMF), chapters 19, 20 and 22. No
function takes a modulus k alone: near k = 1 it needs the complementary modulus k', which the
caller forms without cancellation (scipy.special.ellipj, which takes k^2, is wrong by 5e-6 at
k'^2 = 1e-10).
"""

import math

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.numerics.double_double import add, add_alike, multiply, root
from rigid_body_sim.numerics.functions import cos, exp, log, sin


@compiled_inline
def _duplicated(x, y, z):
    root_x, root_y, root_z = math.sqrt(x), math.sqrt(y), math.sqrt(z)
    shift = root_x * (root_y + root_z) + root_y * root_z
    return 0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift)


@compiled_inline
def _spread(x, y, z):
    mean = (x + y + z) / 3.0
    return mean, max(abs(mean - x), abs(mean - y), abs(mean - z)) > 0.01 * mean


@compiled_inline
def _rf_series(x, y, mean):
    dx, dy = 1.0 - x / mean, 1.0 - y / mean
    dz = -dx - dy
    e2 = dx * dy - dz * dz
    e3 = dx * dy * dz
    series = (e2 * (-1 / 10 + e2 * (1 / 24 - 5 / 208 * e2) + e3 * (-3 / 44 + 1 / 16 * e2))
              + e3 * (1 / 14 + 3 / 104 * e3))
    return (1.0 + series) / math.sqrt(mean)


@compiled
def carlson_rf(x, y, z):
    """Return Carlson's R_F(x, y, z), the symmetric integral of the first kind (DLMF 19.16.1).

    The arguments are not negative, and at most one of them is 0. Duplication (DLMF 19.26.18) is
    repeated until they agree to 1 %; then the series of DLMF 19.36.1 follows to its seventh order.
    """
    mean, apart = _spread(x, y, z)
    while apart:
        x, y, z = _duplicated(x, y, z)
        mean, apart = _spread(x, y, z)
    return _rf_series(x, y, mean)


@compiled
def carlson_rf_pair(x, y, z, u, v, w):
    """Return R_F(x, y, z) and R_F(u, v, w) together, in little more than the time of one."""
    mean, apart = _spread(x, y, z)
    other_mean, other_apart = _spread(u, v, w)
    while apart or other_apart:
        x, y, z = _duplicated(x, y, z)
        u, v, w = _duplicated(u, v, w)
        mean, apart = _spread(x, y, z)
        other_mean, other_apart = _spread(u, v, w)
    return _rf_series(x, y, mean), _rf_series(u, v, other_mean)


@compiled
def carlson_rc(x, y):
    """Return Carlson's R_C(x, y) = R_F(x, y, y) (DLMF 19.2.17) for x >= 0, y > 0.

    It stands for atan where x < y and for artanh where x > y, and is smooth at x = y.
    """
    mean = (x + y + y) / 3.0
    while abs(y - mean) > 0.01 * mean:
        shift = 2.0 * math.sqrt(x) * math.sqrt(y) + y
        x, y = 0.25 * (x + shift), 0.25 * (y + shift)
        mean = (x + y + y) / 3.0
    s = (y - mean) / mean
    series = s * s * (3 / 10 + s * (1 / 7 + s * (3 / 8 + s * (
        9 / 22 + s * (159 / 208 + 9 / 8 * s)))))
    return (1.0 + series) / math.sqrt(mean)


@compiled_inline
def _rj_series(x, y, z, mean):
    """Return R_J times mean^(3/2) for arguments that are close to their mean."""
    dx, dy, dz = 1.0 - x / mean, 1.0 - y / mean, 1.0 - z / mean
    dp = -0.5 * (dx + dy + dz)
    e2 = dx * dy + dx * dz + dy * dz - 3.0 * dp * dp
    e3 = dx * dy * dz + 2.0 * e2 * dp + 4.0 * dp * dp * dp
    e4 = (2.0 * dx * dy * dz + e2 * dp + 3.0 * dp * dp * dp) * dp
    e5 = dx * dy * dz * dp * dp
    series = (-3 / 14 * e2 + e3 / 6 + 9 / 88 * e2 * e2 - 3 / 22 * e4 - 9 / 52 * e2 * e3
              + 3 / 26 * e5 - e2 * e2 * e2 / 16 + 3 / 40 * e3 * e3
              + 3 / 20 * e2 * e4 + 45 / 272 * e2 * e2 * e3 - 9 / 68 * (e3 * e4 + e2 * e5))
    return 1.0 + series


@compiled
def carlson_rj(x, y, z, p):
    """Return Carlson's R_J(x, y, z, p), the integral of the third kind (DLMF 19.16.2).

    x, y and z are not negative, at most one of them is 0, and p > 0. Duplication uses R_C in the
    form of DLMF 19.26.21, whose terms are all positive and free of cancellation; then the series
    of DLMF 19.36.2 follows. R_D(x, y, z), the integral of the second kind, is R_J(x, y, z, z).
    """
    mean = (x + y + z + p + p) / 5.0
    total, factor = 0.0, 1.0
    while max(abs(mean - x), abs(mean - y), abs(mean - z), abs(mean - p)) > 0.01 * mean:
        root_x, root_y, root_z = math.sqrt(x), math.sqrt(y), math.sqrt(z)
        shift = root_x * (root_y + root_z) + root_y * root_z
        alpha = p * (root_x + root_y + root_z) + root_x * root_y * root_z
        total += factor * carlson_rc(alpha * alpha, p * (p + shift) * (p + shift))
        x, y, z, p = (0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift),
                      0.25 * (p + shift))
        mean = (x + y + z + p + p) / 5.0
        factor *= 0.25
    return factor * _rj_series(x, y, z, mean) / (mean * math.sqrt(mean)) + 3.0 * total


@compiled
def agm(x, y):
    """Return the arithmetic-geometric mean of x > 0 and y >= 0 (DLMF 19.8.1)."""
    if y == 0.0:
        return 0.0
    while abs(x - y) > 2e-8 * x:
        x, y = 0.5 * (x + y), math.sqrt(x) * math.sqrt(y)
    return 0.5 * (x + y)


@compiled
def complete_k(kc):
    """Return the quarter period K for the complementary modulus kc = k' > 0 (DLMF 19.8.5).

    The quarter period K' is complete_k(k).
    """
    return 0.5 * math.pi / agm(1.0, kc)


@compiled
def nome(k, kc):
    """Return q = exp(-pi K'/K) (DLMF 22.2.1) for 0 <= k and kc >= 0.17 (q <= 0.21).

    The result has full relative accuracy. The function takes both moduli because k^2 + kc^2 = 1
    gives more digits to the smaller one. For kc < 0.17 use the nome of the complementary modulus,
    nome(kc, k) = exp(-pi K/K'). The series is DLMF 19.5.5 with the integers of OEIS A002103.
    """
    s = 1.0 + math.sqrt(kc)
    half = 0.5 * k * k / ((1.0 + kc) * s * s)
    x = half * half * half * half
    return half * (1.0 + x * (2.0 + x * (15.0 + x * (150.0 + x * (1707.0 + x * (20910.0 + x * (
        268616.0 + x * (3567400.0 + x * (48555069.0 + x * 673458874.0)))))))))


@compiled
def agm_pair(x, x_low, y, y_low):
    """Return the arithmetic-geometric mean of two pairs of doubles, x >= y > 0, to 1e-19.

    Pairs are those of double_double.py. Two steps of the mean bring the modulus to the one with
    nome q^4; the mean then differs from its first argument by a factor 1/theta_3(q^4)^2
    (DLMF 20.9.2).
    """
    while y < 0.7 * x:
        product, product_low = multiply(x, x_low, y, y_low)
        x, x_low = add_alike(x, x_low, y, y_low)
        x, x_low = 0.5 * x, 0.5 * x_low
        y, y_low = root(product, product_low)
    q = nome(math.sqrt(max((x - y) * (x + y), 0.0)) / x, y / x)
    q4 = q * q * q * q
    excess = 2.0 * q4 * (1.0 + q4 * q4 * q4)                    # theta_3 - 1
    rest = excess * (2.0 + excess) / ((1.0 + excess) * (1.0 + excess))
    product, product_low = multiply(x, x_low, y, y_low)
    product, product_low = root(product, product_low)
    x, x_low = add_alike(x, x_low, y, y_low)
    x, x_low = add_alike(0.5 * x, 0.5 * x_low, product, product_low)
    x, x_low = add(x, x_low, -rest * x, 0.0)
    return 0.5 * x, 0.5 * x_low


@compiled
def jacobi(u, k, kc):
    """Return sn, cn and dn of u for moduli k and kc (k^2 + kc^2 = 1; kc = 0 is allowed).

    They come from theta functions: of the nome for kc >= 0.17, otherwise of the complementary nome
    with hyperbolic functions (Jacobi's imaginary transformation, DLMF 22.2.4-6, 22.6(iv)), so that
    a few terms give round-off everywhere. u is reduced modulo 2 K in double precision.
    """
    if kc >= 0.17:
        return _jacobi_circular(u, k, kc)
    return _jacobi_hyperbolic(u, k, kc)


@compiled
def _jacobi_circular(u, k, kc):
    q = nome(k, kc)
    v = 0.5 * math.pi * u / complete_k(kc)
    s, c = sin(v), cos(v)
    q2 = q * q
    q4 = q2 * q2
    q6, q9, q12, q16, q20 = (q2 * q4, q4 * q4 * q, q4 * q4 * q4, q4 * q4 * q4 * q4,
                             q4 * q4 * q4 * q4 * q4)
    c1 = (c - s) * (c + s)
    c2 = 2.0 * c1 * c1 - 1.0
    c3 = c1 * (2.0 * c2 - 1.0)
    c4 = 2.0 * c2 * c2 - 1.0
    # theta_1/sin and theta_2/cos without their common factor; even and odd parts of theta_3 and
    # theta_4
    d1 = 1.0 + 2.0 * c1
    d2 = d1 + 2.0 * c2
    d3 = d2 + 2.0 * c3
    d4 = d3 + 2.0 * c4
    b1 = 2.0 * c1 - 1.0
    b2 = 2.0 * c2 - b1
    b3 = 2.0 * c3 - b2
    b4 = 2.0 * c4 - b3
    theta1 = s * (1.0 - q2 * d1 + q6 * d2 - q12 * d3 + q20 * d4)
    theta2 = c * (1.0 + q2 * b1 + q6 * b2 + q12 * b3 + q20 * b4)
    even = 1.0 + 2.0 * q4 * c2 + 2.0 * q16 * c4
    odd = 2.0 * q * c1 + 2.0 * q9 * c3
    zero2 = 1.0 + q2 + q6 + q12 + q20
    zero_even, zero_odd = 1.0 + 2.0 * q4 + 2.0 * q16, 2.0 * q + 2.0 * q9
    theta4 = even - odd
    return (theta1 * (zero_even + zero_odd) / (zero2 * theta4),
            theta2 * (zero_even - zero_odd) / (zero2 * theta4),
            (even + odd) * (zero_even - zero_odd) / ((zero_even + zero_odd) * theta4))


@compiled
def _jacobi_hyperbolic(u, k, kc):
    quarter = complete_k(k)                                     # K', near pi/2
    root_q = kc * math.sqrt(0.5 / (1.0 + k)) / (1.0 + math.sqrt(k))
    q = root_q * root_q
    root_q *= 1.0 + q * q * q * q            # sqrt(q'), far above q' where that underflows
    q = root_q * root_q
    y = 0.5 * math.pi * u / quarter
    sign = 1.0
    if kc > 0.0:
        period = -2.0 * log(root_q)                         # pi K / K'
        turns = math.floor(y / period + 0.5)
        y -= turns * period
        sign = 1.0 - 2.0 * (turns - 2.0 * math.floor(0.5 * turns))
    x = exp(-abs(y))
    e = x * x
    f = root_q / x if x > 0.0 else 0.0                          # sqrt(q') e^|y| <= 1
    f *= f
    theta2 = 1.0 + e + q * (f + q * e * e) + q * q * q * q * f * f
    theta1 = math.copysign(1.0 - e - q * (f - q * e * e) + q * q * q * q * f * f, y)
    even = 1.0 + q * q * (f * f + q * q * e * e)
    odd = f + q * e
    zero3, zero4 = 1.0 + 2.0 * q + 2.0 * q * q * q * q, 1.0 - 2.0 * q + 2.0 * q * q * q * q
    scale = 2.0 * x * (1.0 + q * q)
    return (sign * theta1 * zero3 / (zero4 * theta2),
            sign * scale * (even - odd) / (zero4 * theta2),
            scale * (even + odd) / (zero3 * theta2))


@compiled
def root_nome(k, kc):
    """Return the square root of the nome for k <= kc, also where the nome itself underflows.

    The result has full relative accuracy.
    """
    s = 1.0 + math.sqrt(kc)
    half = 0.5 * k * k / ((1.0 + kc) * s * s)
    x = half * half * half * half
    return k * math.sqrt(0.5 / (1.0 + kc) * (1.0 + x * (2.0 + x * (15.0 + x * 150.0)))) / s
