# SPDX-License-Identifier: Apache-2.0
"""What rounding does to a run: the rounding of the angle turned, and how a motion magnifies it.

A motion magnifies rounding errors, whatever method solves it. Moving the start shows by how much:
with G the derivative of the attitude by the start, and D half an ulp of each of its numbers,

    conditioning = |G D| (Frobenius) = sqrt(mean |G D s|^2) over signs s

which is estimated by finite differences along a few orthogonal rows of signs.
"""

import functools
import math

import numpy as np

from rigid_body_sim.choice import measured
from rigid_body_sim.choice.comparison import apart, lengths
from rigid_body_sim.choice.measured import HALF_ULP
from rigid_body_sim.choice.runs import LOOKS, looks, run
from rigid_body_sim.choice.trial_time import changes
from rigid_body_sim.mechanics.bounds import angles_turned, drive, swing_rate
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import matrix, normalised, rotate
from rigid_body_sim.numerics.vectors import apply, cross, scaled, transposed
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import (
    ANGULAR_VELOCITY,
    ORIENTATION,
    POSITION,
    STATE_SIZE,
    TIME,
    VELOCITY,
)

SIGNS = ((1, 1, 1, 1, 1, 1, 1), (1, -1, 1, -1, 1, -1, 1), (1, 1, -1, -1, 1, 1, -1),
         (1, -1, -1, 1, 1, -1, -1))
"""Rows of a Hadamard matrix of 8, for the four numbers of q and the three of omega."""
OF_Q, OF_OMEGA = slice(0, 4), slice(4, 7)
MOVED = (2.0 ** 23, 2.0 ** 10, 1.0)    # number of half ulps by which the start is moved
FAR = 2.0 ** 16          # half ulps of a move that tells magnification from the errors of steps
FARTHER = 2.0 ** 8       # factor by which it changes a run at least if the motion magnifies
AGAIN = 4.0 * HALF_ULP   # rad, rounding of the attitude at a strike
MANY = LOOKS            # strikes and jumps between looks: more are a torque that changes slowly
SLOWED = 0.5             # a run is looked at earlier where the rate falls below that share
BLOCK = 256              # bodies that run at once
LINEAR = 0.03            # rad: larger changes are no longer proportional to their cause


def of_angle_turned(scene, prototype, states, times):
    """Return half an ulp of all the angle that a body has turned at times, rad, shape (n,).

    At each moment it counts as turning as fast as it does then or will until the time. A rate that
    a torque adds counts twice, since the moment of inertia is rounded, too. One that torques or
    strikes take away again leaves its rounding, unless heat does away with it: it counts to the
    end. On a hinge the attitude is the product of that of the start and of a turn, each of them
    rounded.

    Parameters
    ----------
    prototype : Solver
        It runs again up to the first of the times if heat has made the body slow by then, and up
        to strikes and jumps of torques that no look tells of.
    states : array (n, 14)
        The run, at rising times (s).
    """
    start, heats = scene.initial.vector, measured.makes_heat(scene)
    first, pushed = hypot3(*start[ANGULAR_VELOCITY].tolist()), drive(scene, None) > 0.0
    unseen, found, rates = _unseen(scene, times), (), lengths(states[:, ANGULAR_VELOCITY])
    if rates[0] < SLOWED * first and heats:
        unseen = np.union1d(unseen, _early(first, float(times[0]))[1:])
    if len(unseen):
        found = lengths(run(scene, prototype, start, unseen)[:, ANGULAR_VELOCITY])
    when = np.concatenate((np.zeros(1), unseen, times))
    order = np.argsort(when, kind='stable')
    when, rates = when[order], np.concatenate(((first,), found, rates))[order]
    turned, left = np.empty((2, len(when)))
    angles_turned(when, rates, first if pushed else math.inf, turned)
    if (pushed or scene.strikes) and not heats:
        angles_turned(when, np.maximum.accumulate(rates), math.inf, left)
        turned = np.maximum(turned, left)
    return HALF_ULP * (_numbers(scene) + turned[order > len(unseen)])


