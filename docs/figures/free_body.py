# SPDX-License-Identifier: Apache-2.0
"""Angular velocity of a free body within the bounds that E and L^2 set."""

import numpy as np

from figures.style import LINES, label, panels, run
from rigid_body_sim.theory import euler_equations as theory


def draw():
    """Return the figure."""
    figure, axes = panels(3, sharey=True)
    simulation = run('free_body')
    moments = np.array(simulation.scene.body.about_center.moments)
    times = np.linspace(0.0, 20.0, 801)
    omega = simulation.states(times).angular_velocity
    start = omega[0]
    by_energy = theory.bounds_from_energy(moments, theory.kinetic_energy(moments, start))
    by_momentum = theory.bounds_from_angular_momentum(
        moments, theory.angular_momentum_squared(moments, start))
    for k, one in enumerate(axes):
        one.plot(times, omega[:, k], **LINES[0])
        for sign in (1.0, -1.0):
            one.axhline(sign * by_energy[k], label='√(2T/I$_i$)' if sign > 0.0 else None,
                        **LINES[1])
            one.axhline(sign * by_momentum[k], label='L/I$_i$' if sign > 0.0 else None, **LINES[2])
        label(one, 'time (s)', f'ω$_{k + 1}$ (rad/s)', legend=k == 1, loc='lower center',
              bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure
