"""One pass through a recording: every message is looked at once, and what the report tells of it is kept."""

from rigid_body_sim.analysis.collectors import Curve
from rigid_body_sim.analysis.drift import Residual, scales
from rigid_body_sim.analysis.flips import Flips, can_flip
from rigid_body_sim.analysis.source import EVERY_TICK
from rigid_body_sim.analysis.timing import Punctuality
from rigid_body_sim.timeline import NANOSECONDS


class Measured:
    """All that is measured of one Source.

    Attributes
    ----------
    source : Source
    energy, momentum : Residual
        Of the energy and of L^2.
    angular_velocity : Curve
        Components in body axes, rad/s.
    punctuality : Punctuality
    flips : Flips or None
    """

    def __init__(self, source):
        self.source = source
        energy_scale, momentum_scale = scales(source.scene)
        self.energy = Residual(source.history, lambda segment: segment.keeps_energy, energy_scale, source.ticks)
        self.momentum = Residual(source.history, lambda segment: segment.keeps_momentum, momentum_scale, source.ticks)
        self.angular_velocity = Curve(source.ticks)
        self.punctuality = Punctuality(source.history)
        self.flips = Flips(source.scene) if can_flip(source.scene) and 'angular_velocity' in source.topics else None
        self._paced_by = next((name for name in ('pose', 'angular_velocity') if name in source.topics), None)

    def take(self, name, columns):
        """Take a block of the messages of a topic, by its name in source.EVERY_TICK."""
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
        if name == self._paced_by:
            self.punctuality.add(columns['header.stamp'], columns['publish_time'])


def measure(recording, sources, progress=None):
    """Return a Measured for each Source of a Recording; `progress` is called with numbers of messages done."""
    measured = [Measured(source) for source in sources]
    takers = {one.source.topics[name]: (one, name) for one in measured for name in EVERY_TICK if name in one.source.topics}
    for topic, columns in recording.blocks(list(takers), progress=progress):
        one, name = takers[topic]
        one.take(name, columns)
    return measured
