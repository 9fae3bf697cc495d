# SPDX-License-Identifier: Apache-2.0
"""Residuals of conserved quantities, relative to the first tick of each segment."""

import numpy as np

from rigid_body_sim.analysis.collectors import Curve
from rigid_body_sim.mechanics import energy, parameters
from rigid_body_sim.mechanics.potential import energies

FLOOR = 4 * np.finfo(float).eps
"""Round-off floor of a relative residual: values are made of a handful of products and sums."""


MOST_LEVELS = 100


class Residual:
    """Residual of a quantity that is constant in some segments of the history.

    Parameters
    ----------
    history : History
    kept : callable
        Says of a Segment whether the quantity is constant there.
    scale : float
        Least scale of the residual, in the unit of the quantity; it is relative to the largest of
        that and its size at the segment's start.
    count : int
        Approximate number of values to come.
    size : int
        Number of components; the residual of a vector is the length of its change, that of a
        number has a sign.
    """

    def __init__(self, history, kept, scale, count, size=1):
        self._history = history
        self._kept = np.array([kept(segment) for segment in history.segments])
        self._scale = scale
        self._place, self._reference = -1, np.zeros(size)
        self._residuals = Curve(count)
        self.values = Curve(count)
        self.first = self.last = None
        self.least, self.greatest = np.full(size, np.inf), np.full(size, -np.inf)
        self.largest = self.last_residual = 0.0
        self.judged = self.stretches = 0
        self.levels, self._level = [], None

    def add(self, stamps, times, values):
        """Take values (n,) or (n, size): their stamps (ns) and times from the start (s)."""
        values = values.reshape(len(times), -1)
        self.values.add(times, values)
        self.first = values[0] if self.first is None else self.first
        self.last = values[-1]
        self.least, self.greatest = np.minimum(self.least, values.min(axis=0)), np.maximum(
            self.greatest, values.max(axis=0)
        )
        places = self._history.at(stamps)
        # index of the first value of the segment of each value (-1: in an earlier block)
        begins = np.flatnonzero(np.diff(places, prepend=self._place))
        which = np.searchsorted(begins, np.arange(len(values)), side='right') - 1
        references = np.concatenate([values[begins], [self._reference]])[which]
        self._place, self._reference = places[-1], references[-1]
        self._note_levels(times[begins], values[begins], places[begins])
        kept = self._kept[places]
        if not kept.any():
            return
        scales = np.maximum(_length(references), self._scale)
        changes = values - references
        changes = changes[:, 0] if values.shape[1] == 1 else _length(changes)
        residuals = np.divide(changes, scales, out=np.zeros(len(values)), where=scales > 0.0)[kept]
        self._residuals.add(times[kept], residuals)
        self.judged += len(residuals)
        self.largest = max(self.largest, float(np.abs(residuals).max()))
        self.last_residual = float(residuals[-1])

    def _note_levels(self, times, values, places):
        """Note where the quantity begins to be constant, where it ends, and its value."""
        for time, value, place in zip(times.tolist(), values, places.tolist(), strict=True):
            if self._level:
                self._level['until'] = time
            self._level = None
            if self._kept[place]:
                self._level = {'from': time, 'until': None, 'value': _plain(value),
                               'begun_by': self._history.segments[place].begun_by}
                self.stretches += 1
                self.levels += [self._level] if len(self.levels) < MOST_LEVELS else []

    @property
    def not_kept_from(self):
        """Stamps (ns) from which on the quantity is not kept for a while."""
        return [
            segment.stamp
            for segment, kept in zip(self._history.segments, self._kept, strict=True)
            if not kept
        ]

    def curve(self):
        """Return times (s) and residuals where the quantity is kept."""
        return self._residuals.curve()

    def summary(self):
        """Return a dict of plain data.

        It has the first, last, least and greatest value; the largest and the last residual (None
        where it is never constant); how many stretches there are in which it is constant, and of
        the first MOST_LEVELS of them when each begins (s), by what, when it ends (None: with the
        recording), and the value.
        """
        seen = {
            name: _plain(getattr(self, name)) if self.first is not None else None
            for name in ('first', 'last', 'least', 'greatest')
        }
        return {
            **seen,
            'largest_residual': self.largest if self.judged else None,
            'last_residual': self.last_residual if self.judged else None,
            'judged_ticks': self.judged,
            'stretches': self.stretches,
            'levels': self.levels,
        }


def _length(vectors):
    return (
        np.sqrt((vectors * vectors).sum(axis=1)) if vectors.shape[1] > 1 else np.abs(vectors[:, 0])
    )


def _plain(values):
    """Return one number, or the list of several."""
    return values.tolist() if len(values) > 1 else float(values[0])


def scales(scene):
    """Return the scales of energy (J) and of L^2 in a scene.

    That of the energy is the larger one of kinetic and potential energy at the start; that of L^2
    is 0.
    """
    if scene is None:
        return 0.0, 0.0
    out = np.empty(energy.DIAGNOSIS_SIZE)
    energies(scene).diagnose(parameters.parameters(scene), scene.initial.vector, out)
    return max(out[energy.KINETIC], abs(out[energy.POTENTIAL])), 0.0
