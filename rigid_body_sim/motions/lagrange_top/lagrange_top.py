"""Heavy symmetric top with a fixed point, in closed form over any time (notes, "Symmetric Top" to "Fast top").

Absorbs: constraint pivot (the body's origin stays where it is), gravity or none, a body with two equal moments about the pivot and its
centre of mass on the third axis. Spherical tops, thin rods (the spherical pendulum), hanging and standing tops, and tops without weight are
ordinary cases.

Symbols: e3 the symmetry axis, towards the centre of mass at distance h from the pivot; I1, I1, I3 moments about the pivot; k = M g h/I1;
n = P_gamma/I1 = I3 omega_3/I1; beta the angle of e3 to the vertical, u = cos(beta).

A top with I3 := I1 and the same n differs from ours by a steady rotation about e3 at the rate omega_3 - n = omega_3 (I1 - I3)/I1, so I3
enters nowhere else. The attitude is a pair of complex numbers a = w + i z, b = y - i x (Cayley-Klein parameters, |a|^2 = (1 + u)/2,
|b|^2 = (1 - u)/2), so nothing happens at beta = 0 and pi where Euler's angles fail. a, b and omega_c = omega_2 - i omega_1 are
single-valued functions of time: a theta quotient times a phase that grows steadily (lagrange_top_theta.py). The phase of omega_c is that of
b less that of a, because with gamma the vertical in body axes and c = omega . gamma across e3

    omega_c = (c + i u')/(1 - u^2) gamma_c,     gamma_c = 2 i conj(a) b.

What grows with time has more digits than a double (lagrange_top_means.py), so errors do not grow.

Kernels besides those of every motion: `states`, the same operations as `state` on many times side by side; `next_event`, `turning_index`,
`turning_time` (where beta turns); `reaction`. Nutation too slight to be seen in doubles (NOTICED in lagrange_top_anchor.py) is no event.
"""

import math
from fractions import Fraction

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.motions.lagrange_top.anchor import (
    IS_HYPERBOLIC,
    NEVER,
    NUTATES,
    NUTATION_SIZE,
    PARITY,
    RATE,
    START,
    STRETCH,
    anchor_nutation,
    circular_functions,
    functions,
    hyperbolic_functions,
)
from rigid_body_sim.motions.loops import BLOCK
from rigid_body_sim.numerics.double_double import multiply_double, two_sum
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.pairs import pair_at, pair_of
from rigid_body_sim.numerics.phase import COUNTABLE
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate, rotate_back
from rigid_body_sim.scene import bodies
from rigid_body_sim.scene.constraints import Pivot
from rigid_body_sim.scene.effects.gravity import Gravity

# layout of the parameters: M, g, h; as pairs M g h/I1, I3/I1, (I1 - I3)/I1; quaternion that turns the axes of the top (third: e3) to the body
MASS, GRAVITY, ARM, PULL, RATIO, EXCESS, FRAME = 0, 1, 2, 3, 5, 7, 9
PARAMETER_SIZE = 13

# layout of the anchor: functions of time, then what is constant
TIME, SPIN, TOP_FRAME, PIVOT = NUTATION_SIZE, NUTATION_SIZE + 1, NUTATION_SIZE + 2, NUTATION_SIZE + 6
ANCHOR_SIZE = NUTATION_SIZE + 9

EVENTS = ('turning point',)
exchanged = takes = None


def absorbs(scene):
    """Return whether the scene is a symmetric body on a pivot under its weight alone; symmetric means exactly so (see `symmetry_axis`)."""
    return (isinstance(scene.constraint, Pivot) and scene.acts_only(Gravity)
            and symmetry_axis(scene.body) is not None)


def symmetry_axis(body):
    """Return the number (0, 1, 2) of the principal axis that is e3, and the quaternion that turns the top's axes into the body's, or None.

    Two moments about the origin must be the same double and the centre of mass must lie on the third axis: to the last bit where principal
    axes and body axes coincide up to order and sign, else to the rounding of the turn between them. e3 points towards the centre of mass.
    """
    moments, axes, center = body.about_origin.moments, body.about_origin.axes, body.center_of_mass
    distance = hypot3(*center)
    if moments[0] == moments[1] == moments[2]:
        return 2, _turn_to(*(component / distance for component in center)) if distance > 0.0 else bodies.IDENTITY
    local = rotate_back(*axes, *center)
    slack = 0.0 if set(map(abs, axes)) <= {0.0, 0.5, 1.0} else bodies.ULPS * distance
    for k, order in enumerate(((0.5, 0.5, 0.5, 0.5), (-0.5, -0.5, -0.5, 0.5), bodies.IDENTITY)):
        i, j = (k + 1) % 3, (k + 2) % 3
        if moments[i] == moments[j] and max(abs(local[i]), abs(local[j])) <= slack:
            upside_down = (1.0, 0.0, 0.0, 0.0) if local[k] < 0.0 else bodies.IDENTITY
            return k, multiply(*axes, *multiply(*order, *upside_down))
    return None


