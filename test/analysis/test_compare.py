# SPDX-License-Identifier: Apache-2.0
"""A recording beside its rerun, on messages made by hand: where bits part, and by how much."""

import types

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.analysis import compare
from rigid_body_sim.analysis.compare import Comparison, within
from rigid_body_sim.errors import BadInput

RATE, START = 100.0, 5_000_000_000
TOPICS = {'pose': '/pose', 'angular_velocity': '/omega', 'energy': '/energy'}


class Rerun:
    """A body that turns about z at 3 rad/s and moves along x, tick by tick; 100 a second."""

    def __init__(self):
        self.next_tick, self.skipped = 0, []
        self.simulation = types.SimpleNamespace(rate=RATE)

    def ticks(self, log_times):
        return (log_times - START) // 10_000_000

    def skip_to(self, tick):
        self.skipped.append(tick)
        self.next_tick = tick

    def through(self, last):
        ticks = np.arange(self.next_tick, last + 1)
        self.next_tick = last + 1
        return states(ticks)


def states(ticks):
    vectors = np.zeros((len(ticks), 14))
    vectors[:, 0] = ticks / RATE
    vectors[:, 3], vectors[:, 4] = np.sin(0.015 * ticks), np.cos(0.015 * ticks)
    vectors[:, 7], vectors[:, 8] = 3.0, 0.5 * ticks
    found = types.SimpleNamespace(vector=vectors, angular_velocity=vectors[:, 5:8])
    return ticks, found, 7.0 + 0.0 * ticks, 9.0 + 0.0 * ticks


def recorded(ticks, **changes):
    """Return a stretch of messages at ticks; changes: topic -> what is added to its column."""
    ticks = np.array(ticks)
    _, found, energies, _ = states(ticks)
    times = {'log_time': START + 10_000_000 * ticks}
    stamped = {**times, 'header.stamp': times['log_time']}
    columns = {
        '/pose': {**stamped, 'pose.orientation': found.vector[:, 1:5].copy(),
                  'pose.position': found.vector[:, 8:11].copy()},
        '/omega': {**stamped, 'vector': found.vector[:, 5:8].copy()},
        '/energy': {**times, 'data': energies.copy()}}
    for topic, (column, place, by) in changes.items():
        columns[f'/{topic}'][column][place] += by
    return columns


@pytest.fixture
def comparison():
    return Comparison(Rerun(), TOPICS, types.SimpleNamespace(start=START, ticks=100))


def test_the_same_bits_are_told_as_such(comparison):
    comparison.take(recorded(range(10)))
    comparison.take(recorded(range(10, 15)))
    assert comparison.parting is None
    assert (comparison.ticks, comparison.messages) == (15, 45)
    assert {name: worst['difference'] for name, worst in comparison.largest.items()} == {
        'orientation': 0.0, 'position': 0.0, 'angular_velocity': 0.0, 'energy': 0.0}
    assert comparison.turned == pytest.approx(15 * 3.0 / RATE)
    # where it was first as large
    assert {worst['since_start'] for worst in comparison.largest.values()} == {0.0}
    scales = {name: worst['scale'] for name, worst in comparison.largest.items()}
    assert scales == pytest.approx({'orientation': 1.0, 'position': 7.0, 'angular_velocity': 3.0,
                                    'energy': 7.0})


def test_the_first_parting_is_that_of_the_earliest_tick_whatever_the_topic(comparison):
    comparison.take(recorded(range(10), pose=('pose.position', (8, 1), 0.25),
                             energy=('data', 3, 1e-12), omega=('vector', (5, 0), -2.0)))
    assert comparison.parting == {'tick': 3, 'time': 0.03, 'quantity': 'energy',
                                  'recorded': [7.0 + 1e-12], 'resimulated': [7.0]}
    assert comparison.largest['position'] == {
        'difference': 0.25, 'since_start': pytest.approx(0.08), 'scale': pytest.approx(4.5)}
    assert comparison.largest['angular_velocity']['difference'] == 2.0
    assert comparison.largest['angular_velocity']['since_start'] == pytest.approx(0.05)
    times, sizes = comparison.curve('position')
    assert dict(zip(times.tolist(), sizes.tolist(), strict=True))[0.08] == 0.25
    comparison.take(recorded(range(10, 12), omega=('vector', (1, 2), 9.0)))
    assert comparison.parting['tick'] == 3
    assert comparison.largest['angular_velocity']['difference'] == 9.0
    comparison.take(recorded(range(12, 14), omega=('vector', (1, 2), 1.0)))
    assert comparison.largest['angular_velocity']['difference'] == 9.0


