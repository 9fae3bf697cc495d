# SPDX-License-Identifier: Apache-2.0
"""Sweet spot: the two equations of motion of the notes, a uniform rod by hand, the erratum."""

import pytest
from near import near

from rigid_body_sim.theory import baseball_bat as theory

M, LENGTH, GYRATION = 0.9, 0.55, 0.2


@pytest.mark.parametrize('d', [0.0, 0.3, 0.6227, 0.8])
def test_both_equations_of_motion(d):
    """The equations M l phi'' = F - F_R and M (l^2 + a^2) phi'' = F d hold."""
    F = 12.0
    acceleration = theory.angular_acceleration(F, d, M, LENGTH, GYRATION)
    assert (M * LENGTH * acceleration
            == near(F * (1.0 - theory.reaction_ratio(d, LENGTH, GYRATION)), 1e-14))
    assert M * (LENGTH**2 + GYRATION**2) * acceleration == near(F * d, 1e-14)


def test_uniform_rod():
    """A rod of length 1.2 m held at its end has its sweet spot at two thirds.

    A blow at the tip pulls the hand forward by F/2.
    """
    length, gyration = 0.6, 1.2 / 12.0**0.5
    assert theory.center_of_percussion(length, gyration) == near(0.8, 1e-15)
    assert theory.reaction_ratio(0.8, length, gyration) == pytest.approx(0.0, abs=1e-15)
    assert theory.reaction_ratio(1.2, length, gyration) == near(-0.5, 1e-15)
    assert theory.reaction_ratio(0.0, length, gyration) == 1.0


def test_erratum():
    """With l'^2 = l^2 + a^2 the sweet spot of the rod would lie at 0.693 m.

    M l phi'' = F - F_R would not hold.
    """
    length, gyration = 0.6, 1.2 / 12.0**0.5
    assert theory.center_of_percussion_as_written(length, gyration) == near(0.48**0.5, 1e-15)
    ratio = theory.reaction_ratio_as_written(0.8, length, gyration)
    assert ratio == near(1.0 - 0.8 / 0.48**0.5, 1e-14)
    wrong = 1.0 - ratio
    assert abs(M * length * theory.angular_acceleration(1.0, 0.8, M, length, gyration)
               - wrong) > 0.1
