# SPDX-License-Identifier: Apache-2.0
"""Compare a recording with its rerun: the same bits, or where and by how much they differ."""

import numpy as np

from rigid_body_sim.analysis.collectors import Curve
from rigid_body_sim.analysis.measure import check_numbers
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, POSITION, TIME

# topic -> column of the message, and the quantity of the rerun that it should equal
QUANTITIES = {
    'pose': (('orientation', 'pose.orientation'), ('position', 'pose.position')),
    'angular_velocity': (('angular_velocity', 'vector'),),
    'energy': (('energy', 'data'),),
    'angular_momentum_squared': (('angular_momentum_squared', 'data'),),
}
SLICES = {'orientation': ORIENTATION, 'angular_velocity': ANGULAR_VELOCITY, 'position': POSITION}


GAP, SPAN = 1000, 100_000
"""Missing ticks beyond which a gap is skipped; ticks that are compared at a time."""


class Comparison:
    """Compares stretches of a recording with the rerun.

    Parameters
    ----------
    rerun : rerun.Rerun
    topics : dict
        Name in QUANTITIES -> complete topic name.
    source : source.Source

    Attributes
    ----------
    topics : dict
    messages, ticks : int
        Compared so far; `ticks` counts those of which anything was recorded.
    parting : dict or None
        Where bits differ first: tick, time (s), quantity, the recorded and the resimulated value.
    largest : dict
        Quantity -> the largest ``difference``: the angle between attitudes (rad), else the length
        of the difference; when that was, in s ``since_start``; and the ``scale`` of the quantity,
        the largest that was recorded.
    turned : float
        Angle through which the body turned, rad.
    """

    def __init__(self, rerun, topics, source):
        self._rerun, self.topics, self._start = rerun, topics, source.start
        self.messages = self.ticks = 0
        self.parting = None
        self.largest = {}
        self.turned = 0.0
        self._curves = {
            name: Curve(source.ticks)
            for quantities in QUANTITIES.values()
            for name, _ in quantities
        }

    def take(self, stretch):
        """Compare a stretch (see align.aligned)."""
        ticks_of = {
            topic: self._rerun.ticks(columns['log_time']) for topic, columns in stretch.items()
        }
        for name, topic in self.topics.items():
            if topic in stretch:
                check_numbers(topic, stretch[topic], name)
        for topic, ticks in ticks_of.items():
            if ticks.min() < self._rerun.next_tick:
                raise BadInput(
                    topic,
                    f'tick {int(ticks.min())} comes too late',
                    'messages in the order of time',
                )
        recorded = np.unique(np.concatenate(list(ticks_of.values())))
        self.ticks += len(recorded)
        for first, last in _runs(recorded):
            inside = {
                topic: (ticks >= first) & (ticks <= last) for topic, ticks in ticks_of.items()
            }
            self._take_run(
                {
                    topic: {name: column[inside[topic]] for name, column in columns.items()}
                    for topic, columns in stretch.items()
                },
                {topic: ticks[inside[topic]] for topic, ticks in ticks_of.items()},
                first,
                last,
            )

    def _take_run(self, stretch, ticks_of, first, last):
        """Compare the messages of the ticks from `first` to `last`, of which few are missing."""
        if first > self._rerun.next_tick + GAP:
            self._rerun.skip_to(first)
        ticks, states, energies, momenta = self._rerun.through(last)
        vectors = states.vector
        self.turned += (
            float(np.sqrt((states.angular_velocity**2).sum(axis=1)).sum())
            / self._rerun.simulation.rate
        )
        found = {
            'energy': energies,
            'angular_momentum_squared': momenta,
            **{name: vectors[:, part] for name, part in SLICES.items()},
        }
        for name, topic in self.topics.items():
            if topic not in stretch or not len(ticks_of[topic]):
                continue
            rows = ticks_of[topic] - ticks[0]
            self.messages += len(rows)
            for quantity, column in QUANTITIES[name]:
                self._compare(
                    quantity,
                    ticks_of[topic],
                    vectors[rows, TIME],
                    stretch[topic],
                    column,
                    found[quantity][rows],
                )

    def _compare(self, quantity, ticks, times, columns, column, resimulated):
        recorded = columns[column]
        recorded, resimulated = (
            np.ascontiguousarray(values, dtype=float).reshape(len(ticks), -1)
            for values in (recorded, resimulated)
        )
        different = (recorded.view(np.int64) != resimulated.view(np.int64)).any(axis=1)
        if different.any():
            first = int(different.argmax())
            if self.parting is None or ticks[first] < self.parting['tick']:
                self.parting = {
                    'tick': int(ticks[first]),
                    'time': float(times[first]),
                    'quantity': quantity,
                    'recorded': recorded[first].tolist(),
                    'resimulated': resimulated[first].tolist(),
                }
        size = (
            _angle(recorded, resimulated)
            if quantity == 'orientation'
            else np.sqrt(((recorded - resimulated) ** 2).sum(axis=1))
        )
        since_start = (columns['log_time'] - self._start) / NANOSECONDS
        self._curves[quantity].add(since_start, size)
        worst = int(size.argmax())
        largest = self.largest.setdefault(
            quantity, {'difference': -1.0, 'since_start': 0.0, 'scale': 0.0}
        )
        if size[worst] > largest['difference']:
            largest.update(difference=float(size[worst]), since_start=float(since_start[worst]))
        largest['scale'] = max(largest['scale'], float(np.sqrt((recorded ** 2).sum(axis=1).max())))

    def curve(self, quantity):
        """Return times (s, since the first tick) and differences of a quantity."""
        return self._curves[quantity].curve()


def _runs(ticks):
    """Yield (first, last) of runs of rising ticks, without long gaps and of bounded length."""
    jumps = np.flatnonzero(np.diff(ticks) > GAP) + 1
    begin = 0
    while begin < len(ticks):
        end = int(np.searchsorted(ticks, ticks[begin] + SPAN))
        place = np.searchsorted(jumps, begin, side='right')
        end = min(end, int(jumps[place])) if place < len(jumps) else end
        yield int(ticks[begin]), int(ticks[end - 1])
        begin = end


def within(largest, limit):
    """Return whether all differences are small.

    Attitudes may differ by `limit` (rad), other quantities by 4 times that part of their scale.
    """
    return all(
        worst['difference'] <= limit * (1.0 if quantity == 'orientation' else 4.0 * worst['scale'])
        for quantity, worst in largest.items()
    )


def _angle(p, q):
    """Return the angles between attitudes, accurate also where they are tiny.

    The chord of two quaternions is 2 sin(angle / 4).
    """
    chord = np.minimum(np.linalg.norm(p - q, axis=1), np.linalg.norm(p + q, axis=1))
    return 4.0 * np.arcsin(np.minimum(0.5 * chord, 1.0))
