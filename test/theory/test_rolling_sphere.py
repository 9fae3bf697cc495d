# SPDX-License-Identifier: Apache-2.0
"""Routh's sphere against its equations of motion, integrated by SciPy."""

import math

import numpy as np
import pytest
import rolling
from near import near
from scipy.integrate import solve_ivp

from rigid_body_sim.theory.rolling_sphere import routh_constant, swing

A, C, M, R, OFF, G = 0.05, 0.08, 1.3, 0.4, 0.15, 9.81


# measured: at most 5e-13
@pytest.mark.parametrize(('theta', 's', 'w3'), [
    (0.6, 0.4, 2.0), (1.9, -3.0, 1.0), (1.0, 9.0, -4.0), (0.5, 5.0, 0.0)])
def test_it_swings_between_two_inclinations_and_keeps_routh_s_constant(theta, s, w3):
    def rates(_, x):
        return rolling.rates(x, M, np.diag([A, A, C]), np.array([0.0, 0.0, -OFF]), (R, R, R), G)

    def turns(_, x):
        """Return the rate of cos theta."""
        return x[0] * x[4] - x[1] * x[3]
    other, time = swing(theta, s, w3, A, C, M, R, OFF, G)
    start = [math.sin(theta), 0.0, math.cos(theta), s, 0.0, w3]
    run = solve_ivp(rates, (0.0, 1.5 * time), start, method='DOP853', rtol=1e-12, atol=1e-13,
                    t_eval=[0.3 * time, 0.7 * time], events=turns)
    back, = [at for at in run.t_events[0] if at > 0.1 * time]
    turned = math.acos(run.y_events[0][-1][2])
    assert back == near(time, rel=1e-9)
    assert turned == near(other, rel=1e-9)
    for x in run.y.T:
        kept = routh_constant(x[5], math.acos(x[2]), A, C, M, R, OFF)
        assert abs(kept - routh_constant(w3, theta, A, C, M, R, OFF)) < 1e-11
