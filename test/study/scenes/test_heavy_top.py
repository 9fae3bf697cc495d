# SPDX-License-Identifier: Apache-2.0
"""The heavy top's window of differentiation and its search for an extreme, on made-up motions."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.study.scenes import heavy_top


def turning(omega, beta=0.5):
    """Return an experiment whose one state has gamma = 0: omega1 = -alpha' sin(beta)."""
    states = types.SimpleNamespace(
        orientation=np.array([[0.0, math.sin(0.5 * beta), 0.0, math.cos(0.5 * beta)]]),
        angular_velocity=np.array([omega]))
    return types.SimpleNamespace(states=lambda _: states)


@pytest.mark.parametrize(('omega', 'P_gamma', 'Mgl', 'pace'), [
    # |alpha'| + |beta'|/sin(beta)
    ((-3.0 * math.sin(0.5), 0.0, 0.0), 0.0, 1e-3, 3.0),
    ((3.0 * math.sin(0.5), -5.0 * math.sin(0.5), 0.0), 0.0, 1e-3, 8.0),
    # sqrt((P_gamma/I1)^2 + M g l/I1) with I1 = 0.25
    ((0.0, 0.0, 0.0), 0.75, 4.0, 5.0), ((0.1, 0.1, 0.0), 0.0, 4.0, 4.0)])
def test_in_a_window_nothing_turns_by_more_than_four_tenths(omega, P_gamma, Mgl, pace):
    top = types.SimpleNamespace(P_gamma=P_gamma, I1=0.25, Mgl=Mgl)
    width = heavy_top.window(turning(omega), top, 7.0)
    assert width == near(0.4 / pace, rel=1e-14)    # measured: no error
    assert heavy_top.window(turning(omega), top, 0.9 * width) == 0.9 * width    # not before 0


def test_the_extreme_of_a_rate_is_found_by_newton_s_method():
    """By hand: from 3 the zeros of t^2 - 2 come as 11/6, 1.462, 1.41500 and 1.4142138."""
    run = types.SimpleNamespace(derivative=lambda _, time, width, order=1: (
        {1: time * time - 2.0, 2: 2.0 * time}[order]))
    # measured: 1.5e-7
    assert heavy_top.where_beta_rate_turns(run, 3.0, 0.1) == near(math.sqrt(2.0), rel=1e-6)
