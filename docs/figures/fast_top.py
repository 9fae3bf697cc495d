# SPDX-License-Identifier: Apache-2.0
"""Deviation from the formulas of the fast top as the spin grows."""

import numpy as np

from figures.style import BLACK, LINES, label, panels, run
from rigid_body_sim.study.scenes.experiment import Experiment
from rigid_body_sim.study.scenes.fast_top import _measure
from rigid_body_sim.study.scenes.heavy_top import Top

NAMES = 'ε = −I$_1$Mgl/P$_γ$²', 'precession Mgl/P$_γ$', 'nutation P$_γ$/I$_1$'


def draw():
    """Return the figure."""
    figure, (axes,) = panels(height=3.6)
    slowness, found = [], []
    for spin in (300.0, 600.0, 1200.0, 2400.0):
        scene = run('fast_top', f'initial.euler_zyz=[0, {np.arccos(12.0 / spin)}, 0]',
                    f'initial.angular_velocity=[0, 0, {spin}]').scene
        one = Experiment(scene, 'exact')
        top = Top(one)
        slowness.append(top.I1 * top.Mgl / top.P_gamma**2)
        found.append(_measure(one, top)[:3])
    deviations = np.abs(np.transpose(found) - 1.0)
    for name, deviation, line, marker in zip(NAMES, deviations, LINES, 'os^', strict=False):
        axes.loglog(slowness, deviation, marker=marker, markersize=5, label=name, **line)
    for order, reference in ((1.0, deviations[0]), (1.5, deviations[2])):
        axes.loglog(slowness, 1.6 * reference[1] * (np.array(slowness) / slowness[1]) ** order,
                    color=BLACK, linewidth=0.7, linestyle=':')
        axes.annotate(
            f'order {order:g}',
            (slowness[2], 1.6 * reference[1] * (slowness[2] / slowness[1]) ** order),
            xytext=(4, 8), textcoords='offset points', fontsize=8)
    label(axes, 'I$_1$ M g l / P$_γ$², at constant P$_α$', '|measured/formula − 1|')
    return figure
