# SPDX-License-Identifier: Apache-2.0
"""Residuals of made-up values, from the start of their segment, only where they are kept."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.analysis.drift import FLOOR, Residual, scales
from rigid_body_sim.analysis.history import History, Segment
from rigid_body_sim.scene.scene import load_scene

STAMPS = np.arange(1000, dtype=np.int64) * 1_000_000


def residual(values, segments, kept, scale=0.0, block=230):
    found = Residual(History((), segments), kept, scale, len(values))
    for begin in range(0, len(values), block):
        part = slice(begin, begin + block)
        found.add(STAMPS[part], STAMPS[part] * 1e-9, values[part])
    return found


def segment(tick, held=False):
    return Segment(int(STAMPS[tick]), None, 1000.0, 1.0, held)


@pytest.mark.parametrize('block', [1, 7, 230, 1000])
def test_each_segment_has_its_own_reference_and_what_is_not_kept_is_not_judged(block):
    values = np.full(1000, 4.0)
    values[100:] = 6.0          # an impulse at tick 100
    values[400:700] = np.linspace(6.0, 20.0, 300)   # a held wrench
    values[700:] = 20.0
    values[950] += 1e-10
    values[999] -= 4e-11
    found = residual(values, (segment(0), segment(100), segment(400, held=True), segment(700)),
                     lambda segment: not segment.held, block=block)
    summary = found.summary()
    assert (summary['first'], summary['last'], summary['least'], summary['greatest']) == (
        4.0, 20.0 - 4e-11, 4.0, 20.0 + 1e-10)
    assert summary['largest_residual'] == near(5e-12, rel=1e-3)
    assert summary['last_residual'] == near(-2e-12, rel=1e-3)
    assert summary['judged_ticks'] == 700
    times, curve = found.curve()
    assert times.tolist() == [*(STAMPS[:400] * 1e-9), *(STAMPS[700:] * 1e-9)]
    assert np.flatnonzero(curve).tolist() == [650, 699]


def test_a_change_inside_a_segment_is_drift():
    values = np.full(1000, 4.0)
    values[100:] = 6.0
    assert residual(
        values, (segment(0),), lambda segment: True).summary()['largest_residual'] == 0.5


def test_the_scale_holds_where_the_value_is_small():
    values = np.zeros(1000)
    values[10:] = 1e-9
    assert residual(
        values, (segment(0),), lambda segment: True, scale=2.0).largest == pytest.approx(5e-10)
    assert residual(
        values, (segment(0),), lambda segment: True, scale=0.5).largest == pytest.approx(2e-9)
    # nothing to compare with
    assert residual(values, (segment(0),), lambda segment: True).largest == 0.0


def test_nothing_kept_nothing_said():
    summary = residual(np.arange(1000.0), (segment(0),), lambda segment: False).summary()
    assert (summary['largest_residual'] is None and summary['judged_ticks'] == 0
            and summary['last'] == 999.0)


@pytest.mark.parametrize('block', [1, 4, 6])
def test_of_a_vector_the_length_of_the_change_is_compared_with_its_length_before(block):
    """Of (3, 4) it is 5, and the change of (0, 2) to (6, 10) is 10."""
    values = np.array([[3.0, 4.0], [3.0, 4.0], [3.0, 5.0], [0.0, 2.0], [6.0, 10.0], [0.0, 2.0]])
    found = Residual(History((), (segment(0), segment(3))), lambda segment: True, 1.0, 6, size=2)
    for begin in range(0, 6, block):
        part = slice(begin, begin + block)
        found.add(STAMPS[:6][part], STAMPS[:6][part] * 1e-9, values[part])
    assert found.summary() == {
        'first': [3.0, 4.0], 'last': [0.0, 2.0], 'least': [0.0, 2.0], 'greatest': [6.0, 10.0],
        'largest_residual': 5.0, 'last_residual': 0.0, 'judged_ticks': 6, 'stretches': 2,
        'levels': [{'from': 0.0, 'until': 0.003, 'value': [3.0, 4.0], 'begun_by': ''},
                   {'from': 0.003, 'until': None, 'value': [0.0, 2.0], 'begun_by': ''}]}
    assert found.curve()[1].tolist() == [0.0, 0.0, 0.2, 0.0, 5.0, 0.0]


def test_a_change_at_the_first_tick_leaves_no_reference_from_before():
    found = residual(np.full(5, 4.0), (segment(0), segment(0)), lambda segment: True,
                     block=5)
    assert found.summary()['largest_residual'] == 0.0
    assert [level['value'] for level in found.levels] == [4.0]


def test_the_first_hundred_levels_are_told_and_all_stretches_counted():
    found = residual(np.arange(202.0), tuple(segment(k, held=k % 2 == 1) for k in range(202)),
                     lambda segment: not segment.held, block=101)
    assert [level['value'] for level in found.levels] == list(range(0, 200, 2))
    assert [level['until'] for level in found.levels] == [STAMPS[k] * 1e-9
                                                          for k in range(1, 200, 2)]
    assert found.stretches == 101
    assert found.not_kept_from == STAMPS[1:202:2].tolist()
    assert FLOOR == 2.0**-50


def test_energies_are_compared_with_the_larger_of_kinetic_and_potential():
    energy, momentum = scales(load_scene('tennis_racket'))
    assert energy == pytest.approx(0.5 * (1e-4 + 50.0 + 3e-4)) and momentum == 0.0
    top = load_scene(
        'tennis_racket',
        ['constraint=pivot', 'effects=[{gravity: {g: 10.0}}]', 'body.center_of_mass=[0, 0, -10.0]',
         'initial.angular_velocity=[0, 0, 0.01]'])
    assert scales(top)[0] == 100.0
    assert scales(None) == (0.0, 0.0)


@pytest.mark.parametrize(('overrides', 'held', 'energy', 'momentum'), [
    ([], False, True, True),
    ([], True, False, False),
    (['effects=[{gravity: {g: 9.8}}]'], False, True, True),
    (['effects=[{gravity: {g: 9.8}}]', 'constraint=pivot'], False, True, False),
    (['effects=[{torque: {value: [1, 0, 0]}}]'], False, False, False),
    (['effects=[{drag: {linear: 0.1, angular: 0.1}}]'], False, False, False),
])
def test_what_is_kept_follows_from_the_scene(overrides, held, energy, momentum):
    scene = load_scene('tennis_racket', overrides)
    one = Segment(0, scene, 1000.0, 1.0, held)
    assert (one.keeps_energy, one.keeps_momentum) == (energy, momentum)
    assert not Segment(0, None, 1000.0, 1.0).keeps_energy
