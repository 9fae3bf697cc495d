# SPDX-License-Identifier: Apache-2.0
"""Path of the centre of mass of a body on the ball joint of docs/extending."""

import numpy as np

from figures.more_bodies import installed, needle
from figures.style import BLACK, BLUE, THEORY, label, panels
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.scene import changed_scene
from rigid_body_sim.simulation.simulation import Simulation

SECONDS = 5.0


def draw():
    """Return the figure."""
    with installed() as folder:
        scene = changed_scene(needle(folder), {'effects': [{'gravity': {'g': 9.81}}]})
        states = Simulation(scene, accuracy=1e-9).states(np.linspace(0.0, SECONDS, 4000))
        center = scene.body.center_of_mass
        size = float(np.linalg.norm(scene.constraint.arm(scene.body)))
    x, y, z = np.array([np.add(place, rotate(*q, *center)) for place, q in zip(
        states.position, states.orientation, strict=True)]).T
    figure, both = panels(2, 4.0)
    around = np.linspace(0.0, 2.0 * np.pi, 200)
    for axes, up, name in zip(both, (y, z), ('y (m)', 'z (m)'), strict=True):
        axes.plot(size * np.cos(around), size * np.sin(around), **THEORY)
        axes.plot(x, up, color=BLUE, linewidth=0.8)
        axes.plot(0.0, 0.0, color=BLACK, marker='o', linestyle='')
        axes.set_aspect('equal')
        label(axes, 'x (m)', name, legend=False)
    both[0].set_title('from above', fontsize=10)
    both[1].set_title('from the side', fontsize=10)
    return figure
