# SPDX-License-Identifier: Apache-2.0
"""Free precession of the Earth, were it rigid (notes, "Chandler wobble").

Symbols: ellipticity (I3 - I1)/I1 = 1/305, omega = 2 pi per sidereal day, lambda angle between
omega and the axis of figure.
"""

SIDEREAL_DAY = 86164.0905  # s
SOLAR_DAY = 86400.0  # s
ELLIPTICITY = 1.0 / 305.0
OBSERVED_PERIOD = 435.0  # days; the Earth is not rigid


def period_in_sidereal_days(ellipticity=ELLIPTICITY):
    """Return the period of the wobble, 1/ellipticity = 305 sidereal days."""
    return 1.0 / ellipticity


def period_in_solar_days(ellipticity=ELLIPTICITY):
    """Return the period in days of 86400 s, 304.2."""
    return period_in_sidereal_days(ellipticity) * SIDEREAL_DAY / SOLAR_DAY


def period_in_sidereal_days_as_written(ellipticity=ELLIPTICITY):
    """Return 2 pi/Omega with Omega = omega3 (I3 - I1)/I3, as written in the section before.

    It is I3/(I3 - I1) = 306 sidereal days.
    """
    return (1.0 + ellipticity) / ellipticity


def wobble_angle(offset, radius):
    """Return lambda = (few metres)/R_Earth, rad.

    `offset` (m) is the distance of the rotation pole from the pole of figure, `radius` (m) that
    of the Earth.
    """
    return offset / radius
