"""Motion of a free rigid body, in closed form over any time: no torque, perhaps a uniform field.

Absorbs constraint `free` with no effect, or with gravity; every inertia. Rotation: rigid_body_sim/motions/free_rotation.py, which has the
equations and the frame. The centre of mass flies on a parabola; the pose is that of the body's origin, which may be elsewhere.

What grows with time, the phases v and Omega t/2, has rates with more digits than a double, counted in turns; so the error does not grow with
time beyond what the doubles of the input carry. Products e1 e2 of Euler's coefficients e1 = (I2 - I3)/I1 (cyclic) are exact to 32 digits:

    p^2 = -e1 e2 omega_3^2 + e1 e3 omega_2^2,        k^2 p^2 = -e2 e3 omega_1^2 + e1 e3 omega_2^2,        both sums of positive terms,
    k'^2 p^2 = e2 (I3 (I3 - I2) omega_3^2 - I1 (I2 - I1) omega_1^2) / (I1 I3),

the last one decides by its sign which axis is polar: the largest moment's where it is >= 0, else the smallest's, with 1 and 3 exchanged.
The period follows from agm(p, k' p) = pi p/(2 K).

Beside `anchor` and `state` there is `flip_count` and `flip_time`: the events at which the middle component of omega changes sign.
"""

import math
from fractions import Fraction

import numpy as np

from rigid_body_sim.compiled import compiled
from rigid_body_sim.double_double import add, divide, multiply, multiply_double, root, square, two_sum
from rigid_body_sim.elliptic import agm_pair, carlson_rf, complete_k
from rigid_body_sim.motions import free_rotation
from rigid_body_sim.motions.free_rotation import (
    AMPLITUDES,
    KC_HYPERBOLIC,
    circular,
    fill_circular,
    fill_hyperbolic,
    hyperbolic,
    shift_from_half_period,
)
from rigid_body_sim.rotations import multiply as compose
from rigid_body_sim.rotations import normalised, rotate
from rigid_body_sim.turns import phase, sin_cos

# layout of the parameters: centre of mass, g, the factors of the discriminant, then a block for either choice of the polar axis
CENTER, GRAVITY, GAP_LARGE, GAP_SMALL, GAP, BLOCKS = 0, 3, 4, 6, 8, 10
# layout of a block
MOMENTS, MATRIX, SIDE, HAND, E12, E13, E23, E32, ROOT12, SQUARES, TOWARD = 0, 3, 12, 13, 14, 16, 18, 19, 21, 22, 28
BLOCK_SIZE = 30
PARAMETER_SIZE = BLOCKS + 2 * BLOCK_SIZE

# layout of the anchor, behind the series of free_rotation
KIND, START, RATE, PHASE, HALF, TO_BODY, UNIT, FIXED, FLIPS, FLIGHT = (free_rotation.SIZE + k for k in (0, 1, 2, 4, 5, 7, 16, 19, 23, 24))
ANCHOR_SIZE = FLIGHT + 11
CIRCULAR, HYPERBOLIC, STEADY = 0.0, 1.0, 2.0

TURN, TURN_LOW = 0.15915494309189535, -9.839338337591243e-18        # 1/(2 pi)
NEVER = 2.0 ** 200              # stands for the infinite period on the separatrix
FLIP_SHARE = 0.5


def absorbs(scene):
    """Return whether this motion solves the whole scene."""
    return scene.constraint.kind == 'free' and all(effect.name == 'gravity' for effect in scene.effects)


