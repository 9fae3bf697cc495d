# SPDX-License-Identifier: Apache-2.0
"""Vectors of trees, computed with numbers and compared with NumPy's and with SciPy's rotations."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.scene.expressions import vectors

A, B, C = np.array([2.0, 3.0, 5.0]), np.array([7.0, 11.0, 13.0]), 17.0
ROWS = [[1.0, -2.0, 3.0], [5.0, 7.0, -11.0], [13.0, 17.0, 19.0]]
QUATERNION = (1.0, -3.0, 5.0, 1.0)    # of the norm 6
OPERATIONS = {'+': lambda a, b: a + b, '-': lambda a, b: a - b, '*': lambda a, b: a * b,
              'negative': lambda a: -a}
KNOWN = dict(zip(['qx', 'qy', 'qz', 'qw'], (one / 6.0 for one in QUATERNION), strict=True),
             **dict(zip(['a', 'b', 'c'], A, strict=True)),
             **dict(zip(['x', 'y', 'z'], B, strict=True)), k=C)
LEFT, RIGHT = vectors.named('abc'), vectors.named('xyz')


def value(one):
    if one.op == 'number':
        return one.args[0]
    if one.op == 'name':
        return KNOWN[one.args[0]]
    return OPERATIONS[one.op](*map(value, one.args))


def test_names_and_numbers_stand_for_themselves():
    assert [one.args[0] for one in LEFT] == ['a', 'b', 'c']
    assert list(map(value, vectors.constant(B))) == B.tolist()


@pytest.mark.parametrize(('found', 'expected'), [
    (vectors.total(LEFT, RIGHT), A + B), (vectors.difference(LEFT, RIGHT), A - B),
    (vectors.scaled(vectors.term('name', 'k'), LEFT), C * A),
    (vectors.apply(ROWS, LEFT), ROWS @ A), (vectors.cross(LEFT, RIGHT), np.cross(A, B)),
    ([vectors.dot(LEFT, RIGHT)], [A @ B])])
def test_sums_and_products_are_those_of_vectors(found, expected):
    assert list(map(value, found)) == list(expected)    # whole numbers


@pytest.mark.parametrize(('turn', 'rotation'), [
    (vectors.to_world, Rotation.from_quat(QUATERNION)),
    (vectors.to_body, Rotation.from_quat(QUATERNION).inv())])
def test_turning_is_by_the_attitude(turn, rotation):
    found = list(map(value, turn(LEFT)))
    # measured 2e-15, of the length 6.2
    assert found == pytest.approx(rotation.apply(A).tolist(), abs=1e-14)
    assert math.hypot(*found) == pytest.approx(math.hypot(*A), abs=1e-14)
