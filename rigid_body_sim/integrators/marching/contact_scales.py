# SPDX-License-Identifier: Apache-2.0
"""The lengths and speeds beside which rounding at a contact is judged."""

import math

from rigid_body_sim.integrators.equations.contact_views import ROW, UNKNOWNS
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.functions import hypot3, power

ROUNDING = 2.0 ** -47    # of gap, slip and normal velocity, relative to lengths and speeds
CREEPS = 1e-4            # share of the speeds, times the cube root of the accuracy
LARGEST_CREEP = 1e-7
OMEGA, U = (UNKNOWNS.part(name).places for name in ('omega', 'u'))
LEVER = ROW.part('lever').places


class Scales:
    """The scales of one course.

    Attributes
    ----------
    length : float
        Of the body: from its centre of mass to the plane, and its size, m.
    heaviness : float
        Acceleration beside which rounding is judged, m/s^2.
    creep : float
        Share of the speeds below which a slip relaxes at a rate of its own.
    """

    def __init__(self, length, heaviness, accuracy):
        self.length, self.heaviness = length, heaviness
        self.creep = min(LARGEST_CREEP, CREEPS * power(accuracy, 1.0 / 3.0))

    def speed(self, y):
        """Return a speed beside which rounding is judged, m/s."""
        rate = hypot3(*y[OMEGA].tolist())
        return (hypot3(*y[U].tolist()) + rate * self.length
                + math.sqrt(self.heaviness * self.length))

    def rounding(self, y):
        """Return the rounding of a velocity at the contact, m/s."""
        return ROUNDING * self.speed(y)


def length_of(p, rates, y, row):
    """Return a length of the body: from its centre of mass to the plane, and its size, m."""
    rates.rate(p, y, row)
    lever = hypot3(*row[LEVER].tolist())
    return max(lever, max(map(abs, p[CONTACT.part('size').places])))
