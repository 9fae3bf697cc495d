# SPDX-License-Identifier: Apache-2.0
"""The tilt of an upright disk and hoop after a small push, on both sides of their thresholds."""

from fractions import Fraction

import numpy as np

from figures.style import BLUE, GREY, ORANGE, label, panels, run
from rigid_body_sim.study.scenes.convex_body import normals
from rigid_body_sim.theory import rolling_disk as theory

PUSH = 1e-6      # rad/s
SECONDS = 40.0
BODIES = (('disk', BLUE, 'o'), ('hoop', ORANGE, 's'))


def draw():
    """Return the figure."""
    figure, (left, right) = panels(2, sharey=True)
    for shape, color, marker in BODIES:
        A, C, m, R, g = _numbers(shape)
        rate = theory.rate_of_upright_stability(A, m, R, g)
        speed = theory.speed_of_upright_stability(A, C, m, R, g)
        squares = np.linspace(0.5, 1.0, 41)
        _panel(left, squares, [_tilt(shape, [-np.sqrt(x * g / R), PUSH, 0.0]) for x in squares],
               rate * rate * R / g, shape, color, marker)
        squares = np.linspace(0.15, 0.45, 41)
        _panel(right, squares, [_tilt(shape, [0.0, PUSH, np.sqrt(x * g / R)]) for x in squares],
               speed * speed / (g * R), shape, color, marker)
    left.set_ylim(1e-7, 10.0)
    label(left, 'spinning: $W^2 R/g$', f'largest tilt in {SECONDS:g} s (rad)', legend=False)
    label(right, 'rolling: $v^2/(g R)$', '', legend=False)
    return figure


def _numbers(shape):
    """Return A, C, m, R, g."""
    scene = run('rolling_disk', _body(shape), method='dop8').scene
    A, _, C = scene.body.about_center.moments
    return A, C, scene.body.mass, scene.body.surface.size[0], scene.effect('gravity').g


def _body(shape):
    return f'body.shape={{{shape}: {{radius: 0.5}}}}'


def _tilt(shape, omega):
    """Return the largest tilt (rad) of a body that starts upright."""
    upright = run('rolling_disk', _body(shape), f'initial.euler_zyz=[0.0, {0.5 * np.pi!r}, 0.0]',
                  f'initial.angular_velocity={[float(w) for w in omega]}', method='dop8')
    n = normals(upright.states(np.linspace(0.0, SECONDS, 401)))
    return np.arcsin(np.abs(n[:, 2]).max())


def _panel(axes, squares, tilts, threshold, shape, color, marker):
    """Draw the tilts of a body, and the threshold of theory with its name."""
    axes.semilogy(squares, tilts, color=color, marker=marker, markersize=3.5, linewidth=0.8)
    axes.axvline(threshold, color=GREY, linestyle=':', linewidth=1.2)
    axes.text(threshold, 1.0, f' {shape}: {Fraction(threshold).limit_denominator(9)}', color=color,
              fontsize=9, va='bottom')