def _turn_to(x, y, z):
    """Return a quaternion that turns the third axis into the unit vector (x, y, z)."""
    if z < 0.0:
        return multiply(*normalised(y, -x, 0.0, 1.0 - z), 1.0, 0.0, 0.0, 0.0)      # -z into it, after z into -z
    return normalised(-y, x, 0.0, 1.0 + z)


def parameters(scene):
    """Return the numbers of the scene, shape (13,): layout above."""
    body, gravity = scene.body, scene.effect('gravity')
    axis, frame = symmetry_axis(body)
    I1, I3 = Fraction(body.about_origin.moments[(axis + 1) % 3]), Fraction(body.about_origin.moments[axis])
    g, arm = gravity.g if gravity else 0.0, hypot3(*body.center_of_mass)
    pull = Fraction(body.mass) * Fraction(g) * Fraction(arm) / I1
    return np.array([body.mass, g, arm, *pair_of(pull), *pair_of(I3 / I1), *pair_of((I1 - I3) / I1), *frame])


@compiled
def anchor(parameters, start, anchor):
    """Fill the anchor from the state `start`."""
    fx, fy, fz, fw = parameters[FRAME], parameters[FRAME + 1], parameters[FRAME + 2], parameters[FRAME + 3]
    x, y, z, w = multiply(start[1], start[2], start[3], start[4], fx, fy, fz, fw)
    omega_1, omega_2, omega_3 = rotate_back(fx, fy, fz, fw, start[5], start[6], start[7])
    anchor_nutation(w, z, y, -x, omega_2, -omega_1, multiply_double(parameters[RATIO], parameters[RATIO + 1], omega_3),
                    pair_at(parameters, PULL), multiply_double(parameters[EXCESS], parameters[EXCESS + 1], omega_3), anchor)
    anchor[TIME], anchor[SPIN] = start[0], omega_3
    anchor[TOP_FRAME], anchor[TOP_FRAME + 1], anchor[TOP_FRAME + 2], anchor[TOP_FRAME + 3] = fx, fy, fz, fw
    anchor[PIVOT], anchor[PIVOT + 1], anchor[PIVOT + 2] = start[8], start[9], start[10]


@compiled_inline
def _attitude_and_omega(c, a_re, a_im, b_re, b_im, o_re, o_im):
    """Return quaternion and angular velocity of the body from a, b, omega_c; the norm is 1 up to rounding, which is taken out."""
    fx, fy, fz, fw = c[TOP_FRAME], c[TOP_FRAME + 1], c[TOP_FRAME + 2], c[TOP_FRAME + 3]
    # summed near 0, where rounding has no side
    excess = ((a_re * a_re - 0.25) + (a_im * a_im - 0.25)) + ((b_re * b_re - 0.25) + (b_im * b_im - 0.25))
    scale = 1.0 - 0.5 * excess
    x, y, z, w = multiply(scale * -b_im, scale * b_re, scale * a_im, scale * a_re, -fx, -fy, -fz, fw)
    wx, wy, wz = rotate(fx, fy, fz, fw, -o_im, o_re, c[SPIN])
    return x, y, z, w, wx, wy, wz


@compiled
def state(c, time, out):
    """Fill out with the state (14 doubles) at a time before or after the anchor c."""
    elapsed, elapsed_low = two_sum(time, -c[TIME])
    a_re, a_im, b_re, b_im, o_re, o_im = functions(c, elapsed, elapsed_low)
    out[0] = time
    out[1], out[2], out[3], out[4], out[5], out[6], out[7] = _attitude_and_omega(c, a_re, a_im, b_re, b_im, o_re, o_im)
    out[8], out[9], out[10] = c[PIVOT], c[PIVOT + 1], c[PIVOT + 2]
    out[11], out[12], out[13] = 0.0, 0.0, 0.0


