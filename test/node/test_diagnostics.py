# SPDX-License-Identifier: Apache-2.0
"""What /diagnostics says of timing, commands, recording and prediction, from counters by hand."""

import collections
import dataclasses
import types

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from near import near

from rigid_body_sim.node import diagnostics
from rigid_body_sim.node.diagnostics import SAME_NAME_CHECKS, Diagnostics
from rigid_body_sim.recording.recorder import Status

OK, WARN, ERROR = (
    level[0] for level in (DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR))
LATE = {'p50': 1e-4, 'p99': 1e-3, 'max': 2e-3}
BOUNDS = {'lateness_warn': 0.002, 'lateness_error': 0.1, 'prediction_warn': 1e-6,
          'prediction_error': 1e-2, 'energy_residual_warn': 1e-11, 'energy_residual_error': 1e-6,
          'momentum_residual_warn': 1e-11, 'momentum_residual_error': 1e-6}


class Settings(types.SimpleNamespace):
    """Parameters by name, those with a point in their names too."""

    def __getitem__(self, name):
        return BOUNDS[name.removeprefix('diagnostics.')]


class Node:
    """Stands for the node: it keeps what is published and logged."""

    def __init__(self):
        self.names, self.warned, self.published, self.timers = [('sim', '/a')], [], [], []

    def get_fully_qualified_name(self):
        return '/a/sim'

    def get_name(self):
        return 'sim'

    def get_namespace(self):
        return '/a'

    def get_node_names_and_namespaces(self):
        return self.names

    def get_logger(self):
        return types.SimpleNamespace(warning=self.warned.append)

    def create_publisher(self, kind, topic, profile):
        return types.SimpleNamespace(publish=self.published.append)

    def create_timer(self, period, callback, clock):
        self.timers.append(period)


@pytest.fixture
def made():
    """Return Diagnostics of parts whose counters a test sets."""
    lateness = types.SimpleNamespace(since_last=lambda: dict(LATE))
    ticker = types.SimpleNamespace(
        lateness=lateness, latest=(0, 0), slipped=0, overruns=0, skipped=3, clock_jumps=0,
        paused=False, scheduling='usual', waiting_for_clock=False)
    session = types.SimpleNamespace(
        next_tick=8, simulation=types.SimpleNamespace(scene=types.SimpleNamespace(name='ball')),
        prediction=types.SimpleNamespace(compared=dict))
    queue = types.SimpleNamespace(refusals=collections.Counter(), received=0, accepted=0,
                                  applied=0, waiting=0, lost=0)
    settings = Settings(rate=100.0, real_time_factor=1.0, overrun='slip')
    journal = types.SimpleNamespace(status=None, path='runs/a', look=None)
    return Diagnostics(Node(), settings, session, ticker, queue, journal)


def told(status):
    """Return level, message and values of a status."""
    return status.level[0], status.message, {one.key: one.value for one in status.values}


def test_the_rate_is_that_of_the_ticks_since_the_last_one(made):
    """Of the very first ticks, which come in a burst, there is none: 0.2 s are needed."""
    assert made._node.timers == [1.0, 0.25]
    for latest, rate in [((0, 0), 0.0), ((40, 199_999_999), 0.0), ((50, 500_000_000), 100.0),
                         ((70, 700_000_000), 100.0), ((70, 700_000_000), 0.0),
                         ((100, 900_000_000), 150.0), ((200, 1_000_000_000), 150.0)]:
        made._ticker.latest = latest
        level, message, values = told(made._timing())
        assert (level, message) == (OK, 'on time')
        assert float(values['achieved_rate']) == near(rate, rel=1e-15)
    assert (values['tick'], values['rate'], values['skipped']) == ('7', '100', '3')
    made._ticker.paused = True
    assert told(made._timing())[1] == 'paused'


def test_all_ticks_so_far_make_the_first_rate(made):
    made._ticker.latest = (20, 200_000_000)
    assert float(told(made._timing())[2]['achieved_rate']) == near(100.0, rel=1e-15)


FORECAST = {'expected_error': '1e-09', 'met_until': '50'}
UNKNOWN = dict.fromkeys(FORECAST, 'unknown since the command at t = 1.5 s')


@pytest.mark.parametrize(('error', 'missed', 'departed', 'level', 'message', 'method'), [
    (0.0, '', None, OK, 'energy and angular momentum balance', FORECAST),
    (0.0, 'it is not met', None, WARN, 'it is not met', FORECAST),
    (-2e-11, 'it is not met', None, WARN, 'momentum residual 2e-11', FORECAST),
    (2e-6, '', None, ERROR, 'momentum residual 2e-06', FORECAST),
    # what was foreseen without the command
    (0.0, '', 1.5, OK, 'energy and angular momentum balance', UNKNOWN),
    # no trial has foreseen anything
    (0.0, '', 1.5, OK, 'energy and angular momentum balance', None)])
def test_the_ledger_tells_its_residuals_and_how_good_the_method_is(
        error, missed, departed, level, message, method, made):
    made._session.balance = {'tick': 7, 'energy_residual': -1e-12, 'momentum_residual': error}
    settled = types.SimpleNamespace(forecast=types.SimpleNamespace(error=1e-9, met_until=50.0))
    simulation = made._session.simulation
    simulation.missed, simulation.departed, simulation.method = missed, departed, 'taylor'
    simulation.choice = types.SimpleNamespace(
        method='auto', horizon=100.0, tolerance=None, settled=settled if method else None)
    found = told(made._ledger())
    assert found[:2] == (level, message)
    # what is not known is not told
    assert found[2] == {'tick': '7', 'energy_residual': f'{-1e-12:.17g}',
                        'momentum_residual': f'{error:.17g}', 'method': 'taylor',
                        'horizon': '100'} | {
        name: value if departed else f'{float(value):.17g}'
        for name, value in (method or {}).items()}


