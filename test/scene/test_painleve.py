# SPDX-License-Identifier: Apache-2.0
"""The friction below which every slip has a solution, beside closed forms."""

import math

import numpy as np
import pytest
from near import near
from scipy.optimize import minimize_scalar

from rigid_body_sim.scene.painleve import inverse_of, may_meet_paradox, painleve_bound
from rigid_body_sim.scene.scene import parse_scene

TIP = 1e-6    # m, the radius of what is nearly a point


def body_of(mass, inertia, radius, center):
    """Return a body with a spherical surface about a point away from its centre of mass."""
    return with_surface(mass, inertia, f'sphere: {{radius: {radius}, center: {center}}}')


def with_surface(mass, inertia, surface):
    return parse_scene(
        f'scene: a\nbody: {{mass: {mass}, inertia: {inertia}, surface: {{{surface}}}}}\n'
        'constraint: free\neffects: []\ninitial: {}\n').body


def of_a_point(mass, distance, moment):
    """Return 2 sqrt(k)/(k - 1) with k = 1 + m d^2/I, the bound of the end of a rod."""
    k = 1.0 + mass * distance * distance / moment
    return 2.0 * math.sqrt(k) / (k - 1.0)


@pytest.mark.parametrize('seed', range(3))
def test_the_inverse_of_a_symmetric_matrix(seed):
    half = np.random.default_rng(seed).normal(size=(3, 3))
    matrix = half @ half.T
    inverse = np.array(inverse_of(tuple(map(tuple, matrix.tolist()))))
    assert inverse @ matrix == pytest.approx(np.eye(3), abs=1e-10)    # measured: 1e-14


@pytest.mark.parametrize(('mass', 'inertia', 'center', 'distance', 'moment'), [
    (2.0, [0.5, 0.5, 0.5], [0, 0.6, 0.8], 1.0, 0.5),
    # of two axes across the arm that with the smaller moment is worse; that along it does nothing
    (2.0, [0.7, 0.6, 0.3], [0, 0, -0.5], 0.5, 0.6),
    # a tensor that is not diagonal: moments of 0.3 and 0.7 along (1, 1, 0) and (1, -1, 0)
    (2.0, [[0.5, -0.2, 0], [-0.2, 0.5, 0], [0, 0, 0.8]], [0, 0, 0.7], 0.7, 0.3)])
def test_a_point_of_a_body_has_the_bound_of_the_end_of_a_rod(
        mass, inertia, center, distance, moment):
    found = painleve_bound(body_of(mass, inertia, TIP, center))
    assert found == near(of_a_point(mass, distance, moment), rel=1e-5)    # measured: 2e-6


def test_slips_have_one_solution_below_the_bound_and_where_nothing_slips():
    """The lower bound that spares the search is here the bound itself."""
    body, bound = body_of(2.0, [0.5, 0.5, 0.3], TIP, [0.9, 0, 0]), of_a_point(2.0, 0.9, 0.3)
    assert may_meet_paradox(body, 1.0001 * bound)
    assert not may_meet_paradox(body, 0.9999 * bound)
    assert not may_meet_paradox(body, math.inf)


@pytest.mark.parametrize('sizes', [[0.005, 0.005, 2.0], [0.005, 2.0, 0.005]])
def test_no_slip_of_a_rod_with_two_solutions_is_overlooked(sizes):
    """Its end is up to the half length and the way to its middle from its centre of mass."""
    center = (0.25 * np.array(sizes)).tolist()
    rod = with_surface(1.0, [1.3, 1.3, 1.3],
                       f'ellipsoid: {{semi_axes: {sizes}, center: {center}}}')
    assert may_meet_paradox(rod, 1.0001 * of_a_point(1.0, 2.5, 1.3))    # from 1.0000002 on


def test_a_ball_whose_centre_is_not_that_of_mass():
    """With d from there to the middle, at the angle a to the normal n: r = d - R n."""
    m, I, d, R = 2.0, 0.05, 0.6, 0.25

    def quotient(a):
        normal, along = d * math.cos(a), d * math.sin(a)
        return (1.0 / m + along * along / I) / abs(along * (R - normal) / I)
    least = min(minimize_scalar(quotient, bounds=bounds, method='bounded',
                                options={'xatol': 1e-10}).fun
                for bounds in ((0.01, math.acos(R / d) - 0.01),
                               (math.acos(R / d) + 0.01, math.pi - 0.01)))
    assert painleve_bound(body_of(m, [I, I, I], R, [0.36, 0, 0.48])) == near(least, rel=1e-12)


def test_a_ball_about_its_centre_of_mass_meets_no_paradox():
    assert painleve_bound(body_of(2.0, [0.5, 0.5, 0.5], 0.3, [0, 0, 0])) == math.inf
