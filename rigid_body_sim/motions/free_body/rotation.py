"""Torque-free rotation in closed form, by theta functions (Jacobi 1849).

Frame: axis 3 is the polar axis, that of the largest or the smallest moment, about which omega never turns back; axis 2 is that of the middle
moment, axis 1 the remaining one; signs such that omega_3 >= 0, and omega_1 >= 0 at the start. With u growing at the rate p,

    omega = (A1 cn u, A2 sn u, A3 dn u),        modulus k, quarter period K.

The attitude is C Z S: S takes the angular momentum m, |m| = L, to axis 3 by the shortest way, S = (m x e3, L + m3) up to its norm, which is
never singular as m3 >= 0; Z turns by chi about axis 3; C is constant. With E the energy, chi' = (2 E + L omega_3)/(L + m3), and the half angle
is the argument of one theta function of nome q^2, where q = exp(-pi K'/K):

    exp(i chi/2) = exp(i Omega t/2) theta_4(v + i s a | q^2) / |theta_4|,      v = pi u/(2K),      s = -1 if I3 is the largest moment, else 1,
    sc(2 K a/pi, k') = sqrt(I1 |I3 - I2| / (I3 |I2 - I1|)),                    0 <= 2a <= -log q.

The real part of that theta function is positive: the sign of the quaternion is continuous by itself, and no angle is ever formed. Nothing
divides by the smallest moment, so needles and rods are bodies like others. For k' < 0.17 the same functions are written in the complementary
nome q' = exp(-pi K/K') (Jacobi's imaginary transformation), with hyperbolic functions of y = v K/K'; the separatrix k' = 0 is then nothing
special. At most five terms give round-off in either form.

Sources: Whittaker, Analytical Dynamics, section 69; R. van Zon and J. Schofield, J. Comput. Phys. 225 (2007) 145 (which has the full angle);
NIST DLMF chapters 20 and 22.
"""

import math

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.elliptic import complete_k, nome
from rigid_body_sim.numerics.exponential import decay
from rigid_body_sim.numerics.phase import nearest, phase, sin_cos

KC_HYPERBOLIC = 0.17            # below it the complementary nome is the smaller one

# layout: form, time of the start, rates (turns per second, pairs) of v and of half of Omega, v at the start, I1..I3 over L, A1..A3 times theta
# constants, s, then the coefficients of either form
FORM, START, RATE, HALF, PHASE, UNIT, AMPLITUDES, SIDE, COEFFICIENTS = 0, 1, 2, 4, 6, 7, 10, 13, 14
SIZE = COEFFICIENTS + 16
CIRCULAR, HYPERBOLIC, STEADY = 0.0, 1.0, 2.0    # steady: omega does not move in the body
# circular: of cos 2nv in theta_1/sin and theta_2/cos (n = 0..4), in theta_3 and theta_4 (1..4); cosine and sine part of the half angle (1..3)
FIRST, THIRD, COSINES, SINES = (COEFFICIENTS + k for k in (0, 5, 9, 12))
# hyperbolic: q', its square root and q'^4.5, pi K/K', a K/(pi K'), cosine and sine of the multiples 1, 3, 5, 7 of a K/(2K')
NOME, ROOT, POWER, PERIOD, DRIFT, COS_ANGLE, SIN_ANGLE = (COEFFICIENTS + k for k in (0, 1, 2, 3, 4, 5, 9))


