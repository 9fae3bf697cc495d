# SPDX-License-Identifier: Apache-2.0
"""Which topics of a recording are those of a body."""

import contextlib
import types

import pytest

from rigid_body_sim.analysis import source
from rigid_body_sim.errors import BadInput

POSE, OTHER = source.TYPES['pose'], 'std_msgs/msg/String'


def recording(**topics):
    """Return a recording of topics, name -> (type, number of messages)."""
    return types.SimpleNamespace(
        path='run', journal=list,
        topics={f'/lab/{name}': types.SimpleNamespace(type=kind, count=count)
                for name, (kind, count) in topics.items()})


@pytest.mark.parametrize(('topics', 'found'), [
    ({'pose': (POSE, 3)}, {'pose'}), ({'pose': (POSE, 3), 'energy': (OTHER, 3)}, {'pose'}),
    ({'pose': (POSE, 3), 'energy': (source.TYPES['energy'], 0)}, {'pose'}),
    ({'pose': (OTHER, 3)}, set()), ({'pose': (POSE, 0)}, set())],
    ids=['one', 'another type', 'no message of one', 'only another type', 'no message'])
def test_a_topic_counts_by_its_type_and_its_messages(topics, found, monkeypatch):
    monkeypatch.setattr(source, 'journal_of', lambda path: contextlib.nullcontext())
    monkeypatch.setattr(source, '_source', lambda recording, namespace, topics, journal: topics)
    if not found:
        with pytest.raises(BadInput, match='holds none of the topics'):
            source.sources(recording(**topics))
        return
    assert [set(one) for one in source.sources(recording(**topics))] == [found]
