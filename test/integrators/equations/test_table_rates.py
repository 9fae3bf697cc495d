# SPDX-License-Identifier: Apache-2.0
"""The rates of a pushed ball, beside the laws of Newton and Euler for its centre and its turn."""

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.integrators.equations import table_rates
from rigid_body_sim.integrators.equations.table_rates import (
    CREEPING,
    GLIDING,
    PUSHED,
    ROLLING,
    SLIDING,
    Pushed,
    rate,
)
from rigid_body_sim.motions.sliding_sphere import Parameters
from rigid_body_sim.numerics.rotations import multiply

a, k, M, mu, g = 0.3, 0.4, 1.7, 0.2, 9.81
I, UP, NONE = k * M * a * a, np.array([0.0, 0.0, 1.0]), (0.0, 0.0, 0.0)
Q, V, OMEGA = (0.1, -0.5, 0.5, 0.7), np.array([1.3, -0.4, 0.0]), np.array([2.0, -3.0, 5.0])
WEAK = (0.5, -1.1, 2.0), (0.02, 0.03, -0.04), (0.3, 0.2, -0.1), (-0.01, 0.05, 0.02)
STRONG = (9.5, -7.1, 2.0), *WEAK[1:]
LIFTED = (0.5, -1.1, 30.0), *WEAK[1:]
IDLE = (NONE,) * 4


@pytest.mark.parametrize('wrench', [WEAK, STRONG, LIFTED, IDLE],
                         ids=['weak', 'strong', 'lifted', 'idle'])
@pytest.mark.parametrize('mode', [SLIDING, ROLLING, GLIDING, CREEPING])
def test_the_rates_are_those_of_the_forces_on_the_ball(mode, wrench):
    """M v' = F + f and I omega' = T - a z x f; with e = a omega x z, u = v - e and p = v + k e.

    f is mu N against the slip, or against the way in which a slip begins (not more than what keeps
    it from beginning); what keeps it from beginning; or none.
    """
    turn, q = Rotation.from_quat(Q), np.array(Q) / np.linalg.norm(Q)
    F, T = np.array(wrench[0]) + turn.apply(wrench[2]), np.array(wrench[1]) + turn.apply(wrench[3])
    e = a * np.cross(OMEGA, UP)
    u, p = (V - e)[:2], (V + k * e)[:2]
    N, tends = max(0.0, M * g - F[2]), (F / M - a * np.cross(T, UP) / I)[:2]
    sticks, size = -M * k / (1.0 + k) * tends, np.linalg.norm(tends)
    most = mu * N * tends / size if size > 0.0 else np.zeros(2)
    f = {SLIDING: -mu * N * u / np.linalg.norm(u), ROLLING: sticks, GLIDING: np.zeros(2),
         CREEPING: -most if np.linalg.norm(sticks) > mu * N else sticks}[mode]
    force = np.array([*f, 0.0])
    torque = T + np.cross(-a * UP, force)
    moved, grown = (F + force) / M, a * np.cross(torque / I, UP)
    expected = [*multiply(*(0.5 * OMEGA), 0.0, *q), *(moved - grown)[:2],
                *(moved + k * grown)[:2], T[2] / I, *V[:2], 1.0,
                F[:2] @ V[:2] + T @ OMEGA, -f @ u, *torque]
    pace = np.linalg.norm(u) if mode == SLIDING else 1.0
    pushed = PUSHED.array(Pushed(Parameters(a, k, M, mu, g), float(mode), *wrench))
    found = np.array(rate(pushed, (*q, *u, *p, OMEGA[2], 0.7, 0.8, 0.9)))
    # measured: 4e-15
    assert found == pytest.approx(pace * np.array(expected), abs=4e-14)
    assert table_rates.motion(pushed, (*q, *u, *p, OMEGA[2], 0.7, 0.8, 0.9)) == near(
        (*V[:2], *OMEGA), rel=1e-14)
