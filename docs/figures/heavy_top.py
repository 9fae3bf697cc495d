# SPDX-License-Identifier: Apache-2.0
"""Effective potential with turning points, and the trace of the axis: cusps, loops, waves."""

import numpy as np

from figures.style import BLACK, GREY, LINES, label, panels, run
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.theory import heavy_top as theory

I1, I3, MGL, SPIN, TILT = 0.03, 0.01, 0.981, 60.0, 0.5
STARTS = (('cusps: α′ = 0', 0.0), ('loops: α′ < 0', -3.0), ('waves: α′ > 0', 1.5))


def draw():
    """Return the figure."""
    figure, axes = panels(2, height=3.6, width_ratios=(1.3, 1.0))
    P_gamma = I3 * SPIN
    P_alpha = theory.p_alpha(0.0, TILT, P_gamma, I1)
    tilts = np.linspace(0.43, 0.7, 300)
    E = theory.energy(TILT, 0.0, P_alpha, P_gamma, I1, I3, MGL)
    axes[0].plot(tilts, theory.effective_potential(tilts, P_alpha, P_gamma, I1, I3, MGL),
                 label='V$_{eff}$', **LINES[0])
    axes[0].axhline(E, color=GREY, linewidth=0.8, label='E')
    turns = np.array(theory.turning_points(E, P_alpha, P_gamma, I1, I3, MGL))
    axes[0].plot(turns, [E, E], 'o', color=BLACK, label='turning points')
    beta_0 = theory.equilibrium_tilt(P_alpha, P_gamma, I1, MGL)
    axes[0].plot(beta_0, theory.effective_potential(beta_0, P_alpha, P_gamma, I1, I3, MGL), 'D',
                 color=LINES[1]['color'], label='β$_0$')
    states = run('heavy_top', f'initial.spin={SPIN}').states(np.linspace(0.0, 1.0, 41))
    beta, rate = instruments.beta(states), instruments.beta_rate(states)
    axes[0].plot(beta, E - 0.5 * I1 * rate**2, '.', color=LINES[2]['color'],
                 label='E − I$_1$β′²/2 of the motion')
    axes[0].set_ylim(top=E + 0.1)
    label(axes[0], 'tilt β (rad)', 'energy (J)')
    for (name, start), line in zip(STARTS, LINES, strict=False):
        omega = [float(-start * np.sin(TILT)), 0.0, SPIN]
        e3 = instruments.axes(run('heavy_top', f'initial.angular_velocity={omega}').states(
            np.linspace(0.0, 1.6, 800)))[:, :, 2]
        axes[1].plot(e3[:, 0], e3[:, 1], label=name, **line | {'linewidth': 1.2})
    axes[1].plot(0.0, 0.0, 'k+')
    axes[1].set_aspect('equal')
    label(axes[1], 'e$_3$ along x', 'e$_3$ along y', loc='upper left', bbox_to_anchor=(0.98, 1.0))
    return figure
