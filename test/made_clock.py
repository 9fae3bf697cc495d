# SPDX-License-Identifier: Apache-2.0
"""A clock that goes on only while the code under test sleeps."""

import types


def clock_of(monkeypatch, module):
    """Give a module such a clock for its `time`; return [now] and the list of its sleeps, s."""
    clock, slept = [100.0], []

    def sleep(seconds):
        slept.append(seconds)
        clock[0] += seconds
    monkeypatch.setattr(module, 'time', types.SimpleNamespace(
        monotonic=lambda: clock[0], sleep=sleep))
    return clock, slept