@compiled
def fill_circular(c, A1, A2, A3, k2, kc, quarter, shift):
    """Fill the series of nome q and return the rate (over that of v) at which the argument of the half angle's theta function grows at v = 0.

    quarter is K, shift is K' - 2 K a/pi; k2 = 0 (a symmetric body) is allowed.
    """
    q = nome(math.sqrt(k2), kc)
    q2 = q * q
    q4 = q2 * q2
    q8 = q4 * q4
    q6, q9, q12, q16, q20 = q2 * q4, q8 * q, q8 * q4, q8 * q8, q8 * q8 * q4
    c[FIRST], c[FIRST + 1], c[FIRST + 2] = 1.0 - q2 + q6 - q12 + q20, 2.0 * (q6 - q2 - q12 + q20), 2.0 * (q6 - q12 + q20)
    c[FIRST + 3], c[FIRST + 4] = 2.0 * (q20 - q12), 2.0 * q20
    c[THIRD], c[THIRD + 1], c[THIRD + 2], c[THIRD + 3] = 2.0 * q, 2.0 * q4, 2.0 * q9, 2.0 * q16
    zero2 = 1.0 + q2 + q6 + q12 + q20
    zero3, zero4 = 1.0 + 2.0 * (q + q4 + q9 + q16), 1.0 - 2.0 * (q - q4 + q9 - q16)
    c[AMPLITUDES], c[AMPLITUDES + 1], c[AMPLITUDES + 2] = A1 * zero4 / zero2, A2 * zero3 / zero2, A3 * zero4 / zero3
    # terms 2 Q^(n^2) cosh 2na and sinh 2na of nome Q = q^2, by up = q e^(2a) <= 1 and down = q e^(-2a)
    up = decay(math.pi * shift / quarter) if q > 0.0 else 0.0
    down = q * (q / max(up, q)) if q > 0.0 else 0.0
    up2, down2, q15 = up * up, down * down, q6 * q9
    up3, down3 = q15 * up2 * up, q15 * down2 * down
    up, down, up2, down2 = q * up, q * down, q6 * up2, q6 * down2
    c[COSINES], c[COSINES + 1], c[COSINES + 2] = -(up + down), up2 + down2, -(up3 + down3)
    s = c[SIDE]
    c[SINES], c[SINES + 1], c[SINES + 2] = s * (up - down), -s * (up2 - down2), s * (up3 - down3)
    return (2.0 * c[SINES] + 4.0 * c[SINES + 1] + 6.0 * c[SINES + 2]) / (1.0 + c[COSINES] + c[COSINES + 1] + c[COSINES + 2])


@compiled_inline
def circular_series(c, v, v_low):
    """Return omega_1, omega_2, omega_3, and real and imaginary part of the half angle's theta function, at the phase v (turns)."""
    s, c0 = sin_cos(v, v_low)
    c1, s1 = (c0 - s) * (c0 + s), 2.0 * s * c0
    c2 = 2.0 * c1 * c1 - 1.0
    c3 = c1 * (2.0 * c2 - 1.0)
    c4 = 2.0 * c2 * c2 - 1.0
    even, odd = c[FIRST] + c[FIRST + 2] * c2 + c[FIRST + 4] * c4, c[FIRST + 1] * c1 + c[FIRST + 3] * c3
    even3, odd3 = 1.0 + c[THIRD + 1] * c2 + c[THIRD + 3] * c4, c[THIRD] * c1 + c[THIRD + 2] * c3
    scale = 1.0 / (even3 - odd3)
    return (c[AMPLITUDES] * c0 * (even - odd) * scale,
            c[AMPLITUDES + 1] * s * (even + odd) * scale,
            c[AMPLITUDES + 2] * (even3 + odd3) * scale,
            1.0 + c[COSINES] * c1 + c[COSINES + 1] * c2 + c[COSINES + 2] * c3,
            s1 * (c[SINES] + 2.0 * c[SINES + 1] * c1 + c[SINES + 2] * (2.0 * c2 + 1.0)))


@compiled
def fill_hyperbolic(c, A1, A2, A3, k, kc, period, shift):
    """Fill the series of the complementary nome q'; return the rate (over that of y) at which the half angle's argument grows at y = 0.

    period is pi K/K'. On the separatrix (kc = 0) it is any number so large that the motion never gets there.
    """
    root = kc * math.sqrt(0.5 / (1.0 + k)) / (1.0 + math.sqrt(k))
    x = root * root
    root *= 1.0 + x * x * x * x                     # sqrt(q'): as in nome(), but q' itself may underflow
    q = root * root
    q2 = q * q
    c[NOME], c[ROOT], c[POWER], c[PERIOD] = q, root, q2 * q2 * root, period
    zero2, zero3, zero4 = 2.0 * (1.0 + q2 + q2 * q2 * q2), 1.0 + 2.0 * (q + q2 * q2), 1.0 - 2.0 * (q - q2 * q2)
    c[AMPLITUDES], c[AMPLITUDES + 1], c[AMPLITUDES + 2] = A1 * zero2 / zero4, A2 * zero3 / zero4, A3 * zero2 / zero3
    turns = 0.125 * (1.0 - shift / complete_k(k))   # a K/(2K')
    c[DRIFT] = c[SIDE] * 4.0 * turns
    sine, cosine = sin_cos(turns, 0.0)
    twice = 2.0 * (cosine - sine) * (cosine + sine)
    s, c0 = c[SIDE] * sine, cosine
    s_before, c_before = -s, c0
    for n in range(4):
        c[COS_ANGLE + n], c[SIN_ANGLE + n] = c0, s
        c0, c_before = twice * c0 - c_before, c0
        s, s_before = twice * s - s_before, s
    return ((0.5 * c[SIN_ANGLE] + q * (1.5 * c[SIN_ANGLE + 1] + q2 * 2.5 * c[SIN_ANGLE + 2]))
            / (c[COS_ANGLE] + q * (c[COS_ANGLE + 1] + q2 * c[COS_ANGLE + 2])))


