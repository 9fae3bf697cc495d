# SPDX-License-Identifier: Apache-2.0
"""Topics side by side: every message once, in order, though their chunks are cut anywhere."""

import types

import numpy as np
import pytest

from rigid_body_sim.analysis import align
from rigid_body_sim.analysis.align import aligned


def made_up(counts, seed):
    """Return a recording whose blocks are cut at random, and what each topic holds."""
    random = np.random.default_rng(seed)
    times = {topic: np.sort(random.choice(5000, count, replace=False))
             for topic, count in counts.items()}
    blocks = []
    for topic, stamps in times.items():
        cuts = np.sort(random.choice(len(stamps) + 1, 12))
        for begin, end in zip([0, *cuts], [*cuts, len(stamps)], strict=True):
            if end > begin:
                blocks.append((stamps[begin], topic,
                               {'log_time': stamps[begin:end], 'data': -stamps[begin:end]}))
    blocks.sort(key=lambda block: block[0])
    recording = types.SimpleNamespace(
        topics={topic: types.SimpleNamespace(count=count) for topic, count in counts.items()},
        blocks=lambda topics, progress: ((topic, columns) for _, topic, columns in blocks))
    return recording, times


@pytest.mark.parametrize('seed', range(20))
@pytest.mark.parametrize(
    'counts', [{'a': 3000, 'b': 3000}, {'a': 3000, 'b': 1, 'c': 40}, {'a': 5000}])
def test_every_message_comes_once_and_nothing_later_is_older(counts, seed):
    recording, times = made_up(counts, seed)
    found, latest = {topic: [] for topic in counts}, -1
    for stretch in aligned(recording, list(counts)):
        assert min(columns['log_time'][0] for columns in stretch.values()) > latest
        latest = max(columns['log_time'][-1] for columns in stretch.values())
        for topic, columns in stretch.items():
            assert (columns['data'] == -columns['log_time']).all()
            found[topic] += columns['log_time'].tolist()
    assert found == {topic: stamps.tolist() for topic, stamps in times.items()}


def stretches(blocks, topics):
    """Return what `aligned` yields of (topic, log times) in turn, as plain data."""
    recording = types.SimpleNamespace(
        topics={topic: types.SimpleNamespace(
            count=sum(len(times) for name, times in blocks if name == topic)) for topic in topics},
        blocks=lambda topics, progress: (
            (topic, {'log_time': np.array(times)}) for topic, times in blocks))
    return [{topic: columns['log_time'].tolist() for topic, columns in stretch.items()}
            for stretch in aligned(recording, topics)]


def test_what_is_certain_to_be_complete_does_not_wait():
    """A log time may come again in the next block of its topic."""
    assert stretches([('a', [1]), ('a', [3]), ('b', [3]), ('a', [3, 5]), ('b', [4, 9]),
                      ('a', [8, 9])], 'ab') == [
        {'a': [1]}, {'a': [3, 3], 'b': [3, 4]}, {'a': [5, 8, 9], 'b': [9]}]


def test_what_waits_too_long_for_another_topic_comes_alone(monkeypatch):
    monkeypatch.setattr(align, 'LARGEST', 3)
    assert stretches([('a', [1, 2]), ('a', [3]), ('a', [4, 5]), ('a', [6, 7]), ('b', [8])],
                     'ab') == [{'a': [1, 2, 3, 4]}, {'a': [5, 6, 7], 'b': [8]}]


def test_columns_that_not_all_messages_have_are_left_out():
    """A frame that gets another name, of another length, does this."""
    waiting = {'/a': [{'log_time': np.arange(3), 'x': np.zeros((3, 2)), 'w': np.zeros(3),
                       'z': np.zeros((3, 4))},
                      {'log_time': np.arange(3, 5), 'y': np.zeros(2), 'x': np.ones((2, 2)),
                       'z': np.zeros((2, 4))},
                      {'log_time': np.arange(5, 7), 'x': np.ones((2, 2)),
                       'z': np.zeros((2, 5))}]}
    taken = align._take(waiting, '/a', 5)
    assert (set(taken) == {'log_time', 'x'} and taken['log_time'].tolist() == [0, 1, 2, 3, 4, 5]
            and taken['x'].sum() == 6.0)
    assert waiting['/a'][0]['log_time'].tolist() == [6]
