# SPDX-License-Identifier: Apache-2.0
"""How far runs are apart."""

import math

import numpy as np
import pytest
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
