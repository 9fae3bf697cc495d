# SPDX-License-Identifier: Apache-2.0
"""Torque-free rotation in closed form, by theta functions (Jacobi 1849).

Frame: axis 3 is the polar axis, that of the largest or the smallest moment, about which omega
never turns back; axis 2 is that of the middle moment, axis 1 the remaining one; signs such that
omega_3 >= 0, and omega_1 >= 0 at the start. With u growing at the rate p,

    omega = (A1 cn u, A2 sn u, A3 dn u),        modulus k, quarter period K.

The attitude is C Z S: S takes the angular momentum m, |m| = L, to axis 3 by the shortest way,
S = (m x e3, L + m3) up to its norm, which is never singular as m3 >= 0; Z turns by chi about
axis 3; C is constant. With E the energy, chi' = (2 E + L omega_3)/(L + m3), and the half angle is
the argument of one theta function of nome q^2, where q = exp(-pi K'/K):

    exp(i chi/2) = exp(i Omega t/2) theta_4(v + i s a | q^2) / |theta_4|,     v = pi u/(2 K),
    sc(2 K a/pi, k') = sqrt(I1 |I3 - I2| / (I3 |I2 - I1|)),                   0 <= 2a <= -log q,
    s = -1 if I3 is the largest moment, else 1.

The real part of that theta function is positive: the sign of the quaternion is continuous by
itself, and no angle is ever formed. Nothing divides by the smallest moment, so needles and rods
are bodies like others. For k' < 0.17 the same functions are written in the complementary nome
q' = exp(-pi K/K') (Jacobi's imaginary transformation), with hyperbolic functions of y = v K/K';
the separatrix k' = 0 is then nothing special. At most five terms give round-off in either form.

Sources: Whittaker, Analytical Dynamics, section 69; R. van Zon and J. Schofield, J. Comput. Phys.
225 (2007) 145 (which has the full angle); NIST DLMF chapters 20 and 22.
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, Vector, layout
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.elliptic import complete_k, nome
from rigid_body_sim.numerics.exponential import decay
from rigid_body_sim.numerics.phase import nearest, phase, sin_cos
from rigid_body_sim.numerics.vectors import product

KC_HYPERBOLIC = 0.17                            # below it the complementary nome is smaller
CIRCULAR, HYPERBOLIC, STEADY = 0.0, 1.0, 2.0    # the forms; steady: omega is constant in the body

Four = tuple[float, float, float, float]


class Course(NamedTuple):
    """How the motion goes on from its start, in either form."""

    form: float           # CIRCULAR, HYPERBOLIC or STEADY
    start: float          # time of the start, s
    rate: Pair            # rate of v, turns/s
    half_rate: Pair       # Omega/2, turns/s
    phase: float          # v at the start, turns
    shares: Vector        # I1/L, I2/L, I3/L, s/rad
    amplitudes: Vector    # A1, A2, A3 times constants of the theta functions; steady: omega


class CircularSeries(NamedTuple):
    """Coefficients of theta functions of nome q: of cos 2nv and, in the last, of sin 2nv."""

    first: tuple[float, float, float, float, float]     # theta_1/sin v, theta_2/cos v: n = 0..4
    third: Four                                         # theta_3 and theta_4: n = 1..4
    cosines: Vector                                     # the half angle's function: n = 1..3
    sines: Vector


class HyperbolicSeries(NamedTuple):
    """Coefficients of theta functions of the complementary nome."""

    nome: float       # q'
    root: float       # sqrt(q')
    power: float      # q'^4.5
    period: float     # pi K/K'
    drift: float      # s a K/(pi K'): half angle (turns) a turn of v, apart from the series
    cosines: Four     # cosines of 1, 3, 5 and 7 times a K/(2 K')
    sines: Four       # sines of the same, times s


class Rotation(NamedTuple):
    """The view of the kernels below on an array; only one of the two series is filled."""

    course: Course
    circular: CircularSeries
    hyperbolic: HyperbolicSeries


ROTATION = layout(Rotation)
load_course, store_course = ROTATION.part('course').load, ROTATION.part('course').store
load_circular, store_circular = ROTATION.part('circular').load, ROTATION.part('circular').store
load_hyperbolic = ROTATION.part('hyperbolic').load
store_hyperbolic = ROTATION.part('hyperbolic').store


@compiled
def fill_circular(out, A, s, k2, kc, quarter, shift):
    """Fill the series of nome q.

    Parameters
    ----------
    out : array, to be loaded as a Rotation
    A : Vector
        A1, A2, A3 (rad/s).
    s, k2, kc : float
        k^2 = 0, a symmetric body, is allowed.
    quarter, shift : float
        K and K' - 2 K a/pi.

    Returns
    -------
    amplitudes : Vector
        A times constants of the theta functions.
    slope : float
        At v = 0, the rate of the argument of the half angle's theta function over that of v.
    """
    q = nome(math.sqrt(k2), kc)
    q2 = q * q
    q4 = q2 * q2
    q8 = q4 * q4
    q6, q9, q12, q16, q20 = q2 * q4, q8 * q, q8 * q4, q8 * q8, q8 * q8 * q4
    first = (1.0 - q2 + q6 - q12 + q20, 2.0 * (q6 - q2 - q12 + q20), 2.0 * (q6 - q12 + q20),
             2.0 * (q20 - q12), 2.0 * q20)
    third = 2.0 * q, 2.0 * q4, 2.0 * q9, 2.0 * q16
    # theta_2(0), theta_3(0), theta_4(0); the first over 2 q^(1/4)
    zero2 = 1.0 + q2 + q6 + q12 + q20
    zero3, zero4 = 1.0 + 2.0 * (q + q4 + q9 + q16), 1.0 - 2.0 * (q - q4 + q9 - q16)
    amplitudes = A[0] * zero4 / zero2, A[1] * zero3 / zero2, A[2] * zero4 / zero3
    # terms 2 Q^(n^2) cosh 2na and sinh 2na of nome Q = q^2, by up = q e^2a <= 1, down = q e^-2a
    up = decay(math.pi * shift / quarter) if q > 0.0 else 0.0
    down = q * (q / max(up, q)) if q > 0.0 else 0.0
    up2, down2, q15 = up * up, down * down, q6 * q9
    up3, down3 = q15 * up2 * up, q15 * down2 * down
    up, down, up2, down2 = q * up, q * down, q6 * up2, q6 * down2
    c1, c2, c3 = cosines = -(up + down), up2 + down2, -(up3 + down3)
    s1, s2, s3 = sines = s * (up - down), -s * (up2 - down2), s * (up3 - down3)
    store_circular(out, CircularSeries(first, third, cosines, sines))
    return amplitudes, (2.0 * s1 + 4.0 * s2 + 6.0 * s3) / (1.0 + c1 + c2 + c3)


@compiled_inline
def circular_series(amplitudes, series, v):
    """Return omega, and real and imaginary part of the half angle's theta function.

    v is the phase (turns) as a pair.
    """
    sine, cosine = sin_cos(*v)
    # cos 2nv and sin 2v
    c1, s1 = (cosine - sine) * (cosine + sine), 2.0 * sine * cosine
    c2 = 2.0 * c1 * c1 - 1.0
    c3 = c1 * (2.0 * c2 - 1.0)
    c4 = 2.0 * c2 * c2 - 1.0
    f0, f1, f2, f3, f4 = series.first
    t1, t2, t3, t4 = series.third
    even, odd = f0 + f2 * c2 + f4 * c4, f1 * c1 + f3 * c3
    even3, odd3 = 1.0 + t2 * c2 + t4 * c4, t1 * c1 + t3 * c3
    scale = 1.0 / (even3 - odd3)
    A1, A2, A3 = amplitudes
    a1, a2, a3 = series.cosines
    b1, b2, b3 = series.sines
    return ((A1 * cosine * (even - odd) * scale,
             A2 * sine * (even + odd) * scale,
             A3 * (even3 + odd3) * scale),
            1.0 + a1 * c1 + a2 * c2 + a3 * c3,
            s1 * (b1 + 2.0 * b2 * c1 + b3 * (2.0 * c2 + 1.0)))


@compiled
def fill_hyperbolic(out, A, s, k, kc, period, shift):
    """Fill the series of the complementary nome q'; arguments as for :func:`fill_circular`.

    period is pi K/K'. On the separatrix (kc = 0) it is any number so large that the motion never
    gets there.

    Returns
    -------
    amplitudes : Vector
        A times constants of the theta functions.
    slope : float
        At y = 0, the rate of the half angle's argument over that of y.
    drift : float
        Of the series (:class:`HyperbolicSeries`).
    """
    root = kc * math.sqrt(0.5 / (1.0 + k)) / (1.0 + math.sqrt(k))
    x = root * root
    root *= 1.0 + x * x * x * x                     # sqrt(q'): as in nome(), but q' may underflow
    q = root * root
    q2 = q * q
    zero2 = 2.0 * (1.0 + q2 + q2 * q2 * q2)
    zero3, zero4 = 1.0 + 2.0 * (q + q2 * q2), 1.0 - 2.0 * (q - q2 * q2)
    amplitudes = A[0] * zero2 / zero4, A[1] * zero3 / zero4, A[2] * zero2 / zero3
    turns = 0.125 * (1.0 - shift / complete_k(k))   # a K/(2 K')
    drift = s * 4.0 * turns
    sine, c1 = sin_cos(turns, 0.0)
    twice = 2.0 * (c1 - sine) * (c1 + sine)         # cos(n+2)x = 2 cos 2x cos nx - cos(n-2)x
    s1 = s * sine
    c3, s3 = twice * c1 - c1, twice * s1 - -s1
    c5, s5 = twice * c3 - c1, twice * s3 - s1
    c7, s7 = twice * c5 - c3, twice * s5 - s3
    store_hyperbolic(out, HyperbolicSeries(q, root, q2 * q2 * root, period, drift,
                                           (c1, c3, c5, c7), (s1, s3, s5, s7)))
    slope = (0.5 * s1 + q * (1.5 * s3 + q2 * 2.5 * s5)) / (c1 + q * (c3 + q2 * c5))
    return amplitudes, slope, drift


@compiled_inline
def hyperbolic_series(amplitudes, series, v):
    """Return omega, the half angle's theta function (re, im), and a part of the half angle.

    The part (turns) is the one that goes along with v between two half turns.
    """
    v, v_low = v
    half_turns = nearest(2.0 * v)
    x = (v - 0.5 * half_turns) + v_low
    sign = 1.0 - 2.0 * abs(half_turns - 2.0 * nearest(0.5 * half_turns))
    e = decay(2.0 * series.period * abs(x))         # e^-|y|
    q, root = series.nome, series.root
    g = root / max(e, root, 5e-324)                 # sqrt(q') e^|y| <= 1; 0 on the separatrix
    e2, f, qq = e * e, g * g, q * q
    # theta functions of iy times 2 e^-|y|, and that of the half angle times 2 e^(-|y|/2)
    ends, middle = qq * (e2 * e2 + qq * f * f), q * f
    scale = 1.0 / (1.0 + e2 + middle + ends)
    theta1 = 1.0 - e2 - middle + ends
    even, odd = 1.0 + qq * (f * f + qq * e2 * e2), f + q * e2
    side = 1.0 if x >= 0.0 else -1.0
    near, far, near2, far2 = root * g, q * e2, qq * f, qq * q * e2 * e
    last = series.power * g * f
    A1, A2, A3 = amplitudes
    c1, c3, c5, c7 = series.cosines
    s1, s3, s5, s7 = series.sines
    return ((A1 * sign * e * (even - odd) * scale,
             A2 * sign * side * theta1 * scale,
             A3 * e * (even + odd) * scale),
            c1 * (1.0 + e) + c3 * (near + far) + c5 * (near2 + far2) + c7 * last,
            side * (s1 * (1.0 - e) + s3 * (near - far) + s5 * (near2 - far2) + s7 * last),
            -series.drift * x)


@compiled_inline
def phase_of(course, dt):
    """Return v (turns) as a pair, dt (s, a pair) after the start."""
    v, low = phase(*course.rate, *dt)
    v, more = two_sum(v, course.phase)
    return v, low + more


@compiled_inline
def circular(course, series, dt):
    """Return omega, and the quaternion of Z S, not normalised, in the frame above: circular form.

    dt is the time (s) since the start as a pair.
    """
    half = phase(*course.half_rate, *dt)
    omega, re, im = circular_series(course.amplitudes, series, phase_of(course, dt))
    return omega, _joined(course, omega, re, im, half)


@compiled_inline
def hyperbolic(course, series, dt):
    """Return omega and the quaternion of Z S, as :func:`circular` does: hyperbolic form."""
    half, half_low = phase(*course.half_rate, *dt)
    omega, re, im, along = hyperbolic_series(course.amplitudes, series, phase_of(course, dt))
    half, low = two_sum(half, along)
    return omega, _joined(course, omega, re, im, (half, half_low + low))


@compiled_inline
def steady(course, dt):
    """Return omega, which is constant, and the quaternion of Z S, as :func:`circular` does."""
    half = phase(*course.half_rate, *dt)
    return course.amplitudes, _joined(course, course.amplitudes, 1.0, 0.0, half)


@compiled_inline
def _joined(course, omega, re, im, half):
    """Return Z S for the angle chi/2: `half` (turns, a pair) and the argument of re + i im."""
    sine, cosine = sin_cos(*half)
    re, im = cosine * re - sine * im, cosine * im + sine * re
    m1, m2, m3 = product(course.shares, omega)
    up = 1.0 + m3
    return re * m2 + im * m1, im * m2 - re * m1, im * up, re * up


@compiled
def turned(rotation, dt):
    """Return omega and the quaternion of Z S by the form that the motion has."""
    course = load_course(rotation)
    if course.form == CIRCULAR:
        return circular(course, load_circular(rotation), dt)
    if course.form == HYPERBOLIC:
        return hyperbolic(course, load_hyperbolic(rotation), dt)
    return steady(course, dt)
