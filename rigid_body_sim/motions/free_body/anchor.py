# SPDX-License-Identifier: Apache-2.0
"""Numbers of a free rotation that are computed once: those of the body, and the anchor.

The phases v and Omega t/2 of rotation.py grow with time. Their rates are counted in turns and have
more digits than a double, so the error does not grow with time beyond what the doubles of the
input carry. With Euler's coefficients e1 = (I2 - I3)/I1 and cyclically, Euler's equations are
omega_1' = e1 omega_2 omega_3 ..., and

    p^2      = -e1 e2 omega_3^2 + e1 e3 omega_2^2,
    k^2 p^2  = -e2 e3 omega_1^2 + e1 e3 omega_2^2,      both sums of positive terms,
    k'^2 p^2 = e2 (I3 (I3 - I2) omega_3^2 - I1 (I2 - I1) omega_1^2)/(I1 I3),

where the sign of the last one decides which axis is polar: that of the largest moment if it is
positive or zero, else that of the smallest, with 1 and 3 swapped. It is formed with 32 digits
from the input doubles, as are the products of the e. The period follows from
agm(1, k') = pi/(2 K), and chi' = (2 E + L omega_3)/(L + m3) where omega_3 is greatest.
"""

import functools
import math
import struct
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Matrix, Pair, Vector, layout
from rigid_body_sim.errors import BadInput
from rigid_body_sim.motions.free_body.rotation import (
    CIRCULAR,
    HYPERBOLIC,
    KC_HYPERBOLIC,
    STEADY,
    Course,
    Four,
    Rotation,
    fill_circular,
    fill_hyperbolic,
    store_course,
    turned,
)
from rigid_body_sim.numerics.double_double import add, multiply_double, two_product
from rigid_body_sim.numerics.elliptic import agm_pair, carlson_rf_pair, complete_k
from rigid_body_sim.numerics.pairs import (
    TURN,
    in_integers,
    over,
    plus,
    quotient,
    root_of,
    scaled,
    times,
)
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate
from rigid_body_sim.numerics.vectors import apply, minus, product, transposed
from rigid_body_sim.numerics.vectors import plus as plus_vectors
from rigid_body_sim.numerics.vectors import scaled as stretched
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.state import STATE

LEAST_RATIO = 1e-130            # smallest ratio of a needle's moments
UNIT_VECTORS = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
NEVER = 2.0 ** 200              # stands for the infinite period on the separatrix


class Axes(NamedTuple):
    """Numbers of the body for one choice of the axes 1, 2, 3."""

    moments: Vector                         # I1, I2, I3, in a unit of their own
    to_frame: Matrix                        # its rows are the axes in the body
    side: float                             # s of rotation.py
    hand: float                             # 1.0 if the axes are right-handed, else -1.0
    e1_e2: Pair                             # absolute values of Euler's coefficients
    e1_e3: Pair
    e2_e3: float
    e3_by_e2: Pair
    root_e1_by_e2: float
    squares: tuple[Pair, Pair, Pair]        # squares of the moments
    toward_1: float                         # I1 |I3 - I2|
    toward_3: float                         # I3 |I2 - I1|


class Inertia(NamedTuple):
    """Parameters of a rotation: the smallest, middle and largest moment are a <= b <= c."""

    gap_large: Pair     # c (c - b)
    gap_small: Pair     # a (b - a)
    gap: Pair           # (c - a)/(a b c): the factor of the discriminant
    large: Axes         # axis 3 is that of the largest moment
    small: Axes         # axis 3 is that of the smallest


class Attitude(NamedTuple):
    """The attitude of the frame of rotation.py."""

    to_body: Matrix                         # its columns are the axes of the frame in the body
    to_world: tuple[Four, Four, Four, Four]     # takes the quaternion of Z S to the attitude
    rounding: Vector                        # what rounding took from omega at the start, rad/s
    tumbles: float                          # 1.0 if the middle component of m reaches L/2


class RotationAnchor(NamedTuple):
    """The anchor of a rotation."""

    rotation: Rotation
    attitude: Attitude


INERTIA, AXES = layout(Inertia), layout(Axes)
LARGE, SMALL = INERTIA.part('large').first, INERTIA.part('small').first
load_axes, load_frame = AXES.load, AXES.part('to_frame').load
load_gap_large, load_gap_small = INERTIA.part('gap_large').load, INERTIA.part('gap_small').load
load_gap = INERTIA.part('gap').load

ATTITUDE = layout(RotationAnchor).part('attitude')
load_attitude, store_to_world = ATTITUDE.load, ATTITUDE.part('to_world').store
load_to_body, store_to_body = ATTITUDE.part('to_body').load, ATTITUDE.part('to_body').store
store_rounding, store_tumbles = ATTITUDE.part('rounding').store, ATTITUDE.part('tumbles').store

