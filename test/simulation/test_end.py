# SPDX-License-Identifier: Apache-2.0
"""Runs that end early: the simulation stands at the last tick before, and `end` is told."""

import contextlib
import pickle
import types

import numpy as np
import pytest

from rigid_body_sim.analysis.resimulate import main as resimulate
from rigid_body_sim.errors import BadInput, Ended, NotConverged
from rigid_body_sim.messages.state_topics import Frames, chosen, scene_messages
from rigid_body_sim.node.journal import NoJournal
from rigid_body_sim.node.rehearsal import _Nowhere, _Queue, rehearse
from rigid_body_sim.realtime.session import Session
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import STATE_SIZE
from rigid_body_sim.simulation.admission import no_motion_follows
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, LET_GO, ZERO, row_of
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.view.runner import Runner

pytestmark = pytest.mark.without_numba

FAST = """
scene: fast
body: {mass: 1.0, inertia: [0.01, 0.012, 0.02], center_of_mass: [0, 0, -0.03],
       surface: {ellipsoid: {semi_axes: [0.2, 0.1, 0.15]}}}
constraint: table
effects: [gravity: {g: 9.81}, sliding_friction: {mu: .inf}]
initial: {euler_zyz: [0, 0.6, 0.4], angular_velocity: [0, 14, 0], rolling: true}
"""
# the strike pushes a rod that is dragged the other way, into Painleve's paradox
ROD = """
scene: rod
body: {mass: 1.0, inertia: [0.0833333333333, 0.0833333333333, 1.0e-4],
       surface: {ellipsoid: {semi_axes: [0.005, 0.005, 0.5]}}}
constraint: table
effects: [gravity: {g: 9.81}, sliding_friction: {mu: 2.5},
          strike: {impulse: [-8, 0, 0], time: 0.01}]
initial: {euler_zyz: [0, 0.5, 0], velocity: [4.0, 0, 0]}
"""
# more work than a double holds
BAT = """
scene: bat
body: {mass: 1.0, inertia: [0.01, 0.012, 0.02]}
constraint: free
effects: [torque: {value: [0, 0, '0.01*cos(wx)']},
          strike: {impulse: [0, 1e75, 0], point: [1e75, 0, 0], time: 0.0125}]
initial: {angular_velocity: [1, 2, 3]}
"""
ENDS = {'rolling': (FAST, 60, 0.0606186), 'struck': (ROD, 9, 0.01), 'refused': (BAT, 12, 0.0125)}
"""Scene, last tick at 1 kHz, time of the end (s, at 1e-9)."""
both = pytest.mark.parametrize(('text', 'last', 'end'), ENDS.values(), ids=ENDS)


def simulation(text, **settings):
    return Simulation(parse_scene(text), 'dop8', 1e-9, **settings)


def one_by_one(text):
    """Return a simulation that stands where advancing by single ticks ends, and its states."""
    one, vectors = simulation(text), []
    with contextlib.suppress(Ended):
        while True:
            one.advance()
            vectors.append(one.vector.copy())
    return one, np.array(vectors)


def told(one):
    return [(event.name, event.tick) for event in one.events]


@both
def test_advance_goes_to_the_last_tick_and_tells_the_end_once(text, last, end):
    ticking, _ = one_by_one(text)
    jumping = simulation(text)
    for ticks in (100, 1, 100):
        with pytest.raises(Ended) as error:
            jumping.advance(ticks)
        assert str(error.value).count('\n') == 0
        assert (jumping.tick, told(jumping)) == (last, [('end', last)])
    assert jumping.events == ticking.events
    assert jumping.events[0].time == pytest.approx(end, abs=1e-7)
    assert jumping.vector.tobytes() == ticking.vector.tobytes()
    assert jumping.ledger() == ticking.ledger()


@both
def test_advance_through_returns_the_states_before_the_end(text, last, end):
    _, vectors = one_by_one(text)
    one = simulation(text)
    assert one.advance_through(100).vector.tobytes() == vectors.tobytes()
    assert (one.tick, len(vectors), told(one)) == (last, last, [('end', last)])
    with pytest.raises(Ended):
        one.advance_through(100)
    assert (one.tick, told(one)) == (last, [('end', last)])


@both
def test_a_copy_and_a_pickle_of_an_ended_run_do_not_tell_the_end_again(text, last, end):
    one = simulation(text)
    one.advance_through(100)
    for other in (one.copy(), pickle.loads(pickle.dumps(one))):
        with pytest.raises(Ended) as error:
            other.advance()
        assert told(other) == [('end', last)]
        again = pickle.loads(pickle.dumps(error.value))
        assert (str(again), again.time) == (str(error.value), error.value.time)


@both
def test_at_event_finds_the_same_end_before_and_after_it_is_told(text, last, end):
    one, late = simulation(text), simulation(text)
    found = [one.at_event('end'), one.at_event('end')]
    one.advance_through(100)
    late.advance(last)
    found += [one.at_event('end'), late.at_event('end')]
    assert len({state.vector.tobytes() for state in found}) == 1
    assert found[0].time == one.events[0].time
    with pytest.raises(BadInput, match=r"no 'rest' within 100 s; in that time come: end"):
        one.at_event('rest')


