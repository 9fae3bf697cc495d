# SPDX-License-Identifier: Apache-2.0
"""The spin of a rolling disk beside its Legendre functions, and the end of Euler's disk."""

import numpy as np

from figures.style import BLACK, LINES, MEASURED, label, panels, run
from rigid_body_sim.study.scenes.convex_body import normals
from rigid_body_sim.theory import rolling_disk as theory

EFFECTS = 'effects=[gravity: {g: 9.81}, sliding_friction: {mu: .inf}'


def draw():
    """Return the figure."""
    figure, (left, right) = panels(2)
    disk = run('rolling_disk', method='dop8')
    states = disk.states(np.linspace(0.0, 6.0, 601))
    left.plot(np.degrees(np.arccos(normals(states)[:, 2])), states.angular_velocity[:, 2],
              label='6 s by dop8', **LINES[0])
    few = disk.states(np.linspace(0.0, 0.69, 12))
    n = normals(few)
    thetas = np.arccos(n[:, 2])
    s = (few.angular_velocity[0, :2] @ n[0, :2]) / np.hypot(*n[0, :2])
    c1, c2 = theory.legendre_constants(float(thetas[0]), float(s),
                                       float(few.angular_velocity[0, 2]), 0.0625, 0.125, 1.0, 0.5)
    left.plot(np.degrees(thetas), [_spin(theta, c1, c2) for theta in thetas],
              label='c$_1$P$_ν$(cos θ) + c$_2$P$_ν$(−cos θ)', **MEASURED)
    label(left, 'inclination θ of the axis (°)', 'spin ω$_3$ (rad/s)', loc='lower center',
          bbox_to_anchor=(0.5, 1.0))
    for (effect, text, exponent), line in zip((
            ('rolling_friction: {dry: 1.0e-4}', 'dry', 2.0 / 3.0),
            ('rolling_friction: {viscous: 1.0e-5}', 'viscous', 0.5),
            ('air_film: {viscosity: 1.8e-5}', 'film of air', 1.0 / 3.0)), LINES, strict=False):
        fall = run('euler_disk', f'{EFFECTS}, {effect}]', method='dop8')
        rest = fall.at_event('rest', 30.0).time
        before = rest * np.logspace(0.0, -4.0, 60)
        tilt = np.hypot(*normals(fall.states(rest - before)).T[:2])
        right.loglog(before, tilt, label=f'{text}: {exponent:.3g}', **line)
        right.loglog(before[:30], tilt[5] * (before[:30] / before[5]) ** exponent, color=BLACK,
                     linewidth=0.6, linestyle=':')
    label(right, 'time before the end (s)', 'inclination a (rad)', loc='lower center',
          bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure


def _spin(theta, c1, c2):
    """Return c1 P_nu(cos theta) + c2 P_nu(-cos theta) of a disk, nu (nu + 1) = -4/3."""
    import mpmath
    nu = (mpmath.sqrt(1.0 - 16.0 / 3.0) - 1.0) / 2.0

    def legendre(x):
        return mpmath.re(mpmath.hyp2f1(-nu, nu + 1, 1, (1 - x) / 2))

    x = float(np.cos(theta))
    return float(c1 * legendre(x) + c2 * legendre(-x))
