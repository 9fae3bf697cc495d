# SPDX-License-Identifier: Apache-2.0
"""The balance of energy and angular momentum of a body, by hand."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.mechanics.ledger import (
    ANGULAR_IMPULSE,
    DISSIPATED,
    ENTRIES_SIZE,
    HEATS,
    WORK,
    balance,
    entries_size,
    most,
)
from rigid_body_sim.scene.constraints.protocol import Mechanism

START = 3.0, -1.0, 9.0, (1.0, 2.0, -2.0)    # kinetic, potential, L^2, L
NOW = 4.0, 2.0, 14.0, (1.0, 5.0, -2.0)


def row(kinetic, potential, square, momentum):
    return np.array([kinetic, potential, square, *momentum])


def entries(work=0.0, dissipated=0.0, impulse=(0.0, 0.0, 0.0), causes=()):
    return np.array([work, dissipated, *impulse, *causes])


def test_places_of_the_entries_are_those_of_their_layout():
    found = entries(1.0, 2.0, (3.0, 4.0, 5.0))
    assert (len(found), found[WORK], found[DISSIPATED]) == (ENTRIES_SIZE, 1.0, 2.0)
    assert found[ANGULAR_IMPULSE].tolist() == [3.0, 4.0, 5.0]
    for mechanism in Mechanism:
        scene = types.SimpleNamespace(constraint=types.SimpleNamespace(mechanism=mechanism))
        assert entries_size(scene) == 5 + 5 * (mechanism is Mechanism.PLANE)


def test_terms_are_those_of_now_and_of_the_entries():
    found = balance(row(*START), row(*NOW), entries(6.0, 0.5, (0.0, 3.0, 0.0)))
    assert [found[name] for name in ('kinetic', 'potential', 'dissipated', 'work',
                                     'angular_momentum_squared')] == [4.0, 2.0, 0.5, 6.0, 14.0]
    # 4 + 2 + 0.5 - 3 + 1 - 6 = -1.5, of 6
    assert found['energy_residual'] == near(-0.25, rel=1e-15)
    assert found['momentum_residual'] == 0.0
    assert not set(found) & {*HEATS}


@pytest.mark.parametrize(('start', 'now', 'more', 'passed', 'scale'), [
    ((9.0, 0.0), (1.0, 0.0), {}, 0.0, 9.0), ((1.0, 0.0), (9.0, 0.0), {}, 0.0, 9.0),
    ((1.0, 0.0), (0.0, -9.0), {}, 0.0, 9.0), ((1.0, -9.0), (0.0, 0.0), {}, 0.0, 9.0),
    ((1.0, 0.0), (2.0, 0.0), {'work': -9.0}, 0.0, 9.0),
    ((1.0, 0.0), (2.0, 0.0), {}, 9.0, 9.0), ((1.0, 0.0), (2.0, 0.0), {}, 1.0, 2.0)])
def test_the_energy_that_is_missing_is_relative_to_the_largest(start, now, more, passed, scale):
    found = balance(row(*start, 0.0, (0.0,) * 3), row(*now, 0.0, (0.0,) * 3), entries(**more),
                    (passed, 0.0))
    missing = sum(now) - sum(start) - more.get('work', 0.0)
    assert found['energy_residual'] == near(missing / scale, rel=1e-15)
    assert found['momentum_residual'] == 0.0


@pytest.mark.parametrize(('start', 'now', 'impulse', 'passed', 'expected'), [
    ((3.0, 0.0, 4.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), 0.0, math.sqrt(18.0) / 5.0),
    ((0.0, 0.0, 1.0), (3.0, 0.0, 4.0), (0.0, 0.0, 0.0), 0.0, math.sqrt(18.0) / 5.0),
    ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 3.0, 4.0), 0.0, math.sqrt(29.0) / 5.0),
    ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), 8.0, math.sqrt(2.0) / 8.0)])
def test_the_momentum_that_is_missing_is_relative_to_the_largest(
        start, now, impulse, passed, expected):
    found = balance(row(1.0, 0.0, 0.0, start), row(1.0, 0.0, 0.0, now),
                    entries(impulse=impulse), (0.0, passed))
    assert found['momentum_residual'] == near(expected, rel=1e-15)
    assert found['energy_residual'] == 0.0


def test_of_a_body_that_nothing_has_moved_nothing_has_passed():
    found = balance(row(0.5, 0.0, 0.25, (0.0, 0.0, 0.5)), row(0.25, 0.0, 0.0625, (0.0, 0.0, 0.25)),
                    entries())
    assert (found['energy_residual'], found['momentum_residual']) == (-0.5, 0.5)


def test_a_body_at_rest_lacks_nothing():
    nothing = row(0.0, 0.0, 0.0, (0.0, 0.0, 0.0))
    found = balance(nothing, nothing, entries(causes=(1.0, 2.0, 3.0, 4.0, 5.0)))
    assert (found['energy_residual'], found['momentum_residual']) == (0.0, 0.0)
    assert [found[cause] for cause in HEATS] == [1.0, 2.0, 3.0, 4.0, 5.0]


@pytest.mark.parametrize(('found', 'expected'), [
    (entries(-3.0, 2.0, (2.0, -1.0, 2.0)), (3.0, 3.0)), (entries(1.0, -4.0), (4.0, 2.5)),
    (entries(0.5, 0.5), (2.0, 2.5))])
def test_the_most_that_has_passed_is_kept(found, expected):
    assert most((2.0, 2.5), found) == expected