@pytest.mark.parametrize(('late', 'overruns', 'slipped', 'level', 'message'), [
    (0.002, 0, 0, OK, 'on time'), (0.0021, 0, 0, WARN, '0 overruns'),
    (0.1, 0, 0, WARN, '0 overruns in the last second, lateness p99 100000 us'),
    (0.001, 2, 0, WARN, '2 overruns in the last second, lateness p99 1000 us'),
    (0.101, 0, 0, ERROR, 'it does not keep up: 0 of 100 Hz'),
    (0.001, 1, 5, ERROR, 'it does not keep up')])
def test_lateness_overruns_and_slips_are_levels(late, overruns, slipped, level, message, made):
    made._ticker.overruns, made._ticker.slipped = overruns, slipped
    made._ticker.lateness.since_last = lambda: LATE | {'p99': late}
    found = told(made._timing())
    assert found[0] == level and found[1].startswith(message)
    assert float(found[2]['slipped']) == pytest.approx(slipped * 1e-9)
    # each is counted once
    made._ticker.lateness.since_last = lambda: LATE
    assert told(made._timing())[0] == OK
    made._ticker.waiting_for_clock = True
    assert told(made._timing())[0] == WARN


def test_commands_refused_or_lost_in_the_last_second_warn(made):
    queue = made._commands
    queue.refusals.update({'frame_id': 2, 'malformed': 1})
    level, message, values = told(made._command())
    assert (level, message) == (WARN, '3 refused in the last second: see events')
    assert (values['refused'], values['refused: frame_id']) == ('3', '2')
    assert told(made._command())[:2] == (OK, 'none refused in the last second')
    queue.lost = 4
    level, message, values = told(made._command())
    assert level == WARN and values['lost'] == '4'
    assert message == ('4 lost on the way in the last second: send fewer; '
                       'none refused in the last second')
    assert told(made._command())[0] == OK


def test_dropped_ticks_warn_once_and_an_error_as_long_as_it_lasts(made):
    assert told(made._recording()) == (OK, 'off', {})
    whole = made._journal.status = Status(**{
        one.name: '' if one.name == 'error' else 0 for one in dataclasses.fields(Status)})
    assert told(made._recording())[:2] == (OK, 'recording')
    made._journal.status = dataclasses.replace(whole, dropped=2)
    assert told(made._recording())[0] == WARN
    assert told(made._recording())[0] == OK
    made._journal.status = dataclasses.replace(whole, dropped=3, error='the disk is full')
    for _ in range(2):
        level, message, values = told(made._recording())
        assert (level, message) == (ERROR, 'the disk is full')
    assert (values['path'], values['dropped']) == ('runs/a', '3')


@pytest.mark.parametrize(('found', 'level', 'message'), [
    ({}, OK, 'theory has no prediction'), ({'event': 'flip'}, OK, 'nothing measured yet'),
    ({'relative_difference': 1e-6}, OK, 'as predicted'),
    ({'relative_difference': -2e-6}, WARN, 'differs from what is predicted by 2e-06 of it'),
    ({'relative_difference': 0.01}, WARN, 'by 0.01 of it'),
    ({'relative_difference': -0.02}, ERROR, 'by 0.02 of it')])
def test_what_theory_predicts_is_compared_either_way(found, level, message, made):
    made._session.prediction.compared = lambda: found
    status = told(made._prediction())
    assert status[0] == level and message in status[1]


def test_the_worst_of_some_sizes_is_named(made):
    sizes = {'energy_residual': 1e-9, 'prediction': 2e-2}
    assert made._bounded(sizes) == (ERROR, 'prediction 0.02')
    assert made._bounded(dict(reversed(sizes.items()))) == (ERROR, 'prediction 0.02')
    assert made._bounded({'energy_residual': 1e-11}) == (OK, '')


def test_another_node_of_the_same_name_is_looked_for_and_told_once(made, monkeypatch):
    for name in ('_ledger', '_timing', '_command', '_recording', '_prediction'):
        monkeypatch.setattr(Diagnostics, name, lambda self: DiagnosticStatus())
    monkeypatch.setattr(diagnostics, 'DiagnosticArray',
                        lambda status: types.SimpleNamespace(
                            status=status, header=types.SimpleNamespace()))
    node, looked = made._node, []
    now = types.SimpleNamespace(now=lambda: types.SimpleNamespace(to_msg=lambda: 'now'))
    node.get_clock = lambda: now
    made._session.want_balance = made._commands.look_for_mismatches = lambda: None
    node.get_node_names_and_namespaces = lambda: looked.append(None) or node.names
    node.names = [('sim', '/a'), ('sim', '/b'), ('other', '/a')]
    made.publish()
    assert node.warned == []
    node.names = [('sim', '/a')] * 2
    for _ in range(3):
        made.publish()
    assert len(node.warned) == 1 and 'another node /a/sim' in node.warned[0]
    assert len(looked) == 2 and len(node.published) == 4
    assert [len(one.status) for one in node.published] == [5] * 4
    node.names, made._same_name_checks = [], SAME_NAME_CHECKS
    for _ in range(SAME_NAME_CHECKS + 3):
        made.publish()
    assert len(looked) == 2 + SAME_NAME_CHECKS    # not for ever
