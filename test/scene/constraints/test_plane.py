# SPDX-License-Identifier: Apache-2.0
"""Where a convex body starts on its plane: what counts as touching, and rolling from the start."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.scene.scene import parse_scene

NORMAL = np.array([0.6, 0.0, 0.8])
LEVEL = 'orientation: [0, 0, 0, 1]'
TURNED = 'euler_zyz: [0.3, 1.1, -0.4], angular_velocity: [1.0, 2.0, -0.5]'


def start(surface, initial, normal=NORMAL):
    """Return the scene of a body with a surface on a slope."""
    return parse_scene(
        f'scene: laid\nbody: {{mass: 1.0, inertia: [0.3, 0.4, 0.5], surface: {surface}}}\n'
        f'constraint: {{table: {{normal: {[float(x) for x in normal]}}}}}\n'
        f'effects: [gravity: {{g: 9.81}}]\n'
        f'initial: {{{initial}}}\n')


def gap(scene):
    """Return how far the lowest point is above the plane."""
    state, plane = scene.initial, scene.constraint
    arm = rotate(*state.orientation, *plane.touching(state.orientation, scene.body))
    return float(np.dot(plane.normal, np.add(state.position, arm)))


@pytest.mark.parametrize(('surface', 'below', 'size'), [
    ('{sphere: {radius: 2.0}}', 2.0, 2.0),
    ('{sphere: {radius: 2.0, center: [1.14, 0.0, 1.52]}}', 0.1, 2.0),
    # the size is the distance from the origin where that is larger
    ('{sphere: {radius: 0.01, center: [0.0, 0.0, -5.0]}}', 4.01, 4.01)])
@pytest.mark.parametrize('share', [-1.1, -0.9, 0.9, 1.1])
def test_a_body_within_a_billionth_of_its_size_lies_on_the_plane(surface, below, size, share):
    laid = start(surface, LEVEL)
    assert gap(laid) == pytest.approx(0.0, abs=1e-15)
    assert laid.initial.position == pytest.approx(below * NORMAL, rel=1e-14, abs=1e-15)
    off = share * 1e-9 * size
    initial = f'{LEVEL}, position: {((below + off) * NORMAL).tolist()}'
    if share < -1.0:
        with pytest.raises(BadInput, match=r'the lowest point is .* m below the plane'):
            start(surface, initial)
        return
    assert gap(start(surface, initial)) == pytest.approx(off if share > 1.0 else 0.0, abs=1e-14)
    if share > 1.0:
        with pytest.raises(BadInput, match='is above the plane'):
            start(surface, f'{initial}, rolling: true')


@pytest.mark.parametrize('surface', [
    '{sphere: {radius: 0.3, center: [0.1, 0.0, 0.05]}}',
    '{ellipsoid: {semi_axes: [0.3, 0.2, 0.4]}}', '{disk: {radius: 0.5}}'])
def test_what_rolls_from_the_start_has_a_point_of_contact_at_rest(surface):
    scene = start(surface, f'{TURNED}, rolling: true')
    state = scene.initial
    arm = scene.constraint.touching(state.orientation, scene.body)
    of_contact = np.add(state.velocity, rotate(
        *state.orientation, *np.cross(state.angular_velocity, arm)))
    assert of_contact == pytest.approx(np.zeros(3), abs=4e-16)
    assert np.linalg.norm(state.velocity) > 0.1
    with pytest.raises(BadInput, match='has a velocity'):
        start(surface, f'{TURNED}, velocity: [0, 0, 0], rolling: true')


@pytest.mark.parametrize('normal', [(0, 0, 2), (0.3, -0.4, 1.2), (3e-9, 0, 1), (1, 1, 1e-3)])
def test_the_axes_of_a_plane_have_z_along_its_normal_by_the_shortest_turn(normal):
    plane = start('{sphere: {radius: 1.0}}', LEVEL, normal).constraint
    unit = np.array(normal) / np.linalg.norm(normal)
    assert plane.normal == pytest.approx(unit, abs=2e-16)
    assert rotate(*plane.axes, 0.0, 0.0, 1.0) == pytest.approx(unit, abs=4e-16)
    assert plane.axes[2] == 0.0
    assert plane.axes[3] == near(np.sqrt(0.5 * (1.0 + unit[2])), rel=4e-16)
    across = np.cross(unit, [0.0, 0.0, 1.0])
    assert rotate_back(*plane.axes, *across) == pytest.approx(across, abs=4e-16)
