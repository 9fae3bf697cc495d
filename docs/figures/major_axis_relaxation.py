# SPDX-License-Identifier: Apache-2.0
"""Energy on the way to the largest axis, and the path of L in the body."""

import numpy as np

from figures.style import GREY, LINES, label, panels, run
from rigid_body_sim.theory import euler_equations, largest_axis

MOMENTS = np.array([1.0, 2.0, 3.0])


def draw():
    """Return the figure."""
    figure, axes = panels(3, width_ratios=(1.2, 1.2, 1.0))
    times = np.linspace(0.0, 150.0, 6001)
    omega = run('major_axis_relaxation').states(times).angular_velocity
    m = MOMENTS * omega
    L = np.linalg.norm(m[0])
    early = times < 60.0
    axes[0].plot(times[early], euler_equations.kinetic_energy(MOMENTS, omega[early]), **LINES[0])
    for moment, name in zip(MOMENTS, '123', strict=True):
        axes[0].axhline(0.5 * L**2 / moment, color=GREY, linewidth=0.8, linestyle=':')
        axes[0].annotate(f'L²/(2I$_{name}$)', (60.0, 0.5 * L**2 / moment), xytext=(0, 3),
                         textcoords='offset points', ha='right', fontsize=8)
    label(axes[0], 'time (s)', 'T (J)', legend=False)
    axes[1].semilogy(times, largest_axis.excess_energy(MOMENTS, m), **LINES[0])
    label(axes[1], 'time (s)', 'T − L²/(2I$_3$) (J)', legend=False)
    axes[2].plot(m[:, 0] / L, m[:, 2] / L, linewidth=0.5, **LINES[0])
    axes[2].set_aspect('equal', adjustable='datalim')
    label(axes[2], 'L$_1$/L in the body', 'L$_3$/L', legend=False)
    return figure
