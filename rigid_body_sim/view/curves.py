# SPDX-License-Identifier: Apache-2.0
"""The live curves: the residuals of energy and angular momentum, with the band of round-off.

Their times count from now, so that the chart's window is fixed: one that follows the data is moved
by the page itself, which in a slow browser loses the curves for good.
"""

import collections
import math

import numpy as np

from rigid_body_sim.analysis.drift import FLOOR

POINTS = 600
WINDOW = 10.0
"""Time that the chart shows, s of the clock: POINTS at sixty a second."""
SCALE = 1e-16
"""Unit of the numbers in the chart, which would not show smaller ones."""
COLORS = {'energy': '#d55e00', 'momentum': '#0072b2', 'band': 'rgba(128,128,128,0.9)'}


class Curves:
    """A chart of the last residuals; the zero line is exact conservation.

    Parameters
    ----------
    gui : viser.GuiApi
    """

    def __init__(self, gui):
        self._rows = collections.deque(maxlen=POINTS)
        self._speed = 1.0
        axis = {'stroke': '#888', 'grid': {'stroke': 'rgba(128,128,128,0.25)', 'width': 1},
                'ticks': {'stroke': 'rgba(128,128,128,0.25)', 'width': 1}}
        self._chart = gui.add_uplot(
            self._data(),
            ({'label': 't - now (s)'},
             {'label': 'energy', 'stroke': COLORS['energy'], 'width': 2},
             {'label': 'L²', 'stroke': COLORS['momentum'], 'width': 2},
             {'label': '+ round-off', 'stroke': COLORS['band'], 'width': 1, 'dash': (4, 4)},
             {'label': '- round-off', 'stroke': COLORS['band'], 'width': 1, 'dash': (4, 4)}),
            bands=({'series': (3, 4), 'fill': 'rgba(128,128,128,0.15)'},),
            scales=self._scales(), axes=({**axis, 'label': 't - now (s)', 'labelSize': 20},
                                         {**axis, 'size': 74}),
            title='relative residuals, in units of 1e-16', height=250, legend={'show': True})

    def _scales(self):
        return {'x': {'time': False, 'range': (-WINDOW * self._speed, 0.0)}, 'y': {'auto': True}}

    def take(self, snapshot):
        """Remember the residuals of a Snapshot."""
        if snapshot.restarted:
            self._rows.clear()
        if math.isfinite(snapshot.energy_residual) and not (
                self._rows and snapshot.time <= self._rows[-1][0]):
            self._rows.append((snapshot.time, snapshot.energy_residual,
                               snapshot.momentum_residual))

    def draw(self, speed):
        """Draw what is remembered; a few times a second is enough.

        `speed` is how many seconds pass in the motion in one of the clock.
        """
        if speed != self._speed:
            self._speed = speed
            self._chart.scales = self._scales()
        self._chart.data = self._data()

    def _data(self):
        rows = np.array(self._rows or [(0.0, 0.0, 0.0)], float)
        floor = np.full(len(rows), FLOOR / SCALE)
        return (rows[:, 0] - rows[-1, 0], rows[:, 1] / SCALE, rows[:, 2] / SCALE, floor, -floor)
