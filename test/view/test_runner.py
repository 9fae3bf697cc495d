# SPDX-License-Identifier: Apache-2.0
"""The loop behind a live page, driven by hand: pace, trail, pause, commands, reset."""

import numpy as np
import pytest

from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, LET_GO, WORLD, ZERO
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.view import runner
from rigid_body_sim.view.runner import Runner

SCENE = load_scene('tennis_racket')
SETTINGS = {'rate': 100.0, 'integrator': 'auto', 'accuracy': 1e-9}
SPIN = float(np.linalg.norm(SCENE.initial.angular_velocity))


class Pipe:
    """Stands for the pipe to the page; nothing comes from there."""

    def __init__(self):
        self.sent = []

    def send(self, message):
        self.sent.append(message)

    def poll(self, *_):
        return False

    def snapshots(self):
        """Return the snapshots since the last call."""
        found = [value for name, value in self.sent if name == 'snapshot']
        self.sent.clear()
        return found


@pytest.fixture
def running():
    """Return (Runner, Pipe) of a scene that has begun."""
    pipe = Pipe()
    one = Runner(pipe, SETTINGS, None)
    one.told('scene', SCENE.text)
    return one, pipe


def test_a_scene_begins_with_its_description_and_a_snapshot(running):
    _, pipe = running
    names = [name for name, _ in pipe.sent]
    assert names[:4] == ['preparing', 'preparing', 'scene', 'snapshot'] and names[-1] == 'prepared'
    about = pipe.sent[2][1]
    assert (about.method, about.text) == ('exact', SCENE.text)
    [snapshot] = pipe.snapshots()
    assert snapshot.restarted
    assert (snapshot.time, len(snapshot.trail)) == (0.0, 1)
    assert (snapshot.energy_residual, snapshot.momentum_residual) == (0.0, 0.0)


def test_a_scene_that_is_wrong_is_refused_and_the_one_before_goes_on(running):
    one, pipe = running
    pipe.snapshots()
    one.told('scene', SCENE.text.replace('mass:', 'mess:'))
    assert [name for name, _ in pipe.sent] == ['preparing', 'refused', 'prepared']
    pipe.snapshots()
    one._advance(0.1)
    assert pipe.snapshots()[0].time == pytest.approx(0.1)


def test_it_keeps_the_pace_of_the_clock_and_its_trail_is_dense(running):
    one, pipe = running
    pipe.snapshots()
    one._advance(0.105)
    [snapshot] = pipe.snapshots()
    assert snapshot.time == pytest.approx(0.105)
    truth = Simulation(SCENE, **SETTINGS).states(snapshot.trail[:, 0]).vector
    assert snapshot.trail == pytest.approx(truth, abs=1e-14)
    assert (snapshot.vector == snapshot.trail[-1]).all()
    # from one state to the next the body turns by a tenth at most
    assert len(snapshot.trail) == 1 + int(SPIN * 0.105 / runner.TURN_BETWEEN)
    assert np.diff([0.0, *snapshot.trail[:, 0]]).max() * SPIN <= runner.TURN_BETWEEN * 1.01
    one.told('speed', 4.0)
    one._cost = 0.0    # a machine that is busy lags; this is about the pace
    one._advance(0.5)
    [snapshot] = pipe.snapshots()
    assert snapshot.time == pytest.approx(2.105)
    assert len(snapshot.trail) == 1 + runner.MOST_BETWEEN