def _unseen(scene, times):
    """Return when strikes are or torques jump, where the next of them comes before a look does.

    A body may be fast between the two, and at rest at all looks. Of more than MANY looks tell
    enough.

    Parameters
    ----------
    times : array (n,)
        Those of the looks, s.
    """
    found = np.array(changes(scene, float(times[-1])))
    looks_before = np.searchsorted(times, found)
    unseen = found[1:-1][looks_before[1:-1] == looks_before[2:]]
    return unseen if len(unseen) <= MANY else np.empty(0)


def angle_turned(scene, states, times):
    """Return a bound of the angle (rad) that a body turns in a run; NaN if the run is.

    Parameters
    ----------
    states : array (n, 14)
        The run, at rising times (s).
    """
    rates = np.concatenate((scene.initial.vector[None, ANGULAR_VELOCITY],
                            states[:, ANGULAR_VELOCITY]))
    turned = np.empty(len(rates))
    angles_turned(np.concatenate(((0.0,), times)), lengths(rates), math.inf, turned)
    return float(turned[-1])


def _early(rate, time):
    """Return 0 and times (s) before one: each twice the one before, but for the first radian."""
    times = [0.5 * time]
    while rate * times[-1] > 1.0:
        times.append(0.5 * times[-1])
    return np.array([*times, 0.0])[::-1]


def _turned(scene, many, starts, time):
    """Return the angles (rad) that bodies turn in a time (s) from their starts, shape (n,)."""
    rates = lengths(starts[:, ANGULAR_VELOCITY])
    later = looks(time)
    times = np.concatenate((_early(float(rates.max()), float(later[0])), later))
    out = np.empty((len(starts), len(times), STATE_SIZE))
    many(starts, starts[0, TIME] + times, out)
    turned, pushed = np.empty(len(times)), drive(scene, None) > 0.0
    found = np.empty(len(starts))
    for k, first in enumerate(rates.tolist()):
        angles_turned(times, lengths(out[k, :, ANGULAR_VELOCITY]),
                      first if pushed else math.inf, turned)
        found[k] = turned[-1]
    return found


def _numbers(scene):
    """Return how many rounded numbers of size 1 an attitude has."""
    return 4.0 if scene.constraint.axis is None else 8.0


def of_starts(scene, starts, time):
    """Return half an ulp of all the angle that bodies may turn from starts to a time, rad, (n,).

    Parameters
    ----------
    starts : array (n, 14)
    time : float
        s.
    """
    x, y, z = starts[:, ANGULAR_VELOCITY].T
    turned = np.sqrt(x * x + y * y + z * z)
    turned += swing_rate(scene)
    turned *= time
    turned += _numbers(scene) + 0.5 * drive(scene, None) * time * time
    turned *= HALF_ULP
    return turned


def of_bodies(scene, many, starts, time):
    """Return half an ulp of all the angle that bodies turn from starts to a time, rad, (n,).

    Bodies that heat may bring to rest run once more.

    Parameters
    ----------
    many : function
        ``many(starts, times, out)`` fills out with the states of bodies, as Choice.many.
    starts : array (n, 14)
    time : float
        s.
    """
    found = of_starts(scene, starts, time)
    if not measured.makes_heat(scene):
        return found
    for begin in np.unique(starts[starts[:, TIME] < time, TIME]):
        bodies = np.flatnonzero(starts[:, TIME] == begin)
        for k in range(0, len(bodies), BLOCK):
            part = bodies[k:k + BLOCK]
            turned = _turned(scene, many, starts[part], float(time - begin))
            found[part] = np.minimum(found[part], HALF_ULP * (_numbers(scene) + turned))
    return found