load_state = STATE.load
KEPT = 64    # inertias whose numbers are kept for scenes that differ in other things


def rotation_parameters(inertia):
    """Return the numbers of an inertia that the kernels take, an :class:`Inertia`.

    Raises
    ------
    BadInput
        A moment that is not zero but so small beside the others that its square would underflow.
    """
    return _numbers(struct.pack('10d', *inertia.moments, *inertia.lost, *inertia.axes))


@functools.lru_cache(maxsize=KEPT)
def _numbers(bits):
    """Return the Inertia of the bits of moments, what they lost, and axes; it is cached.

    Integers keep the moments exact, as fractions would at ten times the cost.
    """
    I1, I2, I3, d1, d2, d3, *turn = struct.unpack('10d', bits)
    (a, more_a, small), (b, more_b, middle), (c, more_c, large) = sorted(
        ((I1, d1, 0), (I2, d2, 1), (I3, d3, 2)))
    if 0.0 < a < LEAST_RATIO * c:
        raise BadInput('body.inertia', f'moment {a!r} beside {c!r}',
                       f'at least {LEAST_RATIO} of the largest, or 0 for a rod')
    unit = math.ldexp(1.0, -math.frexp(c)[1])
    (a, b, c, *more), one = in_integers(
        (*stretched(unit, (a, b, c)), *stretched(unit, (more_a, more_b, more_c))))
    (a, b, c), square = plus_vectors((a, b, c), more), one * one
    to_a, to_b, to_c = c - b, c - a, b - a    # Euler's coefficients are to_a/a, to_b/b, to_c/c
    ab, bc, ca = (_quotient(to_a * to_b, a * b), _quotient(to_b * to_c, b * c),
                  _quotient(to_c * to_a, c * a))
    a_by_b, c_by_b = _quotient(to_a * b, a * to_b), _quotient(to_c * b, c * to_b)
    sizes = a / one, b / one, c / one
    squares = quotient(a * a, square), quotient(b * b, square), quotient(c * c, square)
    toward_a, toward_c = a * to_a / square, c * to_c / square
    own = turn == [*IDENTITY]
    axes = tuple([UNIT_VECTORS[k] if own else rotate(*turn, *UNIT_VECTORS[k])
                  for k in (small, middle, large)])
    upward = 1.0 if (middle - small) % 3 == 1 else -1.0
    downward = 1.0 if (middle - large) % 3 == 1 else -1.0
    return Inertia(
        quotient(c * to_a, square), quotient(a * to_c, square),
        _quotient(to_b * square, a * b * c),
        Axes(sizes, axes, -1.0, upward, ab, ca, bc[0], c_by_b, math.sqrt(a_by_b[0]), squares,
             toward_a, toward_c),
        Axes(sizes[::-1], axes[::-1], 1.0, downward, bc, ca, ab[0], a_by_b,
             math.sqrt(c_by_b[0]), squares[::-1], toward_c, toward_a))


def _quotient(a, b):
    """Return a/b as a pair, or 0 for b = 0: for rods and spheres, where omega does not change."""
    return quotient(a, b) if b else (0.0, 0.0)


@compiled
def fill_rotation(parameters, start, out):
    """Fill the anchor of the rotation from a state.

    Parameters
    ----------
    parameters : array, an :class:`Inertia`
    start : array (14,)
        The angular velocity along an axis of zero moment must be 0.
    out : array, to be loaded as a :class:`RotationAnchor`
    """
    begin = load_state(start)
    scale, unscale = _units(begin.angular_velocity)
    wx, wy, wz = stretched(scale, begin.angular_velocity)
    body_omega = _normal(wx), _normal(wy), _normal(wz)
    small, _, large = apply(load_frame(parameters, LARGE), body_omega)
    gap, lift = _discriminant(parameters, small, large)
    choice = LARGE
    if gap[0] < 0.0:
        choice, gap = SMALL, scaled(gap, -1.0)
    axes = load_axes(parameters, choice)
    w1, w2, w3 = apply(axes.to_frame, body_omega)
    s1, s3 = math.copysign(1.0, w1), math.copysign(1.0, w3)
    s2 = axes.hand * s1 * s3
    omega = abs(w1), s2 * w2, abs(w3)
    X, Y, Z = transposed(axes.to_frame)
    signs = s1, s2, s3
    store_to_body(out, (product(signs, X), product(signs, Y), product(signs, Z)))
    _fill_course(axes, omega, gap, lift, scale, unscale, begin.time, out)
    _fill_attitude(start, out)


