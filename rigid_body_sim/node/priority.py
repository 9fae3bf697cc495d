"""What a thread that keeps deadlines asks of the system and of the interpreter."""

import contextlib
import ctypes
import gc
import os
import sys

PRIORITY = 10
PR_SET_TIMERSLACK = 29
SWITCH_INTERVAL = 1e-4
"""How long another thread may keep the interpreter from the one that keeps deadlines, s."""


def ask_for_priority(real_time, priority=PRIORITY):
    """Ask for exact timers in this thread, and for real-time scheduling if wanted and allowed; return how the thread is scheduled.

    Threads that this one starts inherit it.
    """
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0)
    scheduling = 'normal'
    with contextlib.suppress(OSError, AttributeError):
        if real_time:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))
            scheduling = f'SCHED_FIFO {priority}'
        else:
            os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    return scheduling


def quicken():
    """Keep pauses of the interpreter short from here on: called when all is made and the thread is about to start."""
    # what is there now stays: the collector need not look at it again
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(SWITCH_INTERVAL)
