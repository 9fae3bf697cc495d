# SPDX-License-Identifier: Apache-2.0
"""The path of a point: its velocity and acceleration are those of calculus."""

import math

import pytest

from rigid_body_sim.scene.expressions import path
from rigid_body_sim.scene.expressions.reader import read


def test_place_velocity_and_acceleration_of_a_path():
    trees = tuple(read(text, {'t', 'A'}, 'here') for text in ('A*cos(9*t)', 't^3 - 2*t', '5'))
    place, velocity, acceleration = path.along(path.path(trees, (('A', 0.2),)), 0.7)
    cosine, sine = math.cos(6.3), math.sin(6.3)
    assert place == pytest.approx((0.2 * cosine, 0.343 - 1.4, 5.0), rel=1e-14, abs=1e-14)
    assert velocity == pytest.approx((-1.8 * sine, 3 * 0.49 - 2, 0.0), rel=1e-14, abs=1e-14)
    assert acceleration == pytest.approx((-16.2 * cosine, 4.2, 0.0), rel=1e-14, abs=1e-14)


@pytest.mark.parametrize(('texts', 'found'), [
    (('sin(t)', 't^2', '3'), []), (('abs(t)', 'min(t, 1)', '2*abs(t - 1)'), ['abs', 'min']),
    (('where(t < 1, t, 1)', 'sin(max(t, 2))', '1'), ['less', 'max', 'where'])])
def test_functions_with_kinks_are_named(texts, found):
    trees = tuple(read(text, {'t'}, 'here') for text in texts)
    assert path.kinks(trees) == found
