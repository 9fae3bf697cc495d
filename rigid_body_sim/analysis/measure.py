# SPDX-License-Identifier: Apache-2.0
"""One pass through a recording: every message is read once, and the report's numbers are kept."""

import numpy as np

from rigid_body_sim.analysis.align import aligned
from rigid_body_sim.analysis.collectors import Curve
from rigid_body_sim.analysis.drift import Residual, scales
from rigid_body_sim.analysis.flips import Flips, can_flip
from rigid_body_sim.analysis.motion import Motion
from rigid_body_sim.analysis.source import COLUMNS, EVERY_TICK
from rigid_body_sim.analysis.timing import Punctuality
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.timeline import NANOSECONDS

HAVE_STAMPS = ('pose', 'angular_velocity')
LARGEST = 1e150     # the square of this is finite
UNIT = 1e-6
"""Largest error of the square of a quaternion's length; single precision is off by 1e-7."""


class Measured:
    """Everything that is measured in one Source.

    Attributes
    ----------
    source : Source
    energy, momentum : Residual
        Residuals of the energy and of L^2.
    angular_velocity : Curve
        Components in body axes, rad/s.
    punctuality : Punctuality
    flips : Flips or None
    motion : Motion or None
        What needs pose and angular velocity.
    """

    def __init__(self, source):
        self.source = source
        energy_scale, momentum_scale = scales(source.scene)
        self.energy = Residual(
            source.history, lambda segment: segment.keeps_energy, energy_scale, source.ticks
        )
        self.momentum = Residual(
            source.history, lambda segment: segment.keeps_momentum, momentum_scale, source.ticks
        )
        self.angular_velocity = Curve(source.ticks)
        self.punctuality = Punctuality(source.history)
        self.flips = (
            Flips(source.scene)
            if can_flip(source.scene) and 'angular_velocity' in source.topics
            else None
        )
        self.motion = (
            Motion(source) if {'pose', 'angular_velocity'} <= set(source.topics) else None
        )

    def take(self, stretch):
        """Take messages of one stretch of time: name in source.EVERY_TICK -> columns.

        Raises
        ------
        BadInput
            If they hold no sensible numbers.
        """
        for name, columns in stretch.items():
            check_numbers(self.source.topics[name], columns, name)
            stamps = columns['log_time']
            times = (stamps - self.source.start) / NANOSECONDS
            if name == 'energy':
                self.energy.add(stamps, times, columns['data'])
            elif name == 'angular_momentum_squared':
                self.momentum.add(stamps, times, columns['data'])
            elif name == 'angular_velocity':
                self.angular_velocity.add(times, columns['vector'])
                if self.flips:
                    self.flips.add(columns['vector'])
        paced_by = stretch.get('pose', stretch.get('angular_velocity'))
        if paced_by is not None:
            self.punctuality.add(paced_by['header.stamp'], paced_by['publish_time'])
        if self.motion and 'pose' in stretch and 'angular_velocity' in stretch:
            self._take_motion(stretch['pose'], stretch['angular_velocity'])

    def _take_motion(self, pose, omega):
        """Take the ticks that have both messages, matched by their header stamps."""
        _, mine, theirs = np.intersect1d(
            pose['header.stamp'], omega['header.stamp'], assume_unique=True, return_indices=True
        )
        if len(mine):
            stamps = pose['log_time'][mine]
            self.motion.add(
                stamps,
                (stamps - self.source.start) / NANOSECONDS,
                pose['pose.orientation'][mine],
                omega['vector'][theirs],
                pose['pose.position'][mine],
            )


def check_numbers(topic, columns, name):
    """Raise BadInput where the columns of a topic cannot be those of a motion.

    `name` is that of the topic in source.EVERY_TICK.
    """
    for column, width in COLUMNS[name].items():
        if (
            column not in columns
            or columns[column].shape[1:] != width
            or columns[column].dtype != np.float64
        ):
            raise BadInput(
                topic,
                f'has no {column} in its messages, or not of {width[0] if width else 1} doubles',
                EVERY_TICK[name],
            )
        if not (np.abs(columns[column]) < LARGEST).all():     # false for NaN
            raise BadInput(
                topic,
                f'holds a number that is not finite, or beyond {LARGEST:g}',
                'a recording of a simulation that went well',
            )
    if name in HAVE_STAMPS and (
        'header.stamp' not in columns or columns['header.stamp'].dtype != np.int64
    ):
        raise BadInput(topic, 'has no stamps in its messages', EVERY_TICK[name])
    q = columns.get('pose.orientation')
    if q is not None and not (np.abs((q * q).sum(axis=1) - 1.0) < UNIT).all():
        raise BadInput(
            topic, 'holds an orientation that is not a unit quaternion',
            'a recording of a rigid body'
        )


def measure(recording, sources, progress=None):
    """Return a Measured for each Source of a Recording.

    `progress` is called with the number of messages done.
    """
    measured = [Measured(source) for source in sources]
    names = {
        one.source.topics[name]: (one, name)
        for one in measured
        for name in EVERY_TICK
        if name in one.source.topics
    }
    for stretch in aligned(recording, list(names), progress):
        for one in measured:
            one.take(
                {
                    names[topic][1]: columns
                    for topic, columns in stretch.items()
                    if names[topic][0] is one
                }
            )
    return measured
