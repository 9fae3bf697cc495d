# SPDX-License-Identifier: Apache-2.0
"""Group 4, steps from a nanosecond to 1e3 s, jumps, any order.

The cases stand in rigid_body_sim/study/hard_cases, each with why it is hard and the reason of its
bound; `hard_cases` prints what is measured.
"""

import math

import numpy as np
import pytest
from hard_cases.judged import judge

from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases.table import of_group

EPSILON = np.finfo(float).eps


@pytest.mark.parametrize('case', of_group(4), ids=lambda case: case.name)
def test_case(case):
    # measured: the same bits
    judge(case)


@pytest.mark.parametrize('step', [1e-9, 1e-6, 1e-3, 1.0, 1e3])
def test_steps_from_a_nanosecond_to_a_thousand_seconds(step):
    """A thousand ticks of any length end where one jump ends.

    Anchored anew at each tick, they do so within the rounding of the anchors.
    """
    scene = load_scene('free_body')
    ticking, jumping = Simulation(scene, rate=1.0 / step), Simulation(scene, rate=1.0 / step)
    last = ticking.advance_through(1000)[-1].vector
    jumping.advance(1000)
    assert last.tobytes() == jumping.vector.tobytes()
    state, out = scene.initial.vector.copy(), np.empty(14)
    for k in range(1, 1001):
        jumping.choice.solver(state, Wrench()).state(k * step, out)
        state = out.copy()
    turned = np.linalg.norm(scene.initial.angular_velocity) * 1000.0 * step
    # each anchor rounds omega by up to 2 ulp, which turns the body for the rest of the time: a
    # walk of 1000 steps, over the third power of it
    bound = 4.0 * EPSILON * (math.sqrt(1000.0) + turned * math.sqrt(1000.0 / 3.0) / 2.0)
    # measured: at most 0.2 of it (1e3 s)
    assert angle_between(*state[1:5], *jumping.vector[1:5]) < bound
