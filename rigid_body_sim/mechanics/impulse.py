"""What an impulse does to a state: only the free directions move, the rest is reaction.

The point of reference is the centre of mass of a free body and of a sphere on a table, the fixed
point of a pivoted body, and the axis of a hinged one. Symbols: M mass, c centre of mass from the
body's origin (body axes), omega angular velocity (body axes), L angular momentum about the point of
reference (world axes), g acceleration of gravity (along -z of the world).
"""

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_allocating
from rigid_body_sim.mechanics import exchange as ledger
from rigid_body_sim.mechanics.parameters import (
    AXES,
    CENTER,
    FREE,
    HINGE,
    HINGE_AXIS,
    HINGE_MOMENT,
    KIND,
    MASS,
    MOMENTS,
    PIVOT,
    TABLE,
    THROUGH,
)
from rigid_body_sim.numerics.rotations import rotate, rotate_back

# layout of what `apply_impulse` fills beside the state
WORK, ANGULAR_IMPULSE, REACTION_FORCE, REACTION_COUPLE = 0, 1, 4, 7
EXCHANGE_SIZE = 10
GIVEN_WORK, GIVEN_IMPULSE = ledger.WORK, ledger.ANGULAR_IMPULSE.start    # of what `push` adds to


@compiled
def apply_impulse(p, state, force, couple, exchange):
    """Change a state by an impulse: only the free directions move, the rest is reaction.

    Parameters
    ----------
    state : array (14,)
        Changed in place.
    force : array (3,)
        Impulse of force (N s) at the centre of mass, world axes.
    couple : array (3,)
        Impulse of torque (N m s), world axes.
    exchange : array (10,)
        Filled with the work done (J), the angular impulse about the point of reference (world axes), and the impulse of the reaction:
        force (N s) and couple (N m s) at the fixed point, at `through` of a hinge, at the contact with the table.

    Returns
    -------
    bool
        False if there is a torque about an axis of zero moment, beyond its rounding; nothing comes of that part.
    """
    kind = p[KIND]
    qx, qy, qz, qw = state[1], state[2], state[3], state[4]
    fx, fy, fz = rotate_back(qx, qy, qz, qw, force[0], force[1], force[2])
    tx, ty, tz = rotate_back(qx, qy, qz, qw, couple[0], couple[1], couple[2])
    rx, ry, rz = 0.0, 0.0, 0.0
    if kind == PIVOT:
        rx, ry, rz = p[CENTER], p[CENTER + 1], p[CENTER + 2]
    elif kind == HINGE:
        rx, ry, rz = p[CENTER] - p[THROUGH], p[CENTER + 1] - p[THROUGH + 1], p[CENTER + 2] - p[THROUGH + 2]
    tx, ty, tz = tx + ry * fz - rz * fy, ty + rz * fx - rx * fz, tz + rx * fy - ry * fx
    solvable = True
    if kind == HINGE:
        nx, ny, nz = p[HINGE_AXIS], p[HINGE_AXIS + 1], p[HINGE_AXIS + 2]
        free = nx * tx + ny * ty + nz * tz
        dx, dy, dz = free / p[HINGE_MOMENT] * nx, free / p[HINGE_MOMENT] * ny, free / p[HINGE_MOMENT] * nz
        gx, gy, gz = free * nx, free * ny, free * nz
    else:
        solvable, dx, dy, dz = _rate_of(p, tx, ty, tz)
        gx, gy, gz = tx, ty, tz
    cx, cy, cz = p[CENTER], p[CENTER + 1], p[CENTER + 2]
    ox, oy, oz = state[5], state[6], state[7]
    # the work of an impulse goes with the mean of the velocities before and after
    wx, wy, wz = ox + 0.5 * dx, oy + 0.5 * dy, oz + 0.5 * dz
    exchange[WORK] = gx * wx + gy * wy + gz * wz
    for k in range(6):
        exchange[REACTION_FORCE + k] = 0.0
    state[5], state[6], state[7] = ox + dx, oy + dy, oz + dz
    if kind in (FREE, TABLE):
        jz = force[2] if kind == FREE else 0.0
        ux, uy, uz = rotate(qx, qy, qz, qw, oy * cz - oz * cy, oz * cx - ox * cz, ox * cy - oy * cx)
        half = 0.5 / p[MASS]
        exchange[WORK] += (force[0] * (state[11] + ux + half * force[0]) + force[1] * (state[12] + uy + half * force[1])
                           + jz * (state[13] + uz + half * jz))
        # the origin moves with the centre of mass, less what the change of rotation adds between them
        ux, uy, uz = rotate(qx, qy, qz, qw, dy * cz - dz * cy, dz * cx - dx * cz, dx * cy - dy * cx)
        state[11] += force[0] / p[MASS] - ux
        state[12] += force[1] / p[MASS] - uy
        state[13] += jz / p[MASS] - uz
        exchange[REACTION_FORCE + 2] = jz - force[2]
    else:
        # the centre of mass gains dw x r: what the impulse does not supply of that comes from the bearing
        ax, ay, az = rotate(qx, qy, qz, qw, dy * rz - dz * ry, dz * rx - dx * rz, dx * ry - dy * rx)
        exchange[REACTION_FORCE] = p[MASS] * ax - force[0]
        exchange[REACTION_FORCE + 1] = p[MASS] * ay - force[1]
        exchange[REACTION_FORCE + 2] = p[MASS] * az - force[2]
        if kind == HINGE:
            _hinge_couple(p, state, dx, dy, dz, tx, ty, tz, rx, ry, rz, exchange)
            hx, hy, hz = p[THROUGH], p[THROUGH + 1], p[THROUGH + 2]
            ux, uy, uz = rotate(qx, qy, qz, qw, dy * hz - dz * hy, dz * hx - dx * hz, dx * hy - dy * hx)
            state[11], state[12], state[13] = state[11] - ux, state[12] - uy, state[13] - uz
    exchange[ANGULAR_IMPULSE], exchange[ANGULAR_IMPULSE + 1], exchange[ANGULAR_IMPULSE + 2] = rotate(qx, qy, qz, qw, gx, gy, gz)
    return solvable


