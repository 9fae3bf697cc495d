# SPDX-License-Identifier: Apache-2.0
"""The expected error of a run: trial runs with strikes, and the magnification of rounding.

A motion magnifies rounding errors, whatever method solves it. Moving the start shows by how much:
with G the derivative of the attitude by the start, and D half an ulp of each of its numbers,

    conditioning = |G D| (Frobenius) = sqrt(mean |G D s|^2) over signs s

which is estimated by finite differences along a few orthogonal rows of signs.
"""

import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.choice.measured import HALF_ULP
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.integrators.solver import FINEST
from rigid_body_sim.mechanics import impulse
from rigid_body_sim.mechanics.bounds import drive
from rigid_body_sim.mechanics.energy import DIAGNOSIS
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.numerics.functions import hypot3, log, power
from rigid_body_sim.numerics.rotations import angles_between, matrix, normalised
from rigid_body_sim.numerics.vectors import apply, transposed
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, STATE_SIZE, VELOCITY

LOOKS = 64               # times at which runs are compared
SIGNS = ((1, 1, 1, 1, 1, 1, 1), (1, -1, 1, -1, 1, -1, 1), (1, 1, -1, -1, 1, 1, -1),
         (1, -1, -1, 1, 1, -1, -1))
"""Rows of a Hadamard matrix of 8, for the four numbers of q and the three of omega."""
OF_Q, OF_OMEGA = slice(0, 4), slice(4, 7)
MOVED = (2.0 ** 23, 2.0 ** 10, 1.0)    # number of half ulps by which the start is moved
FAR = 2.0 ** 16          # half ulps of a move that tells magnification from the errors of steps
FARTHER = 2.0 ** 8       # factor by which it changes a run at least if the motion magnifies
AGAIN = 4.0 * HALF_ULP   # rad, rounding of the attitude at a strike
FINER = 2.0 ** -7        # share of a tolerance: that of the finer run, which tells the error
POWERS = 1.0, 2.0        # of the angle that a body turns: those with which errors grow
LINEAR = 0.03            # rad: larger changes are no longer proportional to their cause


class Forecast(NamedTuple):
    """The expected error of a run.

    Attributes
    ----------
    error : float
        Largest error of the attitude within the horizon, rad.
    met_until : float
        Time until which the accuracy asked is met, s: the horizon if it is met throughout, else
        the last time at which it was seen to be met.
    """

    error: float
    met_until: float


def missed(accuracy, horizon, expected, met_until):
    """Return one line that says that an accuracy is missed, and until when it is met; else None.

    Parameters
    ----------
    accuracy : float
        Asked for, rad.
    horizon : float
        s.
    expected : float or None
        Error within the horizon, rad, where it is known.
    met_until : float or None
        s, where it is known.
    """
    if expected is None or expected <= accuracy:
        return None
    until = ''
    if met_until is not None:
        until = (f'; it is met until {met_until:.3g} s' if met_until > 0.0
                 else '; it is met at no time')
    figures = (f'{expected:.{places}e}' for places in range(1, 18))
    shown = next(figure for figure in figures if not float(figure) <= accuracy)
    return (f'the accuracy asked, {accuracy:g} rad, is missed: the error expected within '
            f'{horizon:g} s is {shown} rad{until}')


def looks(time):
    """Return the times (s) up to one at which runs are compared, shape (LOOKS,)."""
    return time * (np.arange(1, LOOKS + 1) / LOOKS)


def run(scene, prototype, vector, times, allowances=None):
    """Return the states at rising times (s), shape (n, 14), with the strikes of the scene.

    They are NaN where the run did not converge.

    Parameters
    ----------
    prototype : Solver
    vector : array (14,)
        The start.
    allowances : list, optional
        What solvers have allowed themselves (Solver.allowance) is appended to it.

    Raises
    ------
    TooMuchWork
    """
    def allowed(solver, until):
        found = solver.allowance(until)
        if found and allowances is not None:
            allowances.append(found)

    out = np.full((len(times), STATE_SIZE), math.nan)
    try:
        solver, first = prototype.start(vector), 0
        for strike in strikes(scene):
            if strike.time > times[-1]:
                break
            last = int(np.searchsorted(times, strike.time))
            solver.states(times[first:last], out[first:last])
            struck, first = prototype.start(_struck(scene, strike, solver)), last
            allowed(solver, strike.time)
            solver = struck
        solver.states(times[first:], out[first:])
        allowed(solver, float(times[-1]))
    except TooMuchWork:
        raise
    except NotConverged:
        out[:] = math.nan
    return out