def test_snapshots_come_every_sixtieth_of_a_second_or_as_often_as_the_work_allows(monkeypatch):
    clock, advanced = [100.0], []

    class Busy(Pipe):
        """Waits as long as it is asked to; a request comes at once in the second period."""

        def poll(self, seconds):
            if len(advanced) == 1 and not self.sent:
                self.sent.append('asked')
                clock[0] += 0.25 * seconds
                return True
            if len(advanced) == 5:
                raise EOFError
            clock[0] += seconds
            return False

        def recv(self):
            return 'pause', True

    def advance(seconds):
        advanced.append(seconds)
        if len(advanced) == 2:
            clock[0] += 1.0    # work for a second: the next ones are due at once, and then in time
    monkeypatch.setattr(runner.time, 'monotonic', lambda: clock[0])
    one = Runner(Busy(), SETTINGS, None)
    monkeypatch.setattr(one, '_advance', advance)
    with pytest.raises(EOFError):
        one.run()
    assert one._paused
    assert advanced == pytest.approx([0.0, 1.0 / 60.0, 1.0, 0.0, 1.0 / 60.0])


def test_the_motion_ends_while_ticks_are_exact(running, monkeypatch):
    """1e9 s at 1000 Hz; here 1 s of that, 10 s at 100 Hz."""
    one, pipe = running
    monkeypatch.setattr(runner, 'LAST_TIME', 1.0)
    for until in (9.0, 10.0, 10.0):
        one._cost = 0.0
        one._advance(9.0)
        assert pipe.snapshots()[-1].time == until


@pytest.mark.parametrize('request_', ['scene', 'reset'])
def test_what_a_preparation_takes_is_no_time_of_the_motion(running, monkeypatch, request_):
    """A motion once leapt by the seconds in which its kernels were compiled."""
    one, pipe = running
    clock = [100.0]
    monkeypatch.setattr(runner.time, 'monotonic', lambda: clock[0])
    one._follow_clock()
    prepare = runner.expectation

    def slowly(*arguments):
        clock[0] += 9.0
        return prepare(*arguments)
    monkeypatch.setattr(runner, 'expectation', slowly)
    one.told(request_, SCENE.text)
    pipe.snapshots()
    clock[0] += 0.01
    one._follow_clock()
    assert pipe.snapshots()[0].time == pytest.approx(0.01)


def test_work_that_takes_long_makes_the_motion_lag(running, monkeypatch):
    one, pipe = running
    pipe.snapshots()
    one._cost = 5.0    # a second of the motion takes five
    one._advance(0.5)
    assert pipe.snapshots()[0].time == pytest.approx(runner.LONGEST_WORK / 5.0)
    assert one._cost < 5.0
    # a fifth of what it took this time: 0.3 s for 0.1 s of the motion
    ticks = iter((7.0, 7.3))
    monkeypatch.setattr(runner.time, 'perf_counter', lambda: next(ticks))
    one._cost = 0.25
    one._advance(0.1)
    assert one._cost == pytest.approx(0.8 * 0.25 + 0.2 * 3.0)


def test_a_pause_halts_it_and_steps_go_on_by_a_snapshot(running):
    one, pipe = running
    pipe.snapshots()
    one.told('pause', True)
    one._advance(0.5)
    assert pipe.snapshots() == []
    one._cost = 0.0
    one.told('step', None)
    one.told('step', None)
    one._advance(0.5)
    assert pipe.snapshots()[0].time == pytest.approx(2.0 * runner.PERIOD)
    one.told('pause', False)
    one._cost = 0.0
    one._advance(0.1)
    assert pipe.snapshots()[0].time == pytest.approx(2.0 * runner.PERIOD + 0.1)


def test_a_command_acts_at_the_present_tick_and_a_reset_goes_back(running):
    one, pipe = running
    one._advance(0.1)
    [_, before] = pipe.snapshots()
    push = (IMPULSE, WORLD, *ZERO, 0.0, 0.0, 0.25)
    one.told('command', np.array([push, (*push[:-1], np.inf)]))
    assert [name for name, _ in pipe.sent] == ['refused']
    pipe.snapshots()
    one._cost = 0.0
    one._advance(0.05)
    [snapshot] = pipe.snapshots()
    other = Simulation(SCENE, **SETTINGS)
    other.advance(10)
    other.command(np.array([push]))
    assert snapshot.vector == pytest.approx(other.states([snapshot.time])[0].vector, abs=1e-12)
    assert abs(snapshot.energy - before.energy) > 1e-4
    one.told('reset', None)
    [snapshot] = pipe.snapshots()
    assert snapshot.restarted
    assert snapshot.vector[1:] == pytest.approx(SCENE.initial.vector[1:])
    one._cost = 0.0
    one._advance(0.02)
    assert pipe.snapshots()[0].time == pytest.approx(0.02)


