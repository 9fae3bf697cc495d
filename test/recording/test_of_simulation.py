# SPDX-License-Identifier: Apache-2.0
"""A recording without ROS: each message at its tick, in the order in which things took effect."""

import types

import numpy as np
import pytest
from recording.conftest import START

from rigid_body_sim.recording import of_simulation
from rigid_body_sim.recording.of_simulation import SimulationRecording
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.scene.state import States
from rigid_body_sim.simulation.command_rows import BODY, IMPULSE, LET_GO
from rigid_body_sim.simulation.simulation import Simulation

TICK = 10**7    # ns, at 100 Hz
BLOCK = ['/pose', '/angular_velocity', '/energy', '/angular_momentum_squared']


@pytest.fixture
def begun(tmp_path, monkeypatch):
    """Return (Simulation, its recording), whose first stamp is START."""
    monkeypatch.setattr(of_simulation, 'time', types.SimpleNamespace(time_ns=lambda: START))
    simulation = Simulation('tennis_racket', rate=100.0)
    return simulation, SimulationRecording(
        tmp_path / 'bag', 'simulate', simulation, {'scene': 'tennis_racket'}, ['tf'], True)


def event(tick):
    return types.SimpleNamespace(name=f'at {tick}', tick=tick, time=tick / 100, values={})


def messages(recording):
    """Return (topic, tick) of each message as they lie in the file; the journal's by kind."""
    journal = iter(recording.journal())
    found = []
    for one in recording.messages():
        assert one.publish_time == one.log_time
        tick, rest = divmod(one.log_time - START, TICK)
        assert rest == 0
        found.append((one.topic if one.topic != '/journal' else next(journal)['kind'], tick))
    return found


def test_each_message_is_recorded_with_its_tick(begun):
    simulation, recorded = begun
    recorded.ticks(0, States(simulation.vector[np.newaxis].copy()))
    first = simulation.advance_through(10)
    recorded.note([event(10), event(0), event(4), event(15)])    # tick 0 is recorded already
    recorded.ticks(1, first)
    recorded.ticks(11, States(first.vector[:0]))    # none: nothing happens
    recorded.ticks(11, simulation.advance_through(10))
    recorded.close()
    with Recording(recorded._writer.path) as recording:
        found = messages(recording)
        names = [one.name for one in recording.events()]
        assert recording.read('/pose')['sequence'].tolist() == list(range(21))
        assert recording.read('/pose')['header.stamp'].tolist() == [
            START + k * TICK for k in range(21)]
        assert recording.message_count == recorded.messages
    assert names == ['at 0', 'at 4', 'at 10', 'at 15']
    # 30 Hz: the first tick at or after each thirtieth of a second
    between = {4: ['/events', '/tf'], 7: ['/tf'], 10: ['/events', '/tf'], 14: ['/tf'],
               15: ['/events'], 17: ['/tf'], 20: ['/tf']}
    expected = [('begin', 0), ('/scene', 0), ('/tf', 0), *((name, 0) for name in BLOCK),
                ('state', 0), ('/events', 0)]
    for tick in range(1, 21):
        expected += [(name, tick) for name in (*between.get(tick, ()), *BLOCK)]
    assert found == expected


def test_the_full_state_is_that_of_the_last_tick_recorded(begun):
    simulation, recorded = begun
    states = simulation.advance_through(5)
    recorded.ticks(1, States(states.vector[:4]))    # the simulation is further on
    assert recorded._writer.state_wanted
    recorded.ticks(5, States(states.vector[4:]))
    assert not recorded._writer.state_wanted
    recorded.ticks(6, simulation.advance_through(1))
    recorded.close()
    with Recording(recorded._writer.path) as recording:
        [entry] = [entry for entry in recording.journal() if entry['kind'] == 'state']
    assert (entry['tick'], entry['stamp']) == (5, START + 5 * TICK)
    assert entry['vector'] == states.vector[4].tolist()


def test_commands_resets_and_other_simulations_are_recorded_at_the_present_tick(begun):
    simulation, recorded = begun
    recorded.ticks(1, simulation.advance_through(3))
    rows = np.concatenate([
        np.array([(IMPULSE, BODY, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)]), LET_GO])
    recorded.commands(rows)
    recorded.commands(rows[:0])
    recorded.reset()
    other = Simulation('tennis_racket', rate=100.0, overrides={'body.mass': 2.0})
    other.follow(simulation, keep_state=False)
    recorded.switch(other, {'scene': 'heavier'})
    recorded.ticks(4, other.advance_through(2))
    recorded.close()
    with Recording(recorded._writer.path) as recording:
        entries = {entry['kind']: entry for entry in recording.journal()}
        assert [one for one in messages(recording) if one[0] not in (*BLOCK, '/tf')] == [
            ('begin', 0), ('/scene', 0), ('state', 3), ('/cmd_impulse', 3), ('commands', 3),
            ('reset', 3), ('parameters', 3), ('/scene', 3)]
        scenes = [message['data'] for _, message in recording.decoded('/scene')]
        assert recording.commands()['force'].tolist() == [[1.0, 2.0, 3.0], [0.0] * 3]
    assert scenes == [simulation.scene.text, other.scene.text]
    assert scenes[0] != scenes[1]
    assert entries['reset']['tick'] == entries['parameters']['tick'] == 3
    assert entries['parameters']['keeps_state'] is False
    assert entries['parameters']['scene'] == other.scene.text


def test_topics_of_commands_are_there_where_commands_may_come(tmp_path):
    simulation = Simulation('tennis_racket', rate=100.0)
    for commanded, count in ((False, 0), (True, 2)):
        path = tmp_path / str(commanded)
        more = (commanded,) if commanded else ()
        SimulationRecording(path, 'simulate', simulation, {}, (), *more).close()
        with Recording(path) as recording:
            assert sum('cmd' in name for name in recording.topics) == count
            assert '/tf' not in recording.topics
