# SPDX-License-Identifier: Apache-2.0
"""Admission of commands: the one place that decides if the body takes one, and applies it.

The impulses of a tick are added before they act, so opposite ones cancel to the last bit. Each
command is tried with the sum of those before it: the body's state after the sum is computed once
for each command, and the state after the last impulse taken is the state from which the motion
goes on.
"""

import math
import operator
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_allocating
from rigid_body_sim.compilation.layout import Vector, layout
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.mechanics.impulse import RESPONSE_SIZE, WORK, apply_impulse
from rigid_body_sim.mechanics.parameters import SCENE
from rigid_body_sim.numerics.pair_vectors import difference, less, turned, with_low
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.numerics.vectors import plus, scaled
from rigid_body_sim.scene.state import ORIENTATION, STATE, STATE_SIZE
from rigid_body_sim.simulation.command_rows import (
    AXES,
    BODY,
    FORCE,
    IMPULSE,
    KIND,
    NAMES,
    TORQUE,
    not_three_numbers,
)

LARGEST_WORK = 1e250
"""Largest work (J) of a tick's impulses, and of a wrench in a tick: energies are doubles."""
LARGEST_TURN = 1e7
"""Largest angle (rad) of a held wrench within a tick: beyond it, a tick takes minutes."""

TAKEN, NOT_FINITE, NOT_SOLVABLE, TOO_MUCH_WORK, TOO_FAST = range(5)
"""Verdicts on a command."""
SCENE_REFUSES = 'the scene refuses commands'
REASONS = ('', 'not finite', 'the body cannot take it', 'too large', 'the body cannot take it')
"""The reason of each verdict, as events and diagnostics name it."""
ZERO = (0.0, 0.0, 0.0)
_F, _END = FORCE.start, TORQUE.stop
load_moments = SCENE.part('moments').load
load_q, load_omega = STATE.part('orientation').load, STATE.part('angular_velocity').load


class Push(NamedTuple):
    """Force and torque of a command (N and N m, or N s and N m s)."""

    force: Vector
    torque: Vector


class InPairs(NamedTuple):
    """Impulses of force and torque, and what rounding took from each (N s and N m s)."""

    force: Vector
    of_force: Vector
    torque: Vector
    of_torque: Vector


SUMS = layout(InPairs)
SUMS_SIZE, _LOST, _SECOND = SUMS.size, SUMS.part('of_force').first, SUMS.part('torque').first
load_push, load_sums, store_sums = layout(Push).load, SUMS.load, SUMS.store


class Refusal(NamedTuple):
    """A command that is not taken and has no effect.

    Attributes
    ----------
    place : int
        Its row.
    reason : str
        In words: SCENE_REFUSES or one of REASONS.
    error : BadInput
        What is wrong, with the numbers, and what would be right.
    """

    place: int
    reason: str
    error: BadInput


class Given(NamedTuple):
    """What the commands of one tick amount to so far, filled by :func:`admit`.

    Attributes
    ----------
    start : array (14,)
        The state at the tick before its first command. Commands in body axes turn with this
        attitude.
    sums : array (12,)
        Force (N s) and torque (N m s) of all impulses, world axes, each followed by three numbers
        that say what rounding took from it.
    after : array (14,)
        The state after the sums.
    response : array (10,)
        The Response to the sums (mechanics/impulse.py).
    """

    start: np.ndarray
    sums: np.ndarray
    after: np.ndarray
    response: np.ndarray

    @classmethod
    def at(cls, vector: np.ndarray) -> 'Given':
        """Return the Given of no commands at a state (14,)."""
        return cls(vector.copy(), np.zeros(SUMS_SIZE), vector.copy(), np.zeros(RESPONSE_SIZE))

    def copy(self) -> 'Given':
        """Return a Given with arrays of its own."""
        return Given(*(part.copy() for part in self))

    @property
    def any_impulse(self) -> bool:
        """Whether the impulses do not cancel."""
        sums = load_sums(self.sums)
        return any(map(operator.add, (*sums.force, *sums.torque),
                       (*sums.of_force, *sums.of_torque)))


@compiled_allocating
def admit(p, rate, rows, start, sums, after, response, verdicts, amounts):
    """Take the commands of a tick, in their order.

    More than eight arguments: compiled code is handed the arrays of a Given one by one.
    More than forty lines: the verdicts share one trial.

    Parameters
    ----------
    p : array
        See mechanics/parameters.py.
    rate : float
        Ticks per second: a held wrench is tried as the impulse that it gives in a tick.
    rows : array (n, 8)
        See command_rows.py.
    start, sums, after, response : array
        Of a Given; the last three are changed in place.
    verdicts, amounts : array (n,)
        Filled with the verdict on each command, and with the amount that is too large: J or rad.

    Returns
    -------
    int, int
        Row of the last command that holds or releases, -1 if there is none; number of refused
        commands.
    """
    last, taken = -1, 0
    alone, total = np.empty(SUMS_SIZE), np.empty(SUMS_SIZE)
    trial, trial_response = np.empty(STATE_SIZE), np.empty(RESPONSE_SIZE)
    I1, I2, I3 = load_moments(p)
    some_do_not_turn = I1 == 0.0 or I2 == 0.0 or I3 == 0.0
    for k in range(len(rows)):
        row = rows[k]
        impulse = row[KIND] == IMPULSE
        acts, finite = False, True
        for j in range(_F, _END):
            acts = acts or row[j] != 0.0
            finite = finite and math.isfinite(row[j])
        _to_world(row, start, 1.0 if impulse else rate, alone)
        solvable = True
        if some_do_not_turn:
            # asked of the command alone: in a sum that nearly cancels, rounding looks like a
            # torque
            solvable = _apply(p, start, alone, trial, trial_response)
        _add(sums, alone, total)
        _apply(p, start, total, trial, trial_response)
        work = trial_response[WORK]
        wx, wy, wz = load_omega(trial)
        turn = max(abs(wx), abs(wy), abs(wz)) / rate
        verdicts[k], amounts[k] = TAKEN, 0.0
        if not finite:
            verdicts[k] = NOT_FINITE
        elif not solvable:
            verdicts[k] = NOT_SOLVABLE
        elif not abs(work) <= LARGEST_WORK:
            verdicts[k], amounts[k] = TOO_MUCH_WORK, work
        elif impulse:
            taken += 1
            for j in range(SUMS_SIZE):
                sums[j] = total[j]
            for j in range(STATE_SIZE):
                after[j] = trial[j]
            for j in range(RESPONSE_SIZE):
                response[j] = trial_response[j]
        elif acts and turn > LARGEST_TURN:
            verdicts[k], amounts[k] = TOO_FAST, turn
        else:
            last = k
            taken += 1
    return last, len(rows) - taken