def test_of_quantities_that_part_at_the_same_tick_the_first_is_told(comparison):
    comparison.take(recorded(range(2), pose=('pose.position', (1, 1), 0.25),
                             energy=('data', 1, 1e-12)))
    assert (comparison.parting['tick'], comparison.parting['quantity']) == (1, 'position')
    assert comparison.largest['position']['scale'] == (0.5**2 + 0.25**2)**0.5


def test_minus_zero_is_another_bit_but_no_difference(comparison):
    stretch = recorded(range(3))
    stretch['/omega']['vector'][1, 0] = -0.0
    comparison.take(stretch)
    assert (comparison.parting['tick'], comparison.parting['quantity']) == (1, 'angular_velocity')
    assert comparison.largest['angular_velocity']['difference'] == 0.0


def test_long_gaps_are_skipped_and_short_ones_computed(comparison):
    comparison.take(recorded([0, 1, 1001, 1002, 2003, 5000]))
    assert comparison._rerun.skipped == [5000]
    assert comparison.parting is None
    assert comparison.ticks == 6
    later = Comparison(Rerun(), TOPICS, types.SimpleNamespace(start=START, ticks=100))
    later.take(recorded([1001]))
    assert later._rerun.skipped == [1001]
    later = Comparison(Rerun(), TOPICS, types.SimpleNamespace(start=START, ticks=100))
    later.take(recorded([1000]))
    assert later._rerun.skipped == []


def test_a_topic_may_have_no_messages_beyond_a_gap_or_none_at_all(comparison):
    stretch = recorded([0, 5000])
    stretch['/energy'] = {name: column[:1] for name, column in stretch['/energy'].items()}
    del stretch['/omega']
    comparison.take(stretch)
    assert (comparison.ticks, comparison.messages, comparison.parting) == (2, 3, None)
    assert set(comparison.largest) == {'orientation', 'position', 'energy'}


def test_a_tick_that_comes_too_late_and_what_is_not_finite_are_refused(comparison):
    comparison.take(recorded(range(5)))
    with pytest.raises(BadInput, match='tick 4 comes too late'):
        comparison.take(recorded([4, 5]))
    with pytest.raises(BadInput, match='energy'):
        comparison.take(recorded([6], energy=('data', 0, np.nan)))


@pytest.mark.parametrize(('ticks', 'runs'), [
    ([0, 1, 2], [(0, 2)]), ([0, 1000], [(0, 1000)]), ([0, 1001], [(0, 0), (1001, 1001)]),
    ([5, 6, 2000, 2001, 9000], [(5, 6), (2000, 2001), (9000, 9000)])])
def test_ticks_are_cut_at_long_gaps(ticks, runs):
    assert list(compare._runs(np.array(ticks))) == runs


def test_ticks_are_cut_where_they_are_too_many_at_once(monkeypatch):
    monkeypatch.setattr(compare, 'SPAN', 10)
    assert list(compare._runs(np.arange(3, 28))) == [(3, 12), (13, 22), (23, 27)]


def worst(difference, scale):
    return {'difference': difference, 'since_start': 0.0, 'scale': scale}


@pytest.mark.parametrize(('largest', 'good'), [
    ({'orientation': worst(1e-6, 1.0)}, True), ({'orientation': worst(1.1e-6, 1.0)}, False),
    ({'position': worst(3.9e-5, 10.0)}, True), ({'position': worst(4.1e-5, 10.0)}, False),
    ({'orientation': worst(1e-7, 1.0), 'energy': worst(1.0, 1.0)}, False), ({}, True)])
def test_differences_are_small_beside_the_limit_and_their_scale(largest, good):
    assert within(largest, 1e-6) is good


@pytest.mark.parametrize('angle', [0.0, 1e-12, 1e-3, 1.0, 3.0, np.pi])
@pytest.mark.parametrize('sign', [1.0, -1.0])
def test_attitudes_are_apart_by_their_angle_whatever_the_signs(angle, sign):
    p = Rotation.from_rotvec([0.3, 0.4, -0.2])
    q = p * Rotation.from_rotvec(np.array([2.0, -1.0, 2.0]) / 3.0 * angle)
    found = compare._angle(p.as_quat()[np.newaxis], sign * q.as_quat()[np.newaxis])
    assert found == pytest.approx([angle], rel=1e-3 if angle < 1e-9 else 1e-9, abs=1e-15)


def test_a_recorded_attitude_that_is_no_unit_quaternion_is_as_far_off_as_any_may_be():
    assert compare._angle(np.array([[10.0, 0.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 0.0, 1.0]])) == (
        pytest.approx([2.0 * np.pi]))
