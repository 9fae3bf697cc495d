# SPDX-License-Identifier: Apache-2.0
"""Fall with drag in closed form, beside Kummer's function with 40 digits."""

import math

import mpmath
import numpy as np
import pytest
from near import near

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.integrators.equations.falling import SMALL, fallen, phi
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

EPS = 2.0 ** -53


def exactly(z):
    """Return e^(-z), phi1(z), phi2(z): Kummer's function, phi_k(z) = 1F1(1, k + 1, -z)/k!."""
    with mpmath.workdps(40):
        return (mpmath.exp(-mpmath.mpf(z)), mpmath.hyp1f1(1, 2, -mpmath.mpf(z)),
                mpmath.hyp1f1(1, 3, -mpmath.mpf(z)) / 2)


@pytest.mark.parametrize(
    'z', [0.0, 1e-300, 1e-16, 1e-8, 0.01, 0.5, SMALL, SMALL * (1.0 + 2.0 * EPS), 3.0, 40.0, 700.0])
def test_functions_of_the_decay_are_right_to_rounding(z):
    # measured over 4000 values from 1e-12 to 300: 1.9, 1.7, 2.9
    for found, true in zip(phi(z), exactly(z), strict=True):
        assert abs(found - true) <= 4.0 * EPS * true


def test_fall_beyond_what_is_left_of_its_speed_goes_on_at_the_final_one():
    # c t/M = 1e4: v = a M/c, x = v (t - M/c) + v0 M/c
    (x, y, z), velocity = fallen((1.0, 2.0, 3.0), (5.0, 0.0, 0.0), (0.0, 0.0, -9.81), 10.0, 1e3)
    assert velocity == (0.0, 0.0, near(-0.981, 4.0 * EPS))
    assert (x, y) == (1.5, 2.0)
    assert z == near(3.0 - 0.981 * (1e3 - 0.1), 4.0 * EPS)


def test_fall_without_drag_is_a_parabola():
    place, velocity = fallen((1.0, 2.0, 3.0), (5.0, -1.0, 2.0), (0.0, 0.0, -8.0), 0.0, 0.5)
    assert (place, velocity) == ((3.5, 1.5, 3.0), (5.0, -1.0, -2.0))


def test_a_fall_counts_from_its_own_start():
    """What acts is the same at all times: 1 s after a start at 2 s is as 1 s after one at 0."""
    scene = parse_scene('scene: s\nbody: {mass: 2, inertia: [1, 2, 2.5]}\nconstraint: free\n'
                        'effects: [gravity: {g: 9.81}, drag: {linear: 0.5, angular: 0.1}]\n'
                        'initial: {angular_velocity: [0.1, 0.2, 0.3], velocity: [3, 2, 1]}\n')
    choice = choose(scene, 'taylor', 1e-9)
    ends = np.empty((2, 14))
    for begin, out in zip((0.0, 2.0), ends, strict=True):
        start = scene.initial.vector.copy()
        start[0] = begin
        choice.solver(start, Wrench()).state(begin + 1.0, out)
    assert ends[1, 1:] == near(ends[0, 1:], rel=1e-9)
    # x = v (1 - exp(-c t/M)) M/c
    assert ends[0, 8] == near(3.0 * 4.0 * -math.expm1(-0.25), rel=1e-9)
