# SPDX-License-Identifier: Apache-2.0
"""The point of contact: how a force there moves it, and the couples of rolling friction."""

import math

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics.contact.numbers import contact_parameters, weight
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.mechanics.contact.touch import couples, lever, response
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.surfaces import shifted

SURFACES = {
    'ellipsoid': 'ellipsoid: {semi_axes: [0.2, 0.15, 0.1], center: [0.02, -0.01, 0.03]}',
    'sphere': 'sphere: {radius: 0.2, center: [0.02, -0.01, 0.03]}',
    'torus': 'torus: {radius: 0.2, tube: 0.05}', 'disk': 'disk: {radius: 0.2}'}


def scene_of(surface, effects='', table='table'):
    return parse_scene(
        'scene: s\nbody: {mass: 2.0, inertia: [[0.03, 0.001, 0], [0.001, 0.04, 0.002], '
        f'[0, 0.002, 0.05]], surface: {{{SURFACES[surface]}}}}}\nconstraint: {table}\n'
        f'effects: [gravity: {{g: 9.81}}{effects}]\ninitial: {{position: [0, 0, 1]}}\n')


def parameters(surface, effects='', table='table'):
    return CONTACT.load(contact_parameters(scene_of(surface, effects, table)).tolist())


def axes(seed):
    rows = Rotation.random(random_state=seed).as_matrix()
    return tuple(map(tuple, rows.tolist()))


@pytest.mark.parametrize('surface', SURFACES)
@pytest.mark.parametrize('seed', range(3))
def test_the_lever_is_the_lowest_point_of_the_surface(surface, seed):
    """No point of it lies lower, and the lever to it from the centre of mass is as told."""
    c, down = parameters(surface), -np.array(axes(seed)[2])
    r = np.array(lever(c, tuple(-down)))
    point = r - c.middle
    draw = np.random.default_rng(seed).normal(size=(4000, 3))
    n = draw / np.linalg.norm(draw, axis=1)[:, np.newaxis]
    if surface == 'ellipsoid':
        points = n * [0.2, 0.15, 0.1]
        assert np.sum((point / [0.2, 0.15, 0.1]) ** 2) == pytest.approx(1.0)
    elif surface == 'sphere':
        points = n * 0.2
        assert np.linalg.norm(point) == pytest.approx(0.2)
    else:
        ring = np.stack([n[:, 0], n[:, 1], 0.0 * n[:, 0]], axis=1)
        ring *= 0.2 / np.linalg.norm(ring, axis=1)[:, np.newaxis]
        points = ring + (0.05 * n if surface == 'torus' else 0.0)
        assert c.size[0] == 0.2
    assert point @ down >= (points @ down).max() - 1e-12
    assert point @ down < (points @ down).max() + 2e-3


@pytest.mark.parametrize('seed', range(4))
def test_the_response_is_how_a_force_accelerates_the_point(seed):
    """G f = f/m + (I^-1 (r x f)) x r, along the axes of the plane; with N goes a couple."""
    c, rows = parameters('ellipsoid'), axes(seed)
    r, wrung = lever(c, rows[2]), (0.01, -0.02, 0.03)
    G = np.array(response(c.mass, c.inverse, rows, r, wrung))
    E, inverse = np.array(rows), np.linalg.inv(np.array(c.inertia))
    for k in range(3):
        torque = np.cross(r, E[k]) + (np.array(wrung) if k == 2 else 0.0)
        moved = E[k] / c.mass + np.cross(inverse @ torque, r)
        assert G[:, k] == pytest.approx(E @ moved, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize(('effects', 'force'), [
    ('', lambda N, s, gamma: 0.0),
    (', rolling_friction: {dry: 0.02}', lambda N, s, gamma: 0.02 * N),
    (', rolling_friction: {viscous: 0.3}', lambda N, s, gamma: 0.3 * s),
    (', rolling_friction: {dry: 0.02, viscous: 0.3}',
     lambda N, s, gamma: 0.02 * N + 0.3 * s),
    (', air_film: {viscosity: 1.8e-2}',
     lambda N, s, gamma: math.pi / 4.0 * 1.8e-2 * 0.2 * s / math.hypot(gamma[0], gamma[1]))])
@pytest.mark.parametrize('surface', ['ellipsoid', 'torus', 'disk'])
def test_rolling_friction_takes_the_power_of_a_force_against_the_moving_contact(
        surface, effects, force):
    """A force C N + c s acts against s': the couple has its power and wrings no spin."""
    if 'air_film' in effects and surface != 'disk':
        return
    c, gamma = parameters(surface, effects), axes(3)[2]
    omega = (0.7, -1.3, 0.4)
    moved = shifted(c.kind, c.size, gamma, tuple(np.cross(gamma, omega).tolist()))
    viscous, wrung, speed, film = couples(c, gamma, moved)
    assert speed == pytest.approx(np.linalg.norm(moved))
    N = 7.0
    couple = np.array(viscous) + N * np.array(wrung)
    assert couple @ omega == near(-force(N, speed, gamma) * speed, rel=1e-12)
    assert couple @ gamma == pytest.approx(0.0, abs=1e-13)
    assert bool(film) == ('air_film' in effects)


def test_a_contact_that_does_not_move_wrings_nothing():
    c = parameters('ellipsoid', ', rolling_friction: {dry: 0.02, viscous: 0.3}')
    assert couples(c, (0.0, 0.6, 0.8), (0.0, 0.0, 0.0)) == ((0.0,) * 3, (0.0,) * 3, 0.0, 0.0)


def test_the_numbers_of_a_scene_are_its_own_and_frictions_add():
    c = parameters('ellipsoid', ', sliding_friction: {mu: 0.3}, rolling_friction: '
                   '{dry: 0.01}', '{table: {normal: [0, 0.6, 0.8], restitution: 0.4}}')
    assert (c.mass, c.mu, c.rolling, c.restitution, c.inclined) == (2.0, 0.3, 0.01, 0.4, 1.0)
    assert c.middle == pytest.approx((0.02, -0.01, 0.03))
    assert np.array(c.inertia) @ np.array(c.inverse) == pytest.approx(np.eye(3), abs=1e-14)
    assert Rotation.from_quat(c.plane).apply([0, 0, 1]) == pytest.approx([0.0, 0.6, 0.8])
    level = parameters('sphere')
    assert (level.inclined, level.mu, level.until) == (0.0, 0.0, math.inf)
    assert weight(scene_of('sphere')) == 9.81
