# SPDX-License-Identifier: Apache-2.0
"""One simulated body of a recording: scene, states, events, commands.

Several bodies may have been recorded together, each in a namespace of its own.
"""

import json
import typing

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.state_topics import OUTPUTS
from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.recording.about import STATUS_TYPE, STRING_TYPE
from rigid_body_sim.recording.command_messages import WRENCH_TYPE
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import (
    ANGULAR_VELOCITY,
    ORIENTATION,
    POSITION,
    STATE_SIZE,
    TIME,
    VELOCITY,
    States,
)
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, TOPICS

MARKS = ('pose', 'angular_velocity', 'journal', 'scene')
"""A namespace with one of these topics is that of a body."""
TYPES = {**{name: OUTPUTS[name].type for name in ('pose', 'angular_velocity', 'odom')},
         'events': STATUS_TYPE, 'scene': STRING_TYPE, 'journal': STRING_TYPE,
         **{TOPICS[kind]: WRENCH_TYPE for kind in (IMPULSE, HOLD)}}


class Event(typing.NamedTuple):
    """An event that the simulation noted.

    `time` in seconds since the recording's start, `log_time` in ns; `name` (``flip``, ...),
    `message` for people, `values`, a dict of texts.
    """

    time: float
    log_time: int
    name: str
    message: str
    values: dict


def namespace_of(recording, namespace=None):
    """Return a body's namespace (without ``/`` at its end); without one given, the only one's."""
    found = sorted({name.rpartition('/')[0] for name, topic in recording.topics.items()
                    if (last := name.rpartition('/')[2]) in MARKS and TYPES[last] == topic.type})
    names = [one or '/' for one in found]
    if namespace is None and len(found) == 1:
        return found[0]
    if namespace is None or namespace.rstrip('/') not in found:
        problem = 'several bodies were recorded' if found else 'no body was recorded'
        if namespace is not None:
            problem = f'no body was recorded in the namespace {namespace!r}'
        remedy = 'a recording of a simulation'
        if found:
            remedy = f'namespace= one of {", ".join(names)}'
        raise BadInput(str(recording.path), problem, remedy)
    return namespace.rstrip('/')


def _topic(recording, namespace, last):
    """Return the complete name of a body's topic, or None if it was not recorded as its type."""
    topic = recording.topics.get(f'{namespace}/{last}') or recording.topics.get(
        _remapped(recording, last))
    return topic.name if topic and topic.type == TYPES[last] and topic.count else None


def _remapped(recording, last):
    """Return the complete name that a topic of the only body was remapped to, or None."""
    try:
        name = json.loads(recording.about.get('topics', '{}')).get(last)
    except (ValueError, AttributeError):
        return None
    return name if isinstance(name, str) else None


def _entries(recording, namespace):
    return [entry for entry in recording.journal() if entry['topic'] == f'{namespace}/journal']


def scene(recording, namespace):
    """Return the Scene of a body; see :meth:`rigid_body_sim.recording.reader.Recording.scene`."""
    texts = [entry.get('scene') for entry in _entries(recording, namespace)
             if entry['kind'] == 'begin']
    latched = _topic(recording, namespace, 'scene')
    if latched:
        texts += [message['data'] for _, message in recording.decoded(latched)]
    text = next((text for text in texts if isinstance(text, str) and text), None)
    if text is None:
        raise BadInput(str(recording.path), 'the scene was not recorded',
                       'a recording by sim_node or simulate, or one with the topic "scene"')
    return parse_scene(text, where=f'{recording.path}: scene')


def states(recording, namespace, start, end, progress):
    """Return the States; see :meth:`rigid_body_sim.recording.reader.Recording.states`."""
    pose, omega, odom = (_topic(recording, namespace, name)
                         for name in ('pose', 'angular_velocity', 'odom'))
    if not pose or not omega:
        raise BadInput(str(recording.path), 'pose and angular_velocity were not both recorded',
                       f'some of {", ".join(sorted(recording.topics))} by read()')
    poses = recording.read(pose, ['header.stamp', 'pose.position', 'pose.orientation'], start, end,
                           progress)
    turns = recording.read(omega, ['header.stamp', 'vector'], start, end, progress)
    if not len(poses['log_time']) or not len(turns['log_time']):
        return States(np.empty((0, STATE_SIZE)))
    stamps, rows, turn_rows = np.intersect1d(poses['header.stamp'], turns['header.stamp'],
                                             return_indices=True)
    vectors = np.empty((len(stamps), STATE_SIZE))
    vectors[:, TIME] = (stamps - _first_stamp(recording, pose)) / NANOSECONDS
    vectors[:, ORIENTATION] = poses['pose.orientation'][rows]
    vectors[:, POSITION] = poses['pose.position'][rows]
    vectors[:, ANGULAR_VELOCITY] = turns['vector'][turn_rows]
    vectors[:, VELOCITY] = np.nan
    if odom:
        moved = recording.read(odom, ['header.stamp', 'twist.twist.linear'], start, end, progress)
        _, mine, theirs = np.intersect1d(stamps, moved['header.stamp'], return_indices=True)
        # a node that records does not need it
        from scipy.spatial.transform import Rotation
        turn = Rotation.from_quat(vectors[mine, ORIENTATION])
        vectors[mine, VELOCITY] = turn.apply(moved['twist.twist.linear'][theirs])
    return States(vectors)


def _first_stamp(recording, topic):
    return int(next(recording.blocks([topic], ['header.stamp']))[1]['header.stamp'][0])


def events(recording, namespace):
    """Return a list of Events."""
    topic = _topic(recording, namespace, 'events')
    return [Event((log_time - recording.start_time) / NANOSECONDS, log_time, message['name'],
                  message['message'],
                  {value['key']: value['value'] for value in message['values']})
            for log_time, message in (recording.decoded(topic) if topic else ())]


def commands(recording, namespace):
    """Return commands as columns, see :meth:`rigid_body_sim.recording.reader.Recording.commands`.

    The journal tells the ticks at which they took effect; without one, the messages themselves
    are taken.
    """
    entries = _entries(recording, namespace)
    if entries:
        rows = [(entry['log_time'], entry['tick'], one['topic'], one['frame'], one['force'],
                 one['torque']) for entry in entries if entry['kind'] == 'commands'
                for one in entry['commands']]
    else:
        rows = []
        for name in (TOPICS[IMPULSE], TOPICS[HOLD]):
            topic = _topic(recording, namespace, name)
            rows += [(log_time, -1, name, message['header']['frame_id'],
                      *(list(message['wrench'][part].values()) for part in ('force', 'torque')))
                     for log_time, message in (recording.decoded(topic) if topic else ())]
        rows.sort(key=lambda row: row[0])
    times, ticks, topics, frames, forces, torques = zip(*rows, strict=True) if rows else ((),) * 6
    return {'log_time': np.array(times, np.int64), 'tick': np.array(ticks, np.int64),
            'topic': np.array(topics, str), 'frame': np.array(frames, str),
            'force': np.array(forces, float).reshape(-1, 3),
            'torque': np.array(torques, float).reshape(-1, 3)}
