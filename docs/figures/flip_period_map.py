# SPDX-License-Identifier: Apache-2.0
"""The map of config/sweeps/racket_periods.yaml beside the elliptic formula."""

import numpy as np

from figures.style import label, panels
from rigid_body_sim import sweep
from rigid_body_sim.theory.asymmetric_top import time_between_flips

SPEC = 'config/sweeps/racket_periods.yaml'


def draw():
    """Return the figure."""
    found = sweep(SPEC)
    middle = found['body.inertia.1'].values
    seed = found['initial.angular_velocity.0'].values
    measured = (found['all_flip'][..., 1] - found['all_flip'][..., 0]).values
    predicted = np.array(
        [
            [time_between_flips((2.0, I2, 3.0), (w1, 5.0, 0.01)) or np.nan for w1 in seed]
            for I2 in middle
        ]
    )
    figure, axes = panels(2)
    shown = axes[0].pcolormesh(middle, seed, measured.T, shading='nearest', rasterized=True)
    figure.colorbar(shown, ax=axes[0], label='time between flips (s)')
    axes[0].set_yscale('log')
    label(
        axes[0],
        'middle moment I$_2$ (kg m²); I$_1$ = 2, I$_3$ = 3',
        'ω$_1$ at the start (rad/s)',
        legend=False,
    )
    error = np.abs(measured / predicted - 1.0)
    # L^2 - 2 E I2 decides the period; where it is round-off of its terms no digit is left
    terms = 3.0 * (3.0 - middle) * 0.01**2, 2.0 * np.outer(seed**2, middle - 2.0)
    known = (np.abs(terms[0] - terms[1]) > 1e-12 * terms[0]).T
    shown = axes[1].pcolormesh(
        middle,
        seed,
        np.log10(np.maximum(error, 1e-17)).T,
        shading='nearest',
        cmap='cividis',
        rasterized=True,
    )
    figure.colorbar(shown, ax=axes[1], label='log$_{10}$ of the relative distance\nfrom 2 K(k)/λ')
    axes[1].set_yscale('log')
    label(axes[1], 'middle moment I$_2$ (kg m²)', 'ω$_1$ at the start (rad/s)', legend=False)
    print(
        f'{SPEC}: {measured.size} runs, {np.isfinite(error).sum()} with two flips, relative '
        f'distance from the formula at most {np.nanmax(error[known]):.1e}, '
        f'median {np.nanmedian(error):.1e}; {(~known).sum()} on the separatrix to round-off'
    )
    return figure
