# SPDX-License-Identifier: Apache-2.0
"""A fit of inertia (examples/fit_inertia.py): its errors over the noise of the recording."""

import pathlib
import runpy

import numpy as np

from figures.style import LINES, label, panels
from rigid_body_sim import parse_scene

EXAMPLE = pathlib.Path(__file__).resolve().parents[2] / 'examples' / 'fit_inertia.py'
NOISES = np.logspace(-14, -2, 13)


def draw():
    """Return the figure."""
    example = runpy.run_path(str(EXAMPLE))
    scene, times, true = (
        parse_scene(example['SCENE']),
        np.linspace(0.0, 20.0, 400),
        example['TRUE'],
    )
    found = [
        example['fit'](scene, times, example['record'](scene, times, noise)) for noise in NOISES
    ]
    errors = np.abs([one.x - true for one in found])
    jacobian = found[0].jac
    deviation = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    figure, axes = panels(1)
    for k, line in enumerate(LINES[:2]):
        axes[0].loglog(
            NOISES,
            np.maximum(errors[:, k], 1e-17),
            marker='o',
            markersize=4,
            linestyle='',
            color=line['color'],
            label=f'error of {example["NAMES"][k]}',
        )
        axes[0].loglog(
            NOISES, NOISES * deviation[k], label='standard deviation by the covariance', **line
        )
    label(axes[0], 'noise of the recorded attitude (rad)', 'error of the ratio of moments')
    ratios = errors / (NOISES[:, np.newaxis] * deviation)
    print(
        f'fits of five numbers at {len(NOISES)} noises: error over standard deviation: '
        f'rms {np.sqrt(np.mean(ratios[2:] ** 2)):.2f}, '
        f'largest {ratios[2:].max():.2f}; condition of the Jacobian {np.linalg.cond(jacobian):.3g}'
    )
    return figure
