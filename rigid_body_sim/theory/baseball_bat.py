# SPDX-License-Identifier: Apache-2.0
"""Sweet spot of a bat held at one end (notes, "Baseball bat sweet spot").

Symbols: M mass (kg), l (`length`) distance from the hand to the centre of mass (m), a radius of
gyration about the centre of mass (m), l' = l + a^2/l, d distance from the hand to where the ball
hits (m), F force of the ball (N), F_R force of the hand (N), both across the bat and F_R positive
against F. Over the short blow the same formulas hold for their impulses (N s).

Errata: the brace under the formula for phi'' reads l'^2 = l^2 + a^2; it is l l'.
"""

import numpy as np


def center_of_percussion(length, a):
    """Return d = l' = l + a^2/l, where a blow leaves no reaction at the hand, m."""
    return length + a**2 / length


def center_of_percussion_as_written(length, a):
    """Return the l' of the notes' brace, sqrt(l^2 + a^2), m."""
    return np.sqrt(length**2 + a**2)


def angular_acceleration(F, d, M, length, a):
    """Return phi'' = F d/(M (l^2 + a^2)), rad/s^2.

    With an impulse for F it is the change of phi' (rad/s).
    """
    return F * d / (M * (length**2 + a**2))


def reaction_ratio(d, length, a):
    """Return F_R/F = 1 - d/l'."""
    return 1.0 - d / center_of_percussion(length, a)


def reaction_ratio_as_written(d, length, a):
    """Return 1 - d/l' with the l' of the notes' brace."""
    return 1.0 - d / center_of_percussion_as_written(length, a)