def test_at_event_tells_what_the_strike_into_the_paradox_leaves():
    one = simulation(ROD)
    one.advance(9)
    slower = one.at_event('end').velocity[0] - one.state.velocity[0]
    assert slower < -8.0    # 8 N s on 1 kg, and the turn that the contact gives


def test_at_event_finds_an_end_before_a_later_strike():
    one = simulation(FAST.replace('.inf}]', '.inf}, strike: {impulse: [1, 0, 0], time: 0.0607}]'))
    assert one.at_event('end').time == pytest.approx(0.0606186, abs=1e-7)
    with pytest.raises(Ended):
        one.advance(100)
    assert told(one) == [('end', 60)]


def test_a_command_before_the_end_voids_it_and_a_reset_tells_it_anew():
    one = simulation(FAST)
    one.advance_through(100)
    one.hold(force=[0.0, 0.0, -50.0])    # presses it on the plane
    assert told(one) == []
    one.advance(2)
    assert one.tick == 62
    one.reset()
    one.events.clear()
    with pytest.raises(Ended):
        one.advance(100)
    assert told(one) == [('end', 62 + 60)]


UNSTRUCK = ROD.replace(',\n          strike: {impulse: [-8, 0, 0], time: 0.01}', '')
HARD, SOFT = (row_of(IMPULSE, force, ZERO, 'world') for force in ([-8, 0, 0], [-0.5, 0, 0]))


def test_a_command_after_which_no_motion_follows_is_refused_and_leaves_no_trace():
    one, softly, other = (simulation(UNSTRUCK) for _ in range(3))
    for each in one, softly, other:
        each.advance(10)
    with pytest.raises(BadInput, match=r'impulse: no motion follows it: .*paradox at t = 0\.01 s'):
        one.impulse(force=[-8, 0, 0])
    [refusal] = softly.command(np.vstack([SOFT, HARD]))
    assert (refusal.place, refusal.reason) == (1, 'the body cannot take it')
    assert softly.state.velocity[0] < one.state.velocity[0]
    softly.command(row_of(IMPULSE, [0.5, 0, 0], ZERO, 'world'))    # cancels the one taken
    for each in one, softly, other:
        each.advance(10)
    for each in one, softly:
        assert each.vector.tobytes() == other.vector.tobytes()
        assert (each.ledger(), each.events, each.departed) == (other.ledger(), [], None)


def test_a_hold_after_which_no_motion_follows_leaves_the_one_before():
    one = simulation(FAST)
    one.advance(60)
    one.hold(force=[0.0, 0.0, -50.0])    # presses it on the plane
    one.advance(5)
    held, before = one.wrench, one.vector.tobytes()
    with pytest.raises(BadInput, match=r'wrench: no motion follows it: .*a plane that pulls'):
        one.hold(force=[0.0, 0.0, 1.0])
    assert (one.wrench, one.vector.tobytes()) == (held, before)
    one.release()
    assert not one.wrench


def test_a_refused_command_is_not_in_the_recording_which_runs_again_to_the_bit(tmp_path, capsys):
    sent, run = [], tmp_path / 'run'
    pipe = types.SimpleNamespace(send=sent.append, poll=lambda *_: False)
    settings = {'rate': 1000.0, 'integrator': 'dop8', 'accuracy': 1e-9}
    one = Runner(pipe, settings, str(run))
    one.told('scene', UNSTRUCK)
    for rows in HARD, SOFT:
        one._advance(0.005)
        one.told('command', rows)
    one._advance(0.005)
    one.close()
    [line] = [line for name, line in sent if name == 'refused']
    assert line.startswith('impulse: no motion follows it')
    with Recording(run) as recording:
        [entry] = [one for one in recording.journal() if one['kind'] == 'commands']
    assert [row['force'] for row in entry['commands']] == [[-0.5, 0, 0]]
    assert resimulate([str(run)]) == 0
    assert 'identical' in capsys.readouterr().out


def test_without_watching_the_run_ends_at_the_same_tick_without_an_event():
    one = simulation(FAST)
    one.watching = False
    with pytest.raises(Ended):
        one.advance(100)
    assert (one.tick, one.events) == (60, [])


RATES = 'torque: {value: [0, 0, %s]}'


