# SPDX-License-Identifier: Apache-2.0
"""What dry rolling friction lets a body do when a phase begins: be held, tip, or roll a way."""

import math

import numpy as np

from rigid_body_sim.integrators.equations.contact_rest import (
    about_tube,
    grows,
    jams,
    lies,
    pause,
    rolls,
    tipping,
    withheld,
)
from rigid_body_sim.integrators.equations.contact_views import (
    FLIGHT,
    RESTING,
    ROW,
    UNKNOWNS,
    WATCHED,
)
from rigid_body_sim.integrators.marching.contact_scales import ROUNDING
from rigid_body_sim.mechanics.contact.holding import way_out
from rigid_body_sim.mechanics.contact.parameters import CONTACT, HELD, SLOW, TIPS
from rigid_body_sim.mechanics.contact.touch import inclination
from rigid_body_sim.numerics.rotations import matrix, normalised

ENDED = 1e-10            # share of the speeds below which a rolling is over that no step follows
TIE = 1e-12              # share of what friction can hold: so much beyond it is rounding
SHORT = 1e-6             # time of a difference, over that in which a body moves by its length
MODE, SWIFT, DRY, ONSET, TURN, SINCE, SLACK, RIM = (CONTACT.part(name).first for name in (
    'mode', 'swift', 'rolling', 'onset', 'turn', 'since', 'slack', 'rim'))
WAY = CONTACT.part('way').places
SIZE, TIME = UNKNOWNS.size, UNKNOWNS.part('time').first
Q = UNKNOWNS.part('q').places
PACE = ROW.part('pace').first
NORMAL, ROLLS = WATCHED.part('normal').first, WATCHED.part('rolling').first


class DryRolling:
    """Dry rolling friction on one course.

    Parameters
    ----------
    bound : contact.OnPlane
        The body and its rates.
    scales : contact_scales.Scales
    error : float
        What a direction of rolling may err by.

    Attributes
    ----------
    allowed : tuple of 2 floats
        Error beyond that which it allows itself, rad, and the time of the unknowns from which on,
        s; infinite if never.
    """

    def __init__(self, bound, scales, error):
        self._rates, self._scales, self._error = bound.rates, scales, error
        self._is_disk, self._is_torus = bound.is_disk, bound.is_torus
        self.allowed = 0.0, math.inf

    def begin(self, p, y, stopped, tipped=False, released=False):
        """Note whether dry rolling friction holds the body from here on, or which way it rolls.

        A rolling that ends does so at a time rounded to doubles: `stopped` says that what is left
        of it is rounding, however large. `tipped` says that friction along the ring of a torus has
        just ended a tipping: where it has rolled no further than rounding, it rolls both ways.
        `released` says that friction has just ceased to hold the body, and not by rounding.
        """
        p[WAY], p[ONSET], p[TURN], p[SLACK], p[RIM] = (1.0, 0.0), 0.0, 0.0, 0.0, 0.0
        if not p[DRY] > 0.0 or p[MODE] in (FLIGHT, RESTING):
            return
        p[SWIFT] = swift = self._scales.speed(y)
        disk, torus, speed = self._is_disk, self._is_torus, rolls(p, y)
        if lies(p, y) and disk:
            # the lowest point runs along the rim of a flat disk at any speed that rounding gives
            stopped = stopped or abs(tipping(p, y)[1]) * self._scales.length <= ROUNDING * swift
        if stopped or abs(speed) <= (ROUNDING if disk else 2.0 * SLOW) * swift:
            pause(p, y)
            p[WAY], row = HELD, np.empty(ROW.size)
            self._rates.rate(p, y, row)
            if not released and abs(row[ROLLS]) <= TIE * p[DRY] * row[NORMAL]:
                p[SLACK] = 2.0 * TIE
                return
            if row[ROLLS] >= 0.0:
                return
            speed, across = withheld(p, y, row)
            tips = torus and not tipped and self._tips(p, y, about_tube(p, y, speed, across))
            if not disk and not tips:
                self._begin_to_roll(p, y, speed, across)
        elif torus:
            self._tips(p, y, tipping(p, y)[0])
        if disk:
            p[WAY] = math.copysign(1.0, speed), 0.0

    def _tips(self, p, y, speed):
        """Note, and return, whether friction lets a low torus tip only; `speed` has its sign."""
        about, along = tipping(p, y)
        if abs(along) * self._scales.length > ROUNDING * p[SWIFT] + self._error * abs(about):
            return False
        way, p[RIM] = tuple(p[WAY].tolist()), self._error
        p[WAY], row = (math.copysign(1.0, speed), 0.0), np.empty(ROW.size)
        pause(p, y)
        self._rates.rate(p, y, row)
        if not row[ROLLS] > 0.0:
            p[WAY], p[RIM] = way, 0.0
        return p[RIM] > 0.0

    def goes_on_tipping(self, p, y):
        """Return whether a torus whose friction along the ring no step follows tips only."""
        if not p[DRY] > 0.0 or not self._is_torus or p[RIM] > 0.0:
            return False
        if self._error < TIPS:
            self._error = TIPS
            self._allow(TIPS, y)
        return self._tips(p, y, tipping(p, y)[0])

    def has_ended(self, p, y):
        """Return whether a rolling that no step follows further has ended.

        Its direction relaxes ever faster as it dies, at last within the rounding of time.
        """
        return p[DRY] > 0.0 and p[MODE] not in (FLIGHT, RESTING) and not is_held(p) and (
            not self._is_disk and rolls(p, y) <= ENDED * p[SWIFT])

    def jams(self, p, y):
        """Return whether a ring lies so low that rolling friction leaves it no motion.

        It errs by its inclination from here on, since it would come to lie flat.
        """
        if not jams(p, y):
            return False
        self._allow(inclination(matrix(*y[Q].tolist())[2]), y)
        return True

    def _allow(self, error, y):
        before, since = self.allowed
        self.allowed = max(error, before), min(float(y[TIME]), since)

    def _begin_to_roll(self, p, y, x, z):
        """Set the way in which a body begins to roll that a force (x, z) would hold.

        How it turns is a finite difference.
        """
        p[ONSET], p[SINCE] = self._scales.creep * p[SWIFT], y[TIME]

        def way_from(y, x, z):
            return way_out(lambda x, z: self._growth(p, y, x, z), x, z)

        x, z = way = way_from(y, x, z)
        row = np.empty(ROW.size)
        p[WAY] = way
        self._rates.rate(p, y, row)
        short = SHORT * self._scales.length / p[SWIFT]
        later = y + short / row[PACE] * row[:SIZE]
        later[Q] = normalised(*later[Q].tolist())
        a, b = way_from(later, x, z)
        p[WAY], p[TURN] = way, (x * b - z * a) / short

    def _growth(self, p, y, x, z):
        """Return how a rolling grows from 0 under the friction against a direction."""
        p[WAY], row = (x, z), np.empty(ROW.size)
        self._rates.rate(p, y, row)
        return grows(p, y, row)


def is_held(p):
    """Return whether dry friction holds the rolling of a body."""
    return tuple(p[WAY].tolist()) == HELD
