# SPDX-License-Identifier: Apache-2.0
"""Both steady precessions against the tilt, and the nutation about the slow one."""

import numpy as np

from figures.style import BLACK, LINES, MEASURED, THEORY, label, panels, run
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.theory import heavy_top as theory

I1, I3, MGL, SPIN = 0.03, 0.01, 0.981, 60.0


def draw():
    """Return the figure."""
    figure, axes = panels(2)
    tilts = np.linspace(0.1, 3.0, 300)
    tilts = tilts[np.abs(np.cos(tilts)) > 0.03]
    slow, fast = np.transpose([
        theory.steady_precession_rates(tilt, SPIN, I1, I3, MGL) for tilt in tilts])
    fast[np.abs(fast) > 90.0] = np.nan
    axes[0].plot(tilts, slow, label='slow', **LINES[0])
    axes[0].plot(tilts, fast, label='fast', **LINES[1])
    for tilt in (0.3, 0.5, 0.9, 2.3, 2.7):
        for rate, line in zip(
                theory.steady_precession_rates(tilt, SPIN, I1, I3, MGL), LINES, strict=False):
            axes[0].plot(tilt, _measured(tilt, rate), 'o', color=line['color'], markersize=4)
    slow_rate = theory.steady_precession_rates(0.5, SPIN, I1, I3, MGL)[0]
    axes[0].plot(0.5, slow_rate, 's', color=BLACK, markerfacecolor='none', markersize=8,
                 label='the top of the table')
    label(axes[0], 'tilt β$_0$ (rad)', 'precession α′ (rad/s)')
    tilts = np.linspace(0.15, 3.0, 100)
    axes[1].plot(tilts, [_nutation(tilt) for tilt in tilts], label='√(V$_{eff}$″/I$_1$)', **THEORY)
    some = np.array([0.3, 0.8, 1.3, 0.5 * np.pi, 1.9, 2.4, 2.8])
    axes[1].plot(some, [_measured_nutation(tilt) for tilt in some], label='measured, push of 1 %',
                 **MEASURED)
    label(axes[1], 'tilt β$_0$ (rad)', 'nutation Ω (rad/s)')
    return figure


def _run(tilt, rate, push=0.0):
    return run(
        'heavy_top', f'initial.euler_zyz=[0, {tilt}, 0]',
        f'initial.angular_velocity={[float(-rate * np.sin(tilt)), float(push), SPIN]}')


def _measured(tilt, rate):
    times = np.linspace(0.0, 3.0, 2001)
    turned = np.unwrap(instruments.alpha(_run(tilt, rate).states(times)))
    return (turned[-1] - turned[0]) / 3.0


def _nutation(tilt):
    rate = theory.steady_precession_rates(tilt, SPIN, I1, I3, MGL)[0]
    P_gamma = I3 * SPIN
    return theory.nutation_frequency(
        tilt, theory.p_alpha(rate, tilt, P_gamma, I1), P_gamma, I1, MGL)


def _measured_nutation(tilt):
    rate = theory.steady_precession_rates(tilt, SPIN, I1, I3, MGL)[0]
    times = np.linspace(0.0, 4.0, 4001)
    beta_rate = instruments.beta_rate(_run(tilt, rate, 0.01 * 20.0 * tilt).states(times))
    rises = times[1:][(beta_rate[:-1] < 0.0) & (beta_rate[1:] >= 0.0)]
    return 2.0 * np.pi * (len(rises) - 1) / (rises[-1] - rises[0])
