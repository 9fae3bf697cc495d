# SPDX-License-Identifier: Apache-2.0
"""One simulated body of a recording: its topics, how it was made, what happened to it.

A recording may hold several bodies, each in a namespace of its own, and it may come from ``ros2
bag record``: then there is no journal, and the scene is known only if its topic was recorded.
"""

import contextlib
import json
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.analysis.history import History, Segment, history
from rigid_body_sim.analysis.replayed import stamps_of
from rigid_body_sim.choice import forecast
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.recording.about import UNPACED
from rigid_body_sim.scene.scene import parse_scene

EVERY_TICK = {
    'pose': 'geometry_msgs/msg/PoseStamped',
    'angular_velocity': 'geometry_msgs/msg/Vector3Stamped',
    'energy': 'std_msgs/msg/Float64',
    'angular_momentum_squared': 'std_msgs/msg/Float64',
}
# topic of every tick -> its columns, and how many numbers each has
COLUMNS = {
    'pose': {'pose.orientation': (4,), 'pose.position': (3,)},
    'angular_velocity': {'vector': (3,)},
    'energy': {'data': ()},
    'angular_momentum_squared': {'data': ()},
}
TYPES = {
    **EVERY_TICK,
    'events': 'diagnostic_msgs/msg/DiagnosticStatus',
    'scene': 'std_msgs/msg/String',
    'journal': 'std_msgs/msg/String',
    'cmd_wrench': 'geometry_msgs/msg/WrenchStamped',
    'cmd_impulse': 'geometry_msgs/msg/WrenchStamped',
}


@dataclass(frozen=True)
class Source:
    """One body in a recording.

    Attributes
    ----------
    namespace : str
        ``/`` or ``/racket``.
    topics : dict
        Name in TYPES -> complete name of the topic; what was not recorded is missing.
    run : dict
        What the simulation was asked for (see recording.about.run_of); empty where unknown.
    made_by, version : str
        '' where unknown.
    history : History
    entries : list of dict
        Its journal; empty in recordings of other programs.
    start, end : int
        Log times of the first tick, which is t = 0 of all curves, and of the last one, ns.
    ticks : int
        Messages on the topic of every tick that has most of them.
    stamps : (int, int) or None
        Stamps of the first and the last tick in a recording of one that was played, where they
        are not the log times.
    accuracy_missed : list of str
        See :func:`missed`.
    """

    namespace: str
    topics: dict
    run: dict
    made_by: str
    version: str
    history: History
    entries: list
    start: int
    end: int
    ticks: int
    stamps: tuple | None
    accuracy_missed: list

    @property
    def scene(self):
        """The scene at the start, or None."""
        return self.history.segments[0].scene


def sources(recording):
    """Return the Sources in a Recording, by namespace; BadInput where there is none."""
    found, journal = {}, recording.journal()
    with journal_of(recording.path):
        renamed = _renamed(journal)
    for name, topic in recording.topics.items():
        namespace, last = renamed.get(name) or name.rpartition('/')[::2]
        if TYPES.get(last) == topic.type and topic.count:
            found.setdefault(namespace, {})[last] = name
    bodies = [
        _source(recording, namespace or '/', topics, journal)
        for namespace, topics in sorted(found.items())
        if set(topics) & set(EVERY_TICK)
    ]
    if not bodies:
        raise BadInput(
            str(recording.path),
            f'holds none of the topics {", ".join(EVERY_TICK)}',
            'a recording of a simulation',
        )
    return bodies


def _renamed(journal):
    """Return what journals say of remapped topics: full name -> (namespace, name in TYPES)."""
    return {name: (entry['topic'].rpartition('/')[0], last)
            for entry in journal if entry['kind'] == 'begin' and 'topics' in entry
            for last, name in json.loads(entry['topics']).items()}


