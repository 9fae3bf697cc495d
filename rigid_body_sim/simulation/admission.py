"""What is no command, and what a body cannot take: each command of a tick is tried on what those before it leave of the state."""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled_allocating
from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.impulse import EXCHANGE_SIZE, WORK, apply_impulse
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, STATE_SIZE
from rigid_body_sim.simulation.command_rows import AXES, BODY, FORCE, FRAMES, IMPULSE, KIND, TORQUE

LARGEST_WORK = 1e250
"""Work (J) of all impulses of a tick, and of what is held within it: energies stay far below what a double holds."""
LARGEST_TURN = 1e7
"""Angle (rad) through which a held wrench may turn the body within a tick: beyond, a tick would take minutes."""

TAKEN, NOT_FINITE, NOT_SOLVABLE, TOO_MUCH_WORK, TOO_FAST = range(5)
"""Verdicts on a command."""

# layout of what the impulses of a tick add up to: force, torque (world axes), work
SUM_FORCE, SUM_TORQUE, SUM_WORK = slice(0, 3), slice(3, 6), 6
SUM_SIZE = 7
_F, _T, _Q, _W = FORCE.start, TORQUE.start, ORIENTATION.start, ANGULAR_VELOCITY.start


def well_formed(force, torque, frame, what):
    """Return the row (command_rows.py) without its kind of a force and a torque; BadInput if they or the frame are none."""
    force, torque = tuple(map(float, force)), tuple(map(float, torque))
    if (len(force), len(torque)) != (3, 3) or not all(map(math.isfinite, force + torque)):
        raise BadInput(what, f'got force {list(force)}, torque {list(torque)}', 'three finite numbers each')
    if frame not in FRAMES:
        raise BadInput(what, f'got frame {frame!r}', "'world' or 'body'")
    return (FRAMES.index(frame), *force, *torque)


@compiled_allocating
def take(p, rate, start, rows, left, sums, verdicts, amounts):
    """Add up the impulses of a tick, and find what is held from it on, each command tried on what those before it leave of the state.

    Parameters
    ----------
    p : array
        Of mechanics/parameters.py.
    rate : float
        Ticks per second: what is held is tried as what it gives in a tick.
    start : array (14,)
        The state at the tick before its first command; commands in body axes turn with its attitude, so that opposite ones cancel.
    rows : array (n, 8)
        See command_rows.py.
    left : array (14,)
        The state that the impulses so far leave, and sums, shape (7,), what they add up to; both are changed in place.
    verdicts, amounts : array (n,)
        Filled with what becomes of each command, and with what is too much: J or rad.

    Returns
    -------
    int, int
        Place of the last row that holds or releases, -1 if there is none; how many are not taken.
    """
    last, taken = -1, 0
    force, torque, after, exchange = np.empty(3), np.empty(3), np.empty(STATE_SIZE), np.empty(EXCHANGE_SIZE)
    for k in range(len(rows)):
        row = rows[k]
        impulse = row[KIND] == IMPULSE
        fx, fy, fz, tx, ty, tz = row[_F], row[_F + 1], row[_F + 2], row[_T], row[_T + 1], row[_T + 2]
        acts, finite = False, True
        for j in range(_F, _T + 3):
            acts = acts or row[j] != 0.0
            finite = finite and math.isfinite(row[j])
        if row[AXES] == BODY:
            fx, fy, fz = rotate(start[_Q], start[_Q + 1], start[_Q + 2], start[_Q + 3], fx, fy, fz)
            tx, ty, tz = rotate(start[_Q], start[_Q + 1], start[_Q + 2], start[_Q + 3], tx, ty, tz)
        share = 1.0 if impulse else rate
        force[0], force[1], force[2] = fx / share, fy / share, fz / share
        torque[0], torque[1], torque[2] = tx / share, ty / share, tz / share
        for j in range(STATE_SIZE):
            after[j] = left[j]
        solvable = apply_impulse(p, after, force, torque, exchange)
        work = exchange[WORK]
        turn = max(abs(after[_W]), abs(after[_W + 1]), abs(after[_W + 2])) / rate
        verdicts[k], amounts[k] = TAKEN, 0.0
        if not finite:
            verdicts[k] = NOT_FINITE
        elif not solvable:
            verdicts[k] = NOT_SOLVABLE
        elif not max(abs(work), abs(sums[SUM_WORK] + work)) <= LARGEST_WORK:
            verdicts[k], amounts[k] = TOO_MUCH_WORK, work
        elif impulse:
            sums[0], sums[1], sums[2] = sums[0] + fx, sums[1] + fy, sums[2] + fz
            sums[3], sums[4], sums[5] = sums[3] + tx, sums[4] + ty, sums[5] + tz
            sums[SUM_WORK] += work
            taken += 1
            for j in range(STATE_SIZE):
                left[j] = after[j]
        elif acts and turn > LARGEST_TURN:
            verdicts[k], amounts[k] = TOO_FAST, turn
        else:
            last = k
            taken += 1
    return last, len(rows) - taken


def refusal(verdict, amount, row, attitude):
    """Return the BadInput that says why a command is not taken."""
    what = 'impulse' if row[KIND] == IMPULSE else 'wrench'
    force, torque = row[FORCE].tolist(), row[TORQUE].tolist()
    if verdict == NOT_FINITE:
        return BadInput(what, f'got force {force}, torque {torque}', 'three finite numbers each')
    if row[AXES] == BODY:
        force, torque = list(rotate(*attitude, *force)), list(rotate(*attitude, *torque))
    if verdict == NOT_SOLVABLE:
        return BadInput(what, f'torque {torque} (world axes) about an axis of zero moment',
                        'leave that component 0: an axis without moment takes no angular momentum')
    if verdict == TOO_MUCH_WORK:
        return BadInput(what, f'force {force}, torque {torque} would do a work of {amount!r} J',
                        f'at most {LARGEST_WORK:g} J in a tick: energies are doubles')
    return BadInput(what, f'torque {torque} would turn the body by {amount:.3g} rad within a tick',
                    f'at most {LARGEST_TURN:g} rad: hold less, or give it as an impulse')