def strikes(scene):
    """Return the strikes of a scene in the order of their times."""
    struck = (effect for effect in scene.effects if effect.as_impulse is not None)
    return sorted(struck, key=lambda effect: effect.time)


def _struck(scene, strike, solver):
    """Return the state just after a strike."""
    vector = np.empty(STATE_SIZE)
    solver.state(max(strike.time, 0.0), vector)
    return _pushed(scene, strike, vector)


def _pushed(scene, strike, vector):
    impulse.push(parameters(scene), vector, *strike.as_impulse(scene.body, vector),
                 np.zeros(ENTRIES_SIZE))
    return vector


def struck_rate(scene):
    """Return approximately what the strikes of a scene add to the rate of its body (rad/s)."""
    total, start = 0.0, scene.initial.vector
    for strike in strikes(scene):
        after = _pushed(scene, strike, start.copy())[ANGULAR_VELOCITY]
        total += hypot3(*(after - start[ANGULAR_VELOCITY]).tolist())
    return total


def apart(states, others):
    """Return the angles between the attitudes of two runs (rad), shape (n,); infinite for NaN."""
    angles = np.empty(len(states))
    angles_between(states[:, ORIENTATION], others[:, ORIENTATION], angles)
    return np.where(np.isnan(angles), math.inf, angles)


def momenta_apart(scene, states, others):
    """Return the differences of the angular momenta of two runs, shape (n,); infinite for NaN.

    They are relative to the largest momentum so far.
    """
    found = []
    for vectors in (states, others):
        out = np.empty((len(vectors), DIAGNOSIS.size))
        energies(scene).diagnose_many(parameters(scene), vectors, out)
        found.append(out[:, DIAGNOSIS.part('momentum').places])
    return _shares(*found)


def velocities_apart(states, others):
    """Return the differences of the velocities of two runs, shape (n,); infinite for NaN.

    They are relative to the largest speed so far.
    """
    return _shares(states[:, VELOCITY], others[:, VELOCITY])


def rates_apart(states, others):
    """Return the differences of the angular velocities of two runs, shape (n,), as above."""
    return _shares(states[:, ANGULAR_VELOCITY], others[:, ANGULAR_VELOCITY])


def _shares(one, other):
    """Return the lengths of differences as shares of the largest length so far, shape (n,)."""
    sizes, apart = np.maximum.accumulate(_lengths(one)), _lengths(one - other)
    shares = np.divide(apart, sizes, out=np.zeros(len(apart)), where=sizes > 0.0)
    return np.where(np.isnan(apart) | np.isnan(sizes), math.inf, shares)


def _lengths(vectors):
    """Return the lengths of vectors (n, 3), shape (n,); NaN where a component is not finite."""
    sizes = np.abs(vectors).max(axis=1)
    x, y, z = np.divide(vectors.T, sizes, out=np.zeros((3, len(vectors))), where=sizes != 0.0)
    return sizes * np.sqrt(x * x + y * y + z * z)


def rounding(scene, states, times):
    """Return half an ulp of all the angle that a body has turned at times, rad, shape (n,).

    A rate that a torque adds counts twice, since the moment of inertia is rounded, too. On a hinge
    the attitude is the product of that of the start and of a turn, each of them rounded.
    """
    rates = [hypot3(*omega) for omega in states[:, ANGULAR_VELOCITY].tolist()]
    fastest = np.maximum.accumulate(rates)
    if drive(scene, None) > 0.0:
        first = hypot3(*scene.initial.vector[ANGULAR_VELOCITY].tolist())
        fastest = fastest + np.maximum(0.0, fastest - first)
    numbers = 4.0 if scene.constraint.axis is None else 8.0
    return HALF_ULP * (numbers + fastest * times)


