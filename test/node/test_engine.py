# SPDX-License-Identifier: Apache-2.0
"""The engine on parts that are made by hand: services, changes of parameters, the report."""

import concurrent.futures
import types

import pytest

from rigid_body_sim.choice.choice import HORIZON
from rigid_body_sim.errors import BadInput
from rigid_body_sim.node import engine as module
from rigid_body_sim.node.engine import Engine
from rigid_body_sim.realtime.session import Session


def answered(value):
    """Return a Future that has its result."""
    future = concurrent.futures.Future()
    future.set_result(value)
    return future


class Ticker:
    """Stands for the ticker: keeps what it is asked for."""

    def __init__(self, paused=False, step=None, alive=False, failure=None):
        self.asked, self.paused, self._step = [], paused, step
        self.alive, self.failure, self.skip_publish = alive, failure, False

    def step(self):
        return self._step

    def pause(self):
        self.asked.append('pause')

    def resume(self):
        self.asked.append('resume')

    def pace(self, rate, factor):
        self.asked.append((rate, factor))

    def is_alive(self):
        return self.alive

    def stop(self):
        self.asked.append('stop')

    def join(self, seconds):
        self.asked.append(('join', seconds))


class Asked:
    """Stands for a Session: keeps requests, and what it is told at their tick."""

    def __init__(self, future=None):
        self.requests, self.told, self.command_timeout = [], [], None
        self.future = future

    def request(self, act):
        self.requests.append(act)
        return self.future

    def switch(self, *arguments):
        self.told.append(('switch', *arguments))

    def note_parameters(self, *arguments):
        self.told.append(('note', *arguments))


def engine_of(**parts):
    engine = object.__new__(Engine)
    vars(engine).update(parts)
    return engine


@pytest.fixture(autouse=True)
def _no_wait(monkeypatch):
    monkeypatch.setattr(module, 'ANSWER_WITHIN', 0.0)


@pytest.mark.parametrize(('tick', 'paused', 'told'), [
    (0, False, 'the state went back at tick 0'), (7, True, 'the state went back at tick 7'),
    (None, False, 'the state goes back at the next tick'),
    (None, True, 'the state goes back at the next tick: resume or step')])
def test_a_reset_answers_with_its_tick_or_with_what_will_happen(tick, paused, told):
    future = concurrent.futures.Future() if tick is None else answered(tick)
    session = Asked(future)
    response = engine_of(session=session, ticker=Ticker(paused))._reset(
        None, types.SimpleNamespace())
    assert (response.success, response.message) == (True, told)
    assert session.requests == [Session.reset]


@pytest.mark.parametrize(('data', 'asked', 'told'), [
    (True, ['pause'], 'paused'), (False, ['resume'], 'running')])
def test_a_pause_is_begun_and_ended(data, asked, told):
    ticker = Ticker()
    response = engine_of(ticker=ticker)._pause(
        types.SimpleNamespace(data=data), types.SimpleNamespace())
    assert (response.success, response.message, ticker.asked) == (True, told, asked)


@pytest.mark.parametrize(('paused', 'step', 'success', 'told'), [
    (False, answered(3), False, 'the node is running'), (True, answered(0), True, 'tick 0'),
    (True, concurrent.futures.Future(), True, 'the tick has not been run yet')])
def test_a_step_is_for_a_node_that_is_paused(paused, step, success, told):
    response = engine_of(ticker=Ticker(paused, step))._step(None, types.SimpleNamespace())
    assert response.success is success and response.message.startswith(told)


@pytest.mark.parametrize(('changes', 'prepared', 'keeps', 'paces'), [
    ({'command_timeout': 0.5}, None, True, False), ({'rate': 50.0}, 'new', True, True),
    ({'real_time_factor': 2.0}, None, True, True), ({'integrator': 'dop8'}, 'new', True, False),
    ({'scene': 'sphere'}, 'new', False, False),
    ({'scene_overrides': ['a=1'], 'rate': 50.0}, 'new', False, True)])
@pytest.mark.parametrize('overrun', ['skip_publish', 'slip'])
def test_changes_are_made_at_a_tick_and_only_another_scene_begins_anew(
        changes, prepared, keeps, paces, overrun):
    """What was prepared is used once."""
    session, ticker = Asked(), Ticker()
    settings = types.SimpleNamespace(
        command_timeout=0.25, overrun=overrun, rate=50.0, real_time_factor=2.0)
    engine = engine_of(session=session, ticker=ticker, _settings=settings,
                       _prepared=prepared and (prepared, 'messages'))
    engine._after_change(changes)
    assert engine._prepared is None and session.told == []
    [change] = session.requests
    change(session)
    switched = [('switch', 'new', 'messages', keeps)] if prepared else []
    assert session.told == [*switched, ('note', changes, keeps)]
    assert ticker.asked == ([(50.0, 2.0)] if paces else [])
    assert session.command_timeout == 0.25
    assert ticker.skip_publish is (overrun == 'skip_publish')
    engine._after_change({})
    assert len(session.requests) == 1


