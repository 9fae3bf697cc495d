# SPDX-License-Identifier: Apache-2.0
"""The map of config/sweeps/coin.yaml beside Keller's stripes, cos(2 omega u/g) = 0."""

import numpy as np

from figures.style import label, panels
from rigid_body_sim import sweep

SPEC = 'config/sweeps/coin.yaml'
G = 9.81


def draw():
    """Return the figure."""
    found = sweep(SPEC)
    speed = found['initial.velocity.2'].values
    spin = found['initial.angular_velocity.0'].values
    side = found['side'].values
    predicted = np.cos(2.0 * np.outer(speed, spin) / G)
    figure, axes = panels(2)
    axes[0].pcolormesh(speed, spin, np.sign(side).T, shading='nearest', cmap='cividis', rasterized=True)
    for k in range(8):
        axes[0].plot(speed, (k + 0.5) * np.pi * G / (2.0 * speed), color='#D55E00', linewidth=0.8)
    axes[0].set_ylim(spin[0], spin[-1])
    label(axes[0], 'speed of the toss u (m/s)', 'spin ω (rad/s)', legend=False)
    axes[1].pcolormesh(speed, spin, np.log10(np.maximum(np.abs(side - predicted), 1e-17)).T, shading='nearest', cmap='viridis', rasterized=True)
    figure.colorbar(axes[1].collections[0], ax=axes[1], label='log$_{10}$ of |cos tilt − cos(2 ω u/g)|')
    label(axes[1], 'speed of the toss u (m/s)', 'spin ω (rad/s)', legend=False)
    clear = np.abs(predicted) > 1e-12
    print(f'{SPEC}: {side.size} runs; heads in {np.mean(side > 0.0):.4f} of them; the side differs from the formula in '
          f'{int((np.sign(side) != np.sign(predicted))[clear].sum())}; largest difference of the cosine {np.abs(side - predicted).max():.1e}')
    return figure
