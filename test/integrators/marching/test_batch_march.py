# SPDX-License-Identifier: Apache-2.0
"""taylor on many bodies beside taylor one by one: stretches, late starts, more than the lanes."""

import numpy as np
import pytest

from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import parse_scene

SCENE = parse_scene("""
scene: pieces
body: {mass: 1.0, inertia: [[1.0, 0.1, 0.0], [0.1, 1.5, 0.2], [0.0, 0.2, 2.0]]}
constraint: free
effects: [torque: {times: [0.5, 1.25], values: [[1, 0, 0.5], [0, -3, 0]], frame: world}]
initial: {angular_velocity: [0.4, -0.2, 1.1]}
""")
TIMES = np.array([2.0, 0.2, 0.5, 1.25, 1.3])


@pytest.mark.without_numba
@pytest.mark.parametrize('count', [1, LANES + 3])
def test_bodies_in_lanes_are_where_they_are_one_by_one(count):
    """Each has a rate of its own, and some start late, between two times that are asked for."""
    one = Stepped(SCENE, 'taylor', accuracy=1e-9, horizon=2.0)
    starts = np.tile(SCENE.initial.vector, (count, 1))
    starts[:, 5:8] *= np.linspace(1.0, 3.0, count)[:, np.newaxis]
    starts[1::3, 0] = 0.15
    together, alone = np.empty((2, count, len(TIMES), 14))
    one.many(starts, TIMES, together)
    for start, states in zip(starts, alone, strict=True):
        one.start(start).states(TIMES, states)
    assert together[:, :, 0] == pytest.approx(np.tile(TIMES, (count, 1)), abs=0.0)
    for a, b in zip(together.reshape(-1, 14), alone.reshape(-1, 14), strict=True):
        assert angle_between(*a[1:5], *b[1:5]) < 1e-8
        assert a[1:5] @ b[1:5] > 0.0
        assert a[5:8] == pytest.approx(b[5:8], abs=1e-7)


@pytest.mark.without_numba
def test_a_late_body_is_not_moved_by_the_stretches_before_it():
    one = Stepped(SCENE, 'taylor', accuracy=1e-9, horizon=2.0)
    starts = np.tile(SCENE.initial.vector, (3, 1))
    starts[:, 0] = 0.0, 0.7, 1.9
    times = np.array([1.95, 2.4])
    together, alone = np.empty((2, 3, 2, 14))
    one.many(starts, times, together)
    for start, states in zip(starts, alone, strict=True):
        one.start(start).states(times, states)
    assert together == pytest.approx(alone, abs=1e-7)


@pytest.mark.without_numba
def test_a_body_whose_clock_is_too_coarse_for_a_step_is_named_and_ends_the_run():
    """A double does not tell 2^53 s from half a second later, when a torque acts."""
    one = Stepped(SCENE, 'taylor', accuracy=1e-9, horizon=2.0)
    starts = np.tile(SCENE.initial.vector, (3, 1))
    starts[:, 5:8] = 0.0
    starts[:, 0] = 2.0 ** 53
    with pytest.raises(NotConverged, match=r'body 0: .* at t = 9007199254740992\.0 s'):
        one.many(starts, np.array([2.0 ** 53 + 1000.0]), np.empty((3, 1, 14)))