def conditioning(scene, prototype, times, states, enough=math.inf, start=None):
    """Return the change of the attitude by half an ulp on each number of the start, rad, (n,).

    Parameters
    ----------
    states : array (n, 14)
        The run from the start.
    enough : float, optional
        rad. It is given where the only question is whether the change reaches it. The start is
        then moved by half an ulp alone, and no more often than it takes to see that. A change that
        is no longer proportional to its cause counts as having reached it. One that a far larger
        move leaves as it is comes of other steps, whose errors it shows, and counts as none.
    start : array (14,), optional
        A state of the scene, whose strikes are over up to its time; else the scene's own start.
    """
    again = run
    if start is None:
        start = scene.initial.vector
    else:
        again = functools.partial(run, over=float(start[TIME]))
    found = np.full(len(times), math.inf)
    least = min(enough, LINEAR) if enough < math.inf else math.inf
    for many in MOVED if enough == math.inf else MOVED[-1:]:
        squares = np.zeros(len(times))
        for signs in SIGNS:
            moved = again(scene, prototype, _moved(scene, start, signs, many), times)
            change = apart(moved, states)
            squares += np.square(change)
            if squares.max() >= len(SIGNS) * least * least:
                moved = again(scene, prototype, _moved(scene, start, signs, FAR), times)
                far = float(apart(moved, states).max())
                if far < min(LINEAR, FARTHER * float(change.max())):
                    return np.zeros(len(times))
                return np.maximum(enough, np.sqrt(squares))
        change = np.sqrt(squares / len(SIGNS))
        small = np.maximum.accumulate(change) <= LINEAR
        found = np.where(small & (found == math.inf), change / many, found)
        if small.all():
            break
    return np.where(found == math.inf, change, found)


def lost(scene, prototype, times, states, enough=math.inf):
    """Return the error of the attitude of a run by rounding, rad, shape (n,).

    Each strike starts the motion anew, with roundings of its own, which grow from then on: squares
    add up.

    Parameters
    ----------
    states : array (n, 14)
        The run from the scene's own start.
    enough : float, optional
        rad. As in :func:`conditioning`.
    """
    found = of_angle_turned(scene, prototype, states, times)
    if not float(found.max()) >= enough:
        found = np.maximum(found, conditioning(scene, prototype, times, states, enough))
    squares = np.square(found)
    for strike in scene.strikes:
        since = 1.0 - max(strike.time, 0.0) / times
        squares += np.where(since >= 0.0, np.square(found * since) + AGAIN * AGAIN, 0.0)
    return np.sqrt(squares)


def _moved(scene, start, signs, many):
    """Return a start moved by so many half ulps of its numbers, with signs."""
    vector, by = start.copy(), HALF_ULP * many * np.array(signs, dtype=float)
    vector[ORIENTATION] = normalised(*(vector[ORIENTATION] + by[OF_Q]).tolist())
    if scene.constraint.axis is not None:
        vector[ANGULAR_VELOCITY] *= 1.0 + by[OF_OMEGA][0]    # the rotation stays along the hinge
    else:
        vector[ANGULAR_VELOCITY] += _rounded(scene, vector[ANGULAR_VELOCITY], by[OF_OMEGA])
    if scene.constraint.mechanism is Mechanism.PLANE:
        _keep_contact(scene, start, vector)
    return vector


def _keep_contact(scene, start, moved):
    """Give a moved start the gap and the velocity of the lowest point that the start has.

    A body that touches its plane, or rolls, would fall or slip else: a change of another kind,
    which is in no proportion to the move.
    """
    gap, slip = np.zeros(3), np.zeros(3)
    for sign, vector in (1.0, start), (-1.0, moved):
        q, omega = vector[ORIENTATION].tolist(), vector[ANGULAR_VELOCITY].tolist()
        arm = scene.constraint.touching(q, scene.body)
        gap += sign * np.array(scaled(scene.constraint.height(q, scene.body),
                                      scene.constraint.normal))
        slip += sign * np.array(rotate(*q, *cross(omega, arm)))
    moved[POSITION] += gap
    moved[VELOCITY] += slip


def _rounded(scene, omega, by):
    """Return what relative errors `by` of components along the principal axes do to a rate, rad/s.

    A component along a principal axis rounds with the products that it is the sum of. About an
    axis of zero moment nothing turns.
    """
    inertia = scene.constraint.inertia(scene.body)
    if tuple(inertia.axes) == IDENTITY:
        return by * np.abs(omega)
    axes = matrix(*inertia.axes)
    mixing = [[abs(entry) for entry in row] for row in transposed(axes)]
    sizes = apply(mixing, np.abs(omega).tolist())
    moved = [one * size if moment > 0.0 else 0.0
             for one, size, moment in zip(by.tolist(), sizes, inertia.moments, strict=True)]
    return np.array(apply(axes, moved))
