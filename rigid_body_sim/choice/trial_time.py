# SPDX-License-Identifier: Apache-2.0
"""How long a trial of a scene is: to where the body has turned far, and what changes is seen."""

import math

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


def onset(scene):
    """Return the time (s) from which on something drives the body."""
    return min((effect.breakpoints[0] if effect.breakpoints else 0.0
                for effect in scene.acting
                if effect.bounds and effect.bounds(scene.body, scene.constraint).torque > 0.0),
               default=0.0)


def trial_time(changes, rate, acceleration, onset=0.0):
    """Return the length of a trial, s: until the body could have turned by RADIANS.

    It goes on to the last change, for that angle again, and at least to SEEN times the time of the
    change; but no further than the body could turn by LONGER times the angle.

    Parameters
    ----------
    changes : list of float
        As above.
    rate, acceleration : float
        Bounds, rad/s and rad/s^2.
    onset : float
        Time from which on the body accelerates, s.
    """
    most = LONGER * RADIANS
    if rate * onset < most:
        most = onset + _time(most - rate * onset, rate, acceleration)
    else:
        most /= rate
    last = changes[-1]
    return min(max(last + _time(RADIANS, rate, acceleration), SEEN * last), most)


def _time(angle, rate, acceleration):
    """Return the time (s) in which a body that accelerates turns by an angle (rad)."""
    fast = rate + hypot3(rate, math.sqrt(2.0 * acceleration * angle), 0.0)
    return 2.0 * angle / fast if fast else math.inf
