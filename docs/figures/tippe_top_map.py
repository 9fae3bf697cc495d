# SPDX-License-Identifier: Apache-2.0
"""The map of config/sweeps/tippe_top.yaml beside the three groups.

Friction can bring a top no further than to the inclination of least energy among the motions with
its Jellett integral (rigid_body_sim/theory/rising.py). The heavy end is left if A/C > 1 - e and
the spin is fast enough, the stem can be reached if A/C < 1 + e.
"""

import math

import numpy as np

from figures.style import BLUE, GREY, ORANGE, label, panels
from rigid_body_sim import sweep
from rigid_body_sim.theory import rising

SPEC = 'config/sweeps/tippe_top.yaml'
A, M, R, G, SPIN, START = 8e-7, 0.006, 0.015, 9.81, 180.0, 0.1
SECTIONS = (0.2, 0.4)


def draw():
    """Return the figure."""
    found = sweep(SPEC)
    C = found['body.inertia.2'].values
    a = -found['body.center_of_mass.2'].values
    share, e = A / C, a / R
    reached = np.degrees(np.arccos(found['minimum_cos_tilt'].values))
    least = np.array([[of_least_energy(moment, arm) for arm in a] for moment in C])
    figure, axes = panels(2, height=3.4)
    shown = axes[0].pcolormesh(share, e, reached.T, shading='nearest', cmap='cividis',
                               vmin=0.0, vmax=180.0, rasterized=True)
    figure.colorbar(shown, ax=axes[0], label='largest inclination in 12 s (°)')
    line = np.array([e[0], e[-1]])
    for bound in (1.0 - line, 1.0 + line):
        axes[0].plot(bound, line, color='white', linestyle='--', linewidth=1.5)
    for x, y, name in ((0.68, 0.1, 'I'), (1.02, 0.36, 'II'), (1.4, 0.1, 'III')):
        axes[0].text(x, y, name, color='black' if name == 'II' else 'white', weight='bold',
                     ha='center')
    axes[0].set_xlim(share[-1], share[0])
    axes[0].grid(False)
    label(axes[0], 'A/C', 'e', legend=False)
    for one, color, marker in zip(SECTIONS, (BLUE, ORANGE), 'os', strict=True):
        k = int(np.abs(e - one).argmin())
        axes[1].plot(share, reached[:, k], color=color, marker=marker, markersize=3,
                     linewidth=0.0, label=f'e = {e[k]:.2f}')
        axes[1].plot(share, least[:, k], color=color, linewidth=1.0,
                     label='least energy' if one == SECTIONS[0] else None)
    axes[1].axhline(180.0, color=GREY, linewidth=0.8)
    label(axes[1], 'A/C', 'largest inclination (°)')
    told(share, e, reached)
    return figure


def of_least_energy(C, a):
    """Return the inclination of least energy (degrees) of a top as it starts."""
    up = math.sin(START), 0.0, math.cos(START)
    omega = tuple(SPIN * one for one in up)
    jellett = rising.jellett(omega, up, A, C, R, a)
    return math.degrees(rising.inclination_of_least_energy(jellett, A, C, M, G, R, a))


def told(share, e, reached):
    """Print how the runs of each group end."""
    share, e = np.meshgrid(share, e, indexing='ij')
    stays = reached < np.degrees(START) + 0.1
    for name, part in (('I', share < 1.0 - e), ('III', share > 1.0 + e),
                       ('II', np.abs(share - 1.0) <= e)):
        print(f'  group {name}: {int(part.sum())} runs, of which {int(stays[part].sum())} stay '
              f'and {int((reached[part] > 170.0).sum())} come beyond 170 degrees; '
              f'{reached[part].min():.1f} to {reached[part].max():.1f} degrees')
