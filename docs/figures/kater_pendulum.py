# SPDX-License-Identifier: Apache-2.0
"""Periods against the suspension distance, and the bias of g against the amplitude."""

import numpy as np

from figures.style import BLACK, GREY, MEASURED, THEORY, WRONG, label, panels, run
from rigid_body_sim.study.scenes.experiment import Experiment
from rigid_body_sim.study.scenes.kater_pendulum import Pendulum
from rigid_body_sim.theory import kater_pendulum as theory

A = np.sqrt(0.24)


def draw():
    """Return the figure."""
    figure, axes = panels(2)
    lengths = np.linspace(0.12, 1.0, 200)
    axes[0].plot(lengths, theory.period(theory.frequency_from_q(9.81, lengths, A), 0.1),
                 label='2π √(l′/g), l′ = l + a²/l', **THEORY)
    axes[0].plot(lengths, 2.0 * np.pi * np.sqrt((lengths**2 + A**2) / 9.81),
                 label='√g/ã with ã² = l² + a²', **WRONG)
    some = np.linspace(0.15, 0.95, 9)
    axes[0].plot(some, [_period('constraint.hinge.distance', length) for length in some],
                 label='measured', **MEASURED)
    axes[0].plot([0.4, 0.6], [_period('constraint.hinge.distance', 0.4)] * 2, 's', color=BLACK,
                 markerfacecolor='none', label='Q and P, l′ = 1 m')
    axes[0].set_ylim(1.0, 3.4)
    label(axes[0], 'distance l from the centre of mass (m)', 'period (s)', loc='upper right')
    amplitudes = np.linspace(0.02, 1.5, 100)
    axes[1].plot(amplitudes, theory.gravity_bias(amplitudes) - 1.0,
                 label='(2 K(k)/π)$^{-2}$ − 1', **THEORY)
    some = np.array([0.1, 0.3, 0.6, 0.9, 1.2, 1.5])
    axes[1].plot(some, [(2.0 * np.pi / _period('initial.angle', one)) ** 2 / 9.81 - 1.0
                        for one in some], label='measured', **MEASURED)
    axes[1].axhline(0.0, color=GREY, linewidth=0.5)
    label(axes[1], 'amplitude (rad)', 'error of g = l′ Ω²')
    return figure


def _period(key, value):
    scene = run('kater_pendulum', f'{key}={value}').scene
    pendulum = Pendulum(scene)
    return pendulum.period(Experiment(scene, 'exact'), 3.0 if key != 'initial.angle' else 2.4)
