# SPDX-License-Identifier: Apache-2.0
"""A recording that is played: which state, trail and marks belong to a moment of the clock."""

import types

import numpy as np
import pytest
from analysis import made
from near import near

from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.view import player, snapshots
from rigid_body_sim.view.player import Player

RATE, TICKS = 100.0, 60
ACTS = {20: [('cmd_impulse', (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 'world')], 40: [('reset',)]}


@pytest.fixture(scope='module')
def path(tmp_path_factory):
    """Return the path of 0.6 s with an impulse at 0.2 s and a reset at 0.4 s."""
    path = tmp_path_factory.mktemp('player') / 'run'
    made.record(path, 'tennis_racket', TICKS, rate=RATE, acts=ACTS)
    return path


@pytest.fixture
def clock(monkeypatch):
    """Return a clock (a list of one time) that stands still unless it is put forward."""
    now = [100.0]
    monkeypatch.setattr(player.time, 'monotonic', lambda: now[0])
    return now


def test_states_are_those_recorded_with_their_times_and_energies(path):
    times, vectors, energies, source = player.states_of(path)
    assert times == pytest.approx(np.arange(TICKS + 1) / RATE, abs=1e-12)
    assert (vectors[:, 0] == times).all()
    simulation = Simulation('tennis_racket')
    before = simulation.states(times[:20])
    assert vectors[:20, 1:] == pytest.approx(before.vector[:, 1:], abs=1e-15)
    assert energies[:20] == near(simulation.diagnose(before)[0], rel=1e-15)
    assert energies[21] > energies[19] + 0.01
    assert source.scene.name == 'tennis_racket'


def test_of_a_long_recording_every_fourth_state_is_kept(path, monkeypatch):
    whole, *_ = player.states_of(path)
    monkeypatch.setattr(player, 'MOST_STATES', 16)
    times, vectors, energies, _ = player.states_of(path)
    assert times.tolist() == whole[::4].tolist()
    assert len(vectors) == len(energies) == 16


def test_a_moment_has_the_last_state_before_it_and_what_passed_since_another(path):
    one = Player(path)
    assert one.end == pytest.approx(0.6)
    # it is played, and cannot be pushed or edited
    assert (one.plays, one.paces, one.pushes, one.edits) == (True, True, False, False)
    begun = one.at(0.1, 0.05)
    assert begun.restarted
    assert (len(begun.trail), begun.events) == (1, ())
    one._restarted = False
    snapshot = one.at(0.305, 0.195)
    assert not snapshot.restarted
    assert snapshot.vector[0] == pytest.approx(0.3)
    assert snapshot.trail[:, 0] == pytest.approx(np.arange(20, 31) / RATE)
    assert [text for _, text in snapshot.events] == [text for at, text in one.marks
                                                  if 0.195 < at <= 0.305]
    assert any('commands' in text for _, text in snapshot.events)
    # a mark is told with the moment at which it lies, and not again
    [first] = [at for at, text in one.marks if 'commands' in text]
    told = [[text for at, text in one.at(*between).events if at == first]
            for between in ((first, 0.0), (0.305, first))]
    assert (len(told[0]), told[1]) == (1, [])
    assert one.at(0.195, 0.305).restarted
    assert one.at(-1.0, -2.0).vector[0] == 0.0


@pytest.mark.parametrize('scene', [
    'billiard_follow', 'heavy_top', 'kater_pendulum',
    pytest.param('rattleback', marks=pytest.mark.skipif(
        not HAVE_NUMBA, reason='its choice takes minutes in plain Python'))])
def test_force_and_torque_of_a_recording_are_those_of_its_motion(tmp_path, scene):
    """The topics have no velocity: a ball that rolls once seemed to slip, at full friction."""
    made.record(tmp_path / 'run', scene, 400, rate=4000.0)
    played = Player(tmp_path / 'run')
    mechanics = snapshots.Mechanics(played.scene)
    simulation = Simulation(played.scene, accuracy=1e-9)
    for at in (0.005, 0.025, 0.075, 0.0975):
        found = mechanics.of(played.at(at + 1e-6, at))    # the tick itself
        true = mechanics.arrows(simulation.states([at]).vector[0], Wrench())
        for name in ('force', 'torque'):
            scale = max(np.linalg.norm(getattr(true, name)), 1e-6)
            assert getattr(found, name) == pytest.approx(getattr(true, name), abs=2e-3 * scale)


def test_a_strike_is_no_force_of_the_states_beside_it(path):
    played = Player(path)
    for k in range(TICKS + 1):
        _, torque = played.at(k / RATE + 1e-9, 0.0).net
        assert np.linalg.norm(torque) < 1e-9


def test_states_too_far_apart_for_differences_tell_no_force(tmp_path):
    made.record(tmp_path / 'run', 'heavy_top', 60, rate=60.0)
    assert np.isnan(Player(tmp_path / 'run').at(0.5, 0.5).net).all()


def test_a_trail_across_many_states_has_a_few_dozen(path, monkeypatch):
    monkeypatch.setattr(player, 'MOST_BETWEEN', 5)
    one = Player(path)
    one._restarted = False
    times = one.at(0.6, 0.0).trail[:, 0]
    assert len(times) <= 2 * 5 + 1
    assert times[-1] == pytest.approx(0.6)
    assert np.ptp(np.diff(times)[:-1]) < 1e-9


def test_many_marks_are_those_of_commands_and_resets_only(path, monkeypatch):
    every = Player(path).marks
    monkeypatch.setattr(player, 'MOST_MARKS', len(every))
    assert Player(path).marks == every
    monkeypatch.setattr(player, 'MOST_MARKS', len(every) - 1)
    few = [text for _, text in Player(path).marks]
    assert {text.split()[0] for text in few} == {'commands', 'reset'}


def test_it_plays_at_its_speed_and_begins_anew_after_the_end(path, clock):
    one = Player(path)
    [first] = one.poll()
    assert (first.time, first.restarted) == (0.0, True)
    assert one.poll() == []
    clock[0] += 0.125
    [snapshot] = one.poll()
    assert snapshot.time == 0.125
    assert not snapshot.restarted
    assert len(snapshot.trail) == 12
    one.set_speed(2.0)
    clock[0] += 0.125
    assert one.poll()[0].time == 0.375
    clock[0] += 0.125
    [again] = one.poll()
    assert (again.time, again.restarted) == (0.0, True)


def test_it_halts_steps_and_goes_where_it_is_told(path, clock):
    one = Player(path)
    one.poll()
    one.tell('pause', True)
    clock[0] += 0.3
    assert one.poll() == []
    one.tell('step')
    assert one.poll()[0].time == pytest.approx(1.0 / 60.0)
    one.seek(0.55)
    [snapshot] = one.poll()
    assert (snapshot.time, snapshot.restarted) == (0.55, True)
    one.set_speed(6.0)
    one.tell('step')
    assert one.poll()[0].time == one.end
    one.tell('pause', False)
    one.tell('reset')
    assert one.poll()[0].time == 0.0


def test_beside_another_recording_the_state_is_that_of_the_very_time(path):
    """Halfway between two ticks it is halfway between their attitudes, and at a tick its own."""
    one = Player(path)
    ticks = [one.at(at / RATE + 1e-9, 0.0).vector for at in (10, 11)]
    moment = one.at(0.1, 0.1)
    for share in (0.0, 0.25, 0.5, 0.875):
        vector = moment.vector.copy()
        vector[0] = ticks[0][0] + share * (ticks[1][0] - ticks[0][0])
        found = one.beside_of(moment._replace(vector=vector)).vector
        assert found == pytest.approx(snapshots.state_between(*ticks, share), abs=1e-12)
    assert not np.allclose(*ticks, atol=1e-3)
    vector[0] = one.end + 1.0    # beyond its end it stays where it was
    assert (one.beside_of(moment._replace(vector=vector)).vector == one._vectors[-1]).all()


def made_of(rows, energies=None):
    """Return a recording and a source of some stamps (ns), poses at x = stamp, and energies."""
    def columns(topic, _):
        if topic == 'energy':
            return {'log_time': np.array(sorted(energies)),
                    'data': np.array([energies[stamp] for stamp in sorted(energies)])}
        place = np.array([(1e-9 * stamp, 0.0, 0.0) for stamp in rows])
        return {'log_time': np.array(rows), 'pose.position': place, 'vector': place + 1.0,
                'pose.orientation': np.tile((0.0, 0.0, 0.6, 0.8), (len(rows), 1))}
    topics = ['pose', 'angular_velocity', *(['energy'] if energies is not None else [])]
    return types.SimpleNamespace(path='run', read=columns), types.SimpleNamespace(
        topics={name: name for name in topics}, start=1_000_000_000, ticks=len(rows))


@pytest.mark.parametrize(('energies', 'expected'), [
    (None, [np.nan] * 3), ({}, [np.nan] * 3),
    ({1_500_000_000: 5.0, 2_000_000_000: 7.0}, [5.0, 5.0, 7.0])])
def test_energies_are_those_recorded_or_unknown(energies, expected):
    stamps = [1_000_000_000, 1_500_000_000, 3_000_000_000]
    times, vectors, found = player._states(*made_of(stamps, energies))
    assert times.tolist() == vectors[:, 0].tolist() == [0.0, 0.5, 2.0]
    assert vectors[:, 8].tolist() == [1.0, 1.5, 3.0]
    assert vectors[:, 5:8].tolist() == [[x + 1.0, 1.0, 1.0] for x in (1.0, 1.5, 3.0)]
    assert vectors[1, 1:5].tolist() == [0.0, 0.0, 0.6, 0.8]
    np.testing.assert_array_equal(found, expected)


def test_of_several_bodies_the_first_is_shown_if_it_has_the_topics(monkeypatch):
    recording, first = made_of([1_000_000_000])
    second = types.SimpleNamespace(topics={'pose': 'pose'})
    monkeypatch.setattr(player, 'Recording', type(recording))
    monkeypatch.setattr(player, 'sources', lambda recording: [first, second])
    assert player.states_of(recording)[-1] is first
    monkeypatch.setattr(player, 'sources', lambda recording: [second, first])
    with pytest.raises(BadInput, match='has no topic angular_velocity'):
        player.states_of(recording)


def test_a_difference_four_times_those_beside_it_is_kept_and_a_larger_one_is_not():
    least, other = np.array([0.0, 0.5, 0.0]), np.array([2.0, 0.0, 0.0])
    for size, kept in ((1.99, True), (2.0, True), (2.01, False)):
        value = np.array([0.0, 0.0, size])
        assert player._steady(value, other, least) is (value if kept else least)
