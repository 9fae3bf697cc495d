# SPDX-License-Identifier: Apache-2.0
"""The status: drawn on a terminal that somebody looks at, written line by line elsewhere."""

import fcntl
import os
import pty
import struct
import subprocess
import sys
import termios
import types

import pytest

from rigid_body_sim.node import status_line
from rigid_body_sim.node.status_line import StatusLine, draws

ASK = 'import sys; from rigid_body_sim.node.status_line import draws; print(draws(sys.stderr))'


@pytest.fixture
def terminal():
    """Yield (master, slave) of a terminal."""
    master, slave = pty.openpty()
    yield master, slave
    os.close(master)
    os.close(slave)


def resize(slave, columns):
    fcntl.ioctl(
        slave, termios.TIOCSWINSZ, struct.pack('HHHH', 24 if columns else 0, columns, 0, 0))


def asked(slave, controlling):
    """Return whether a process draws if its stderr is a terminal, perhaps its controlling one."""
    def control():
        os.setsid()
        if controlling:
            fcntl.ioctl(slave, termios.TIOCSCTTY, 0)
    return subprocess.run([sys.executable, '-c', ASK], stderr=slave, stdout=subprocess.PIPE,
                          text=True, timeout=60, check=True, preexec_fn=control).stdout.strip()


def test_it_draws_on_a_terminal(terminal):
    _, slave = terminal
    resize(slave, 80)
    assert asked(slave, controlling=True) == 'True'


@pytest.mark.parametrize(('columns', 'controlling'), [(0, False), (0, True), (80, False)])
def test_it_does_not_draw_on_the_terminal_that_launch_emulates(terminal, columns, controlling):
    _, slave = terminal
    resize(slave, columns)
    assert asked(slave, controlling) == 'False'


def test_it_does_not_draw_where_there_is_no_terminal():
    with open(os.devnull) as nothing:
        assert not draws(nothing)
    assert not draws(nothing)    # closed by now
    assert not draws(None)


class Parts:
    """Stands for a node and its engine."""

    def __init__(self):
        self.timers = []
        self.session = types.SimpleNamespace(
            next_tick=0, want_balance=lambda: None,
            balance={'time': 1e7, 'energy_residual': 1e-16, 'momentum_residual': 1e-16})
        self.diagnostics = types.SimpleNamespace(rate=1000.0, lateness={'p99': 1e-4})
        self.journal = types.SimpleNamespace(status=None)

    def get_name(self):
        return 'sim_node'

    def create_timer(self, period, callback, clock):
        self.timers.append((period, callback))


def test_lines_come_every_ten_seconds_while_ticks_do(capsys, monkeypatch):
    monkeypatch.setattr(status_line, 'draws', lambda stream: False)
    parts = Parts()
    line = StatusLine(parts, parts)
    [(period, show)] = parts.timers
    assert period == 10.0
    for tick in (0, 100, 100, 100, 200):
        parts.session.next_tick = tick
        show()
    line.close()
    told, errors = capsys.readouterr()
    assert errors == ''
    assert told.count('\n') == 3 and '\r' not in told
    assert all(one.startswith('sim_node: t ') for one in told.splitlines())


@pytest.mark.parametrize('columns', [40, 80, 300])
def test_the_line_is_no_wider_than_the_terminal(terminal, monkeypatch, columns):
    master, slave = terminal
    resize(slave, columns)
    monkeypatch.setattr(status_line, 'draws', lambda stream: True)
    parts = Parts()
    with open(slave, 'w', closefd=False) as screen:
        monkeypatch.setattr(sys, 'stderr', screen)
        line = StatusLine(parts, parts)
        [(period, show)] = parts.timers
        show()
        parts.session.balance['time'] = 2.0
        show()
        line.close()
    drawn = ''
    while not drawn.endswith('\n'):
        drawn += os.read(master, 10_000).decode()
    assert period == 0.2
    assert drawn.endswith('\r\n') and drawn.count('\n') == 1
    assert len(drawn.rstrip().split('\r')) == 3
    widest = max(map(len, drawn.rstrip().split('\r')))
    assert widest == columns - 1 if columns < 100 else widest < columns


@pytest.mark.parametrize(('recording', 'told'), [
    (None, 'nothing'), (types.SimpleNamespace(recorded=1234), '1234')])
def test_the_line_is_in_seconds_hertz_and_microseconds_and_asks_for_the_next_balance(
        recording, told, monkeypatch, capsys):
    monkeypatch.setattr(status_line, 'draws', lambda stream: False)
    parts, asked = Parts(), []
    parts.session.want_balance = lambda: asked.append(1)
    parts.session.balance = {'time': 12.3456, 'energy_residual': 1.5e-9,
                             'momentum_residual': -2e-16}
    parts.journal.status = recording
    StatusLine(parts, parts)
    parts.timers[0][1]()
    assert capsys.readouterr().out.split() == (
        f'sim_node: t 12.346 s 1000.0 Hz late p99 100 us energy 1.5e-09 L^2 -2.0e-16 '
        f'recorded {told}').split()
    assert asked == [1]