@compiled_inline
def _units(body_omega):
    """Return factors of omega, and of rates afterwards, that keep squares within range."""
    wx, wy, wz = body_omega
    size = max(abs(wx), abs(wy), abs(wz))
    if size < 1e-250:
        # the body does not turn in 1e240 s; _fill_attitude keeps what omega there is
        return 0.0, 1.0
    if size < 1e-70 or size > 1e70:
        exponent = min(math.frexp(size)[1], 960)    # powers of two are exact
        return math.ldexp(1.0, -exponent), math.ldexp(1.0, exponent)
    return 1.0, 1.0


@compiled_inline
def _normal(w):
    """Return w, or 0 where it is next to the subnormal numbers, which have fewer digits."""
    return w if abs(w) > 1e-304 else 0.0


@compiled
def _discriminant(parameters, small, large):
    """Return k'^2 p^2 / lift^2 as a pair, and lift.

    It is positive if the largest moment's axis is polar. small and large are the components of
    omega along the axes of these moments; lift keeps tiny numbers from underflow.
    """
    lift, size = 1.0, max(abs(small), abs(large))
    if size < 1e-70 and size > 0.0:
        lift = math.ldexp(1.0, max(math.frexp(size)[1], -1000))
    small, large = small / lift, large / lift
    x = times(load_gap_large(parameters), two_product(large, large))
    y = times(load_gap_small(parameters), two_product(small, small))
    return times(load_gap(parameters), add(*x, *scaled(y, -1.0))), lift


@compiled_inline
def _fill_course(axes, omega, gap, lift, scale, unscale, start, out):
    """Fill how the rotation goes on, from omega in the frame and the discriminant.

    Its eight arguments are the results of the choice of the frame.
    """
    w1, w2, w3 = omega
    squares = two_product(w1, w1), two_product(w2, w2), two_product(w3, w3)
    _, x2, x3 = squares
    p2 = plus(times(axes.e1_e2, x3), times(axes.e1_e3, x2))
    # with p^2 < 1e-250 (omega being of order 1) omega does not move in the body in 1e120 s, and
    # squares would be near underflow
    is_steady = p2[0] < 1e-250 or _is_principal(axes.moments, omega)
    top = w3, 0.0           # omega_3 where it is greatest
    if not is_steady:
        top = root_of(plus(times(axes.e3_by_e2, x2), x3))
    L, half_rate = _momentum_and_rate(axes, squares, top)
    if is_steady:
        form, rate, phase, amplitudes, tumbles = STEADY, (0.0, 0.0), 0.0, omega, 0.0
    else:
        form, rate, phase, amplitudes, slope = _fill_series(
            axes, omega, top[0], p2, gap, lift, out)
        half_rate = add(*half_rate, -slope, 0.0)
        tumbles = 1.0 if axes.moments[1] * abs(amplitudes[1]) >= 0.5 * L else 0.0
    store_tumbles(out, tumbles)
    store_course(out, Course(
        form, start, scaled(rate, unscale), scaled(half_rate, unscale), phase,
        stretched(scale / L if L > 0.0 else 0.0, axes.moments), stretched(unscale, amplitudes)))


@compiled_inline
def _is_principal(moments, omega):
    """Return whether omega lies along a principal axis, so that nothing turns in the body."""
    I1, I2, I3 = moments
    w1, w2, w3 = omega
    return not ((w1 != 0.0 and w2 != 0.0 and I1 != I2) or (w2 != 0.0 and w3 != 0.0 and I2 != I3)
                or (w3 != 0.0 and w1 != 0.0 and I3 != I1))


@compiled_inline
def _momentum_and_rate(axes, squares, top):
    """Return L and, as a pair, chi'/2 (turns/s) where omega_3 = top: (2 E + L omega_3)/(L + m3)/2.

    squares are those of omega; they and top are pairs.
    """
    x1, x2, x3 = squares
    I1, I2, I3 = axes.moments
    I1_2, I2_2, I3_2 = axes.squares
    L = root_of(plus(plus(times(I1_2, x1), times(I2_2, x2)), times(I3_2, x3)))
    if L[0] == 0.0:
        return 0.0, (0.0, 0.0)
    twice_E = plus(plus(multiply_double(*x1, I1), multiply_double(*x2, I2)),
                   multiply_double(*x3, I3))
    chi = over(plus(twice_E, times(L, top)), plus(multiply_double(*top, I3), L))
    return L[0], times(chi, scaled(TURN, 0.5))


