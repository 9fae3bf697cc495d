# SPDX-License-Identifier: Apache-2.0
"""Scheduling of a thread that keeps deadlines where real-time scheduling is not allowed."""

import ctypes
import os
import pathlib
import platform
import subprocess
import sys

import pytest

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