def parameters(scene):
    """Return the numbers of the scene that the kernels take, shape (PARAMETER_SIZE,)."""
    p = np.zeros(PARAMETER_SIZE)
    p[CENTER:CENTER + 3] = scene.body.center_of_mass
    p[GRAVITY] = sum(effect.g for effect in scene.effects)
    inertia = scene.body.about_center
    small, middle, large = order = sorted(range(3), key=lambda k: inertia.moments[k])
    unit = math.frexp(inertia.moments[large])[1]
    moments = [Fraction(math.ldexp(inertia.moments[k], -unit)) for k in order]
    least, mean, most = moments
    p[GAP_LARGE:GAP_LARGE + 2] = _pair(most * (most - mean))
    p[GAP_SMALL:GAP_SMALL + 2] = _pair(least * (mean - least))
    p[GAP:GAP + 2] = _pair(_quotient(most - least, least * mean * most))
    columns = [rotate(*inertia.axes, *unit_vector) for unit_vector in np.eye(3)]
    _fill_block(p[BLOCKS:], moments, [columns[k] for k in (small, middle, large)], -1.0, 1.0 if (middle - small) % 3 == 1 else -1.0)
    _fill_block(p[BLOCKS + BLOCK_SIZE:], moments[::-1], [columns[k] for k in (large, middle, small)], 1.0,
                1.0 if (middle - large) % 3 == 1 else -1.0)
    return p


def _fill_block(block, moments, columns, side, hand):
    """Fill the numbers that belong to one choice of the axes 1, 2, 3: moments, axes in the body, s, +1 if the axes are right-handed else -1."""
    I1, I2, I3 = moments
    e1, e2, e3 = _quotient(abs(I2 - I3), I1), _quotient(abs(I3 - I1), I2), _quotient(abs(I1 - I2), I3)      # Euler's coefficients
    block[MOMENTS:MOMENTS + 3] = moments
    block[MATRIX:MATRIX + 9] = np.transpose(columns).reshape(-1)
    block[SIDE], block[HAND] = side, hand
    block[E12:E12 + 2], block[E13:E13 + 2], block[E23] = _pair(e1 * e2), _pair(e1 * e3), e2 * e3
    block[E32:E32 + 2], block[ROOT12] = _pair(_quotient(e3, e2)), math.sqrt(_quotient(e1, e2))
    block[SQUARES:SQUARES + 6] = [half for moment in moments for half in _pair(moment * moment)]
    block[TOWARD:TOWARD + 2] = I1 * abs(I3 - I2), I3 * abs(I2 - I1)


def _pair(number):
    """Return an exact number as a pair of doubles."""
    return float(number), float(number - Fraction(float(number)))


def _quotient(a, b):
    """Return a/b, or 0 for b = 0: Euler's coefficients of a rod and of a sphere, where omega does not change."""
    return a / b if b else Fraction(0)


