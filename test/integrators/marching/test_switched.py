# SPDX-License-Identifier: Apache-2.0
"""How often a course looks for kinks: within a step, and while friction holds a body."""

import math
import types

import numpy as np
import pytest

from rigid_body_sim.integrators.marching.switched import Resting, Switched
from rigid_body_sim.scene.state import STATE_SIZE


@pytest.mark.parametrize(('winds', 'rates', 'looks'), [
    (True, ((1.0, -2.0, 0.5), (0.0, 0.0, 0.0)), 7), (True, ((0.0, 0.0, 0.0), (0.0, 0.0, -3.1)), 7),
    (True, ((0.0, 0.0, 3.0), (0.0, 1.0, 0.0)), 6), (True, ((0.0, 0.0, 1.9), (0.0, 0.0, 1.0)), 4),
    (True, ((0.0, 0.0, math.inf), (0.0, 0.0, 1.0)), 4),
    (True, ((0.0, 0.0, 1.0), (0.0, 0.0, math.nan)), 4),
    (False, ((0.0, 0.0, 9.0), (0.0, 0.0, 9.0)), 4)])
def test_a_body_on_a_hinge_that_winds_turns_by_a_radian_at_most_between_two_looks(
        winds, rates, looks):
    """In the 2 s until 5 s, at the rate of the faster end; there are four looks at least."""
    def states(times, out):
        assert times.tolist() == [3.0, 5.0]
        out[:, 5:8] = rates
    course = types.SimpleNamespace(states=states)
    of = types.SimpleNamespace(_winds=winds, _seen=3.0)
    assert Switched._looks(of, course, 5.0) == looks


@pytest.mark.parametrize(('slope', 'begin', 'spacings'), [
    (0.0, -20, [*range(-20, -3), -4]), (4.0, -4, [-5, -5, -5]), (-4.0, -4, [-5, -5]),
    (8.0, -4, [-6, -6]), (1.0, -7, [-7, -6, -5, -5]),
    (1e9, -4, [-20, -20])], ids=['nothing', 'up', 'down', 'steep', 'calm', 'too steep'])
def test_a_body_at_rest_is_looked_at_as_often_as_the_torque_changes(slope, begin, spacings):
    """By a tenth of the grip, 2 N m, at most; by less than a hundredth, and the next is later.

    They are from 2^-20 to 2^-4 s apart; `spacings` are powers of 2. A torque of 4 N m/s changes
    by 0.25 N m in 2^-4 s and by 0.125 in half that; one of 1 N m/s by 0.016 in 2^-6 s. What it
    was before does not count.
    """
    of = types.SimpleNamespace(
        _seen=1.0, _spacing=2.0 ** begin, _pull=lambda out: slope * max(float(out[0]), of._seen),
        _bound=types.SimpleNamespace(equations=types.SimpleNamespace(in_field=True, grip=2.0)))
    stretch = types.SimpleNamespace(vector=np.zeros(STATE_SIZE), end=9.0)
    for spacing in spacings:
        found = Switched._end_at_rest(of, stretch)
        assert found - of._seen == pytest.approx(2.0 ** spacing, abs=1e-15)
        of._seen = found
    of._bound.equations.in_field = False
    assert Switched._end_at_rest(of, stretch) == 9.0


def test_time_goes_on_for_a_body_at_rest_however_late_it_is():
    """At 2^40 s the clock resolves 2^-12 s."""
    of = types.SimpleNamespace(
        _seen=2.0 ** 40, _spacing=2.0 ** -20, _pull=lambda out: 0.0,
        _bound=types.SimpleNamespace(equations=types.SimpleNamespace(in_field=True, grip=2.0)))
    stretch = types.SimpleNamespace(vector=np.zeros(STATE_SIZE), end=math.inf)
    assert Switched._end_at_rest(of, stretch) == 2.0 ** 40 + 2.0 ** -12


def test_what_rests_is_where_it_was_at_any_time():
    vector, out, one = np.arange(14.0), np.zeros((2, 14)), np.zeros(14)
    Resting(vector).states(np.array([5.0, 3.0]), out)
    Resting(vector).state(7.0, one)
    assert [*out[:, 0], one[0]] == [5.0, 3.0, 7.0]
    assert (np.array([*out, one])[:, 1:] == vector[1:]).all()
