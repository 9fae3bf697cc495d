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

from rigid_body_sim.compiled import compiled
from rigid_body_sim.elliptic import carlson_rf, complete_k, nome
from rigid_body_sim.turns import nearest, sin_cos

KC_HYPERBOLIC = 0.17            # below it the complementary nome is the smaller one

# layout of the series: A1..A3 times theta constants, s, then the coefficients of either form
AMPLITUDES, SIDE, COEFFICIENTS = 0, 3, 4
SIZE = COEFFICIENTS + 15
# circular: of cos 2nv in theta_1/sin and theta_2/cos (n = 0..4), in theta_3 and theta_4 (1..4); cos and sin part of the half angle (1..3)
SINE, EVEN_ODD, COSINE_PART, SINE_PART = COEFFICIENTS, COEFFICIENTS + 5, COEFFICIENTS + 9, COEFFICIENTS + 12
# hyperbolic: q', its square root and q'^4.5, pi K/K', a K/(pi K'), cos and sin of odd multiples of a K/(2K') (1, 3, 5, 7)
NOME, ROOT, POWER, PERIOD, DRIFT, COSINES, SINES = (COEFFICIENTS + k for k in (0, 1, 2, 3, 4, 5, 9))


@compiled
def shift_from_half_period(k2, toward_1, toward_3):
    """Return K' - 2 K a/pi = F of the complementary amplitude, from k^2, I1 |I3 - I2| and I3 |I2 - I1| (DLMF 19.25.5, 19.7(iii))."""
    if toward_3 == 0.0:
        return 0.0
    return math.sqrt(toward_3) * carlson_rf(k2 * toward_1, k2 * (toward_1 + toward_3), k2 * toward_1 + toward_3)


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
    c[SINE], c[SINE + 1] = 1.0 - q2 + q6 - q12 + q20, 2.0 * (q6 - q2 - q12 + q20)
    c[SINE + 2], c[SINE + 3], c[SINE + 4] = 2.0 * (q6 - q12 + q20), 2.0 * (q20 - q12), 2.0 * q20
    c[EVEN_ODD], c[EVEN_ODD + 1], c[EVEN_ODD + 2], c[EVEN_ODD + 3] = 2.0 * q, 2.0 * q4, 2.0 * q9, 2.0 * q16
    zero2 = 1.0 + q2 + q6 + q12 + q20
    zero3, zero4 = 1.0 + 2.0 * (q + q4 + q9 + q16), 1.0 - 2.0 * (q - q4 + q9 - q16)
    c[AMPLITUDES], c[AMPLITUDES + 1], c[AMPLITUDES + 2] = A1 * zero4 / zero2, A2 * zero3 / zero2, A3 * zero4 / zero3
    s = c[SIDE]
    # terms 2 Q^(n^2) cosh 2na and sinh 2na with Q = q^2, by up = q e^(2a) <= 1 and down = q e^(-2a) = q (q / up)
    up, down = 0.0, 0.0
    if q > 0.0:
        up = math.exp(-math.pi * shift / quarter)
        down = q * min(q / up, 1.0) if up > 0.0 else q
    growth, at_zero = 0.0, 1.0
    up_power, down_power, weight, sign = up, down, q, -1.0
    for n in range(3):
        # Q^(n^2) e^(2na) = q^(2n^2 - n) up^n
        total, difference = weight * (up_power + down_power), weight * (up_power - down_power)
        c[COSINE_PART + n], c[SINE_PART + n] = sign * total, -sign * s * difference
        at_zero += sign * total
        growth -= sign * 2.0 * (n + 1) * difference
        up_power, down_power, sign = up_power * up, down_power * down, -sign
        weight = q6 if n == 0 else q6 * q9
    return s * growth / at_zero


