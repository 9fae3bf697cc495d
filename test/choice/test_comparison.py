# SPDX-License-Identifier: Apache-2.0
"""How far runs are apart."""

import math

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.choice import comparison


def test_runs_are_apart_by_the_angle_between_them():
    states, others = np.zeros((2, 3, 14))
    for k, angle in enumerate((0.0, 0.5, 3.0)):
        states[k, 1:5] = Rotation.from_rotvec([0.0, 0.0, 1.0]).as_quat()
        others[k, 1:5] = Rotation.from_rotvec([0.0, 0.0, 1.0 + angle]).as_quat()
    assert comparison.apart(states, others) == pytest.approx([0.0, 0.5, 3.0], abs=1e-15)
    others[1, 1] = math.nan
    assert comparison.apart(states, others)[1] == math.inf


def test_the_mean_of_finer_runs_errs_less_than_each_of_them():
    """Runs turned by 1, 2 and 3 nrad about z are 2 nrad from the true one, in mean."""
    true, finer = np.zeros((4, 14)), np.zeros((3, 4, 14))
    true[:, 4] = 1.0
    for one, angle in zip(finer, (1e-9, 2e-9, 3e-9), strict=True):
        one[:, 1:5] = Rotation.from_rotvec([0.0, 0.0, angle]).as_quat()
    finer[1] *= -1.0    # the same attitude
    turned = finer[0].copy()
    turned[:, 1:5] = Rotation.from_rotvec([0.0, 0.0, 5e-9]).as_quat()
    assert comparison.apart_from_mean(true, list(finer)) == near(2e-9, rel=1e-7)
    assert comparison.apart_from_mean(turned, list(finer)) == near(3e-9, rel=1e-7)
    gave_up = np.full((4, 14), math.nan)
    assert comparison.apart_from_mean(true, [finer[0], gave_up]) == near(1e-9, rel=1e-7)
    assert (comparison.apart_from_mean(true, [gave_up]) == math.inf).all()
    gave_up[:3] = finer[0, :3]    # at the last time only
    assert comparison.apart_from_mean(true, [finer[0], gave_up]) == near(1e-9, rel=1e-7)