@compiled
def anchor(p, start, out):
    """Precompute the motion from a state (14 doubles, its time included); the angular velocity along an axis of zero moment must be 0."""
    wx, wy, wz = start[5], start[6], start[7]
    # powers of two are exact: the work is done with angular velocities of order 1
    exponent = min(max(math.frexp(max(abs(wx), abs(wy), abs(wz)))[1], -960), 960)
    scale, unscale = math.ldexp(1.0, -exponent), math.ldexp(1.0, exponent)
    wx, wy, wz = scale * wx, scale * wy, scale * wz
    small, _, large = _to_frame(p, BLOCKS, wx, wy, wz)
    gap, gap_low, lift = _discriminant(p, small, large)
    b = BLOCKS
    if gap < 0.0:
        b, gap, gap_low = BLOCKS + BLOCK_SIZE, -gap, -gap_low
    w1, w2, w3 = _to_frame(p, b, wx, wy, wz)
    s1, s3 = math.copysign(1.0, w1), math.copysign(1.0, w3)
    s2 = p[b + HAND] * s1 * s3
    w1, w2, w3 = abs(w1), s2 * w2, abs(w3)
    for row in range(3):
        m, d = b + MATRIX + 3 * row, TO_BODY + 3 * row
        out[d], out[d + 1], out[d + 2] = s1 * p[m], s2 * p[m + 1], s3 * p[m + 2]
    out[START], out[free_rotation.SIDE] = start[0], p[b + SIDE]
    x2, x2_low = square(w2)
    x3, x3_low = square(w3)
    p2, p2_low = _sum_of_products(p, b + E12, x3, x3_low, b + E13, x2, x2_low)
    if p2 == 0.0 or _is_principal(p, b, w1, w2, w3):
        L, chi, chi_low = _momentum_and_rate(p, b, w1, w2, w3, w3, 0.0)
        out[KIND], out[RATE], out[RATE + 1], out[PHASE], out[FLIPS] = STEADY, 0.0, 0.0, 0.0, 0.0
        out[AMPLITUDES], out[AMPLITUDES + 1], out[AMPLITUDES + 2] = w1, w2, w3
        slope = 0.0
    else:
        e, e_low = multiply(p[b + E32], p[b + E32 + 1], x2, x2_low)
        e, e_low = add(e, e_low, x3, x3_low)
        top, top_low = root(e, e_low)
        L, chi, chi_low = _momentum_and_rate(p, b, w1, w2, w3, top, top_low)
        slope = _fill_periodic(p, b, w1, w2, w3, top, p2, p2_low, gap, gap_low, lift, out)
        out[FLIPS] = 1.0 if p[b + MOMENTS + 1] * abs(out[AMPLITUDES + 1]) >= FLIP_SHARE * L else 0.0
    half, half_low = multiply(chi, chi_low, 0.5 * TURN, 0.5 * TURN_LOW)
    half, half_low = add(half, half_low, -slope, 0.0)
    out[HALF], out[HALF + 1] = unscale * half, unscale * half_low
    out[RATE], out[RATE + 1] = unscale * out[RATE], unscale * out[RATE + 1]
    for k in range(3):
        out[AMPLITUDES + k] *= unscale
        out[UNIT + k] = scale * p[b + MOMENTS + k] / L if L > 0.0 else 0.0
    _, _, _, x, y, z, w = _rotated(out, 0.0, 0.0)
    scale = 1.0 / (x * x + y * y + z * z + w * w)
    out[FIXED], out[FIXED + 1], out[FIXED + 2], out[FIXED + 3] = compose(
        start[1], start[2], start[3], start[4], -scale * x, -scale * y, -scale * z, scale * w)
    _fill_flight(p, start, out)


@compiled
def _to_frame(p, b, wx, wy, wz):
    """Return the components along the axes 1, 2, 3 of the block at b, before their signs are chosen."""
    m = b + MATRIX
    return (p[m] * wx + p[m + 3] * wy + p[m + 6] * wz, p[m + 1] * wx + p[m + 4] * wy + p[m + 7] * wz,
            p[m + 2] * wx + p[m + 5] * wy + p[m + 8] * wz)


@compiled
def _discriminant(p, small, large):
    """Return k'^2 p^2 2^(-2 lift) as a pair, positive if the largest moment's axis is polar; lift keeps tiny components from underflow."""
    lift = math.frexp(max(abs(small), abs(large)))[1]
    x, x_low = square(math.ldexp(large, -lift))
    x, x_low = multiply(p[GAP_LARGE], p[GAP_LARGE + 1], x, x_low)
    y, y_low = square(math.ldexp(small, -lift))
    y, y_low = multiply(p[GAP_SMALL], p[GAP_SMALL + 1], y, y_low)
    x, x_low = add(x, x_low, -y, -y_low)
    x, x_low = multiply(p[GAP], p[GAP + 1], x, x_low)
    return x, x_low, lift


@compiled
def _sum_of_products(p, i, x, x_low, j, y, y_low):
    """Return p[i] x + p[j] y, all pairs."""
    a, a_low = multiply(p[i], p[i + 1], x, x_low)
    c, c_low = multiply(p[j], p[j + 1], y, y_low)
    return add(a, a_low, c, c_low)


@compiled
def _is_principal(p, b, w1, w2, w3):
    """Return whether omega lies along a principal axis, so that nothing turns in the body."""
    I1, I2, I3 = p[b + MOMENTS], p[b + MOMENTS + 1], p[b + MOMENTS + 2]
    return not ((w1 != 0.0 and w2 != 0.0 and I1 != I2) or (w2 != 0.0 and w3 != 0.0 and I2 != I3) or (w3 != 0.0 and w1 != 0.0 and I3 != I1))


