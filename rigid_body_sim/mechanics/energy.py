"""Energy and angular momentum of a state.

The point of reference is the centre of mass of a free body and of a sphere on a table, the fixed
point of a pivoted body, and the axis of a hinged one. Symbols: M mass, c centre of mass from the
body's origin (body axes), omega angular velocity (body axes), L angular momentum about the point of
reference (world axes), g acceleration of gravity (along -z of the world).
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.mechanics.parameters import (
    AXES,
    CENTER,
    FREE,
    GRAVITY,
    HINGE,
    HINGE_AXIS,
    HINGE_MOMENT,
    KIND,
    MASS,
    MOMENTS,
    TABLE,
)
from rigid_body_sim.numerics.rotations import rotate, rotate_back

# layout of what `diagnose` fills
KINETIC, POTENTIAL, MOMENTUM_SQUARED, MOMENTUM = 0, 1, 2, 3
DIAGNOSIS_SIZE = 6


@compiled
def angular_momentum(p, omega_x, omega_y, omega_z):
    """Return I omega in body axes, I about the point of reference."""
    if p[KIND] == HINGE:
        along = p[HINGE_MOMENT] * (p[HINGE_AXIS] * omega_x + p[HINGE_AXIS + 1] * omega_y + p[HINGE_AXIS + 2] * omega_z)
        return along * p[HINGE_AXIS], along * p[HINGE_AXIS + 1], along * p[HINGE_AXIS + 2]
    ax, ay, az, aw = p[AXES], p[AXES + 1], p[AXES + 2], p[AXES + 3]
    x, y, z = rotate_back(ax, ay, az, aw, omega_x, omega_y, omega_z)
    return rotate(ax, ay, az, aw, p[MOMENTS] * x, p[MOMENTS + 1] * y, p[MOMENTS + 2] * z)


@compiled
def diagnose(p, state, out):
    """Fill out with kinetic and potential energy (J), L^2 and L (world axes, kg m^2/s) of a state."""
    qx, qy, qz, qw = state[1], state[2], state[3], state[4]
    wx, wy, wz = state[5], state[6], state[7]
    mx, my, mz = angular_momentum(p, wx, wy, wz)
    kinetic = 0.5 * (mx * wx + my * wy + mz * wz)
    cx, cy, cz = p[CENTER], p[CENTER + 1], p[CENTER + 2]
    if p[KIND] == FREE or p[KIND] == TABLE:
        ux, uy, uz = rotate(qx, qy, qz, qw, wy * cz - wz * cy, wz * cx - wx * cz, wx * cy - wy * cx)
        vx, vy, vz = state[11] + ux, state[12] + uy, state[13] + uz
        kinetic += 0.5 * p[MASS] * (vx * vx + vy * vy + vz * vz)
    potential = 0.0
    if p[GRAVITY] != 0.0:
        _, _, height = rotate(qx, qy, qz, qw, cx, cy, cz)
        potential = p[MASS] * p[GRAVITY] * (state[10] + height)
    out[KINETIC] = kinetic
    out[POTENTIAL] = potential
    # of the body components: the turn to the world would only add its rounding
    out[MOMENTUM_SQUARED] = mx * mx + my * my + mz * mz
    out[MOMENTUM], out[MOMENTUM + 1], out[MOMENTUM + 2] = rotate(qx, qy, qz, qw, mx, my, mz)


@compiled
def diagnose_many(p, states, out):
    """Fill out, shape (n, 6), for states of shape (n, 14)."""
    for k in range(len(states)):
        diagnose(p, states[k], out[k])
