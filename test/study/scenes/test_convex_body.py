# SPDX-License-Identifier: Apache-2.0
"""How the frequency of small rocking is found, on a signal of a known one."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.study.scenes import convex_body


@pytest.mark.parametrize(('frequency', 'guess'), [(7.0, 6.9), (7.0, 7.12), (0.3, 0.302)])
def test_the_strongest_frequency_near_a_guess_is_found(frequency, guess):
    step = math.pi / (8.0 * frequency)
    phase = frequency * step * np.arange(2048)
    signal = np.cos(phase + 0.4) + 0.3 * np.cos(2.5 * phase)
    # measured: 6e-9
    assert convex_body._peak(signal, step, guess) == near(frequency, rel=1e-7)
