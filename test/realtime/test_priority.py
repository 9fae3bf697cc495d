# SPDX-License-Identifier: Apache-2.0
"""Scheduling of a thread that keeps deadlines where real-time scheduling is not allowed."""

import ctypes
import os
import pathlib
import platform
import struct
import subprocess
import sys
import types

import pytest

from rigid_body_sim.realtime import priority

ROOT = pathlib.Path(__file__).resolve().parents[2]
PR_CAPBSET_DROP, CAP_SYS_NICE = 24, 23
SLICES = """
import ctypes, os, struct
from rigid_body_sim.realtime import priority
def slice():
    attributes = ctypes.create_string_buffer(48)
    number = priority.SCHED_SETATTR[os.uname().machine] + 1    # sched_getattr
    assert ctypes.CDLL(None).syscall(number, 0, attributes, 48, 0) == 0
    return struct.unpack('=IIQiIQQQ', attributes.raw)[5]
before = slice()
for wanted in (True, False):
    print(priority.ask_for_priority(wanted), slice() if wanted else slice() == before,
          os.getpriority(os.PRIO_PROCESS, 0))
"""


def without_priority():
    ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, CAP_SYS_NICE, 0, 0, 0)
    os.nice(3)


@pytest.mark.skipif(tuple(map(int, platform.release().split('.')[:2])) < (6, 12)
                    or platform.machine() not in ('x86_64', 'aarch64'),
                    reason='Linux before 6.12 knows no slices')
def test_who_may_not_have_real_time_asks_for_short_slices():
    done = subprocess.run([sys.executable, '-c', SLICES], cwd=ROOT, capture_output=True, text=True,
                          preexec_fn=without_priority, timeout=20, check=True)
    nice = min(os.getpriority(os.PRIO_PROCESS, 0) + 3, 19)    # the largest there is
    assert done.stdout.splitlines() == [f'normal 100000 {nice}', f'normal True {nice}']


@pytest.fixture
def asked(monkeypatch):
    """Return what is asked of a system that grants everything, on x86-64."""
    calls = []

    def keep(name):
        return lambda *arguments: calls.append((name, *arguments))
    library = types.SimpleNamespace(prctl=keep('prctl'), syscall=keep('syscall'))
    monkeypatch.setattr(priority, 'ctypes', types.SimpleNamespace(CDLL=lambda _: library))
    monkeypatch.setattr(priority.platform, 'machine', lambda: 'x86_64')
    monkeypatch.setattr(priority, 'os', types.SimpleNamespace(
        SCHED_OTHER=0, SCHED_FIFO=1, PRIO_PROCESS=0, sched_param=lambda number: number,
        sched_setscheduler=keep('scheduler'), getpriority=lambda which, who: (which, who) == (
            0, 0) and -3))
    return calls


@pytest.mark.parametrize(('real_time', 'more', 'slice_', 'said', 'last'), [
    (True, (), 100_000, 'SCHED_FIFO 10', [('scheduler', 0, 1, 10)]),
    (True, (9,), 100_000, 'SCHED_FIFO 9', [('scheduler', 0, 1, 9)]),
    (False, (), 0, 'normal', [])])
def test_this_thread_is_what_the_system_is_asked_about(asked, real_time, more, slice_, said, last):
    """As prctl(2) and sched_setattr(2) have it: 0 is this thread, what is not used is 0.

    The timer slack is 29, 1 ns; the structure has 48 bytes; a priority of 10 is far below the 50
    of the kernel's own threads.
    """
    assert priority.ask_for_priority(real_time, *more) == said
    wanted = struct.pack('=IIQiIQQQ', 48, 0, 0, -3, 0, slice_, 0, 0)
    assert len(wanted) == 48
    assert asked == [('prctl', 29, 1, 0, 0, 0), ('scheduler', 0, 0, 0),
                     ('syscall', 314, 0, wanted, 0), *last]


@pytest.mark.parametrize(('machine', 'numbers'), [('x86_64', [314]), ('aarch64', [274]),
                                                 ('riscv64', []), ('', [])])
def test_a_slice_is_asked_for_where_the_number_of_the_call_is_known(
        asked, monkeypatch, machine, numbers):
    """Those of sched_setattr in the tables of Linux (syscall_64.tbl, asm-generic/unistd.h)."""
    monkeypatch.setattr(priority.platform, 'machine', lambda: machine)
    assert priority.ask_for_priority(True) == 'SCHED_FIFO 10'
    assert [number for name, number, *_ in asked if name == 'syscall'] == numbers


def test_another_thread_keeps_the_interpreter_for_a_tenth_of_a_millisecond(monkeypatch):
    """The usual 5 ms are several ticks at 1 kHz."""
    done = []
    monkeypatch.setattr(priority.gc, 'collect', lambda: done.append('collect'))
    monkeypatch.setattr(priority.gc, 'freeze', lambda: done.append('freeze'))
    monkeypatch.setattr(priority.sys, 'setswitchinterval', done.append)
    priority.quicken()
    assert done == ['collect', 'freeze', 1e-4]
