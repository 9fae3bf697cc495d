# SPDX-License-Identifier: Apache-2.0
"""What a figure for print has beside its curves."""

import types

import numpy as np

from rigid_body_sim.analysis import plots
from rigid_body_sim.analysis.panels import Line, Panel


def test_a_legend_stands_beside_the_axes_and_shows_whole_dashes():
    lines = [Line(name, np.arange(3.0), np.arange(3.0)) for name in 'xy']
    source = types.SimpleNamespace(history=types.SimpleNamespace(marks=[]), start=0)
    figure = plots.stack([Panel('turning', 'omega (rad/s)', lines)], 'a title', source)
    [axes] = figure.axes
    legend = axes.get_legend()
    assert [text.get_text() for text in legend.get_texts()] == ['x', 'y']
    assert legend.handlelength == 2.5    # widths of a letter; dashes repeat after less
    assert not legend.get_frame_on()
    figure.canvas.draw()
    assert legend.get_window_extent().x0 >= axes.get_window_extent().x1
