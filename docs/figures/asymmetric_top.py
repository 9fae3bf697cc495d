# SPDX-License-Identifier: Apache-2.0
"""Frequency of small oscillations against their size."""

import numpy as np

from figures.style import LINES, MEASURED, THEORY, WRONG, label, panels, run
from rigid_body_sim.study.scenes.asymmetric_top import _frequency
from rigid_body_sim.study.scenes.experiment import Experiment
from rigid_body_sim.theory import asymmetric_top as theory


def draw():
    """Return the figure."""
    figure, axes = panels(2)
    Omega = theory.frequency(5.0, 1.0, 2.0, 3.0)
    sizes = np.array([2e-4, *np.geomspace(1e-3, 0.3, 9)])    # the first one is the scene's
    found = np.array([_frequency(_run(size), Omega) for size in sizes])
    axes[0].axhline(Omega, label='ω$_0$√((I$_3$−I$_1$)(I$_3$−I$_2$)/(I$_1$I$_2$))', **THEORY)
    axes[0].axhline(np.sqrt(theory.frequency_squared_as_written(5.0, 1.0, 2.0, 3.0)),
                    label='I$_1$ in all three equations', **WRONG)
    axes[0].semilogx(sizes, found, label='measured', **MEASURED)
    axes[0].set_ylim(4.0, 8.5)
    label(axes[0], 'η$_1$/ω$_0$', 'Ω (rad/s)')
    axes[1].loglog(sizes, np.abs(found / Omega - 1.0), label='measured', **MEASURED)
    axes[1].loglog(sizes, abs(found[4] / Omega - 1.0) * (sizes / sizes[4]) ** 2, label='slope 2',
                   **LINES[3])
    label(axes[1], 'η$_1$/ω$_0$', '|Ω/formula − 1|')
    return figure


def _run(size):
    return Experiment(
        run('asymmetric_top', f'initial.angular_velocity=[{5.0 * size}, 0, 5]').scene, 'exact')
