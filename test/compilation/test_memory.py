# SPDX-License-Identifier: Apache-2.0
"""What kernels are handed: arrays, or memoryviews of them where they are plain Python."""

from typing import NamedTuple

import numpy as np
import pytest

from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.compilation.layout import Vector, layout
from rigid_body_sim.compilation.memory import memory, table


class Moving(NamedTuple):
    """A view."""

    time: float
    velocity: Vector


load, load_velocity = layout(Moving).load, layout(Moving).part('velocity').load


@pytest.mark.skipif(not HAVE_NUMBA, reason='compiled kernels take arrays')
def test_a_compiled_kernel_takes_the_array_itself():
    array = np.zeros((2, 3))
    assert memory(array) is table(array) is array
    assert memory(array[0]).base is array


@pytest.mark.without_numba
def test_plain_python_reads_floats_and_writes_into_the_array():
    array = np.arange(6.0).reshape(2, 3)
    row, rows = memory(array[1]), memory(array)
    row[0], rows[0][2] = 7.0, 8.0
    assert array.tolist() == [[0.0, 1.0, 8.0], [7.0, 4.0, 5.0]]
    assert len(rows) == 2
    assert {type(number) for number in (row[0], row[1:][1], rows[0][2], table(array)[1, 2])} == {
        float}
    assert table(array)[1, 2] == 5.0


@pytest.mark.without_numba
@pytest.mark.parametrize('made', [
    np.array, lambda numbers: memory(np.array(numbers)), list, tuple])
def test_plain_python_loads_floats_of_whatever_holds_them(made):
    numbers = made([9.0, 1.0, 2.0, 3.0, 4.0])
    moving = load(numbers, 1)
    assert moving == Moving(1.0, (2.0, 3.0, 4.0))
    assert load_velocity(numbers) == (1.0, 2.0, 3.0)
    assert {type(number) for number in (moving.time, *moving.velocity)} == {float}