def later(scene, states, errors, longer):
    """Return the error (rad) at a time beyond a run, from its errors at looks.

    It grows in proportion to time. Where a drive makes a body turn ever faster, errors go with the
    angle that it turns, or with a power of it up to the square: then those of the momentum, which
    add up, turn the body. What the errors did in the second half of the run tells the power.

    Parameters
    ----------
    states : array (LOOKS, 14)
        The run, at looks.
    errors : array (LOOKS,)
        rad.
    longer : float
        The later time over that of the run, at least 1.
    """
    last = float(errors.max())
    faster, so_far = _spin_up(scene, states)
    if faster == 0.0 or not 0.0 < last < math.inf:
        return last * longer
    first = float(errors[:LOOKS // 2].max())
    grew = log(last / first) / log(so_far) if first > 0.0 else POWERS[1]
    angle = longer * (1.0 + faster * (longer - 1.0))
    return last * power(angle, min(max(grew, POWERS[0]), POWERS[1]))


def _spin_up(scene, states):
    """Return how a drive makes a body turn faster.

    First the share of its last rate that a run adds, after the lesser growth of its last two
    quarters; then the factor by which rate times time, an angle, grew in its second half.
    """
    if drive(scene, None) == 0.0:
        return 0.0, 2.0
    rates = [hypot3(*omega) for omega in states[:, ANGULAR_VELOCITY].tolist()]
    half, quarter, last = (max(rates[:many]) for many in (LOOKS // 2, 3 * LOOKS // 4, LOOKS))
    if not 0.0 < half <= last < math.inf:
        return 0.0, 2.0
    return 4.0 * min(quarter - half, last - quarter) / last, 2.0 * last / half


def conditioning(scene, prototype, times, states, enough=math.inf):
    """Return the change of the attitude by half an ulp on each number of the start, rad, (n,).

    Parameters
    ----------
    states : array (n, 14)
        The run from the scene's own start.
    enough : float, optional
        rad. It is given where the only question is whether the change reaches it. The start is
        then moved by half an ulp alone, and no more often than it takes to see that. A change that
        is no longer proportional to its cause counts as having reached it. One that a far larger
        move leaves as it is comes of other steps, whose errors it shows, and counts as none.
    """
    start, found = scene.initial.vector, np.full(len(times), math.inf)
    least = min(enough, LINEAR) if enough < math.inf else math.inf
    for many in MOVED if enough == math.inf else MOVED[-1:]:
        squares = np.zeros(len(times))
        for signs in SIGNS:
            moved = run(scene, prototype, _moved(scene, start, signs, many), times)
            change = apart(moved, states)
            squares += np.square(change)
            if squares.max() >= len(SIGNS) * least * least:
                moved = run(scene, prototype, _moved(scene, start, signs, FAR), times)
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
    found = rounding(scene, states, times)
    if not float(found.max()) >= enough:
        found = np.maximum(found, conditioning(scene, prototype, times, states, enough))
    squares = np.square(found)
    for strike in strikes(scene):
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
    return vector


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


def forecast(errors, times, accuracy, horizon, last=None):
    """Return the Forecast that follows from errors at times.

    Beyond the last of the times the error is taken to grow evenly.

    Parameters
    ----------
    errors, times : array (n,)
    accuracy : float
        rad.
    horizon : float
        s.
    last : float, optional
        The error at the horizon, rad; else it grows in proportion to time.
    """
    errors = np.maximum.accumulate(errors)
    seen, end = float(errors[-1]), float(times[-1])
    error = seen * max(1.0, horizon / end) if last is None else max(seen, last)
    if error <= accuracy:
        return Forecast(error, horizon)
    k = int(np.searchsorted(errors, accuracy, side='right'))    # errors[k] is too large
    if k == 0:    # in proportion to time before the first look
        return Forecast(error, float(times[0]) * accuracy / float(errors[0]))
    if k < len(errors):
        return Forecast(error, float(times[k - 1]))
    return Forecast(error, end + (horizon - end) * (accuracy - seen) / (error - seen))


class _Continued:
    """A closed form, and the method that goes on from states from which it does not hold."""

    def __init__(self, exact, general):
        self._exact, self._general = exact, general

    def start(self, vector):
        """Return a solver from a state vector."""
        return (self._exact if self._exact.takes(vector) else self._general).start(vector)


def of_exact(scene, prototype, own, accuracy, horizon, general):
    """Return the Forecast of a motion in closed form.

    Its error is magnified rounding, plus `own` (rad, at the horizon) if it is the closed form of a
    scene that is nearly this one, plus that of the general method after a strike that ends the
    closed form.

    Parameters
    ----------
    prototype : Exact
    own, accuracy : float
        rad.
    horizon : float
        s.
    general : function
        ``general(accuracy)`` returns the Stepped that goes on where the closed form does not hold.
    """
    times, start, errors = looks(horizon), scene.initial.vector, 0.0
    if prototype.motion.takes is not None and strikes(scene):
        finer = run(scene, _Continued(prototype, general(max(FINEST, FINER * accuracy))), start,
                    times)
        prototype = _Continued(prototype, general(accuracy))
        states = run(scene, prototype, start, times)
        errors = apart(states, finer)
    else:
        states = run(scene, prototype, start, times)
    errors = errors + lost(scene, prototype, times, states)
    return forecast(errors + own * (times / horizon), times, accuracy, horizon)
