# SPDX-License-Identifier: Apache-2.0
"""Single-valued functions of a heavy symmetric top's motion: quotients of theta functions.

The Cayley-Klein parameters a, b and omega_c are elliptic functions of the second kind of time
(F. Klein, A. Sommerfeld, Theorie des Kreisels, chapter VI): a phase that grows steadily times one
theta function of complex argument over one of real argument. Four terms are enough at any modulus.
About u = u1, with v the phase that grows by pi in a period of nutation, and q the nome,

    a ~ theta_1(v + i A)/theta_4(v),
    b ~ theta_2(v + i B)/theta_4(v),     omega_c ~ theta_2(v + i C)/theta_4(v)

(DLMF chapter 20). The orientation, +1 or -1, says on which side of the real axis the zero lies.
The shift A enters by X = exp(-2 A) with q <= X <= 1, so that with z = exp(-2 i v) and the phase
factor of the leading term taken out

    S(z) = 1 + X z + q^2/X z^-1 + q^2 X^2 z^2 + q^6/X^2 z^-2 + ...       (theta_1: -X for X)

*Circular* form: the root u3 lies apart, and q <= exp(-pi). *Hyperbolic* form: the root u1 lies
apart; Jacobi's imaginary transformation (DLMF 20.7(viii)) makes v imaginary and A, B, C angles
between 0 and pi/2, again with q <= exp(-pi). There time is cut into stretches about the lowest and
the highest position in turn, so that no term outgrows the leading one, and what vanishes at a pole
keeps all its digits.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, Vector
from rigid_body_sim.numerics.exponential import decay
from rigid_body_sim.numerics.functions import cos, sin
from rigid_body_sim.numerics.phase import sin_cos

Four = tuple[float, float, float, float]
THETA_1, THETA_2 = -1.0, 1.0    # kinds of functions: zero near u1, zero near u2


class Klein(NamedTuple):
    """Cayley-Klein parameters and omega_c (rad/s): complex numbers as (real, imaginary)."""

    a: Pair
    b: Pair
    omega: Pair


class Powers(NamedTuple):
    """The nome q and its powers."""

    q: float
    q2: float
    q4: float
    q6: float
    q9: float


class CircularTerms(NamedTuple):
    """Coefficients of one function of the circular form."""

    re: Four      # coefficients of 1, cos 2v, cos 4v, cos 6v
    im: Vector    # coefficients of sin 2v, sin 4v, sin 6v


class HyperbolicTerms(NamedTuple):
    """Coefficients of one function of the hyperbolic form, y the phase of a stretch."""

    odd_re: Four       # where it is theta_1 or theta_2: of cosh y, cosh 3y, cosh 5y, cosh 7y
    odd_im: Four       # of sinh y, sinh 3y, sinh 5y, sinh 7y
    even_re: Four      # where it is theta_3 or theta_4: of 1, cosh 2y, cosh 4y, cosh 6y
    even_im: Vector    # of sinh 2y, sinh 4y, sinh 6y


class CircularSeries(NamedTuple):
    """The circular form of a, b and omega_c."""

    powers: Powers
    a: CircularTerms
    b: CircularTerms
    omega: CircularTerms


class HyperbolicSeries(NamedTuple):
    """The hyperbolic form of a, b and omega_c."""

    powers: Powers
    a: HyperbolicTerms
    b: HyperbolicTerms
    omega: HyperbolicTerms


class Waves(NamedTuple):
    """Hyperbolic functions of multiples of y times powers of the nome, as coefficients want them.

    Those of odd multiples have the factor exp(-|y|) besides.
    """

    cosh_odd: Four
    sinh_odd: Four
    cosh_even: Vector
    sinh_even: Vector


@compiled
def powers_of(q):
    """Return the Powers of a nome."""
    q4 = q * q * q * q
    return Powers(q, q * q, q4, q * q * q * q * q * q, q4 * q4 * q)


@compiled
def theta_3(q):
    """Return theta_3(0) = 1 + 2 q + 2 q^4 + 2 q^9 + ...; theta_4(0) is theta_3 of -q."""
    q3 = q * q * q
    return 1.0 + 2.0 * q * (1.0 + q3 * (1.0 + q3 * q * q))


@compiled
def circular_terms(powers, X, kind, orientation, modulus):
    """Compute one function of the circular form.

    Parameters
    ----------
    kind : float
        THETA_1 or THETA_2.
    modulus : float
        Of the function where |S| is largest: at u2 for THETA_1, at u1 for THETA_2.

    Returns
    -------
    terms : CircularTerms
    slope : float
        Minus the rate of the phase of the periodic part over that of 2v, where |S| is largest.
    """
    q = powers.q
    Y = min(q / X, 1.0) if X > 0.0 else 0.0
    p1, p2, p3 = X, powers.q2 * X * X, powers.q6 * X * X * X
    m1, m2, m3 = q * Y, powers.q4 * Y * Y, powers.q9 * Y * Y * Y
    total = 1.0 + (p1 + m1) + (p2 + m2) + (p3 + m3)
    scale = modulus * theta_3(-kind * q) / total
    turned = -orientation * scale
    re = scale, kind * scale * (p1 + m1), scale * (p2 + m2), kind * scale * (p3 + m3)
    im = kind * turned * (p1 - m1), turned * (p2 - m2), kind * turned * (p3 - m3)
    slope = orientation * ((p1 - m1) + 2.0 * (p2 - m2) + 3.0 * (p3 - m3)) / total
    return CircularTerms(re, im), slope


@compiled_inline
def circular(series, v):
    """Return (cos 2v, sin 2v) and the Klein without its phase factors; 2v is a pair of turns."""
    s1, c1 = sin_cos(*v)
    c2, s2 = 1.0 - 2.0 * s1 * s1, 2.0 * s1 * c1
    c3, s3 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2
    cosines, sines, powers = (c1, c2, c3), (s1, s2, s3), series.powers
    theta = 1.0 / (1.0 - 2.0 * (powers.q * c1 - powers.q4 * c2 + powers.q9 * c3))
    return (c1, s1), Klein(_sum(series.a, theta, cosines, sines),
                           _sum(series.b, theta, cosines, sines),
                           _sum(series.omega, theta, cosines, sines))


@compiled_inline
def _sum(terms, theta, cosines, sines):
    """Return one function of the circular form, divided by theta_4."""
    c1, c2, c3 = cosines
    s1, s2, s3 = sines
    a0, a1, a2, a3 = terms.re
    b1, b2, b3 = terms.im
    return (theta * (a0 + a1 * c1 + a2 * c2 + a3 * c3), theta * (b1 * s1 + b2 * s2 + b3 * s3))


@compiled
def hyperbolic_terms(powers, angle, kind, orientation, modulus, root_nome):
    """Return one function of the hyperbolic form, as HyperbolicTerms.

    Parameters
    ----------
    angle : float
        A, B or C, 0 to pi/2; kind and modulus as for the circular form.
    root_nome : float
        Square root of the nome, which may be far above an underflowing nome.
    """
    q = powers.q
    s1, c1 = sin(angle), cos(angle)
    c2, s2 = (c1 - s1) * (c1 + s1), 2.0 * s1 * c1
    c4, s4 = (c2 - s2) * (c2 + s2), 2.0 * s2 * c2
    c3, s3, c5, s5 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2, c1 * c4 - s1 * s4, s1 * c4 + c1 * s4
    c6, s6, c7, s7 = c2 * c4 - s2 * s4, s2 * c4 + c2 * s4, c3 * c4 - s3 * s4, s3 * c4 + c3 * s4
    theta_4 = 1.0 - 2.0 * (q * c2 - powers.q4 * c4 + powers.q9 * c6)
    if kind == THETA_1:    # theta_1/theta_2 about the lowest position, theta_4/theta_3 the highest
        odd = even = modulus * theta_3(q) / theta_4
    else:                  # theta_4/theta_2 about the lowest position, theta_1/theta_3 the highest
        # theta_2(0) = 2 q^(1/4) (1 + q^2 + ...)
        even = 2.0 * modulus * (1.0 + powers.q2 + powers.q6) / theta_4
        odd = even * root_nome
    turned_odd, turned_even = orientation * odd, orientation * even
    return HyperbolicTerms(
        (odd * s1, -odd * s3, odd * s5, -odd * s7),
        (turned_odd * c1, -turned_odd * c3, turned_odd * c5, -turned_odd * c7),
        (even, -even * c2, even * c4, -even * c6),
        (turned_even * s2, -turned_even * s4, turned_even * s6))


@compiled_inline
def hyperbolic(series, y, highest):
    """Return the Klein without its phase factors.

    Parameters
    ----------
    y : float
        Phase from the lowest position, or from the highest one if `highest`; in size at most half
        of the way between them.
    """
    q, q2, q4, q6, q9 = series.powers
    e = decay(abs(y))
    e2 = e * e
    f = q / e2 if e2 > 0.0 else 0.0
    turn = 1.0 if y >= 0.0 else -1.0
    up1, up2, up3 = q * f, q4 * f * f, q9 * f * f * f
    down1, down2 = q2 * e2 * e2, q6 * e2 * e2 * e2
    cosh_odd = 1.0 + e2, up1 + down1, up2 + down2, up3
    sinh_odd = turn * (1.0 - e2), turn * (up1 - down1), turn * (up2 - down2), turn * up3
    up4, up5, up6 = f, q2 * f * f, q6 * f * f * f
    down4, down5, down6 = q * e2, q4 * e2 * e2, q9 * e2 * e2 * e2
    cosh_even = up4 + down4, up5 + down5, up6 + down6
    sinh_even = turn * (up4 - down4), turn * (up5 - down5), turn * (up6 - down6)
    waves = Waves(cosh_odd, sinh_odd, cosh_even, sinh_even)
    odd = cosh_odd[0] + cosh_odd[1] + cosh_odd[2] + cosh_odd[3]
    even = 1.0 + cosh_even[0] + cosh_even[1] + cosh_even[2]
    # about the lowest position a has odd terms and the others even ones, reversed at the highest
    for_a = 1.0 / (even if highest else odd)
    for_b = (1.0 if highest else e) / (even * e if highest else odd)
    return Klein(_odd_or_even(series.a, not highest, for_a, waves),
                 _odd_or_even(series.b, highest, for_b, waves),
                 _odd_or_even(series.omega, highest, for_b, waves))


@compiled_inline
def _odd_or_even(terms, odd, scale, waves):
    """Return one function of the hyperbolic form, by its odd or its even terms."""
    a0, a1, a2, a3 = terms.odd_re
    b0, b1, b2, b3 = terms.odd_im
    c0, c1, c2, c3 = terms.even_re
    d1, d2, d3 = terms.even_im
    ch0, ch1, ch2, ch3 = waves.cosh_odd
    sh0, sh1, sh2, sh3 = waves.sinh_odd
    ev1, ev2, ev3 = waves.cosh_even
    od1, od2, od3 = waves.sinh_even
    re = a0 * ch0 + a1 * ch1 + a2 * ch2 + a3 * ch3 if odd else c0 + c1 * ev1 + c2 * ev2 + c3 * ev3
    im = b0 * sh0 + b1 * sh1 + b2 * sh2 + b3 * sh3 if odd else d1 * od1 + d2 * od2 + d3 * od3
    return scale * re, scale * im
