# SPDX-License-Identifier: Apache-2.0
"""The ball's formulas against each other, hand numbers, and the erratum."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.theory import billiard as theory

BALL = {'a': 0.03, 'mu': 0.25, 'g': 9.8}


def rolls(t, v0, h):
    return (theory.sliding_speed(t, v0, h, **BALL)
            - BALL['a'] * theory.sliding_spin(t, v0, h, **BALL))


@pytest.mark.parametrize('h', [-0.025, -0.01, 0.0, 0.006, 0.02, 0.03])
def test_at_the_onset_the_ball_rolls_at_the_final_speed(h):
    onset = theory.onset_of_rolling(2.0, h, **BALL)
    assert rolls(onset, 2.0, h) == pytest.approx(0.0, abs=1e-14)
    assert abs(rolls(0.5 * onset, 2.0, h)) > 0.1
    assert theory.sliding_speed(onset, 2.0, h, **BALL) == near(
        theory.rolling_speed(2.0, h, BALL['a']), 1e-14)


def test_hand_numbers():
    """v0 = 2 m/s, mu g = 2.45 m/s^2 at the centre: 4/17.15 s, 10/7 m/s, and 24/84.035 ... m.

    The distance is 12 v0^2/(49 mu g).
    """
    onset = theory.onset_of_rolling(2.0, 0.0, **BALL)
    assert onset == near(4.0 / 17.15, 1e-15)
    assert theory.rolling_speed(2.0, 0.0, 0.03) == near(10.0 / 7.0, 1e-15)
    assert theory.sliding_distance(onset, 2.0, 0.0, **BALL) == near(48.0 / (49.0 * 2.45), 1e-15)
    assert theory.spin_after_strike(2.0, 0.03, 0.03) == near(5.0 / 0.03, 1e-15)


def test_below_two_fifths_the_notes_are_right():
    for h in (-0.02, 0.0, 0.011):
        notes = 2.0 * 2.0 / (7.0 * 2.45) * (1.0 - 2.5 * h / 0.03)
        assert theory.onset_of_rolling(2.0, h, **BALL) == near(notes, 1e-14)


def test_natural_roll():
    h = theory.height_of_natural_roll(0.03)
    assert theory.onset_of_rolling(2.0, h, **BALL) == pytest.approx(0.0, abs=1e-15)
    assert 0.03 * theory.spin_after_strike(2.0, h, 0.03) == near(2.0, 1e-15)
    assert theory.friction_direction(np.array([0.0, 0.02, h]), 0.03).tolist() == [-1.0, 1.0, 0.0]


def test_erratum_above_two_fifths():
    """As written the ball would roll seven times later.

    By then the slip of the formulas above is far on the other side.
    """
    right, written = (theory.onset_of_rolling(2.0, 0.02, **BALL),
                      theory.onset_of_rolling_above_as_written(2.0, 0.02, **BALL))
    assert written == near(7.0 * right, 1e-14)
    assert rolls(right, 2.0, 0.02) == pytest.approx(0.0, abs=1e-14)
    assert abs(rolls(written, 2.0, 0.02)) > 5.0