@compiled_allocating
def push(p, state, force, couple, given):
    """Change a state by an impulse as `apply_impulse` does, and what was exchanged with the body so far, `given` (exchange.py), by it.

    Returns
    -------
    bool, float
        What `apply_impulse` returned, and the work (J).
    """
    if not (force[0] != 0.0 or force[1] != 0.0 or force[2] != 0.0 or couple[0] != 0.0 or couple[1] != 0.0 or couple[2] != 0.0):
        return True, 0.0
    exchange = np.empty(EXCHANGE_SIZE)
    solvable = apply_impulse(p, state, force, couple, exchange)
    add_exchange(exchange, given)
    return solvable, exchange[WORK]


@compiled
def add_exchange(exchange, given):
    """Add the work and the angular impulse of an impulse to what was exchanged with the body so far."""
    given[GIVEN_WORK] += exchange[WORK]
    for k in range(3):
        given[GIVEN_IMPULSE + k] += exchange[ANGULAR_IMPULSE + k]


@compiled
def _rate_of(p, mx, my, mz):
    """Return whether m has no part along an axis of zero moment, and I^-1 m of the rest in body axes."""
    ax, ay, az, aw = p[AXES], p[AXES + 1], p[AXES + 2], p[AXES + 3]
    along = rotate_back(ax, ay, az, aw, mx, my, mz)
    # what turning to the world and back leaves along the axis: 1e-15 of it, 3e-15 of the moment of a force (300,000 random ones)
    slack = 1e-14 * (abs(mx) + abs(my) + abs(mz))
    solvable = (_turns(p[MOMENTS], along[0], slack) and _turns(p[MOMENTS + 1], along[1], slack)
                and _turns(p[MOMENTS + 2], along[2], slack))
    x, y, z = rotate(ax, ay, az, aw, _quotient(along[0], p[MOMENTS]), _quotient(along[1], p[MOMENTS + 1]), _quotient(along[2], p[MOMENTS + 2]))
    return solvable, x, y, z


@compiled
def _turns(moment, m, slack):
    """Return whether a momentum m belongs to some rotation about an axis of that moment."""
    return moment > 0.0 or abs(m) <= slack


@compiled
def _quotient(m, moment):
    return m / moment if moment > 0.0 else 0.0


@compiled
def _hinge_couple(p, state, dx, dy, dz, tx, ty, tz, rx, ry, rz, exchange):
    """Fill the impulse of the bearing's couple at `through`: change of the whole angular momentum there less the torque given."""
    ax, ay, az, aw = p[AXES], p[AXES + 1], p[AXES + 2], p[AXES + 3]
    x, y, z = rotate_back(ax, ay, az, aw, dx, dy, dz)
    lx, ly, lz = rotate(ax, ay, az, aw, p[MOMENTS] * x, p[MOMENTS + 1] * y, p[MOMENTS + 2] * z)
    ux, uy, uz = dy * rz - dz * ry, dz * rx - dx * rz, dx * ry - dy * rx
    lx += p[MASS] * (ry * uz - rz * uy)
    ly += p[MASS] * (rz * ux - rx * uz)
    lz += p[MASS] * (rx * uy - ry * ux)
    cx, cy, cz = rotate(state[1], state[2], state[3], state[4], lx - tx, ly - ty, lz - tz)
    exchange[REACTION_COUPLE], exchange[REACTION_COUPLE + 1], exchange[REACTION_COUPLE + 2] = cx, cy, cz
