# SPDX-License-Identifier: Apache-2.0
"""Columns become rows: every number in its place, and nothing else is written."""

import numpy as np
import pytest

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.compilation.rows import compiled_rows, turned
from rigid_body_sim.motions.loops import BLOCK
from rigid_body_sim.motions.pendulum import pendulum
from rigid_body_sim.motions.solver import Exact, loops
from rigid_body_sim.scene.scene import load_scene

STRIDE = 24


def test_eight_rows_of_eight_are_turned():
    square = np.arange(64.0).reshape(8, 8)
    found = turned(list(square), lambda u, v, places: np.concatenate([u, v])[places])
    assert (np.array(found) == square.T).all()


@pytest.mark.parametrize('count', [8, 9, 14, 16, 17])
def test_rows_hold_the_numbers_of_all_columns(count):
    store_rows = compiled_rows(count, STRIDE)

    @compiled
    def act(columns, at, out, row):
        store_rows(columns, at, out, row)

    columns = np.random.default_rng(count).normal(size=count * STRIDE)
    expected = columns.reshape(count, STRIDE).T
    whole = np.zeros((20, count + 3))
    for out in (np.zeros((20, count)), whole[:, 2:2 + count]):    # contiguous, and part of more
        act(columns, 5, out, 9)
        assert (out[9:9 + LANES] == expected[5:5 + LANES]).all()
        assert not out[:9].any() and not out[9 + LANES:].any()
    assert not whole[:, :2].any() and not whole[:, 2 + count:].any()


@pytest.mark.parametrize('count', [7, 8, 9, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK + 11])
def test_states_are_those_one_by_one_in_rows_of_any_kind(count):
    scene = load_scene('kater_pendulum')
    solver = Exact(scene, pendulum).start(scene.initial.vector)
    times = np.linspace(-1.0, 7.0, count)
    alone, together = np.empty((count, 14)), np.empty((count, 14))
    loops(pendulum).one_by_one(solver.anchor, times, alone)
    solver.states(times, together)
    assert alone.tobytes() == together.tobytes()
    for out in (np.zeros((count + 2, 20))[1:-1, 3:17], np.zeros((14, count)).T,
                np.zeros((count, 28))[:, ::2], np.zeros((count, 14))[::-1]):
        solver.states(times, out)
        assert (out == alone).all()
