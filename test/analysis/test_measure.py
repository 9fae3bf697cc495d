# SPDX-License-Identifier: Apache-2.0
"""Columns that cannot be those of a motion are refused in one line."""

import numpy as np
import pytest

from rigid_body_sim.analysis.measure import LARGEST, check_numbers
from rigid_body_sim.errors import BadInput


def columns(name):
    """Return three good rows of a topic."""
    stamps = {'header.stamp': np.arange(3, dtype=np.int64)}
    return {'pose': {'pose.orientation': np.tile([0.6, 0.0, 0.0, 0.8], (3, 1)),
                     'pose.position': np.ones((3, 3)), **stamps},
            'angular_velocity': {'vector': np.ones((3, 3)), **stamps},
            'energy': {'data': np.ones(3)}}[name]


@pytest.mark.parametrize('name', ['pose', 'angular_velocity', 'energy'])
def test_good_columns_are_taken(name):
    check_numbers('/x', columns(name), name)
    largest = columns(name)
    if name != 'pose':
        for column in largest.keys() - {'header.stamp'}:
            largest[column] = largest[column] * 0.9 * LARGEST
        check_numbers('/x', largest, name)


@pytest.mark.parametrize(('name', 'column', 'value', 'said'), [
    ('pose', 'header.stamp', None, 'has no stamps'),
    ('pose', 'header.stamp', np.arange(3.0), 'has no stamps'),
    ('angular_velocity', 'header.stamp', None, 'has no stamps'),
    ('angular_velocity', 'vector', None, 'has no vector in its messages, or not of 3 doubles'),
    ('angular_velocity', 'vector', np.ones((3, 2)), 'has no vector'),
    ('angular_velocity', 'vector', np.ones((3, 3), np.float32), 'has no vector'),
    ('angular_velocity', 'vector', np.full((3, 3), np.nan), 'not finite'),
    ('angular_velocity', 'vector', np.array([[0, 0, 0], [0, -LARGEST, 0], [0, 0, 0.0]]),
     'holds a number that is not finite, or beyond 1e+150'),
    ('energy', 'data', np.ones((3, 1)), 'has no data in its messages, or not of 1 doubles'),
    ('energy', 'data', np.array([0.0, np.inf, 0.0]), 'not finite'),
    ('pose', 'pose.orientation', np.array([[0, 0, 0, 1], [0, 0, 0, 1.001], [0, 0, 0, 1]]),
     'not a unit quaternion'),
    ('pose', 'pose.orientation', np.zeros((3, 4)), 'not a unit quaternion')])
def test_what_is_wrong_is_said(name, column, value, said):
    broken = columns(name)
    if value is None:
        del broken[column]
    else:
        broken[column] = value
    with pytest.raises(BadInput, match=r'^/x: ') as refusal:
        check_numbers('/x', broken, name)
    assert said in str(refusal.value)


def test_a_quaternion_of_single_precision_is_a_unit_quaternion():
    rounded = columns('pose')
    rounded['pose.orientation'] = rounded['pose.orientation'].astype(np.float32).astype(float)
    check_numbers('/x', rounded, 'pose')
