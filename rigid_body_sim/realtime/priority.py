# SPDX-License-Identifier: Apache-2.0
"""Settings of the system and the interpreter for a thread that keeps deadlines."""

import contextlib
import ctypes
import gc
import os
import platform
import struct
import sys

PRIORITY = 10
PR_SET_TIMERSLACK = 29
SLICE = 100_000
"""Time slice that the thread asks for, ns: the shortest possible.

Without real-time scheduling the thread with the shorter slice runs first.

It is then late by 0.1 to 0.7 ms instead of 3 to 4 ms (p99, both processors busy with other
threads).
"""
SCHED_SETATTR = {'x86_64': 314, 'aarch64': 274}
"""Number of the system call, which Python does not offer."""
SWITCH_INTERVAL = 1e-4
"""Longest time that another thread keeps the interpreter from the tick thread, s."""


def ask_for_priority(real_time, priority=PRIORITY):
    """Ask for exact timers in this thread, and for real-time scheduling if wanted and allowed.

    Return how the thread is scheduled, in words.

    Threads that this one starts inherit it.
    """
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0)
    scheduling = 'normal'
    with contextlib.suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        _ask_for_slice(SLICE if real_time else 0)
        if real_time:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
            scheduling = f'SCHED_FIFO {priority}'
    return scheduling


def _ask_for_slice(nanoseconds):
    """Ask for a time slice of this length in normal scheduling; 0 means the usual one.

    Anybody may ask. Linux before 6.12 ignores it.
    """
    number = SCHED_SETATTR.get(platform.machine())
    if number is not None:
        # struct sched_attr, see sched_setattr(2): its sched_runtime is the slice
        nice = os.getpriority(os.PRIO_PROCESS, 0)
        ctypes.CDLL(None).syscall(
            number,
            0,
            struct.pack('=IIQiIQQQ', 48, os.SCHED_OTHER, 0, nice, 0, nanoseconds, 0, 0),
            0,
        )


def quicken():
    """Keep pauses of the interpreter short, just before the thread that keeps deadlines starts."""
    # the objects of now stay alive: the garbage collector need not visit them again
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(SWITCH_INTERVAL)