@compiled_inline
def hyperbolic_series(c, v, v_low):
    """Return what :func:`circular_series` returns, and the part of the half angle (turns) that goes along with v between two half turns."""
    half_turns = nearest(2.0 * v)
    x = (v - 0.5 * half_turns) + v_low
    sign = 1.0 - 2.0 * abs(half_turns - 2.0 * nearest(0.5 * half_turns))
    e = decay(2.0 * c[PERIOD] * abs(x))             # e^-|y|
    q, root = c[NOME], c[ROOT]
    g = root / max(e, root, 5e-324)                 # sqrt(q') e^|y| <= 1; 0 on the separatrix
    e2, f, qq = e * e, g * g, q * q
    # theta functions of iy times 2 e^-|y|, and that of the half angle times 2 e^(-|y|/2)
    ends, middle = qq * (e2 * e2 + qq * f * f), q * f
    scale = 1.0 / (1.0 + e2 + middle + ends)
    theta1 = 1.0 - e2 - middle + ends
    even, odd = 1.0 + qq * (f * f + qq * e2 * e2), f + q * e2
    side = 1.0 if x >= 0.0 else -1.0
    near, far, near2, far2, last = root * g, q * e2, qq * f, qq * q * e2 * e, c[POWER] * g * f
    return (c[AMPLITUDES] * sign * e * (even - odd) * scale,
            c[AMPLITUDES + 1] * sign * side * theta1 * scale,
            c[AMPLITUDES + 2] * e * (even + odd) * scale,
            c[COS_ANGLE] * (1.0 + e) + c[COS_ANGLE + 1] * (near + far) + c[COS_ANGLE + 2] * (near2 + far2) + c[COS_ANGLE + 3] * last,
            side * (c[SIN_ANGLE] * (1.0 - e) + c[SIN_ANGLE + 1] * (near - far) + c[SIN_ANGLE + 2] * (near2 - far2) + c[SIN_ANGLE + 3] * last),
            -c[DRIFT] * x)


@compiled_inline
def circular(c, dt, dt_low):
    """Return omega and the quaternion of Z S, not normalised, in the frame above, dt (a pair) after the start: circular form."""
    half, half_low = phase(c[HALF], c[HALF + 1], dt, dt_low)
    v, v_low = phase(c[RATE], c[RATE + 1], dt, dt_low)
    v, low = two_sum(v, c[PHASE])
    w1, w2, w3, re, im = circular_series(c, v, v_low + low)
    return _joined(c, w1, w2, w3, re, im, half, half_low)


@compiled_inline
def hyperbolic(c, dt, dt_low):
    """Return what :func:`circular` returns: hyperbolic form."""
    half, half_low = phase(c[HALF], c[HALF + 1], dt, dt_low)
    v, v_low = phase(c[RATE], c[RATE + 1], dt, dt_low)
    v, low = two_sum(v, c[PHASE])
    w1, w2, w3, re, im, along = hyperbolic_series(c, v, v_low + low)
    half, low = two_sum(half, along)
    return _joined(c, w1, w2, w3, re, im, half, half_low + low)


@compiled_inline
def steady(c, dt, dt_low):
    """Return what :func:`circular` returns: omega constant."""
    half, half_low = phase(c[HALF], c[HALF + 1], dt, dt_low)
    return _joined(c, c[AMPLITUDES], c[AMPLITUDES + 1], c[AMPLITUDES + 2], 1.0, 0.0, half, half_low)


@compiled_inline
def _joined(c, w1, w2, w3, re, im, half, half_low):
    sine, cosine = sin_cos(half, half_low)
    re, im = cosine * re - sine * im, cosine * im + sine * re
    m1, m2, up = c[UNIT] * w1, c[UNIT + 1] * w2, 1.0 + c[UNIT + 2] * w3
    return w1, w2, w3, re * m2 + im * m1, im * m2 - re * m1, im * up, re * up


@compiled
def turned(c, dt, dt_low):
    """Return what :func:`circular` returns, by the form that the motion has."""
    if c[FORM] == CIRCULAR:
        return circular(c, dt, dt_low)
    if c[FORM] == HYPERBOLIC:
        return hyperbolic(c, dt, dt_low)
    return steady(c, dt, dt_low)
