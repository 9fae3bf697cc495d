# SPDX-License-Identifier: Apache-2.0
"""Surfaces: how the lowest point moves as the body turns, and which dimensions are taken."""

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.surfaces import (
    ELLIPSOID,
    SPHERE,
    TORUS,
    lowest,
    shifted,
    surface_of,
    surface_of_shape,
)

KINDS = [(SPHERE, (0.3, 0.0, 0.0)), (ELLIPSOID, (0.3, 0.2, 0.1)), (TORUS, (0.3, 0.1, 0.0)),
         (TORUS, (0.3, 0.0, 0.0))]


@pytest.mark.parametrize(('kind', 'size'), KINDS)
@pytest.mark.parametrize('seed', range(4))
def test_the_lowest_point_moves_by_the_derivative(kind, size, seed):
    """S x for two x across gamma, by differences on the unit sphere; S is symmetric."""
    draw, h = np.random.default_rng(seed), 1e-6
    gamma = draw.normal(size=3)
    gamma /= np.linalg.norm(gamma)
    two = [np.cross(gamma, draw.normal(size=3)) for _ in range(2)]

    def at(x):
        g = gamma + x
        return np.array(lowest(kind, size, tuple((g / np.linalg.norm(g)).tolist())))
    moved = [np.array(shifted(kind, size, tuple(gamma.tolist()), tuple(x.tolist())))
             for x in two]
    for x, found in zip(two, moved, strict=True):
        assert found == pytest.approx((at(h * x) - at(-h * x)) / (2.0 * h), rel=1e-7, abs=1e-9)
        assert found @ gamma == pytest.approx(0.0, abs=1e-14)
    assert moved[0] @ two[1] == pytest.approx(moved[1] @ two[0], abs=1e-14)


def test_a_point_of_a_surface_is_told_from_the_origin_of_the_body():
    ball = surface_of({'sphere': {'radius': 2, 'center': [1, 2, 3]}}, 'here')
    assert ball.lowest((0.0, 0.6, 0.8)) == pytest.approx((1.0, 0.8, 1.4))
    ring = surface_of_shape('torus', {'radius': 1.0, 'tube': 0.5}, (0.0, 0.0, 1.0), 'here')
    assert ring.lowest((0.6, 0.0, 0.8)) == pytest.approx((-1.3, 0.0, 0.6))
    assert surface_of_shape('box', {'size': [1, 1, 1]}, (0.0, 0.0, 0.0), 'here') is None


@pytest.mark.parametrize(('sizes', 'center', 'taken'), [
    ([1e6, 1.0, 1.0], [0, 0, 0], True), ([1.1e6, 1.2, 1.2], [0, 0, 0], False),
    ([1.0, 1.0, 1.0], [0, -1e6, 0], True), ([1.0, 1.0, 1.0], [0, -1.1e6, 0], False),
    ([1.0, 1e-6, 1.0], [0, 0, 0], True), ([1.0, 0.9e-6, 1.0], [0, 0, 0], False),
    ([1e-9, 1e-9, 1e-9], [0, 0, 0], True), ([0.9e-9, 0.9e-9, 0.9e-9], [0, 0, 0], False),
    ([1.0e-8, 0.9e-9, 1.0e-8], [0, 0, 0], False)])
def test_dimensions_are_taken_up_to_their_bounds(sizes, center, taken):
    mapping = {'ellipsoid': {'semi_axes': sizes, 'center': center}}
    if taken:
        assert surface_of(mapping, 'here').size == tuple(sizes)
    else:
        with pytest.raises(BadInput, match=r'here\.ellipsoid: got lengths'):
            surface_of(mapping, 'here')


def test_a_surface_has_its_middle_in_the_origin_of_the_body_unless_it_is_given():
    assert surface_of({'sphere': {'radius': 2}}, 'here').center == (0.0, 0.0, 0.0)


def test_a_body_has_one_surface():
    for surface in '{}', '{sphere: {radius: 1}, disk: {radius: 1}}':
        with pytest.raises(BadInput, match=r'body\.surface'):
            parse_scene('scene: s\nbody: {mass: 1, inertia: [1, 1, 1], '
                        f'surface: {surface}}}\nconstraint: free\neffects: []\ninitial: {{}}\n')
