# SPDX-License-Identifier: Apache-2.0
"""The stamps of a recording that was played and recorded again, on made-up blocks."""

import types

import numpy as np
import pytest

from rigid_body_sim.analysis.replayed import stamps_of

SECOND = 1_000_000_000
END = 5 * SECOND


def recording(stamps, log_times, asked):
    """Return a recording with one block a topic, read from a time (ns) on."""
    def blocks(topics, names, start=0):
        asked.append((topics, start))
        logged = np.array(log_times, dtype=np.int64)
        chosen = logged >= start
        if chosen.any():
            yield topics[0], {'log_time': logged[chosen]} | (
                {} if stamps is None else {name: np.array(stamps)[chosen] for name in names})
    return types.SimpleNamespace(blocks=blocks)


@pytest.mark.parametrize(('stamps', 'log_times', 'found'), [
    ([7, 8, 9], [1, 2, END], (7, 9)),
    ([7, 9, 8], [1, 2, 3], (7, 9)),          # nothing within the last second: all are read
    ([1, 2, 3], [1, 2, 3], None),            # of the simulation itself
    ([1, 2, 4], [1, 2, 3], (1, 4)),          # one of them differs
    (None, [1, 2, 3], None)])                # no message has one
def test_they_are_told_where_they_are_not_the_log_times(stamps, log_times, found):
    asked = []
    assert stamps_of(recording(stamps, log_times, asked), {'pose': '/pose'}, END) == found
    assert asked[0] == (['/pose'], 0)
    assert found is None or (['/pose'], END - SECOND) in asked


def test_the_first_topic_with_a_header_tells():
    asked = []
    made = recording([7, 8], [1, END], asked)
    topics = {'energy': '/e', 'angular_velocity': '/w'}
    assert stamps_of(made, topics, END) == (7, 8)
    assert {one for (one,), _ in asked} == {'/w'}
    assert stamps_of(made, {'energy': '/e'}, END) is None
