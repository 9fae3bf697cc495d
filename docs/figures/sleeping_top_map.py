# SPDX-License-Identifier: Apache-2.0
"""The map of config/sweeps/sleeping_top.yaml beside the threshold P_gamma^2 = 4 I1 M g l."""

import numpy as np

from figures.style import label, panels
from rigid_body_sim import sweep
from rigid_body_sim.theory import sleeping_top as theory

SPEC = 'config/sweeps/sleeping_top.yaml'
I1, I3, MASS, G = 0.03, 0.01, 1.0, 9.81
FALLEN = 0.1  # rad: a hundred thousand times the seed


def draw():
    """Return the figure."""
    found = sweep(SPEC)
    height = found['body.center_of_mass.2'].values
    spin = found['initial.angular_velocity.2'].values
    tilt = np.degrees(np.arccos(found['minimum_cos_tilt'].values))
    threshold = theory.threshold(I1, MASS * G * height) / I3
    predicted = np.degrees(
        [[theory.nodding_tilt(I3 * w, I1, MASS * G * l) for w in spin] for l in height]
    )
    figure, axes = panels(2)
    shown = axes[0].pcolormesh(
        height, spin, tilt.T, shading='nearest', cmap='cividis', rasterized=True
    )
    figure.colorbar(shown, ax=axes[0], label='largest tilt in 20 s (degrees)')
    axes[0].plot(
        height,
        threshold,
        color='white',
        linestyle='--',
        linewidth=1.5,
        label='P$_γ$² = 4 I$_1$ M g l',
    )
    label(
        axes[0],
        'height of the centre of mass l (m)',
        'spin (rad/s)',
        labelcolor='white',
        loc='upper left',
    )
    middle = len(height) // 2
    axes[1].plot(spin, predicted[middle], color='#777777', linewidth=1.0, label='formula')
    axes[1].plot(
        spin,
        tilt[middle],
        color='#0072B2',
        marker='o',
        markersize=3,
        linestyle='',
        label='measured',
    )
    axes[1].axvline(
        threshold[middle], color='#D55E00', linestyle='--', linewidth=1.2, label='threshold'
    )
    label(axes[1], f'spin (rad/s), l = {height[middle]:.3g} m', 'largest tilt (degrees)')
    falls = np.radians(tilt) > FALLEN
    stable = spin[np.newaxis, :] >= threshold[:, np.newaxis]
    wrong = int((falls & stable).sum())
    late = int((~falls & ~stable).sum())
    print(
        f'{SPEC}: {tilt.size} runs; above the threshold {wrong} fall; below it {late} have not '
        f'fallen within 20 s (their seed of 1e-6 rad/s grows too slowly)'
    )
    far = falls & ~stable
    distance = np.abs(tilt - predicted)[far]
    print(
        f'  distance of the tilt from the formula where they fall: median '
        f'{np.nanmedian(distance):.2g} degrees, largest {np.nanmax(distance):.2g} '
        '(close to the threshold 20 s end before the first nod)'
    )
    return figure