@pytest.mark.parametrize(('changes', 'prepares'), [
    ({'command_timeout': 0.5}, False), ({'rate': 50.0, 'command_timeout': 0.5}, True)])
def test_only_what_changes_the_simulation_prepares_another_one(changes, prepares, monkeypatch):
    rehearsed = []
    monkeypatch.setattr(module, 'rehearse', lambda *of: rehearsed.append(of))
    engine = engine_of(
        publishing=types.SimpleNamespace(messages_for=lambda scene: f'messages of {scene}'),
        _prepare=lambda changes: types.SimpleNamespace(scene='top'), _prepared='of before')
    engine._before_change(changes)
    assert rehearsed == ([engine._prepared] if prepares else [])
    assert engine._prepared is None or engine._prepared[1] == 'messages of top'


@pytest.mark.parametrize(('duration', 'step', 'changes', 'wanted'), [
    (0.0, 0.0, {}, ('auto', 1e-9, 100.0, None, HORIZON)),
    (12.0, 0.5, {'rate': 50.0}, ('auto', 1e-9, 50.0, 0.5, 12.0))])
def test_a_simulation_is_prepared_from_parameters_and_changes(
        duration, step, changes, wanted, monkeypatch):
    """A step of 0 is none, and a duration of 0 is that of no end: the usual horizon holds."""
    class Settings(dict):
        pass
    settings = Settings(scene='top', scene_overrides=['a=1'], integrator='auto', accuracy=1e-9,
                        rate=100.0, step=step)
    settings.duration = duration
    monkeypatch.setattr(module, 'load_scene', lambda *of: of)
    monkeypatch.setattr(module, 'Simulation', lambda *of, horizon: (*of, horizon))
    assert engine_of(_settings=settings)._prepare(changes) == (('top', ['a=1']), *wanted)


@pytest.mark.parametrize(('origin', 'stamp'), [('zero', 0), ('now', 5_000_000_001)])
def test_stamps_begin_at_zero_or_at_the_clock(origin, stamp):
    now = types.SimpleNamespace(nanoseconds=5_000_000_001)
    node = types.SimpleNamespace(get_clock=lambda: types.SimpleNamespace(now=lambda: now))
    settings = types.SimpleNamespace(stamp_origin=origin)
    assert engine_of(_node=node, _settings=settings)._epoch() == stamp


@pytest.mark.parametrize(('publish', 'follows', 'refused'), [
    (['clock'], True, True), (['clock'], False, False), (['pose'], True, False)])
def test_a_node_cannot_follow_the_clock_that_it_publishes(publish, follows, refused, monkeypatch):
    begun = []
    monkeypatch.setattr(Engine, '_set_up', lambda *of: begun.append(of))
    node = types.SimpleNamespace(publishers=(), subscriptions=(), services=(), timers=())
    settings = types.SimpleNamespace(publish=publish, use_sim_time=follows, record=False)
    if refused:
        with pytest.raises(BadInput, match='clock together with use_sim_time'):
            Engine(node, settings, None)
    else:
        Engine(node, settings, None)
    assert len(begun) == (not refused)


@pytest.mark.parametrize('publish', [['pose'], ['pose', 'robot_description']])
@pytest.mark.parametrize(('overrun', 'follows'), [('skip_publish', True), ('slip', False)])
def test_parts_are_made_as_the_parameters_say(publish, overrun, follows, monkeypatch):
    """All that can fail is done before the services are offered."""
    made = {}

    def keep(name):
        def make(*arguments):
            made[name] = arguments
            return name
        return make
    for name in ('rehearse', 'Commands', 'open_journal', 'Session', 'Ticker', 'Diagnostics',
                 'StatusLine', 'frames_of', 'Followed', 'Steady', 'Publishing'):
        monkeypatch.setattr(module, name, keep(name))
    monkeypatch.setattr(module.state_topics, 'chosen', lambda names: 'outputs')
    monkeypatch.setattr(module.state_topics, 'scene_messages', lambda *_: 'messages')
    scene = types.SimpleNamespace(notes=['a note'], name='top')
    monkeypatch.setattr(Engine, '_prepare', lambda self, changes: types.SimpleNamespace(
        scene=scene, missed=''))
    said, services = [], []
    logger = types.SimpleNamespace(info=said.append, warning=said.append)
    node = types.SimpleNamespace(
        publishers=(), subscriptions=(), services=(), timers=(), get_logger=lambda: logger,
        get_clock=lambda: 'clock',
        create_service=lambda kind, name, serve: services.append(
            (kind.__name__, name, serve.__name__)))
    settings = types.SimpleNamespace(
        publish=publish, use_sim_time=follows, record=False, rate=50.0, real_time_factor=2.0,
        overrun=overrun, refuse_unknown_qos=lambda: None, on_change=keep('changes'))
    engine = Engine(node, settings, 'at end')
    assert said == ['a note']
    assert made['Publishing'] == (
        node, 'outputs', 'frames_of', 'messages', 'robot_description' in publish)
    source = 'Followed' if follows else 'Steady'
    assert made['Ticker'] == (
        'Session', source, 50.0, 2.0, overrun == 'skip_publish', 'at end')
    assert made[source] == (('clock',) if follows else ())
    assert made['changes'] == (engine._before_change, engine._after_change)
    assert services == [('Trigger', '~/reset', '_reset'), ('SetBool', '~/pause', '_pause'),
                        ('Trigger', '~/step', '_step')]


