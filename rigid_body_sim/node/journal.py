# SPDX-License-Identifier: Apache-2.0
"""The recording of a node: messages, commands with their ticks, and all that a rerun needs.

Entries of the journal topic, beside those of the recorder itself: ``state`` (see
about.state_entry), ``commands`` (``tick``, and ``commands``: in their order, with ``topic``,
``frame``, ``force``, ``torque``; a topic ``release`` ends the held wrench), ``reset`` (``tick``),
``parameters`` (``tick``, ``changed``, and ``scene``, ``simulation``, ``keeps_state`` as they are
from that tick on).
"""

import datetime
import itertools
import json
import pathlib
import time

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import about, compression
from rigid_body_sim.recording.command_messages import WRENCH_TYPE, CommandTopics
from rigid_body_sim.recording.recorder import Recorder
from rigid_body_sim.recording.topics import Topic, journal_topic
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, TOPICS

ATTEMPTS = 5


class Journal:
    """The recording of a node.

    Parameters
    ----------
    node : rclpy.node.Node
    settings : parameters.Settings
    simulation : Simulation
    publishing : publishing.Publishing
    frames : state_topics.Frames

    Attributes
    ----------
    status : recorder.Status
        As it was at the last :meth:`look`.

    Raises
    ------
    BadInput
        Where nothing can be recorded.
    """

    def __init__(self, node, settings, simulation, publishing, frames):
        self._simulation = simulation
        journal = journal_topic(node.get_namespace())
        command_topics = CommandTopics(
            tuple(node.resolve_topic_name(TOPICS[kind]) for kind in (IMPULSE, HOLD)),
            (frames.world, frames.body),
        )
        others = [
            *publishing.others(),
            *(Topic(name, WRENCH_TYPE) for name in reversed(command_topics.topics)),
        ]
        ticking = list(
            zip(publishing.every_tick(), publishing.messages.ticking.sizes, strict=True)
        )
        told = about.about('sim_node', simulation, settings.values)
        told['topics'] = json.dumps(publishing.names())
        asked = settings['recording.compression']
        options = (
            compression.DEFAULT if asked == 'auto' else asked,
            settings['recording.split_bytes'],
            settings['recording.split_seconds'],
            command_topics,
        )
        for attempt in range(ATTEMPTS):
            self.path = _free_path(node, settings, simulation.scene.name)
            try:
                self._recorder = Recorder(self.path, ticking, others, journal, told, *options)
                settings.recordings.add(self.path)
                break
            except BadInput:
                # another node of this name may have begun its recording meanwhile
                if settings['recording.name'] or not self.path.exists() or attempt == ATTEMPTS - 1:
                    raise
        self._record_tick = self._recorder.tick
        self.status = self._recorder.status()

    # -- the tick thread

    def tick(self, stamp, messages):
        """Record the messages of a tick; return whether the full state (`state`) is wanted."""
        return self._record_tick(stamp, time.time_ns(), messages)

    def paced(self, topic, stamp, data):
        """Record a message of an output with a rate of its own."""
        self._recorder.message(topic, stamp, time.time_ns(), data)

    def state(self, simulation, stamp):
        """Record the full state of a tick, after its messages."""
        self._recorder.state_wanted = False
        self._recorder.journal(
            'state', stamp, time.time_ns(),
            **about.state_entry(simulation.tick, stamp, simulation)
        )

    def message(self, topic, stamp, data):
        """Record a message on `events` or `scene`; it is never lost."""
        self._recorder.important(topic, stamp, time.time_ns(), data)

    def entry(self, kind, stamp, **values):
        """Record an entry of the journal; it is never lost."""
        self._recorder.journal(kind, stamp, time.time_ns(), **values)

    def commands(self, tick, stamp, rows):
        """Record the commands that took effect at a tick, in their order (command_rows.py)."""
        self._recorder.commands(tick, stamp, time.time_ns(), rows)

    # -- the main thread

    def look(self):
        """Look after the recorder, a few times a second."""
        self.status = self._recorder.status()

    def close(self, timeout):
        """End the recording; a recorder that takes longer (s) finishes on its own."""
        self.status = self._recorder.close(timeout)


class NoJournal:
    """Stands for the recording of a node that does not record."""

    path = status = None

    def tick(self, stamp, messages):
        """Record nothing, want nothing."""

    def __getattr__(self, name):
        return self._nothing

    @staticmethod
    def _nothing(*_, **__):
        return None


def open_journal(node, settings, simulation, publishing, frames):
    """Return the Journal of a node, or NoJournal where its parameters say so."""
    return (
        Journal(node, settings, simulation, publishing, frames) if settings.record else NoJournal()
    )


def _free_path(node, settings, scene):
    """Return the folder of the recording, which does not exist yet.

    By default two nodes never get the same one.
    """
    folder, name = pathlib.Path(settings['recording.directory']), settings['recording.name']
    if name:
        if pathlib.Path(name).name != name:
            raise BadInput(
                'parameter recording.name',
                f'got {name!r}',
                'needs one name; the folder around it is recording.directory',
            )
        # a managed node that is configured again numbers its own; it never adds to another's
        return _numbered(folder / name, lambda path: path in settings.recordings)
    who = node.get_fully_qualified_name().strip('/').replace('/', '_')
    stem = f'{who}_{scene}_{datetime.datetime.now():%Y-%m-%d_%H-%M-%S}'
    return _numbered(folder / stem, pathlib.Path.exists)


def _numbered(path, taken):
    """Return the path, with the first number after it (from 2 on) that is not taken."""
    paths = (path.with_name(f'{path.name}_{number}') for number in itertools.count(2))
    return next(one for one in itertools.chain([path], paths) if not taken(one))
