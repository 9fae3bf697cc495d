# SPDX-License-Identifier: Apache-2.0
"""Named views of flat arrays: each number has a place, and unused numbers cost nothing."""

import os
import pathlib
import subprocess
import sys
from typing import NamedTuple

import numpy as np
import pytest

from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled
from rigid_body_sim.compilation.layout import Matrix, Pair, Vector, layout


class Rolling(NamedTuple):
    """A view inside a view."""

    rate: Pair
    axis: Vector


class Ball(NamedTuple):
    """One field of each kind."""

    time: float
    velocity: Vector
    tensor: Matrix
    rolling: Rolling
    radius: float


BALL = layout(Ball)
NUMBERS = Ball(0.0, (1.0, 2.0, 3.0), ((4.0, 5.0, 6.0), (7.0, 8.0, 9.0), (10.0, 11.0, 12.0)),
               Rolling((13.0, 14.0), (15.0, 16.0, 17.0)), 18.0)
load_ball, store_ball, load_axis = BALL.load, BALL.store, BALL.part('rolling').part('axis').load


@compiled
def by_name(array, out):
    """Use four of the nineteen numbers."""
    ball = load_ball(array)
    for k in range(len(out)):
        out[k] += ball.radius * ball.tensor[1][2] + ball.velocity[0] * ball.rolling.axis[2]


@compiled
def by_hand(array, out):
    """Compute the same as `by_name`."""
    for k in range(len(out)):
        out[k] += array[18] * array[9] + array[1] * array[17]


@compiled
def copied(array, out, at):
    """Load and store at an offset."""
    store_ball(out, load_ball(array, at))


@compiled
def axis(array):
    """Load one part."""
    return load_axis(array)


def test_a_value_becomes_an_array_with_each_number_at_its_place():
    assert BALL.numbers(NUMBERS) == [float(k) for k in range(19)]
    array = BALL.array(NUMBERS)
    assert array.tolist() == list(range(19)) and array.strides == (8,)
    assert BALL.array(Ball(*NUMBERS[:2], np.array(NUMBERS.tensor), *NUMBERS[3:])).dtype == float


def test_every_number_has_a_place_in_the_order_of_the_fields():
    assert BALL.size == 19
    array = np.arange(19.0)
    assert load_ball(array) == NUMBERS
    out = np.zeros(19)
    store_ball(out, NUMBERS)
    np.testing.assert_array_equal(out, array)


def test_a_part_is_loaded_and_stored_alone():
    array = np.arange(19.0)
    assert BALL.part('rolling').places == slice(13, 18, 1)
    assert axis(array) == load_axis(array) == (15.0, 16.0, 17.0)
    assert BALL.part('tensor').part(1).load(array) == (7.0, 8.0, 9.0)
    BALL.part('time').store(array, -1.0)
    BALL.part('rolling').store(array, Rolling((-2.0, -3.0), (-4.0, -5.0, -6.0)))
    changed = np.flatnonzero(array != np.arange(19.0))
    np.testing.assert_array_equal(changed, [0, 13, 14, 15, 16, 17])


def test_many_values_stand_one_after_another():
    out = np.zeros(19)
    copied(np.arange(40.0), out, 20)
    np.testing.assert_array_equal(out, np.arange(20.0, 39.0))


def test_many_values_stand_side_by_side_in_columns():
    columns, rows = np.zeros(19 * 4), np.random.default_rng(2).normal(size=(4, 19))
    table = layout(Ball, stride=4)
    for k, row in enumerate(rows):
        table.store(columns, load_ball(row), k)
    np.testing.assert_array_equal(columns.reshape(19, 4), rows.T)
    assert table.load(columns, 3) == load_ball(rows[3])
    np.testing.assert_array_equal(columns[table.part('tensor').places], rows[0, 4:13])


def test_kernels_compute_the_same_bits_by_name_as_by_hand():
    array = np.random.default_rng(1).normal(size=19)
    named, handed = np.zeros(5), np.zeros(5)
    by_name(array, named)
    by_hand(array, handed)
    assert named.tobytes() == handed.tobytes()


@pytest.mark.skipif(not HAVE_NUMBA, reason='about compiled code')
def test_numbers_that_a_kernel_does_not_use_are_not_loaded():
    array, out = np.arange(19.0), np.zeros(5)
    by_name(array, out)
    by_hand(array, out)

    def loads(kernel):
        lines = next(iter(kernel.inspect_llvm().values())).splitlines()
        return sum('= load double' in line for line in lines)
    # LLVM may unroll the loop of one kernel; both load four numbers and elements of out
    assert loads(by_name) <= loads(by_hand)


def test_a_field_that_is_not_made_of_floats_is_refused():
    class Named(NamedTuple):
        name: str

    with pytest.raises(TypeError, match=r"Named\.name is <class 'str'>"):
        layout(Named)
    with pytest.raises(KeyError, match='Ball has no field'):
        BALL.part('mass')


SCRIPT = """
import numpy as np
from kernel import first
first(np.arange(3.0), np.zeros(3))
print(sum(first.stats.cache_hits.values()), first.nopython_signatures)
"""
KERNEL = """
from typing import NamedTuple
from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Vector, layout

class Point(NamedTuple):
    at: Vector

POINT = layout(Point)
load, store = POINT.load, POINT.store

@compiled
def first(array, out):
    point = load(array)
    store(out, point)
    return point
"""


@pytest.mark.skipif(not HAVE_NUMBA, reason='about the cache of compiled code')
def test_a_kernel_that_returns_a_view_comes_from_the_cache_in_the_next_process(tmp_path):
    (tmp_path / 'kernel.py').write_text(KERNEL)
    package = pathlib.Path(__file__).resolve().parents[2]
    settings = {**os.environ, 'PYTHONPATH': os.pathsep.join([str(tmp_path), str(package)]),
                'XDG_CACHE_HOME': str(tmp_path / 'cache')}
    hits = [subprocess.run([sys.executable, '-c', SCRIPT], env=settings, cwd=tmp_path,
                           capture_output=True, text=True, timeout=100, check=True).stdout[0]
            for _ in range(2)]
    assert hits == ['0', '1']
