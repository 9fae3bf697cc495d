# SPDX-License-Identifier: Apache-2.0
"""Residual of the energy over steps of split4, with compensated and with plain sums."""

import numpy as np

from bench.energy import SAMPLES, SCENE, plain, residuals
from figures.style import BLUE, ORANGE, label, panels
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.methods import split4
from rigid_body_sim.scene.scene import parse_scene

STEPS = 100_000


def draw():
    """Return the figure."""
    figure, [axes] = panels()
    METHODS['plain split4'] = plain(split4)
    for method, title, line in (
            ('plain split4', 'plain sums', {'color': ORANGE, 'linestyle': '--'}),
            ('split4', 'compensated sums', {'color': BLUE})):
        (energy, _), _ = residuals(parse_scene(SCENE), method, STEPS)
        largest = np.maximum.accumulate(np.abs(energy))
        axes.plot(np.linspace(0, STEPS, SAMPLES)[1:], largest[1:], label=title, **line)
    del METHODS['plain split4']    # no other figure shall know it
    axes.set_yscale('log')
    label(axes, 'steps of split4', 'largest residual of the energy so far')
    return figure
