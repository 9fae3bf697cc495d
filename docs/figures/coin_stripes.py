# SPDX-License-Identifier: Apache-2.0
"""The map of config/sweeps/coin.yaml beside Keller's stripes, cos(2 omega u/g) = 0."""

import numpy as np
from matplotlib import colormaps
from matplotlib.patches import Patch

from figures.style import label, panels
from rigid_body_sim import sweep

SPEC = 'config/sweeps/coin.yaml'
G = 9.81
SHOWN = 40.0  # rad/s


def draw():
    """Return the figure."""
    found = sweep(SPEC)
    speed = found['initial.velocity.2'].values
    spin = found['initial.angular_velocity.0'].values
    side = found['side'].values
    predicted = np.cos(2.0 * np.outer(speed, spin) / G)
    figure, axes = panels(2)
    axes[0].pcolormesh(
        speed, spin, np.sign(side).T, shading='nearest', cmap='cividis', rasterized=True
    )
    for k in range(8):
        axes[0].plot(speed, (k + 0.5) * np.pi * G / (2.0 * speed), color='#D55E00', linewidth=0.8)
    axes[0].set_ylim(spin[0], spin[-1])
    sides = [Patch(color=colormaps['cividis'](share), label=name)
             for share, name in ((1.0, 'heads (light)'), (0.0, 'tails (dark)'))]
    label(axes[0], 'speed of the toss u (m/s)', 'spin ω (rad/s)', handles=sides, ncols=2,
          loc='lower center', bbox_to_anchor=(0.5, 1.0), handlelength=1.0)
    row = int(np.argmin(np.abs(spin - SHOWN)))
    axes[1].plot(speed, predicted[:, row], color='#777777', linewidth=1.0, label='cos(2 ω u/g)')
    axes[1].plot(
        speed,
        side[:, row],
        color='#0072B2',
        marker='o',
        markersize=2.5,
        linestyle='',
        label='runs',
    )
    label(
        axes[1],
        f'speed of the toss u (m/s), ω = {spin[row]:.3g} rad/s',
        'cosine of the tilt when caught',
        ncols=2,
        loc='lower center',
        bbox_to_anchor=(0.5, 1.0),
    )
    clear = np.abs(predicted) > 1e-12
    other = int((np.sign(side) != np.sign(predicted))[clear].sum())
    print(
        f'{SPEC}: {side.size} runs; heads in {np.mean(side > 0.0):.4f} of them; the side differs '
        f'from the formula in {other}; largest difference of the cosine '
        f'{np.abs(side - predicted).max():.1e}'
    )
    return figure