@compiled
def circular(c, v, v_low):
    """Return omega_1, omega_2, omega_3 and real and imaginary part of the half angle's theta function at the phase v (turns)."""
    s, c0 = sin_cos(v, v_low)
    c1, s1 = (c0 - s) * (c0 + s), 2.0 * s * c0
    c2 = 2.0 * c1 * c1 - 1.0
    c3 = c1 * (2.0 * c2 - 1.0)
    c4 = 2.0 * c2 * c2 - 1.0
    even, odd = c[SINE] + c[SINE + 2] * c2 + c[SINE + 4] * c4, c[SINE + 1] * c1 + c[SINE + 3] * c3
    even3, odd3 = 1.0 + c[EVEN_ODD + 1] * c2 + c[EVEN_ODD + 3] * c4, c[EVEN_ODD] * c1 + c[EVEN_ODD + 2] * c3
    scale = 1.0 / (even3 - odd3)
    return (c[AMPLITUDES] * c0 * (even - odd) * scale,
            c[AMPLITUDES + 1] * s * (even + odd) * scale,
            c[AMPLITUDES + 2] * (even3 + odd3) * scale,
            1.0 + c[COSINE_PART] * c1 + c[COSINE_PART + 1] * c2 + c[COSINE_PART + 2] * c3,
            s1 * (c[SINE_PART] + c[SINE_PART + 1] * 2.0 * c1 + c[SINE_PART + 2] * (2.0 * c2 + 1.0)))


@compiled
def fill_hyperbolic(c, A1, A2, A3, k, kc, period, shift):
    """Fill the series of the complementary nome q'; return the rate (over that of y) at which the half angle's argument grows at y = 0.

    period is pi K/K'. On the separatrix (kc = 0) it is any number so large that the motion never gets there.
    """
    root_k = math.sqrt(k)
    root = kc * math.sqrt(0.5 / (1.0 + k)) / (1.0 + root_k)
    x = root * root
    root *= 1.0 + x * x * x * x                     # sqrt(q'), nome() for tiny k', free of its underflow
    q = root * root
    q2 = q * q
    c[NOME], c[ROOT], c[POWER], c[PERIOD] = q, root, q2 * q2 * root, period
    zero2, zero3, zero4 = 2.0 * (1.0 + q2 + q2 * q2 * q2), 1.0 + 2.0 * (q + q2 * q2), 1.0 - 2.0 * (q - q2 * q2)
    c[AMPLITUDES], c[AMPLITUDES + 1], c[AMPLITUDES + 2] = A1 * zero2 / zero4, A2 * zero3 / zero4, A3 * zero2 / zero3
    angle = 0.25 * math.pi * (1.0 - shift / complete_k(k))      # a K/(2K')
    c[DRIFT] = c[SIDE] * 2.0 * angle / math.pi
    growth, at_zero, weight = 0.0, 0.0, 1.0
    for n in range(4):
        cosine, sine = math.cos((2 * n + 1) * angle), math.sin((2 * n + 1) * angle)
        c[COSINES + n], c[SINES + n] = cosine, c[SIDE] * sine
        at_zero += weight * cosine
        growth += weight * (n + 0.5) * sine
        weight = q if n == 0 else q * q2
    return c[SIDE] * growth / at_zero


@compiled
def hyperbolic(c, v, v_low):
    """Return what :func:`circular` returns, and the part of the half angle (turns) that goes along with v between two half turns."""
    half_turns = nearest(2.0 * v)
    x = (v - 0.5 * half_turns) + v_low
    sign = 1.0 - 2.0 * abs(half_turns - 2.0 * nearest(0.5 * half_turns))
    e = math.exp(-2.0 * c[PERIOD] * abs(x))         # e^-|y|
    q, root = c[NOME], c[ROOT]
    g = root / e if e > 0.0 else 0.0                # sqrt(q') e^|y| <= 1
    e2, f, qq = e * e, g * g, q * q
    # theta functions of iy times 2 e^-|y|, and that of the half angle times 2 e^(-|y|/2)
    ends, middle = qq * (e2 * e2 + qq * f * f), q * f
    scale = 1.0 / (1.0 + e2 + middle + ends)
    theta1 = 1.0 - e2 - middle + ends
    even, odd = 1.0 + qq * f * f, f + q * e2
    side = 1.0 if x >= 0.0 else -1.0
    near, far = root * g, q * e2
    near2, far2 = qq * f, qq * q * e2 * e
    last = c[POWER] * g * f
    return (c[AMPLITUDES] * sign * e * (even - odd) * scale,
            c[AMPLITUDES + 1] * sign * side * theta1 * scale,
            c[AMPLITUDES + 2] * e * (even + odd) * scale,
            c[COSINES] * (1.0 + e) + c[COSINES + 1] * (near + far) + c[COSINES + 2] * (near2 + far2) + c[COSINES + 3] * last,
            side * (c[SINES] * (1.0 - e) + c[SINES + 1] * (near - far) + c[SINES + 2] * (near2 - far2) + c[SINES + 3] * last),
            -c[DRIFT] * x)