@pytest.mark.filterwarnings('ignore')
@pytest.mark.parametrize(('effect', 'spin', 'method', 'step', 'last'), [
    (RATES % 'sqrt(0.0305 - t)', 3.0, 'dop8', None, 30),    # not finite after 0.0305 s
    (RATES % 'sqrt(0.0305 - t)', 3.0, 'radau', None, 30),
    (RATES % 'sqrt(0.0305 - t)', 3.0, 'rk4', 7e-4, 30),     # the last step ends at 0.0308 s
    (RATES % 'sqrt(0.0305 - t)', 3.0, 'rk4', 7e-3, 30),     # parts of a step are finite
    (RATES % 'sqrt(0.0305 - t)', 3.0, 'dop8', 7e-3, 30),
    ('force: {value: [sqrt(0.0305 - t), 0, 0]}', 3.0, 'rk4', 7e-3, 30),
    (RATES % 'wz^2', 300.0, 'dop8', None, 8),               # infinite at 1/120 s
    (RATES % 'wz^2', 300.0, 'rk4', 7e-4, 9),
    ('force: {value: [1e5*vx, 0, 0]}', 3.0, 'rk4', 1e-3, 23),    # then the energy is infinite
    (RATES % 'wz^2', 300.0, 'lsoda', None, 8),              # by too many steps
    (RATES % '-100*sign(wz)', 1.02, 'dop8', None, 25)])     # slides along a kink from 0.0255 s on
def test_a_method_that_gives_up_leaves_the_last_tick_before(effect, spin, method, step, last):
    scene = parse_scene('scene: a\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
                        f'effects: [{effect}]\ninitial: {{spin: {spin}, velocity: [1, 0, 0]}}\n')
    one, through, ticking = (
        Simulation(scene, method, 1e-6, step=step, horizon=1.0) for _ in range(3))
    with pytest.raises(NotConverged) as jumped:
        one.advance(4096)
    assert (one.tick, one.events) == (last, [])
    assert len(through.advance_through(4096)) == last
    ticking.advance(last)
    with pytest.raises(NotConverged) as ticked:
        ticking.advance()
    for each in through, ticking:
        assert (each.tick, each.vector.tobytes()) == (last, one.vector.tobytes())
    assert np.isfinite([*one.vector, one.energy, one.angular_momentum_squared]).all()
    if 'sqrt' in effect:    # elsewhere the work, a force times a speed, may be infinite before
        assert np.isfinite(list(one.ledger().values())).all()
    if method != 'lsoda':    # which tells the time that was asked for
        assert str(ticked.value) == str(jumped.value)


@pytest.mark.filterwarnings('ignore')
def test_a_runner_and_an_ensemble_of_fixed_steps_refuse_a_state_that_is_not_finite():
    scene = parse_scene('scene: a\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
                        f"effects: [{RATES % 'sqrt(0.0305 - t)'}]\ninitial: {{spin: 3}}\n")
    one = Simulation(scene, 'rk4', step=7e-3)
    start, out = scene.initial.vector, np.empty(STATE_SIZE)
    one.runner()(start, 0.03, out)
    assert np.isfinite(out).all()
    with pytest.raises(NotConverged, match=r'at t = 0\.031 s the state is no longer finite'):
        one.runner()(start, 0.031, out)
    with pytest.raises(NotConverged, match=r'^body 0: .* at t = 0\.031 s'):
        ensemble(scene, start[np.newaxis], [0.031], one.choice)


class Told(_Nowhere):
    """Publishers that remember: how many ticks, and which events came after how many."""

    def __init__(self, messages):
        super().__init__(messages)
        self.ticks, self.events = 0, []

    def tick(self, messages):
        self.ticks += 1

    def event(self, level, name, message, values):
        self.events.append((name, values['tick'], self.ticks))
        return super().event(level, name, message, values)


def session_of(one, timeout=0.0):
    """Return a Session that has begun, and its publishers."""
    messages = scene_messages(chosen(()), one.scene, Frames())
    rehearse(one, messages)    # ended the node with a traceback
    publishing = Told(messages)
    settings = types.SimpleNamespace(command_timeout=timeout, duration=0.0, display_rate=30.0)
    session = Session(one, _Queue(), publishing, NoJournal(), settings, lambda: 0)
    session.begin()
    return session, publishing


@both
def test_the_node_publishes_every_tick_before_the_end_and_the_event(text, last, end):
    session, publishing = session_of(simulation(text))
    for _ in range(last + 1):
        session.run_tick(True)
    with pytest.raises(Ended):
        session.run_tick(True)
    assert (session.next_tick, publishing.ticks) == (last + 1, last + 1)
    assert publishing.events == [('end', last, last + 1)]


def test_a_release_that_is_refused_when_a_wrench_times_out_is_tried_again(monkeypatch):
    one = simulation(BAT)
    session, publishing = session_of(one, timeout=0.003)
    session._commands.put(row_of(HOLD, [0.1, 0, 0], ZERO, 'world'))
    command = one.command

    def refuse_until_tick_5(rows):
        if rows is LET_GO and one.tick < 5:
            return [no_motion_follows(rows[0], Ended('as a test has it'))]
        return command(rows)
    monkeypatch.setattr(one, 'command', refuse_until_tick_5)
    wrenches = []
    for _ in range(7):
        session.run_tick(True)
        wrenches.append(bool(one.wrench))
    assert wrenches == [True] * 5 + [False] * 2
    assert publishing.events == [('command timed out', 5, 5)]
