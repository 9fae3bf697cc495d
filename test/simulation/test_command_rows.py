# SPDX-License-Identifier: Apache-2.0
"""Commands as rows: each number in its column, there and back."""

import math

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.simulation.command_rows import (
    HOLD,
    IMPULSE,
    LET_GO,
    RELEASE,
    commands_of,
    row_of,
    rows_of,
    wrench_of,
)


def test_a_row_has_its_kind_its_axes_force_and_torque():
    assert row_of(IMPULSE, (1, 2, 3), (4, 5, 6), 'world').tolist() == [[0, 0, 1, 2, 3, 4, 5, 6]]
    assert row_of(HOLD, (1, 2, 3), (4, 5, 6), 'body').tolist() == [[1, 1, 1, 2, 3, 4, 5, 6]]
    assert LET_GO.tolist() == [[RELEASE, 0, 0, 0, 0, 0, 0, 0]] == [[2, 0, 0, 0, 0, 0, 0, 0]]


def test_a_row_holds_its_wrench_and_zeros_let_go():
    held = wrench_of(row_of(HOLD, (1, 2, 3), (4, 5, 6), 'body')[0])
    assert held == Wrench((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 'body')
    assert wrench_of(LET_GO[0]) == Wrench()
    assert wrench_of(row_of(HOLD, (0, 0, 0), (0, 0, 0), 'body')[0]) == Wrench()
    for k in range(6):
        row = np.zeros(8)
        row[0], row[2 + k] = HOLD, 1.0
        assert wrench_of(row)


def test_rows_go_to_a_journal_and_back():
    rows = np.concatenate([row_of(IMPULSE, (1, 2, 3), (4, 5, 6), 'world'), LET_GO,
                           row_of(HOLD, (7, 8, 9), (0, 1, 2), 'body')])
    told = commands_of(rows)
    assert told[0] == {'topic': 'cmd_impulse', 'frame': 'world', 'force': [1.0, 2.0, 3.0],
                       'torque': [4.0, 5.0, 6.0]}
    assert [one['topic'] for one in told] == ['cmd_impulse', 'release', 'cmd_wrench']
    assert (rows_of(told) == rows).all()
    assert rows_of([]).shape == (0, 8)


@pytest.mark.parametrize(('force', 'torque', 'frame', 'words'), [
    ((1, 2), (0, 0, 0), 'world', 'three finite'), ((1, 2, 3), (0,) * 4, 'world', 'three finite'),
    (3, (0, 0, 0), 'world', 'three'), (('a', 2, 3), (0, 0, 0), 'world', 'three'),
    ({1, 2, 3}, (0, 0, 0), 'world', 'three'), ((1, 2, 3), {4, 5, 6}, 'world', 'three'),
    ({1: 0, 2: 0, 3: 0}, (0, 0, 0), 'world', 'three'),
    ((1, 2, 3), {4: 0, 5: 0, 6: 0}, 'body', 'three'),
    ((1, 2, 3), (0, 0, 0), 'moon', "got frame 'moon'")])
def test_what_is_no_command_is_refused(force, torque, frame, words):
    with pytest.raises(BadInput, match=words):
        row_of(HOLD, force, torque, frame)
    assert math.isfinite(row_of(HOLD, (1, 2, 3), (0, 0, 0), 'body').sum())