@compiled_inline
def _fill_series(axes, omega, top, p2, gap, lift, out):
    """Fill the series of a rotation that is not steady.

    Returns
    -------
    form : float
    rate : Pair
        Of v, turns/s.
    phase : float
        v at the start, turns.
    amplitudes : Vector
    slope : float
        What the series contribute to the rate of the half angle (turns/s) at v = 0.
    """
    w1, w2, _ = omega
    a, c = w1, axes.root_e1_by_e2 * abs(w2)
    larger, ratio = max(a, c), min(a, c) / max(a, c)
    A1 = larger * math.sqrt(1.0 + ratio * ratio)
    A2 = -axes.side * A1 / axes.root_e1_by_e2
    A = A1, A2, top
    p = root_of(p2)
    kc = scaled(over(root_of(gap), p), lift)
    k2 = min((axes.e2_e3 * w1 * w1 + axes.e1_e3[0] * w2 * w2) / p2[0], 1.0)
    u, shift = _argument_and_shift(axes, omega, A, k2)
    rate = scaled(p, 0.5 / NEVER)
    if kc[0] > 0.0:
        rate = times(times(agm_pair(1.0, 0.0, *kc), p), TURN)
    f, phase = rate[0], rate[0] * u / p[0]
    if kc[0] >= KC_HYPERBOLIC:
        amplitudes, slope = fill_circular(out, A, axes.side, k2, kc[0], 0.25 * p[0] / f, shift)
        return CIRCULAR, rate, phase, amplitudes, f * slope
    k = math.sqrt(k2)
    period = 0.25 * math.pi * p[0] / (f * complete_k(k)) if kc[0] > 0.0 else NEVER
    amplitudes, slope, drift = fill_hyperbolic(out, A, axes.side, k, kc[0], period, shift)
    return HYPERBOLIC, rate, phase, amplitudes, f * (period * slope / math.pi - drift)


@compiled_inline
def _argument_and_shift(axes, omega, A, k2):
    """Return u at the start, and K' - 2 K a/pi with the body's own constant a.

    u = sn R_F(cn^2, dn^2, 1) (DLMF 19.25.5), its first duplication written out for the sake of cn
    and dn of 1e-300. The other one is F of the complementary amplitude (DLMF 19.7(iii)).
    """
    cn, sn, dn = omega[0] / A[0], omega[1] / A[1], omega[2] / A[2]
    step = cn * dn + cn + dn
    to_1, to_3 = k2 * axes.toward_1, axes.toward_3
    reaches = to_1 > 0.0
    u, shift = carlson_rf_pair(
        0.25 * (cn * cn + step), 0.25 * (dn * dn + step), 0.25 * (1.0 + step),
        to_1 if reaches else 1.0, to_1 + k2 * to_3 if reaches else 1.0,
        to_1 + to_3 if reaches else 1.0)
    return u * sn, shift * (math.sqrt(to_3) if reaches else 0.0)


@compiled
def _fill_attitude(start, out):
    """Fill what takes the quaternion of Z S to the attitude, and what rounding took from omega.

    The missing ulp or so is added to omega at all times. Then the start comes back to the last
    bit. In a motion that is anchored anew at every tick energy and momentum make a random walk and
    have no trend: one-sided rounding of the formulas cancels between two evaluations.
    """
    begin, to_body = load_state(start), load_to_body(out)
    omega, (x, y, z, w) = turned(out, (0.0, 0.0))
    store_rounding(out, minus(begin.angular_velocity, apply(to_body, omega)))
    bx, by, bz = apply(to_body, (x, y, z))
    C = normalised(*multiply(*begin.orientation, -bx, -by, -bz, w))
    axis_1, axis_2, axis_3 = transposed(to_body)
    i, j, k = multiply(*C, *axis_1, 0.0), multiply(*C, *axis_2, 0.0), multiply(*C, *axis_3, 0.0)
    store_to_world(out, ((i[0], j[0], k[0], C[0]), (i[1], j[1], k[1], C[1]),
                         (i[2], j[2], k[2], C[2]), (i[3], j[3], k[3], C[3])))


@compiled_inline
def attitude_of(attitude, omega, ZS):
    """Return quaternion and angular velocity of the body for what `turned` returns."""
    x, y, z, w = ZS
    scale = 1.0 / math.sqrt(x * x + y * y + z * z + w * w)
    q = _apply_4(attitude.to_world, (scale * x, scale * y, scale * z, scale * w))
    return q, plus_vectors(apply(attitude.to_body, omega), attitude.rounding)


@compiled_inline
def _apply_4(matrix, q):
    """Return the product of a 4 x 4 matrix, given by its rows, and a quaternion."""
    a, b, c, d = matrix
    return _dot_4(a, q), _dot_4(b, q), _dot_4(c, q), _dot_4(d, q)


@compiled_inline
def _dot_4(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]
