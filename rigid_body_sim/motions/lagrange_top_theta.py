"""Single-valued functions of a heavy symmetric top's motion: quotients of theta functions, evaluated by four terms at any modulus.

The Cayley-Klein parameters a, b and omega_c are elliptic functions of the second kind of time (F. Klein, A. Sommerfeld, Theorie des Kreisels,
chapter VI): constant phase rate times one theta function of complex argument over one of real argument. Around u = u1, with v the phase that
grows by pi in a period of nutation and nome q,

    a ~ theta_1(v + i A)/theta_4(v),     b ~ theta_2(v + i B)/theta_4(v),     omega_c ~ theta_2(v + i C)/theta_4(v)

(DLMF chapter 20). The orientation, +1 or -1, says on which side of the real axis the zero lies; the shift A enters by X = exp(-2 A) with
q <= X <= 1, so that with z = exp(-2 i v) and the phase factor of the leading term taken out

    S(z) = 1 + X z + q^2/X z^-1 + q^2 X^2 z^2 + q^6/X^2 z^-2 + ...       (sign of X changed for theta_1)

*Circular* form: the root u3 lies apart, q <= exp(-pi). *Hyperbolic* form: the root u1 lies apart; Jacobi's imaginary transformation
(DLMF 20.7(viii)) makes v imaginary and A, B, C angles between 0 and pi/2, again with q <= exp(-pi). There time is cut into stretches about
the lowest and the highest position in turn, so that no term outgrows the leading one and what vanishes at a pole has all its digits.
"""

import math

from rigid_body_sim.compiled import compiled, compiled_inline
from rigid_body_sim.turns import sin_cos

# layout of what a form takes beside its coefficients
NOME, NOME2, NOME4, NOME6, NOME9 = range(5)
BLOCK = 16                             # coefficients of one function
FORM_SIZE = 5 + 3 * BLOCK


@compiled
def set_nome(q, form):
    """Begin a form with its nome."""
    form[NOME], form[NOME2], form[NOME4], form[NOME6] = q, q * q, q * q * q * q, q * q * q * q * q * q
    form[NOME9] = form[NOME4] * form[NOME4] * q


@compiled
def theta_3(q):
    """Return theta_3(0) = 1 + 2 q + 2 q^4 + 2 q^9 + ...; theta_4(0) is theta_3 of -q."""
    q3 = q * q * q
    return 1.0 + 2.0 * q * (1.0 + q3 * (1.0 + q3 * q * q))


@compiled
def set_circular(form, place, X, sign, orientation, modulus):
    """Set one function of a circular form and return how fast the phase of its periodic part grows per growth of 2v, where |S| is largest.

    Parameters
    ----------
    place : int
        0 for a, 1 for b, 2 for omega_c.
    sign : float
        -1.0 for theta_1 (zero near u1), 1.0 for theta_2 (zero near u2).
    modulus : float
        Of the function where |S| is largest: at u2 for sign -1, at u1 for sign +1.
    """
    q = form[NOME]
    Y = min(q / X, 1.0) if X > 0.0 else 0.0
    p1, p2, p3 = X, form[NOME2] * X * X, form[NOME6] * X * X * X
    m1, m2, m3 = q * Y, form[NOME4] * Y * Y, form[NOME9] * Y * Y * Y
    total = 1.0 + (p1 + m1) + (p2 + m2) + (p3 + m3)
    scale = modulus * theta_3(-sign * q) / total
    at = 5 + BLOCK * place
    form[at], form[at + 1], form[at + 2], form[at + 3] = scale, sign * scale * (p1 + m1), scale * (p2 + m2), sign * scale * (p3 + m3)
    turned = -orientation * scale
    form[at + 4], form[at + 5], form[at + 6] = sign * turned * (p1 - m1), turned * (p2 - m2), sign * turned * (p3 - m3)
    return orientation * ((p1 - m1) + 2.0 * (p2 - m2) + 3.0 * (p3 - m3)) / total


@compiled_inline
def circular(form, turns, low):
    """Return cos 2v, sin 2v and real and imaginary part of a, b, omega_c without their phase factors; 2v is given in turns."""
    s1, c1 = sin_cos(turns, low)
    c2, s2 = 1.0 - 2.0 * s1 * s1, 2.0 * s1 * c1
    c3, s3 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2
    theta = 1.0 / (1.0 - 2.0 * (form[NOME] * c1 - form[NOME4] * c2 + form[NOME9] * c3))
    return (c1, s1,
            theta * (form[5] + form[6] * c1 + form[7] * c2 + form[8] * c3), theta * (form[9] * s1 + form[10] * s2 + form[11] * s3),
            theta * (form[21] + form[22] * c1 + form[23] * c2 + form[24] * c3), theta * (form[25] * s1 + form[26] * s2 + form[27] * s3),
            theta * (form[37] + form[38] * c1 + form[39] * c2 + form[40] * c3), theta * (form[41] * s1 + form[42] * s2 + form[43] * s3))