@compiled
def _momentum_and_rate(p, b, w1, w2, w3, top, top_low):
    """Return L and chi' = (2 E + L omega_3)/(L + m3) where omega_3 = top, as a pair."""
    l2, l2_low, e2, e2_low = 0.0, 0.0, 0.0, 0.0
    for k, w in enumerate((w1, w2, w3)):
        x, x_low = square(w)
        y, y_low = multiply(p[b + SQUARES + 2 * k], p[b + SQUARES + 2 * k + 1], x, x_low)
        l2, l2_low = add(l2, l2_low, y, y_low)
        y, y_low = multiply_double(x, x_low, p[b + MOMENTS + k])
        e2, e2_low = add(e2, e2_low, y, y_low)
    L, L_low = root(l2, l2_low)
    if L == 0.0:
        return 0.0, 0.0, 0.0
    y, y_low = multiply(L, L_low, top, top_low)
    y, y_low = add(y, y_low, e2, e2_low)
    m3, m3_low = multiply_double(top, top_low, p[b + MOMENTS + 2])
    m3, m3_low = add(m3, m3_low, L, L_low)
    y, y_low = divide(y, y_low, m3, m3_low)
    return L, y, y_low


@compiled
def _fill_periodic(p, b, w1, w2, w3, top, p2, p2_low, gap, gap_low, lift, out):
    """Fill rate and phase of v and the series; return what the series contribute to the rate of the half angle (turns) at v = 0."""
    A1 = math.hypot(w1, p[b + ROOT12] * w2)
    A2 = -p[b + SIDE] * A1 / p[b + ROOT12]
    k2 = min((p[b + E23] * w1 * w1 + p[b + E13] * w2 * w2) / p2, 1.0)
    x, x_low = root(p2, p2_low)
    y, y_low = root(gap, gap_low)
    y, y_low = math.ldexp(y, lift), math.ldexp(y_low, lift)
    kc = y / x
    # u = F(am u) = sn R_F(cn^2, dn^2, 1), its first duplication written out for the sake of cn, dn of 1e-300 (DLMF 19.25.5, 19.26.18)
    cn, sn, dn = w1 / A1, w2 / A2, w3 / top
    shift = cn * dn + cn + dn
    u = sn * carlson_rf(0.25 * (cn * cn + shift), 0.25 * (dn * dn + shift), 0.25 * (1.0 + shift))
    f, f_low = x / (2.0 * NEVER), x_low / (2.0 * NEVER)
    if kc > 0.0:
        f, f_low = agm_pair(x, x_low, y, y_low)
        f, f_low = multiply(f, f_low, TURN, TURN_LOW)
    shift = shift_from_half_period(k2, p[b + TOWARD], p[b + TOWARD + 1])
    if kc >= KC_HYPERBOLIC:
        out[KIND] = CIRCULAR
        slope = f * fill_circular(out, A1, A2, top, k2, kc, 0.25 * x / f, shift)
    else:
        k = math.sqrt(k2)
        period = 0.25 * math.pi * x / (f * complete_k(k)) if kc > 0.0 else NEVER
        out[KIND] = HYPERBOLIC
        slope = f * (period * fill_hyperbolic(out, A1, A2, top, k, kc, period, shift) / math.pi - out[free_rotation.DRIFT])
    out[RATE], out[RATE + 1], out[PHASE] = f, f_low, f * u / x
    return slope


