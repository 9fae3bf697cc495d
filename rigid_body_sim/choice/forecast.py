# SPDX-License-Identifier: Apache-2.0
"""The expected error of a run: how errors go on in time, and until when an accuracy is met."""

import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.choice.comparison import lengths
from rigid_body_sim.choice.measured import makes_heat
from rigid_body_sim.mechanics.bounds import (
    angles_turned,
    drive,
    drives,
    pushed_unbounded,
    unbounded,
)
from rigid_body_sim.numerics.functions import log, power
from rigid_body_sim.scene.state import ANGULAR_VELOCITY

POWERS = 1.0, 2.0        # of the angle that a body turns: those with which errors grow


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


def later(scene, states, errors, longer):
    """Return the error (rad) at a time beyond a run, from its errors at looks.

    It grows in proportion to time, as the number of steps does, or to the angle that a body turns
    which heat slows. Where a drive makes a body turn ever faster, errors go with the angle that it
    turns, or with a power of it up to the square: then those of the momentum, which add up, turn
    the body. What the errors did in the second half of the run tells the power.

    Parameters
    ----------
    states : array (n, 14)
        The run, at looks.
    errors : array (n,)
        rad.
    longer : float
        The later time over that of the run, at least 1.
    """
    last = float(errors.max())
    if longer == 1.0:
        return last
    faster, so_far = _spin_up(scene, states)
    if faster == 0.0 or not 0.0 < last < math.inf:
        return last * turned_later(scene, states, longer)
    first = float(errors[:len(errors) // 2].max())
    grew = log(last / first) / log(so_far) if first > 0.0 else POWERS[1]
    angle = longer * (1.0 + faster * (longer - 1.0))
    return last * power(angle, min(max(grew, POWERS[0]), POWERS[1]))


def turned_later(scene, states, longer):
    """Return the angle that a body has turned by a later time over that at the end of a run.

    It grows in proportion to time, unless heat slows the body: then it goes on at the largest rate
    of the last quarter of the run. Where that is less than the one of the quarter before, and
    nothing keeps the body turning, each quarter of this length to come has the same share of the
    last.

    Parameters
    ----------
    states : array (n, 14)
        The run, at looks.
    longer : float
        The later time over that of the run, at least 1.
    """
    if longer == 1.0 or not makes_heat(scene):
        return longer
    rates = lengths(states[:, ANGULAR_VELOCITY])
    n = len(rates)
    before, last = float(rates[n // 2:3 * n // 4].max()), float(rates[3 * n // 4:].max())
    if not 0.0 < last < math.inf:
        return 1.0 if last == 0.0 else longer
    turned = np.empty(n)
    angles_turned(np.arange(1.0, n + 1.0), rates, math.inf, turned)
    yet = longer - 1.0
    if last < before and _comes_to_rest(scene):
        yet = min(yet, 0.25 * last / (before - last))
    # the first rate counts up to the first look, too
    return min(longer, 1.0 + yet * n * last / float(turned[-1] + rates[0]))


def _comes_to_rest(scene):
    """Return whether nothing pushes a body for ever; inner heat leaves it a rotation."""
    return (drives(scene)[-1][1] == 0.0 and not pushed_unbounded(scene)
            and scene.inner_dissipation == 0.0)


def _spin_up(scene, states):
    """Return how a drive makes a body turn faster.

    First the share of its last rate that a run adds, after the lesser growth of its last two
    quarters; then the factor by which rate times time, an angle, grew in its second half.
    """
    if drive(scene, None) == 0.0 and not unbounded(scene):
        return 0.0, 2.0
    rates = lengths(states[:, ANGULAR_VELOCITY])
    n = len(rates)
    half, quarter, last = (float(rates[:many].max()) for many in (n // 2, 3 * n // 4, n))
    if not 0.0 < half <= last < math.inf:
        return 0.0, 2.0
    return 4.0 * min(quarter - half, last - quarter) / last, 2.0 * last / half


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
