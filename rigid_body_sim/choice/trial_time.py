# SPDX-License-Identifier: Apache-2.0
"""How long a trial of a scene is: to where the body has turned far, and what changes is seen."""

import math
from itertools import pairwise

from rigid_body_sim.numerics.functions import hypot3

RADIANS = 2e4
"""Largest angle that a trial run turns over, rad: some 10 ms."""
LONGER = 10.0    # times that: up to there a trial goes on to a change, or until heat slows a body
SEEN = 1.25      # times the time of the last change: so far a trial goes at least


def changes(scene, horizon):
    """Return 0 and the times (s) before the horizon at which strikes are or torques jump."""
    times = [strike.time for strike in scene.strikes]
    times += [time for effect in scene.acting for time in effect.breakpoints]
    return [0.0, *sorted(time for time in times if 0.0 < time < horizon)]


def trial_time(changes, rate, drives):
    """Return the length of a trial, s: until the body could have turned by RADIANS.

    It goes on to the last change, for that angle again, and at least to SEEN times the time of the
    change; but no further than the body could turn by LONGER times the angle.

    Parameters
    ----------
    changes : list of float
        As above.
    rate : float
        Bound of the rate at the start, rad/s.
    drives : list of (float, float)
        Of the acceleration, as mechanics.bounds.drives has it.
    """
    last, most = changes[-1], _reached(LONGER * RADIANS, rate, drives)
    if not last < most:
        return most
    own = _reached(turned_by(last, rate, drives) + RADIANS, rate, drives)
    return min(max(own, SEEN * last), most)


def turned_by(time, rate, drives):
    """Return the angle (rad) that a body turns at most up to a time (s)."""
    angle = 0.0
    for (begin, push), (end, _) in pairwise([*drives, (math.inf, 0.0)]):
        part = min(end, time) - begin
        if part <= 0.0:
            break
        angle += (rate + 0.5 * push * part) * part
        rate += push * part
    return angle


def _reached(angle, rate, drives):
    """Return the time (s) at which a body could have turned by an angle (rad)."""
    for (begin, push), (end, _) in pairwise([*drives, (math.inf, 0.0)]):
        fast = rate + hypot3(rate, math.sqrt(2.0 * push * angle), 0.0)
        own = 2.0 * angle / fast if fast else math.inf
        if own <= end - begin:
            break
        part = end - begin
        angle = max(0.0, angle - (rate + 0.5 * push * part) * part)
        rate += push * part
    return begin + own