def test_a_node_ends_within_a_second():
    """It waits for the tick thread, and as long again for the recorder."""
    assert 2.0 * module.STOP_WITHIN < 1.0


def test_a_service_waits_for_its_tick_for_a_limited_time():
    asked = []
    module._result_soon(types.SimpleNamespace(result=asked.append))
    assert asked == [module.ANSWER_WITHIN]


@pytest.mark.parametrize(('running', 'told'), [
    (2_000_000_000, '2001 ticks in 2.000 s (1000.000 Hz)'), (0, '2001 ticks in 0.000 s (0.000 Hz)')
])
@pytest.mark.parametrize('recorded', [True, False])
def test_the_report_is_in_seconds_and_microseconds(running, told, recorded, monkeypatch):
    """2001 ticks have 2000 periods between them."""
    lines = []
    monkeypatch.setattr(module, 'tell', lines.append)
    ticker = types.SimpleNamespace(
        latest=(2001, running), overruns=3, skipped=4, slipped=500_000_000,
        lateness=types.SimpleNamespace(
            summary=lambda: {'p50': 12e-6, 'p99': 345e-6, 'max': 6.789e-3}))
    session = types.SimpleNamespace(
        balance={'energy_residual': 1.5e-16, 'momentum_residual': 2e-15},
        event_counts={'flip': 2, 'end': 1},
        simulation=types.SimpleNamespace(scene=types.SimpleNamespace(name='top')))
    journal = types.SimpleNamespace(
        path='runs/top', status=types.SimpleNamespace(recorded=7, dropped=1) if recorded else None)
    node = types.SimpleNamespace(get_fully_qualified_name=lambda: '/sim_node')
    engine_of(ticker=ticker, session=session, journal=journal, _node=node)._report()
    assert lines == [
        f'/sim_node: top, {told}',
        '  ticks began late by p50 12, p99 345, max 6789 us; 3 overruns, 4 ticks not published, '
        '0.500 s slipped',
        '  energy residual 1.50e-16, angular momentum residual 2.00e-15, 1 x end, 2 x flip',
        '  recorded 7 messages, 1 ticks left out: runs/top' if recorded else '  not recorded']


@pytest.mark.parametrize(('alive', 'failure', 'error', 'status', 'balances'), [
    (False, None, '', 0, 1), (True, None, '', 0, 0), (False, ValueError('x'), '', 1, 0),
    (False, None, 'the disk is full', 1, 1)])
@pytest.mark.parametrize('recorded', [True, False])
def test_the_end_says_what_failed(alive, failure, error, status, balances, recorded, monkeypatch):
    """A tick thread that hangs, or has failed, is asked for no ledger."""
    said, closed, balanced = [], [], []
    monkeypatch.setattr(module, 'say', said.append)
    if not recorded:
        error, status = '', int(failure is not None)
    part = types.SimpleNamespace(close=lambda *of: closed.append(of), on_change=lambda *_: None,
                                 status=types.SimpleNamespace(error=error) if recorded else None)
    ticker = Ticker(alive=alive, failure=failure)
    engine = engine_of(
        _settings=part, _status_line=part, _source=part, journal=part, ticker=ticker,
        _node=types.SimpleNamespace(get_name=lambda: 'sim_node'), _report=lambda: None,
        session=types.SimpleNamespace(next_tick=5, take_balance=lambda: balanced.append(1)))
    assert engine.close() == status
    assert said == ['sim_node: tick 5: ValueError: x'] * (failure is not None) + [
        'sim_node: recording: the disk is full'] * bool(error)
    assert len(balanced) == balances and closed == [(), (), (module.STOP_WITHIN,)]
    assert ticker.asked == (['stop', ('join', module.STOP_WITHIN)] if alive else [])


def test_what_the_engine_added_is_removed_and_nothing_else():
    """Each entity is destroyed once, by the function that knows it."""
    destroyed = []

    def destroys(kind):
        def destroy(entity):
            if entity.startswith(kind):
                destroyed.append(entity)
            return entity.startswith(kind)
        return destroy
    node = types.SimpleNamespace(
        publishers=['publisher a', 'publisher b'], subscriptions=['subscription a'],
        services=['service a', 'service b'], timers=['timer a'],
        **{f'destroy_{kind}': destroys(kind)
           for kind in ('publisher', 'subscription', 'service', 'timer')})
    engine_of(_node=node, commands=None,
              _entities_before={'publisher a', 'service b'}).remove()
    assert sorted(destroyed) == ['publisher b', 'service a', 'subscription a', 'timer a']
