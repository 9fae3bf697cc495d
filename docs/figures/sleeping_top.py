# SPDX-License-Identifier: Apache-2.0
"""The tilt of an upright top on both sides of the threshold."""

import numpy as np

from figures.style import BLACK, GREY, LINES, label, panels, run
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.theory import sleeping_top as theory


def draw():
    """Return the figure."""
    figure, (axes,) = panels()
    times = np.linspace(0.05, 150.0, 3000)
    for name, share, line in (('falling_top', '0.999', LINES[1]),
                              ('sleeping_top', '1.001', LINES[0])):
        axes.semilogy(times, instruments.beta(run(name).states(times)),
                      label=f'P$_γ$² = {share} · 4 I$_1$Mgl', **line)
    P_gamma = 0.01 * 34.29318882810404
    rate = theory.growth_rate(P_gamma, 0.03, 0.981)
    early = times < 45.0
    axes.semilogy(times[early], 1e-6 * np.sinh(rate * times[early]) / rate,
                  label='10$^{-6}$ sinh(rate t)/rate', linestyle=':', color=BLACK)
    axes.axhline(theory.nodding_tilt(P_gamma, 0.03, 0.981), color=GREY, linewidth=0.8)
    axes.annotate('cos β = P$_γ$²/(2I$_1$Mgl) − 1: 3.62°', (150.0, 0.075), fontsize=8, ha='right')
    axes.set_ylim(1e-8, 0.5)
    label(axes, 'time (s)', 'tilt β (rad)', loc='lower center', bbox_to_anchor=(0.5, 1.0), ncols=3)
    return figure
