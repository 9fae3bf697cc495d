# SPDX-License-Identifier: Apache-2.0
"""The truth of a scene with kinks: each copy of the start by itself, from kink to kink."""

import math

import numpy as np

from random_scenes.laws import Laws
from random_scenes.truth import MOVED, TOLERANCE, Truth
from random_scenes.wide import WIDE

SHARE = 0.3              # rad, of a step
DELTA = WIDE(1e-6)       # share of a step after which the slope of a switch is seen
DIPS = 4                 # looks for the lowest point of a switch within a step
SECANTS, HALVINGS = 80, 80
WORDS = 'abs(', 'sign(', 'min(', 'max(', 'where(', '<', 'dry_friction'
"""What a scene's text has where it has kinks."""


class Kinked:
    """Copies of a scene's body, each with its own times of kinks."""

    floor = Truth.floor

    def __init__(self, scene, settings, parameters, motion=None, most=math.inf, moved=MOVED):
        base = Truth(scene, settings, parameters, motion, most, moved)
        self.moved = moved
        self._copies = [_Copy(base, row, parameters) for row in range(len(base.y))]

    def to(self, time):
        """Go on to a time."""
        for one in self._copies:
            one.to(time)

    @property
    def jumped(self):
        """See Truth."""
        return self._copies[0].jumped

    @property
    def turned(self):
        """See Truth."""
        return self._copies[0].turned

    @property
    def rate(self):
        """See Truth."""
        return self._copies[0].rate

    @property
    def y(self):
        """The unknowns of all copies."""
        return np.concatenate([one.y for one in self._copies])


