# SPDX-License-Identifier: Apache-2.0
"""The sleeping top's quantities, measured on made-up motions."""

import math
import types

import pytest
from near import near

from rigid_body_sim.study.scenes import sleeping_top

TOP = types.SimpleNamespace(I1=0.02, I3=0.01, Mgl=1.5)


@pytest.mark.parametrize('seed', [1e-6, 1e-3, 0.3, 4.0])
def test_at_the_threshold_a_seed_leads_as_far_as_its_energy_does(seed):
    """By hand: P^2 = 4 I1 M g l, x = tan^2(beta/2), e = I1 seed^2/(2 M g l): 2 x^2 = e (1 + x)."""
    e = TOP.I1 * seed * seed / (2.0 * TOP.Mgl)
    beta = 2.0 * math.atan(math.sqrt(0.25 * (e + math.sqrt(e * e + 8.0 * e))))
    top = types.SimpleNamespace(crossings=lambda *_: [0.7], read=lambda _, time: [time])
    run = types.SimpleNamespace(variant=lambda _: top)
    threshold = 2.0 * math.sqrt(TOP.I1 * TOP.Mgl)
    [tilt] = sleeping_top._at_the_threshold(run, TOP, threshold, seed)
    # below a hundredth the quartic term alone is taken
    assert tilt.predicted == near(beta, rel=1e-6 if beta < 0.01 else 1e-8)    # 5e-9; 1.1e-9
    assert (tilt.measured, tilt.unit) == (0.7, 'rad')