@compiled
def set_hyperbolic(form, place, angle, sign, orientation, modulus, root_nome):
    """Set one function of a hyperbolic form.

    Parameters
    ----------
    angle : float
        A, B or C, 0 to pi/2; place, sign and modulus as for the circular form.
    root_nome : float
        Square root of the nome, which may be far above an underflowing nome.
    """
    q = form[NOME]
    s1, c1 = math.sin(angle), math.cos(angle)
    c2, s2 = (c1 - s1) * (c1 + s1), 2.0 * s1 * c1
    c4, s4 = (c2 - s2) * (c2 + s2), 2.0 * s2 * c2
    c3, s3, c5, s5 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2, c1 * c4 - s1 * s4, s1 * c4 + c1 * s4
    c6, s6, c7, s7 = c2 * c4 - s2 * s4, s2 * c4 + c2 * s4, c3 * c4 - s3 * s4, s3 * c4 + c3 * s4
    theta_4 = 1.0 - 2.0 * (q * c2 - form[NOME4] * c4 + form[NOME9] * c6)
    at = 5 + BLOCK * place
    if sign < 0.0:      # odd about the lowest position: theta_1/theta_2; about the highest: theta_4/theta_3
        odd_at, even_at = at, at + 8
        odd = even = modulus * theta_3(q) / theta_4
    else:               # about the lowest: theta_4/theta_2; about the highest: theta_1/theta_3; theta_2(0) = 2 q^(1/4) (1 + q^2 + ...)
        odd_at, even_at = at + 8, at
        even = 2.0 * modulus * (1.0 + form[NOME2] + form[NOME6]) / theta_4
        odd = even * root_nome
    turned = orientation * odd
    form[odd_at], form[odd_at + 1], form[odd_at + 2], form[odd_at + 3] = odd * s1, -odd * s3, odd * s5, -odd * s7
    form[odd_at + 4], form[odd_at + 5], form[odd_at + 6], form[odd_at + 7] = turned * c1, -turned * c3, turned * c5, -turned * c7
    turned = orientation * even
    form[even_at], form[even_at + 1], form[even_at + 2], form[even_at + 3] = even, -even * c2, even * c4, -even * c6
    form[even_at + 4], form[even_at + 5], form[even_at + 6], form[even_at + 7] = 0.0, turned * s2, -turned * s4, turned * s6


@compiled_inline
def hyperbolic(form, phase, highest):
    """Return real and imaginary part of a, b, omega_c without their phase factors.

    Parameters
    ----------
    phase : float
        From the lowest position, or from the highest one if `highest`, in size at most half the way between them.
    """
    q, q2, q4, q6, q9 = form[NOME], form[NOME2], form[NOME4], form[NOME6], form[NOME9]
    loss = math.expm1(-abs(phase))
    e = 1.0 + loss
    e2 = e * e
    f = q / e2 if e2 > 0.0 else 0.0
    turn = 1.0 if phase >= 0.0 else -1.0
    # products of the nome's powers with 2 cosh, 2 sinh: of odd multiples of the phase (times exp(-|phase|)), and of even ones
    up1, up2, up3, down1, down2 = q * f, q4 * f * f, q9 * f * f * f, q2 * e2 * e2, q6 * e2 * e2 * e2
    ch0, ch1, ch2 = 1.0 + e2, up1 + down1, up2 + down2
    sh0, sh1, sh2, sh3 = -turn * loss * (1.0 + e), turn * (up1 - down1), turn * (up2 - down2), turn * up3
    up4, up5, up6, down4, down5, down6 = f, q2 * f * f, q6 * f * f * f, q * e2, q4 * e2 * e2, q9 * e2 * e2 * e2
    ev1, ev2, ev3 = up4 + down4, up5 + down5, up6 + down6
    od1, od2, od3 = turn * (up4 - down4), turn * (up5 - down5), turn * (up6 - down6)
    if highest:
        even = 1.0 / (1.0 + ev1 + ev2 + ev3)
        odd = even / e
        return (even * (form[13] + form[14] * ev1 + form[15] * ev2 + form[16] * ev3),
                even * (form[18] * od1 + form[19] * od2 + form[20] * od3),
                odd * (form[29] * ch0 + form[30] * ch1 + form[31] * ch2 + form[32] * up3),
                odd * (form[33] * sh0 + form[34] * sh1 + form[35] * sh2 + form[36] * sh3),
                odd * (form[45] * ch0 + form[46] * ch1 + form[47] * ch2 + form[48] * up3),
                odd * (form[49] * sh0 + form[50] * sh1 + form[51] * sh2 + form[52] * sh3))
    odd = 1.0 / (ch0 + ch1 + ch2 + up3)
    even = odd * e
    return (odd * (form[5] * ch0 + form[6] * ch1 + form[7] * ch2 + form[8] * up3),
            odd * (form[9] * sh0 + form[10] * sh1 + form[11] * sh2 + form[12] * sh3),
            even * (form[21] + form[22] * ev1 + form[23] * ev2 + form[24] * ev3),
            even * (form[26] * od1 + form[27] * od2 + form[28] * od3),
            even * (form[37] + form[38] * ev1 + form[39] * ev2 + form[40] * ev3),
            even * (form[42] * od1 + form[43] * od2 + form[44] * od3))