class _Copy(Truth):
    def __init__(self, base, row, parameters):
        vars(self).update(vars(base))
        self.y, self.struck = base.y[row:row + 1].copy(), set()
        self.laws = Laws(base.effects, parameters, self)
        self._fastest = parameters['w0']

    def _march(self, end):
        sides, h = self.laws.sides, end - self.t
        sides.modes = []
        self.rates(self.y, self.t)
        if self.laws.friction is not None and not self.y[0, 4:7].any():
            self._break_loose()
        while self.t < end:
            if self.laws.friction is not None and sides.modes[self.laws.friction] == 0:
                self.t = self._torn_loose(WIDE(end))
                if self.t < end:
                    sides.modes[self.laws.friction] = 1 if self._pull(self.t) > 0 else -1
                    h = WIDE(SHARE / self._fastest) / 4
                continue
            y, k = self.y, self.rates(self.y, self.t)
            rate, growth = (math.sqrt(float((one[0, 4:7] ** 2).sum())) for one in (y, k))
            pace = max(rate + math.sqrt(growth), self._fastest)
            h = min(2 * h, WIDE(SHARE / pace), end - self.t)
            after, error = self._extrapolated(y, k, h)
            while error > TOLERANCE and h > 1e-9:
                h = h / 2
                after, error = self._extrapolated(y, k, h)
            dip = self._dip(y, k, after, h)
            while dip:    # a switch changes twice within the step, and once up to there
                h = dip
                after, _ = self._extrapolated(y, k, h)
                dip = self._dip(y, k, after, h)
            changed = self._changed(after, h)
            if changed:
                h, which = min((self._crossing(y, k, h, n), n) for n in changed)
                after, _ = self._extrapolated(y, k, h)
            self._go(after, h, end)
            if changed:
                before = self._wound()
                for passed in {which, *self._changed(after, 0)}:    # a kink may be met twice
                    sides.modes[passed] *= -1
                self.jumped += self._wound() - before
                if which == self.laws.friction:
                    self.y[:, 4:7] = 0
                    self._break_loose()
                h = WIDE(SHARE / pace) / 4

    def _wound(self):
        """Return the energy of torsion springs, J."""
        self.rates(self.y, self.t)
        return self.laws.wound

    def _changed(self, y, h):
        """Return the kinks that are passed at unknowns after a step."""
        sides = self.laws.sides
        self.rates(y, self.t + h)
        return [n for n, (mode, value) in enumerate(zip(sides.modes, sides.found, strict=True))
                if mode * value < 0]

    def _dip(self, y, k, after, h):
        """Return a time within the step h at which a switch has changed, back at the end; or None.

        It falls at first and rises at the end: a cubic through values and slopes tells where it
        is lowest.
        """
        first, last = self._switches(y, self.t, h), self._switches(after, self.t + h, h)
        for n, (one, other) in enumerate(zip(first, last, strict=True)):
            low, high = (WIDE(0), *one), (h, *other)
            for _ in range(DIPS):
                if not (low[2] < 0 < high[2] and high[1] > 0):
                    break
                part = _lowest(low, high)
                middle, _ = self._extrapolated(y, k, part)
                here = (part, *self._switches(middle, self.t + part, h)[n])
                if here[1] < 0:
                    return part
                low, high = (here, high) if here[2] < 0 else (low, here)
        return None

    def _switches(self, y, t, h):
        """Return value and slope (1/s) of each switch, above 0 on its side."""
        sides, later = self.laws.sides, DELTA * h
        k, values = self.rates(y, t), sides.found
        self.rates(y + later * k, t + later)
        return [(mode * one, mode * (other - one) / later) for mode, one, other in zip(
            sides.modes, values, sides.found, strict=True)]

    def _crossing(self, y, k, h, which):
        """Return the time after which a kink is met, within the step h."""
        sides = self.laws.sides

        def switch(part):
            self.rates(self._extrapolated(y, k, part)[0], self.t + part)
            return sides.modes[which] * sides.found[which]
        low, high, last = WIDE(0), h, 0
        self.rates(y, self.t)
        at_low, at_high = abs(sides.found[which]), switch(h)
        for _ in range(SECANTS):
            part = (low * at_high - high * at_low) / (at_high - at_low)
            if not low < part < high:
                part = (low + high) / 2
            if not low < part < high or high - low < WIDE(1e-19) * (self.t + h):
                break
            value = switch(part)
            if value > 0:
                low, at_low = part, value
                at_high = at_high / 2 if last > 0 else at_high
            else:
                high, at_high = part, value
                at_low = at_low / 2 if last < 0 else at_low
            last = 1 if value > 0 else -1
        return high

    def _break_loose(self):
        """Say on which side of dry friction a body at rest goes on: 0 where it is held."""
        sides, place = self.laws.sides, self.laws.friction
        sides.modes[place] = 0
        pull = self._pull(self.t)
        if abs(pull) > self.laws.grip:
            sides.modes[place] = 1 if pull > 0 else -1

    def _pull(self, t):
        """Return the torque along the axis at a time, without friction, of a body at rest, N m."""
        return (self.rates(self.y, t)[0, 4:7] @ self.axis) * self.about[0]

    def _torn_loose(self, end):
        """Return when what acts outgrows the grip of friction on a body at rest, at most an end.

        What lasts for less than a look is passed over.
        """
        low, grip = self.t, self.laws.grip
        while low < end:
            high = min(low + WIDE(SHARE / self._fastest), end)
            if abs(self._pull(high)) > grip:
                for _ in range(HALVINGS):
                    middle = (low + high) / 2
                    low, high = ((low, middle) if abs(self._pull(middle)) > grip
                                 else (middle, high))
                return high
            low = high
        return end


def _lowest(low, high):
    """Return where the cubic through two (place, value, slope) is lowest: it falls, then rises."""
    (a, f, down), (b, g, up) = low, high
    h = b - a
    chord = 3 * (g - f) / h
    # slope: down + 2 u (chord - 2 down - up) + 3 u^2 (down + up - 2 chord/3), u from 0 to 1
    half, square = chord - 2 * down - up, 3 * (down + up) - 2 * chord
    root = np.sqrt(half * half - square * down)
    return a + h * min(max(-down / (half + root), WIDE(0.01)), WIDE(0.99))
