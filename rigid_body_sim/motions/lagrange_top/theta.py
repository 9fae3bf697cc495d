"""Single-valued functions of a heavy symmetric top's motion: quotients of theta functions, evaluated by four terms at any modulus.

The Cayley-Klein parameters a, b and omega_c are elliptic functions of the second kind of time (F. Klein, A. Sommerfeld, Theorie des
Kreisels, chapter VI): a steady phase times one theta function of complex argument over one of real argument. Around u = u1, with v the phase
that grows by pi in a period of nutation and nome q,

    a ~ theta_1(v + i A)/theta_4(v),     b ~ theta_2(v + i B)/theta_4(v),     omega_c ~ theta_2(v + i C)/theta_4(v)

(DLMF chapter 20). The orientation, +1 or -1, says on which side of the real axis the zero lies; the shift A enters by X = exp(-2 A) with
q <= X <= 1, so that with z = exp(-2 i v) and the phase factor of the leading term taken out

    S(z) = 1 + X z + q^2/X z^-1 + q^2 X^2 z^2 + q^6/X^2 z^-2 + ...       (sign of X changed for theta_1)

*Circular* form: the root u3 lies apart, q <= exp(-pi). *Hyperbolic* form: the root u1 lies apart; Jacobi's imaginary transformation
(DLMF 20.7(viii)) makes v imaginary and A, B, C angles between 0 and pi/2, again with q <= exp(-pi). There time is cut into stretches about
the lowest and the highest position in turn, so that no term outgrows the leading one and what vanishes at a pole has all its digits.
"""


from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.numerics.exponential import decay
from rigid_body_sim.numerics.functions import cos, sin
from rigid_body_sim.numerics.phase import sin_cos

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
    s1, c1 = sin(angle), cos(angle)
    c2, s2 = (c1 - s1) * (c1 + s1), 2.0 * s1 * c1
    c4, s4 = (c2 - s2) * (c2 + s2), 2.0 * s2 * c2
    c3, s3, c5, s5 = c1 * c2 - s1 * s2, s1 * c2 + c1 * s2, c1 * c4 - s1 * s4, s1 * c4 + c1 * s4
    c6, s6, c7, s7 = c2 * c4 - s2 * s4, s2 * c4 + c2 * s4, c3 * c4 - s3 * s4, s3 * c4 + c3 * s4
    theta_4 = 1.0 - 2.0 * (q * c2 - form[NOME4] * c4 + form[NOME9] * c6)
    if sign < 0.0:      # odd about the lowest position: theta_1/theta_2; about the highest: theta_4/theta_3
        odd = even = modulus * theta_3(q) / theta_4
    else:               # about the lowest: theta_4/theta_2; about the highest: theta_1/theta_3; theta_2(0) = 2 q^(1/4) (1 + q^2 + ...)
        even = 2.0 * modulus * (1.0 + form[NOME2] + form[NOME6]) / theta_4
        odd = even * root_nome
    at, turned = 5 + BLOCK * place, orientation * odd
    form[at], form[at + 1], form[at + 2], form[at + 3] = odd * s1, -odd * s3, odd * s5, -odd * s7
    form[at + 4], form[at + 5], form[at + 6], form[at + 7] = turned * c1, -turned * c3, turned * c5, -turned * c7
    turned = orientation * even
    form[at + 8], form[at + 9], form[at + 10], form[at + 11] = even, -even * c2, even * c4, -even * c6
    form[at + 12], form[at + 13], form[at + 14] = turned * s2, -turned * s4, turned * s6


@compiled_inline
def hyperbolic(form, phase, highest):
    """Return real and imaginary part of a, b, omega_c without their phase factors.

    Parameters
    ----------
    phase : float
        From the lowest position, or from the highest one if `highest`, in size at most half the way between them.
    """
    q, q2, q4, q6, q9 = form[NOME], form[NOME2], form[NOME4], form[NOME6], form[NOME9]
    e = decay(abs(phase))
    e2 = e * e
    f = q / e2 if e2 > 0.0 else 0.0
    turn = 1.0 if phase >= 0.0 else -1.0
    # products of the nome's powers with 2 cosh, 2 sinh: of odd multiples of the phase (times exp(-|phase|)), and of even ones
    up1, up2, up3, down1, down2 = q * f, q4 * f * f, q9 * f * f * f, q2 * e2 * e2, q6 * e2 * e2 * e2
    ch0, ch1, ch2 = 1.0 + e2, up1 + down1, up2 + down2
    sh0, sh1, sh2, sh3 = turn * (1.0 - e2), turn * (up1 - down1), turn * (up2 - down2), turn * up3
    up4, up5, up6, down4, down5, down6 = f, q2 * f * f, q6 * f * f * f, q * e2, q4 * e2 * e2, q9 * e2 * e2 * e2
    ev1, ev2, ev3 = up4 + down4, up5 + down5, up6 + down6
    od1, od2, od3 = turn * (up4 - down4), turn * (up5 - down5), turn * (up6 - down6)
    odd, even = ch0 + ch1 + ch2 + up3, 1.0 + ev1 + ev2 + ev3
    # theta_1 of a about the lowest position, of b and omega_c about the highest; theta_4 otherwise
    for_a = 1.0 / (even if highest else odd)
    for_b = (1.0 if highest else e) / (even * e if highest else odd)
    ar, ai = _theta_1_or_4(form, 5, not highest, for_a, ch0, ch1, ch2, up3, sh0, sh1, sh2, sh3, ev1, ev2, ev3, od1, od2, od3)
    br, bi = _theta_1_or_4(form, 21, highest, for_b, ch0, ch1, ch2, up3, sh0, sh1, sh2, sh3, ev1, ev2, ev3, od1, od2, od3)
    wr, wi = _theta_1_or_4(form, 37, highest, for_b, ch0, ch1, ch2, up3, sh0, sh1, sh2, sh3, ev1, ev2, ev3, od1, od2, od3)
    return ar, ai, br, bi, wr, wi


@compiled_inline
def _theta_1_or_4(form, at, odd, scale, ch0, ch1, ch2, ch3, sh0, sh1, sh2, sh3, ev1, ev2, ev3, od1, od2, od3):
    """Return one function; its coefficients for theta_1 stand at `at`, those for theta_4 behind them."""
    a0, a1, a2, a3 = form[at], form[at + 1], form[at + 2], form[at + 3]
    b0, b1, b2, b3 = form[at + 4], form[at + 5], form[at + 6], form[at + 7]
    c0, c1, c2, c3 = form[at + 8], form[at + 9], form[at + 10], form[at + 11]
    d1, d2, d3 = form[at + 12], form[at + 13], form[at + 14]
    re = a0 * ch0 + a1 * ch1 + a2 * ch2 + a3 * ch3 if odd else c0 + c1 * ev1 + c2 * ev2 + c3 * ev3
    im = b0 * sh0 + b1 * sh1 + b2 * sh2 + b3 * sh3 if odd else d1 * od1 + d2 * od2 + d3 * od3
    return scale * re, scale * im