@compiled
def _to_world(row, start, share, out):
    """Fill out with force and torque of a row divided by `share`.

    It has shape (12,), as `sums` of Given. What rounding takes is known of an impulse, whose
    share is 1.
    """
    q, (force, torque) = load_q(start), load_push(row, _F)
    lost, of_torque = ZERO, ZERO
    if row[AXES] == BODY:
        given, of_body = with_low(force, ZERO), with_low(torque, ZERO)
        force, torque = rotate(*q, *force), rotate(*q, *torque)
        if share == 1.0:
            lost, of_torque = less(turned(*q, given), force), less(turned(*q, of_body), torque)
    (fx, fy, fz), (tx, ty, tz) = force, torque
    store_sums(out, InPairs((fx / share, fy / share, fz / share), lost,
                             (tx / share, ty / share, tz / share), of_torque))


@compiled
def _add(one, other, out):
    """Fill out, shape (12,), with the sum of two arrays as `sums` of Given."""
    a, b = load_sums(one), load_sums(other)
    store_sums(out, InPairs(*_sum(a.force, a.of_force, b.force, b.of_force),
                             *_sum(a.torque, a.of_torque, b.torque, b.of_torque)))


@compiled
def _sum(a, lost_of_a, b, lost_of_b):
    """Return a + b of two vectors, and what rounding takes from it."""
    total, rounding = plus(a, b), difference(a, scaled(-1.0, b))
    return total, plus(less(rounding, total), plus(lost_of_a, lost_of_b))


@compiled
def _apply(p, start, given, after, response):
    """Fill `after` and `response` with what an impulse (12,) does; return if it is possible."""
    for j in range(len(start)):
        after[j] = start[j]
    for j in range(len(response)):
        response[j] = 0.0
    some = False
    for j in range(3):
        some = some or given[j] + given[_LOST + j] != 0.0 or (
            given[_SECOND + j] + given[_SECOND + _LOST + j] != 0.0)
    return not some or apply_impulse(p, after, given[:_SECOND], given[_SECOND:], response)


def scene_refuses(scene_name: str, count: int) -> list[Refusal]:
    """Return the refusals of commands to a scene that takes none."""
    error = BadInput(
        'command',
        f'the scene {scene_name} refuses commands',
        'its key `commands` says so; set commands: accept',
    )
    return [Refusal(place, SCENE_REFUSES, error) for place in range(count)]


def no_motion_follows(row: np.ndarray, error: NotConverged) -> Refusal:
    """Return the Refusal of one command at whose own tick the motion would end."""
    problem = BadInput(NAMES[int(row[KIND])], f'no motion follows it: {error}',
                       'another command, or this one at another time')
    return Refusal(0, REASONS[NOT_SOLVABLE], problem)


def refusals(
    verdicts: np.ndarray, amounts: np.ndarray, rows: np.ndarray, start: np.ndarray
) -> list[Refusal]:
    """Return the Refusal of each row that :func:`admit` did not take."""
    attitude = start[ORIENTATION].tolist()
    return [
        Refusal(
            place,
            REASONS[verdicts[place]],
            _error(verdicts[place], amounts.item(place), rows[place], attitude),
        )
        for place in np.flatnonzero(verdicts).tolist()
    ]


def _error(verdict, amount, row, attitude):
    """Return the BadInput that says why a command is not taken."""
    kind, force, torque = int(row[KIND]), row[FORCE].tolist(), row[TORQUE].tolist()
    if verdict == NOT_FINITE:
        return not_three_numbers(kind, force, torque)
    if row[AXES] == BODY:
        force, torque = list(rotate(*attitude, *force)), list(rotate(*attitude, *torque))
    if verdict == NOT_SOLVABLE:
        return BadInput(
            NAMES[kind],
            f'torque {torque} (world axes) about an axis of zero moment',
            'leave that component 0: an axis without moment takes no angular momentum',
        )
    if verdict == TOO_MUCH_WORK:
        return BadInput(
            NAMES[kind],
            f'force {force}, torque {torque} would do a work of {amount!r} J',
            f'at most {LARGEST_WORK:g} J in a tick: energies are doubles',
        )
    return BadInput(
        NAMES[kind],
        f'torque {torque} would turn the body by {amount:.3g} rad within a tick',
        f'at most {LARGEST_TURN:g} rad: hold less, or give it as an impulse',
    )
