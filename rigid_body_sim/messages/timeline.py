# SPDX-License-Identifier: Apache-2.0
"""Instants of ticks in integer nanoseconds: origin + ticks / rate, exact for any number.

A rate is a double, hence a ratio of integers. All arithmetic is in integers, so nothing drifts:
the instant of tick k does not depend on the way there. Stamps are such instants, and so are the
deadlines of the tick thread.
"""

import math
from fractions import Fraction

NANOSECONDS = 1_000_000_000
ROUND_OFF = Fraction(1, 2**51)
"""Relative error of a product of two factors, each known to half an ulp."""


class Timeline:
    """Evenly spaced instants.

    Parameters
    ----------
    origin : int
        Instant of tick ``tick``, ns.
    rate : float or Fraction
        Ticks per second.
    tick : int
    """

    __slots__ = ('_double_period', '_rate_numerator', 'origin', 'rate', 'tick')

    def __init__(self, origin, rate, tick=0):
        self.origin, self.rate, self.tick = origin, Fraction(rate), tick
        self._rate_numerator = self.rate.numerator
        self._double_period = 2 * NANOSECONDS * self.rate.denominator

    def instant(self, tick):
        """Return the instant of a tick, ns, rounded to the nearest."""
        return self.origin + ((tick - self.tick) * self._double_period + self._rate_numerator) // (
            2 * self._rate_numerator)

    def instants(self, tick, count):
        """Return the instants of `count` ticks, of which `tick` is the first, ns."""
        first, period, divisor = tick - self.tick, self._double_period, 2 * self._rate_numerator
        origin, half = self.origin, self._rate_numerator
        return [origin + (k * period + half) // divisor for k in range(first, first + count)]

    def ticks_in(self, seconds):
        """Return the number of ticks after which at least `seconds` have passed.

        0.07 s at 100 Hz are 7 ticks, though the double is above 0.07.
        """
        exact = Fraction(seconds) * self.rate
        nearest = round(exact)
        return nearest if abs(exact - nearest) <= nearest * ROUND_OFF else math.ceil(exact)

    def from_tick(self, tick, rate):
        """Return the timeline that continues this one from a tick, at another rate."""
        return Timeline(self.instant(tick), rate, tick)


class Pace:
    """The ticks at which a topic with a rate of its own is due.

    It is due at the first tick at or after each of its instants.

    Parameters
    ----------
    rate, tick_rate : float
        Times due per second, and ticks per second. The topic is due at every tick if `rate` is
        the larger.
    """

    def __init__(self, rate: float, tick_rate: float):
        self._ratio = (Fraction(rate) / Fraction(tick_rate)).as_integer_ratio()

    def due(self, tick: int, count: int) -> list[int]:
        """Return the ticks at which the topic is due, among `count` ticks from `tick` on."""
        numerator, denominator = self._ratio
        return [k for k in range(tick, tick + count)
                if k * numerator // denominator > (k - 1) * numerator // denominator]
