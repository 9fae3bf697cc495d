# SPDX-License-Identifier: Apache-2.0
"""Rate of the slowing sphere of docs/extending, in closed form and by steps."""

import numpy as np

from figures.more_bodies import FREE, installed
from figures.style import BLUE, MEASURED, label, panels
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation


def draw():
    """Return the figure."""
    times = np.linspace(0.0, 10.0, 200)
    with installed():
        scene = parse_scene(FREE.format(effect='paddle: {coefficient: 1.0e-4}'),
                            ['body.inertia=[0.002, 0.002, 0.002]'])
        exact, stepped = (Simulation(scene, method, accuracy=1e-6).states(times).angular_velocity
                          for method in ('exact', 'dop8'))
    figure, (left, right) = panels(2)
    left.plot(times, np.linalg.norm(exact, axis=1), color=BLUE, label='closed form')
    left.plot(times[::10], np.linalg.norm(stepped, axis=1)[::10], label='dop8', **MEASURED)
    label(left, 'time (s)', 'rate (rad/s)')
    apart = np.linalg.norm(stepped - exact, axis=1)[1:] / np.linalg.norm(exact, axis=1)[1:]
    right.plot(times[1:], apart, color=BLUE)
    right.set_yscale('log')
    label(right, 'time (s)', 'difference, relative', legend=False)
    return figure
