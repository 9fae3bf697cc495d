# SPDX-License-Identifier: Apache-2.0
"""The command `run` around a node that is made up: names, signals, exit statuses, the report."""

import json
import os
import pathlib
import signal
import subprocess
import sys

import pytest

from rigid_body_sim.analysis import analyze
from rigid_body_sim.cli import run as command


@pytest.fixture
def ended(tmp_path, monkeypatch):
    """Return what sets how the node ends: its exit status, its signal, whether it recorded."""
    monkeypatch.chdir(tmp_path)
    names = []

    def end(status=0, by=None, records=True):
        def node(options, name):
            names.append(name)
            if records:
                (pathlib.Path('recordings') / name).mkdir(parents=True)
            return status, by
        monkeypatch.setattr(command, '_node', node)
        return names
    monkeypatch.setattr(analyze, 'analyze', lambda path, folder, short: (
        [{'scene': str(path), 'short': short}], [folder / 'report.txt']))
    monkeypatch.setattr(analyze, 'show', lambda found, written: print('shown', *written))
    return end


def test_each_run_has_a_recording_of_its_own(ended, monkeypatch, capsys):
    class Now(command.datetime.datetime):
        @classmethod
        def now(cls):
            return cls(2026, 1, 2, 3, 4, 5)
    monkeypatch.setattr(command.datetime, 'datetime', Now)
    names = ended()
    for _ in range(3):
        assert command.main(['--scene', 'scenes/top.yaml']) == 0
    assert names == ['top_2026-01-02_03-04-05', 'top_2026-01-02_03-04-05_',
                     'top_2026-01-02_03-04-05__']
    shown, heading, *commands = capsys.readouterr().out.splitlines()[-4:]
    path = 'recordings/top_2026-01-02_03-04-05__'
    assert (shown, heading) == (f'shown {path}_report/report.txt', 'next:')
    assert [line.split('#')[0].split()[1:] for line in commands] == [
        ['-m', 'rigid_body_sim', 'analyze', path], ['-m', 'rigid_body_sim', 'view', path]]
    assert all(line.split()[0] == os.path.relpath(sys.executable) for line in commands)


def test_it_is_a_racket_at_1_khz_for_20_s_unless_told_otherwise(monkeypatch):
    given = []
    monkeypatch.setattr(command, '_node', lambda options, name: given.append(options) or (2, None))
    assert command.main([]) == 2
    [options] = given
    assert (options.scene, options.rate, options.duration) == ('tennis_racket', 1000.0, 20.0)


def test_json_is_the_last_thing_on_stdout(ended, capsys):
    names = ended()
    assert command.main(['--json']) == 0
    [path] = [f'recordings/{name}' for name in names]
    assert json.loads(capsys.readouterr().out) == {
        'recording': path, 'bodies': [{'scene': path, 'short': True}],
        'files': [f'{path}_report/report.txt']}


@pytest.mark.parametrize(('status', 'by', 'expected', 'reports'), [
    (0, None, 0, True), (0, signal.SIGINT, 0, True), (0, signal.SIGTERM, 143, False),
    (0, signal.SIGHUP, 129, False), (2, None, 2, False), (2, signal.SIGINT, 2, False),
    (1, signal.SIGTERM, 1, False)])
def test_a_report_is_made_unless_the_node_failed_or_was_told_to_end(
        ended, capsys, status, by, expected, reports):
    ended(status, by)
    assert command.main([]) == expected
    assert ('shown' in capsys.readouterr().out) == reports


def test_no_recording_is_one_line(ended, capsys):
    ended(records=False)
    assert command.main([]) == 2
    out, err = capsys.readouterr()
    assert out == '' and err.startswith('recordings/') and err.count('\n') == 1


class Child:
    """A process that notes the signals it is sent."""

    def __init__(self, *_, **__):
        self.heard = []

    def send_signal(self, number):
        self.heard.append(number)


@pytest.fixture
def as_in_a_shell():
    """Let signals end the process, as they do unless `nohup` or a test says otherwise."""
    before = {number: signal.signal(number, signal.SIG_DFL)
              for number in (signal.SIGTERM, signal.SIGHUP)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures('as_in_a_shell')
def test_signals_go_to_the_child_even_before_it_has_started():
    child = Child()
    with command.forwarding() as forwarder:
        signal.raise_signal(signal.SIGTERM)
        forwarder.to(child)
        assert child.heard == [signal.SIGTERM]
        for number in (signal.SIGINT, signal.SIGHUP):
            signal.raise_signal(number)
        assert child.heard == [signal.SIGTERM, signal.SIGINT, signal.SIGHUP]
        assert forwarder.number == signal.SIGHUP
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def test_without_a_signal_none_is_sent():
    child = Child()
    with command.forwarding() as forwarder:
        forwarder.to(child)
    assert (child.heard, forwarder.number) == ([], None)


@pytest.mark.usefixtures('as_in_a_shell')
def test_an_ignored_signal_stays_ignored():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with command.forwarding():
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN


@pytest.mark.parametrize('as_json', [False, True])
def test_the_node_is_given_scene_rate_duration_and_where_to_record(monkeypatch, as_json):
    started = []

    class Node(Child):
        def __init__(self, words, **options):
            super().__init__()
            started.append((words, options))

        def wait(self):
            return 3
    monkeypatch.setattr(subprocess, 'Popen', Node)
    options = command.command_line.parser('run', '', '').parse_args([])
    options.scene, options.rate, options.duration, options.json = 'top', 500.0, 2.0, as_json
    assert command._node(options, 'name') == (3, None)
    [(words, how)] = started
    assert words == [
        sys.executable, '-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p', 'scene:=top',
        '-p', 'rate:=500.0', '-p', 'duration:=2.0', '-p', 'recording.directory:=recordings',
        '-p', 'recording.name:=name']
    assert how['stdout'] is (sys.stderr if as_json else None)
    assert how['env'] == {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', **os.environ}