@compiled
def _fill_flight(p, start, out):
    """Fill position and velocity of the centre of mass at the start, g and the centre of mass in the body."""
    cx, cy, cz = p[CENTER], p[CENTER + 1], p[CENTER + 2]
    qx, qy, qz, qw, wx, wy, wz = start[1], start[2], start[3], start[4], start[5], start[6], start[7]
    rx, ry, rz = rotate(qx, qy, qz, qw, cx, cy, cz)
    ux, uy, uz = rotate(qx, qy, qz, qw, wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx)
    f = FLIGHT
    out[f], out[f + 1], out[f + 2] = start[8] + rx, start[9] + ry, start[10] + rz
    out[f + 3], out[f + 4], out[f + 5] = start[11] + ux, start[12] + uy, start[13] + uz
    out[f + 6], out[f + 7], out[f + 8], out[f + 9] = p[GRAVITY], cx, cy, cz
    out[f + 10] = 1.0 if cx != 0.0 or cy != 0.0 or cz != 0.0 else 0.0


@compiled
def _rotated(c, dt, dt_low):
    """Return omega (body axes) and the rotation Z S, a quaternion not normalised, in body axes, dt after the start."""
    half, half_low = phase(c[HALF], c[HALF + 1], dt, dt_low)
    if c[KIND] == STEADY:
        w1, w2, w3, re, im = c[AMPLITUDES], c[AMPLITUDES + 1], c[AMPLITUDES + 2], 1.0, 0.0
    else:
        v, v_low = phase(c[RATE], c[RATE + 1], dt, dt_low)
        v, low = two_sum(v, c[PHASE])
        if c[KIND] == CIRCULAR:
            w1, w2, w3, re, im = circular(c, v, v_low + low)
        else:
            w1, w2, w3, re, im, along = hyperbolic(c, v, v_low + low)
            half, low = two_sum(half, along)
            half_low += low
    sine, cosine = sin_cos(half, half_low)
    re, im = cosine * re - sine * im, cosine * im + sine * re
    m1, m2, up = c[UNIT] * w1, c[UNIT + 1] * w2, 1.0 + c[UNIT + 2] * w3
    x, y, z = re * m2 + im * m1, im * m2 - re * m1, im * up
    m = TO_BODY
    return (c[m] * w1 + c[m + 1] * w2 + c[m + 2] * w3, c[m + 3] * w1 + c[m + 4] * w2 + c[m + 5] * w3,
            c[m + 6] * w1 + c[m + 7] * w2 + c[m + 8] * w3, c[m] * x + c[m + 1] * y + c[m + 2] * z,
            c[m + 3] * x + c[m + 4] * y + c[m + 5] * z, c[m + 6] * x + c[m + 7] * y + c[m + 8] * z, re * up)


@compiled
def state(c, time, out):
    """Fill out with the state (14 doubles) at a time before or after the anchor c."""
    dt, dt_low = two_sum(time, -c[START])
    wx, wy, wz, x, y, z, w = _rotated(c, dt, dt_low)
    qx, qy, qz, qw = compose(c[FIXED], c[FIXED + 1], c[FIXED + 2], c[FIXED + 3], x, y, z, w)
    qx, qy, qz, qw = normalised(qx, qy, qz, qw)
    out[0] = time
    out[1], out[2], out[3], out[4] = qx, qy, qz, qw
    out[5], out[6], out[7] = wx, wy, wz
    f = FLIGHT
    fall = c[f + 6] * dt
    rx, ry, rz = c[f] + c[f + 3] * dt, c[f + 1] + c[f + 4] * dt, c[f + 2] + (c[f + 5] - 0.5 * fall) * dt
    vx, vy, vz = c[f + 3], c[f + 4], c[f + 5] - fall
    if c[f + 10] != 0.0:
        cx, cy, cz = c[f + 7], c[f + 8], c[f + 9]
        dx, dy, dz = rotate(qx, qy, qz, qw, cx, cy, cz)
        ux, uy, uz = rotate(qx, qy, qz, qw, wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx)
        rx, ry, rz, vx, vy, vz = rx - dx, ry - dy, rz - dz, vx - ux, vy - uy, vz - uz
    out[8], out[9], out[10], out[11], out[12], out[13] = rx, ry, rz, vx, vy, vz
