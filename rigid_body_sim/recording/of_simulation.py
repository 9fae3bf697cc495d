# SPDX-License-Identifier: Apache-2.0
"""The recording of a simulation without ROS: the same as the node would write.

``simulate`` writes it, and ``view`` while its page is open.
"""

import operator
import time

import numpy as np

from rigid_body_sim.messages import state_topics
from rigid_body_sim.messages.timeline import Pace, Timeline
from rigid_body_sim.recording import about
from rigid_body_sim.recording.command_messages import (
    WRENCH_TYPE,
    CommandMessages,
    CommandTopics,
)
from rigid_body_sim.recording.needed import need_mcap
from rigid_body_sim.recording.topics import Topic, journal_message, journal_topic
from rigid_body_sim.simulation.command_rows import HOLD, IMPULSE, TOPICS

SCENE = Topic('/scene', about.STRING_TYPE, 1, durability='transient_local')
EVENTS = Topic('/events', about.STATUS_TYPE, 100, durability='transient_local')
COMMANDS = tuple(f'/{TOPICS[kind]}' for kind in (IMPULSE, HOLD))


class SimulationRecording:
    """A recording of a simulation: topics of every tick, events, the latched scene, the journal.

    Stamps begin at the wall clock and count ticks. Nothing is published, so the publish times are
    the stamps.

    Parameters
    ----------
    path : path-like
        The folder to make.
    made_by : str
        The command that records.
    simulation : Simulation
    parameters : dict
        All settings of the subcommand.
    publish : sequence of str
        Topics beside those of every tick, by the names of state_topics.ON_REQUEST.
    commanded : bool
        Whether commands may come: :meth:`commands`.
    writing : dict
        ``compression_name``, ``split_bytes``, ``split_seconds`` of the Writer.

    Raises
    ------
    BadInput
        Where nothing can be recorded.
    OSError
        By every method when the disk refuses.
    """

    def __init__(self, path, made_by, simulation, parameters, publish=(), commanded=False,
                 **writing):
        need_mcap()
        from rigid_body_sim.recording.writer import Writer
        self._made_by, self._frames = made_by, state_topics.Frames()
        self._outputs = state_topics.chosen(publish)
        self._take(simulation)
        self._pace = Pace(state_topics.DISPLAY_RATE, simulation.rate)
        self._paced = [Topic(f'/{output.name}', output.type) for output in self._outputs.paced]
        self._journal = journal_topic()
        ticking = [(Topic(f'/{output.name}', output.type), size)
                   for output, size in zip(self._outputs.ticking, self._messages.ticking.sizes,
                                           strict=True)]
        commands = [Topic(name, WRENCH_TYPE) for name in COMMANDS] if commanded else []
        self._commands = CommandMessages(
            CommandTopics(COMMANDS, (self._frames.world, self._frames.body)), self._journal.name)
        self._writer = Writer(path, ticking, [EVENTS, SCENE, *self._paced, *commands],
                              self._journal, about.about(made_by, simulation, parameters),
                              **writing)
        self._timeline = Timeline(time.time_ns(), simulation.rate)
        self._waiting, self._recorded = [], -1
        self._announce()

    def _take(self, simulation):
        self._simulation = simulation
        self._messages = state_topics.scene_messages(self._outputs, simulation.scene,
                                                     self._frames)

    def _announce(self):
        self._message(SCENE, self._stamp, about.scene_message(self._simulation.scene))

    @property
    def _stamp(self):
        """Stamp of the simulation's present tick, ns."""
        return self._timeline.instant(self._simulation.tick)

    def note(self, events):
        """Take events; each is recorded with its tick, at once where that tick is recorded."""
        for event in events:
            data = about.event_message(self._made_by, about.OK, event.name,
                                       *about.event_text(event))
            if event.tick <= self._recorded:
                self._message(EVENTS, self._timeline.instant(event.tick), data)
            else:
                self._waiting.append((event.tick, EVENTS, data))

    def ticks(self, first, states):
        """Record the States of consecutive ticks, of which `first` is the first."""
        if not len(states):
            return
        stamps = np.array(self._timeline.instants(first, len(states)))
        given = states.vector, *self._simulation.diagnose(states), stamps
        rows = self._messages.ticking.columns(*given, self._simulation.wrench)
        last, begin = first + len(states) - 1, 0
        due = [entry for entry in self._waiting if entry[0] <= last]
        self._waiting = self._waiting[len(due):]
        between = [*due, *self._paced_messages(first, *given)]
        for tick, topic, data in sorted(between, key=operator.itemgetter(0)):
            end = max(tick - first, begin)
            self._record_ticks(first, begin, end, stamps, rows)
            begin = end
            self._message(topic, stamps[begin], data)
        self._record_ticks(first, begin, len(states), stamps, rows)
        self._recorded = last
        if self._writer.state_wanted and last == self._simulation.tick:
            self._writer.state_wanted = False
            self._entry('state', **about.state_entry(last, self._stamp, self._simulation))

    def commands(self, rows):
        """Record commands (command_rows.py) that take effect at the present tick, in order.

        The state of that tick is recorded after them.
        """
        if not len(rows):
            return
        stamp = self._stamp
        for made in self._commands.messages(self._simulation.tick, stamp, rows):
            if made is not None:
                self._writer.message(made[0], stamp, stamp, made[1])

    def reset(self):
        """Record that the simulation was put back to its initial state at the present tick."""
        self._entry('reset', tick=self._simulation.tick)

    def switch(self, simulation, changed):
        """Go on with another simulation, which stands at the same tick.

        Parameters
        ----------
        simulation : Simulation
            It begins its scene and has the rate of the one before.
        changed : dict
            The parameters that changed, by name.
        """
        self._take(simulation)
        self._entry('parameters', tick=simulation.tick, changed=changed,
                    scene=simulation.scene.text, simulation=about.run_of(simulation),
                    keeps_state=False)
        self._announce()

    def _paced_messages(self, first, vectors, energies, squares, stamps):
        """Return (tick, topic, bytes) of the topics with a rate of their own."""
        if not self._paced:
            return []
        due = self._pace.due(first, len(vectors))
        k = np.array(due, dtype=int) - first
        made = self._messages.paced.messages(vectors[k], energies[k], squares[k], stamps[k],
                                             self._simulation.wrench)
        return [(tick, topic, data) for tick, messages in zip(due, made, strict=True)
                for topic, data in zip(self._paced, messages, strict=True)]

    def _record_ticks(self, first, begin, end, stamps, rows):
        if end > begin:
            self._writer.ticks(first + begin, stamps[begin:end], stamps[begin:end],
                               [part[begin:end] for part in rows])

    def _entry(self, kind, **values):
        self._message(self._journal, self._stamp, journal_message(kind, **values))

    def _message(self, topic, stamp, data):
        self._writer.message(topic.name, stamp, stamp, data)

    @property
    def messages(self):
        """How many messages are in the files."""
        return self._writer.messages_written

    def close(self):
        """Finish the files."""
        self._writer.close()