def test_what_happens_is_told_once():
    pipe = Pipe()
    one = Runner(pipe, SETTINGS, None)
    one._advance(1.0)    # no scene yet
    one.told('command', np.zeros((1, 8)))
    one.told('reset', None)
    assert pipe.sent == []
    one.told('scene', SCENE.text)
    one.told('speed', 1.0)
    told = []
    for _ in range(40):
        one._cost = 0.0
        one._advance(0.25)
        told += [event for snapshot in pipe.snapshots() for event in snapshot.events]
    simulation = Simulation(SCENE, **SETTINGS)
    simulation.advance(1000)
    assert told == [(event.time, event.name) for event in simulation.events]
    assert len(told) > 1


def advance_until(one, pipe, condition):
    """Advance a Runner in snapshots of 0.05 s until a condition holds; return the messages."""
    seen = []
    for _ in range(40):
        one._cost = 0.0
        one._advance(0.05)
        seen += pipe.sent
        pipe.sent.clear()
        if condition(seen):
            return seen
    raise AssertionError(seen)


def has(name):
    """Return a condition: a message of that name is among those seen."""
    return lambda seen: any(message[0] == name for message in seen)


@pytest.fixture(scope='module')
def disk():
    """Return the text of a disk that must roll."""
    return load_scene('rolling_disk').text


@pytest.mark.parametrize(('way', 'begins'), [
    ([('command', LET_GO), ('pause', False)], False), ([('reset', None)], True),
    ([('scene', SCENE.text)], True), ([('command', LET_GO), ('step', None)], False)])
def test_a_body_pulled_where_it_cannot_go_halts_and_each_way_on_leads_on(disk, way, begins):
    """A reset, and another scene, stood still after it."""
    pipe = Pipe()
    one = Runner(pipe, {**SETTINGS, 'integrator': 'dop8', 'accuracy': 1e-6}, None)
    one.told('scene', disk)
    one.told('command', np.array([(HOLD, WORLD, *ZERO, 0.0, 20.0, 0.0)]))
    seen = advance_until(one, pipe, has('failed'))
    [text] = [value for name, value in seen if name == 'failed']
    assert 'ideal rolling needs a plane that pulls' in text and text.endswith(runner.WAYS_ON)
    snapshots = [value for name, value in seen if name == 'snapshot']
    last = snapshots[-1].time
    [(end, name)] = [event for snapshot in snapshots for event in snapshot.events]
    assert name == 'end' and last <= end < last + 1.001 / SETTINGS['rate']
    one._advance(0.5)
    assert pipe.sent == []
    one.told('pause', False)    # still pulled: it says so again
    advance_until(one, pipe, has('failed'))
    for name, value in way:
        one.told(name, value)
    seen = [*pipe.sent, *advance_until(one, pipe, has('snapshot'))]
    snapshots = [value for name, value in seen if name == 'snapshot']
    assert not has('failed')(seen)
    assert snapshots[0].restarted == begins
    assert begins or snapshots[-1].time > last


def test_a_scene_that_cannot_take_its_first_step_is_refused_and_the_one_before_goes_on(running):
    """The process ended, and with it the page."""
    one, pipe = running
    pipe.snapshots()
    one.told('scene', load_scene('rolling_disk', ['initial.angular_velocity=[-30, 3, 3]']).text)
    [text] = [value for name, value in pipe.sent if name == 'refused']
    assert 'needs a plane that pulls' in text
    pipe.snapshots()
    one._cost = 0.0
    one._advance(0.1)
    assert pipe.snapshots()[0].time == pytest.approx(0.1)
