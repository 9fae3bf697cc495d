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
        topics={f'/lab/{name}': types.SimpleNamespace(name=f'/lab/{name}', type=kind, count=count)
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


def test_a_body_begins_with_the_first_message_of_any_topic_of_its_ticks(monkeypatch):
    """The others may have lost theirs, and some messages in between."""
    firsts, asked = {'/lab/pose': 40, '/lab/energy': 20, '/lab/angular_velocity': 30}, []
    made = recording(**{name.rpartition('/')[2]: (source.TYPES[name.rpartition('/')[2]], count)
                        for name, count in zip(firsts, (5, 9, 7), strict=True)})
    monkeypatch.setattr(source, '_first_time', lambda recording, name: firsts[name])
    monkeypatch.setattr(source, '_last_time', lambda recording, name: 100)
    monkeypatch.setattr(source, 'journal_of', lambda path: contextlib.nullcontext())
    monkeypatch.setattr(source, 'missed', lambda runs: [])
    monkeypatch.setattr(source, '_run', lambda recording, topics, entries, start, end: (
        asked.append((entries, start, end)), {'made_by': 'sim_node', 'version': '1.2'}, 'all'))
    topics = {name.rpartition('/')[2]: name for name in firsts}
    found = source._source(made, '/lab', topics, [{'topic': '/other/journal'}])
    assert asked == [([], 20, 100)]
    assert (found.start, found.end, found.ticks) == (20, 100, 9)
    assert (found.made_by, found.version, found.history) == ('sim_node', '1.2', 'all')


@pytest.mark.parametrize(('entries', 'topics', 'held'), [
    ([], ['pose', 'cmd_wrench'], True), ([], ['pose', 'cmd_impulse'], True), ([], ['pose'], False),
    ([{'kind': 'begin', 'simulation': '{"rate": 500.0}', 'scene': ''}],
     ['pose', 'cmd_wrench'], False)],
    ids=['a wrench', 'an impulse', 'no commands', 'a journal tells when they acted'])
def test_without_a_journal_a_wrench_may_be_held_where_commands_were_recorded(
        entries, topics, held, monkeypatch):
    begun = []
    monkeypatch.setattr(source, '_latched_scene', lambda recording, topics: '')
    monkeypatch.setattr(source, '_estimated_rate', lambda recording, topics: 250.0)
    monkeypatch.setattr(source, 'history', lambda entries, events, begin, end: begun.append(begin))
    run, begin, _ = source._run(None, dict.fromkeys(topics), entries, 0, 9)
    assert (begun[0].held, begun[0].rate) == (held, 500.0 if entries else 250.0)
    assert (run, begin) == (({'rate': 500.0}, entries[0]) if entries else ({}, {}))