def _source(recording, namespace, topics, journal):
    entries = [entry for entry in journal if entry['topic'] == topics.get('journal')]
    ticking = [recording.topics[topics[name]] for name in EVERY_TICK if name in topics]
    start = min(_first_time(recording, topic.name) for topic in ticking)
    end = _last_time(recording, ticking[0].name)
    with journal_of(recording.path):
        run, begin, happened = _run(recording, topics, entries, start, end)
        not_met = missed([run, *(entry['simulation'] for entry in entries
                                 if entry['kind'] == 'parameters')])
    return Source(
        namespace,
        topics,
        run,
        begin.get('made_by', ''),
        begin.get('version', ''),
        happened,
        entries,
        start,
        end,
        max(topic.count for topic in ticking),
        stamps_of(recording, topics, end) if entries else None,
        not_met,
    )


def _run(recording, topics, entries, start, end):
    """Return what the run was asked for, the journal's first entry and the History."""
    begin = next(
        (entry for entry in entries if entry['kind'] == 'begin' and 'simulation' in entry), {}
    )
    text = begin.get('scene') or _latched_scene(recording, topics)
    scene = parse_scene(text, where=f'{recording.path}: scene') if text else None
    run = json.loads(begin.get('simulation', '{}'))
    pace = (
        0.0
        if begin.get('made_by') in UNPACED
        else float(json.loads(begin.get('parameters', '{}')).get('real_time_factor', 1.0))
    )
    # without a journal the ticks at which commands acted are unknown
    held = not entries and bool({'cmd_wrench', 'cmd_impulse'} & set(topics))
    events = recording.decoded(topics['events']) if 'events' in topics else ()
    rate = run['rate'] if run else _estimated_rate(recording, topics)
    happened = history(entries, events, Segment(start, scene, rate, pace, held), end)
    return run, begin, happened


@contextlib.contextmanager
def journal_of(where):
    """Turn any error that a malformed journal causes into BadInput with the place of the file.

    A journal is read as if this package wrote it, but another program may have.
    """
    try:
        yield
    except BadInput as refusal:
        if refusal.where.startswith(str(where)):
            raise
        raise BadInput(f'{where}: {refusal.where}', refusal.problem, refusal.remedy) from refusal
    except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError) as error:
        said = ' '.join(str(error).split())[:200]
        raise BadInput(str(where), f'the journal makes no sense ({type(error).__name__}: {said})',
                       'an undamaged recording') from error


def missed(runs):
    """Return lines on the accuracy that was asked and is missed, where `auto` expected as much.

    Parameters
    ----------
    runs : sequence of dict
        What each simulation was asked for and chose, see recording.about.run_of; empty where the
        recording does not tell.
    """
    lines = (forecast.missed(run['accuracy'], run['horizon'], run.get('expected_error'),
                             run.get('met_until')) for run in runs if run)
    return list(dict.fromkeys(line for line in lines if line))


def _first_time(recording, topic):
    return int(next(recording.blocks([topic], []))[1]['log_time'].min())


def _last_time(recording, topic):
    """Return the last log time of a topic, from the recording's last second if it is there."""
    for start in (recording.end_time - NANOSECONDS, recording.start_time):
        times = [
            int(columns['log_time'].max()) for _, columns in recording.blocks([topic], [], start)
        ]
        if times:
            return max(times)
    return recording.end_time


def _estimated_rate(recording, topics):
    """Return the ticks per second by the stamps of the first block of messages, 0 without any."""
    for name in ('pose', 'angular_velocity'):
        if name in topics:
            steps = np.diff(
                next(recording.blocks([topics[name]], ['header.stamp']))[1]['header.stamp']
            )
            steps = steps[steps > 0]
            return NANOSECONDS / float(np.median(steps)) if len(steps) else 0.0
    return 0.0


def _latched_scene(recording, topics):
    return (
        next((message['data'] for _, message in recording.decoded(topics['scene'])), '')
        if 'scene' in topics
        else ''
    )
