# SPDX-License-Identifier: Apache-2.0
"""Error of the method of docs/extending over its step."""

import numpy as np

from figures.more_bodies import installed
from figures.style import MEASURED, THEORY, label, panels
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

SECONDS = 1.0


def draw():
    """Return the figure."""
    scene, steps = load_scene('free_body'), 2.0 ** -np.arange(4.0, 13.0)

    def attitude(*settings, **more):
        return Simulation(scene, *settings, **more).states([SECONDS]).orientation[0]
    with installed():
        exact = attitude('exact')
        errors = [angle_between(*attitude('ralston3', step=step), *exact)
                  for step in steps.tolist()]
    figure, [axes] = panels()
    axes.loglog(steps, errors, label='ralston3', **MEASURED)
    axes.loglog(steps, errors[-1] * (steps / steps[-1]) ** 3, label='slope 3', **THEORY)
    label(axes, 'step (s)', 'error after 1 s (rad)')
    return figure