@compiled
def fill_columns(c, times, columns):
    """Fill columns, BLOCK times, BLOCK times x, ..., with up to BLOCK states: the operations of `state`, arranged to become vector code."""
    b = BLOCK
    if c[IS_HYPERBOLIC] == 0.0:
        for k in range(len(times)):
            elapsed, elapsed_low = two_sum(times[k], -c[TIME])
            a_re, a_im, b_re, b_im, o_re, o_im = circular_functions(c, elapsed, elapsed_low)
            x, y, z, w, wx, wy, wz = _attitude_and_omega(c, a_re, a_im, b_re, b_im, o_re, o_im)
            _keep(columns, k, times[k], x, y, z, w, wx, wy, wz)
    else:
        for k in range(len(times)):
            elapsed, elapsed_low = two_sum(times[k], -c[TIME])
            a_re, a_im, b_re, b_im, o_re, o_im = hyperbolic_functions(c, elapsed, elapsed_low)
            x, y, z, w, wx, wy, wz = _attitude_and_omega(c, a_re, a_im, b_re, b_im, o_re, o_im)
            _keep(columns, k, times[k], x, y, z, w, wx, wy, wz)
    for k in range(len(times)):
        columns[8 * b + k], columns[9 * b + k], columns[10 * b + k] = c[PIVOT], c[PIVOT + 1], c[PIVOT + 2]
        columns[11 * b + k], columns[12 * b + k], columns[13 * b + k] = 0.0, 0.0, 0.0


@compiled_inline
def _keep(columns, k, time, x, y, z, w, wx, wy, wz):
    b = BLOCK
    columns[k], columns[b + k], columns[2 * b + k], columns[3 * b + k], columns[4 * b + k] = time, x, y, z, w
    columns[5 * b + k], columns[6 * b + k], columns[7 * b + k] = wx, wy, wz


@compiled
def next_event(c, after):
    """Return the time of the first turning point of beta later than `after`, infinite if there is none, and the code 0."""
    if c[NUTATES] == 0.0:
        return math.inf, 0
    index = turning_index(c, after) - 1.0
    if not abs(index) < COUNTABLE:
        return math.inf, 0
    time = turning_time(c, index)
    while time <= after:
        index += 1.0
        if turning_time(c, index) == math.inf:
            return math.inf, 0
        time = turning_time(c, index)
    return time, 0


@compiled
def turning_index(c, time):
    """Return the number (a whole float) of the last turning point of beta at or before a time; even: lowest, odd: highest position of e3.

    The turning points in (t1, t2] are those after turning_index(t1) up to turning_index(t2). In steady precession the number never changes.
    """
    return math.floor(2.0 * (c[START] + c[RATE] * (time - c[TIME]))) + c[PARITY]


@compiled
def turning_time(c, index):
    """Return the time (s) of a turning point of beta by its number, infinite if the motion has no such one."""
    turns = 0.5 * (index - c[PARITY])
    if c[RATE] == 0.0 or (turns != 0.0 and c[STRETCH] >= NEVER):
        return math.inf
    return c[TIME] + (turns - c[START]) / c[RATE]


@compiled
def reaction(parameters, state, out):
    """Fill out, shape (3,), with the force of the pivot on the body (N, world axes): M (acceleration of the centre of mass + g z).

    There is no couple. c = h e3, c'' = h (omega' x e3 + omega x (omega x e3)), omega' by Euler's equations.
    """
    fx, fy, fz, fw = parameters[FRAME], parameters[FRAME + 1], parameters[FRAME + 2], parameters[FRAME + 3]
    x, y, z, w = multiply(state[1], state[2], state[3], state[4], fx, fy, fz, fw)
    omega_1, omega_2, omega_3 = rotate_back(fx, fy, fz, fw, state[5], state[6], state[7])
    gamma_1, gamma_2, _ = rotate_back(x, y, z, w, 0.0, 0.0, 1.0)
    rise_1 = parameters[EXCESS] * omega_2 * omega_3 + parameters[PULL] * gamma_2
    rise_2 = -parameters[EXCESS] * omega_1 * omega_3 - parameters[PULL] * gamma_1
    push = parameters[MASS] * parameters[ARM]
    force_x, force_y, force_z = rotate(x, y, z, w, push * (rise_2 + omega_1 * omega_3), push * (omega_2 * omega_3 - rise_1),
                                       -push * (omega_1 * omega_1 + omega_2 * omega_2))
    out[0], out[1], out[2] = force_x, force_y, force_z + parameters[MASS] * parameters[GRAVITY]
