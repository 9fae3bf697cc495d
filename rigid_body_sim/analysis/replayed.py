# SPDX-License-Identifier: Apache-2.0
"""Recordings of a recording that was played back: log times are not the simulation's stamps.

``ros2 bag play`` publishes the messages as they were, so the stamps in their headers stay;
``ros2 bag record`` logs the times at which they arrived.
"""

import numpy as np

from rigid_body_sim.messages.timeline import NANOSECONDS

HAVE_STAMPS = ('pose', 'angular_velocity')


def stamps_of(recording, topics, end):
    """Return the stamps (ns) of the first and the last tick where they are not the log times.

    Parameters
    ----------
    recording : Recording
    topics : dict
        Name in source.TYPES -> complete name.
    end : int
        Log time of the last tick, ns.

    Returns
    -------
    (int, int) or None
        None in a recording of the simulation itself, or if no message has a stamp.
    """
    for name in HAVE_STAMPS:
        if name in topics:
            _, columns = next(recording.blocks([topics[name]], ['header.stamp']))
            stamps = columns.get('header.stamp')
            if stamps is None or (stamps == columns['log_time']).all():
                return None
            for start in (end - NANOSECONDS, 0):
                last = [int(columns['header.stamp'].max()) for _, columns
                        in recording.blocks([topics[name]], ['header.stamp'], start)]
                if last:
                    return int(stamps[0]), max(last)
    return None


class Restamped:
    """A Recording with stamps in place of log times, as far as align.aligned needs it.

    Messages without a header (energy, L^2) get the stamps of the messages of `paced_by` by their
    order, which is known if there are as many of both.

    Parameters
    ----------
    recording : Recording
    paced_by : str
        Complete name of a topic whose messages have stamps.
    """

    def __init__(self, recording, paced_by):
        self._recording, self.topics = recording, recording.topics
        self._stamps = recording.read(paced_by, ['header.stamp'])['header.stamp']

    def can(self, topic):
        """Return whether the messages of a topic have stamps, or get them by their order."""
        _, columns = next(self._recording.blocks([topic]))
        return 'header.stamp' in columns or self.topics[topic].count == len(self._stamps)

    def blocks(self, topics, progress=None):
        """Yield blocks as Recording.blocks does."""
        done = dict.fromkeys(topics, 0)
        for topic, columns in self._recording.blocks(topics, progress=progress):
            count = len(columns['log_time'])
            stamps = columns.get('header.stamp')
            if stamps is None:
                stamps = self._stamps[done[topic]:done[topic] + count]
            done[topic] += count
            order = np.argsort(stamps, kind='stable')
            yield topic, {name: column[order]
                          for name, column in {**columns, 'log_time': stamps}.items()}
