# SPDX-License-Identifier: Apache-2.0
"""Components along the axes of a frame: by a quaternion, and by rows that were not rounded."""

import math
from fractions import Fraction

import pytest

from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.expressions.path import Path
from rigid_body_sim.scene.frame import Frame, Hinging, along, turned_back

# a third of a turn about (1, 1, 1): frame x is body y, y is z, z is x
CYCLE = (0.5, 0.5, 0.5, 0.5)
THIRD = Fraction(1, 3)
ROWS = ((2 * THIRD, -THIRD, 2 * THIRD), (2 * THIRD, 2 * THIRD, -THIRD),
        (-THIRD, 2 * THIRD, 2 * THIRD))


def frame(**given):
    return Frame(**{'moves': True, 'mass': 1.0, 'moments': (1.0, 1.0, 1.0),
                    'differences': (0.0, 0.0, 0.0), 'axes': CYCLE, 'point': (0.0, 0.0, 0.0),
                    'arm': (0.0, 0.0, 0.0), **given})


def test_components_are_along_the_axes_that_the_quaternion_makes():
    assert turned_back(CYCLE, (1.0, 2.0, 3.0)) == (2.0, 3.0, 1.0)
    assert frame().from_body((1.0, 2.0, 3.0)) == (2.0, 3.0, 1.0)
    assert turned_back(IDENTITY, (0.1, -0.2, Fraction(1, 3))) == (0.1, -0.2, 1 / 3)


def test_rows_that_were_not_rounded_are_taken_in_their_place_and_rounded_once():
    """(1, 10^-17, 1) has the part 4/3 - 10^-17/3 along the first of them."""
    vector = 1.0, 1e-17, 1.0
    expected = [float(sum(a * Fraction(b) for a, b in zip(row, vector, strict=True)))
                for row in ROWS]
    assert list(along(CYCLE, ROWS, vector)) == expected
    assert list(frame(rows=ROWS).from_body((3.0, 6.0, 9.0))) == [6.0, 3.0, 9.0]


@pytest.mark.parametrize('k', range(3))
def test_what_is_not_finite_has_no_fraction_and_is_turned(k):
    vector = [0.0, 0.0, 0.0]
    vector[k] = math.inf
    assert along(IDENTITY, ROWS, vector) == tuple(vector)


def test_forces_count_where_they_move_the_body_or_work_on_what_carries_it():
    path = Path.__new__(Path)
    assert [frame(moves=moves, path=given).pushed for moves, given in (
        (True, None), (False, None), (False, path), (True, path))] == [True, False, True, True]


def test_a_hinge_winds_only_where_it_is_said():
    assert not Hinging((0.0, 0.0, 1.0), IDENTITY).winds
