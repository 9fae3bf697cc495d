# SPDX-License-Identifier: Apache-2.0
"""The point of contact: how a force there moves it, and the couples of rolling friction."""

import math
from fractions import Fraction

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.contact.numbers import contact_parameters, weight
from rigid_body_sim.mechanics.contact.parameters import CONTACT, HELD
from rigid_body_sim.mechanics.contact.touch import (
    above_flat,
    couples,
    gap_of,
    grips,
    inclination,
    is_disk,
    lever,
    response,
    spinning,
    swept,
    tangent,
    tilting,
)
from rigid_body_sim.numerics.vectors import plus
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


@pytest.mark.parametrize('seed', range(3))
@pytest.mark.parametrize('surface', SURFACES)
def test_a_normal_force_tilts_a_body_by_its_lever(surface, seed):
    """That of a ball about its middle is none, not the rounding of products."""
    c, gamma = parameters(surface), axes(seed)[2]
    assert tilting(c, gamma) == pytest.approx(np.cross(lever(c, gamma), gamma), abs=1e-16)
    about_middle = tilting(c._replace(middle=(0.0, 0.0, 0.0)), gamma)
    assert (about_middle == (0.0, 0.0, 0.0)) == (surface == 'sphere')


def test_the_lever_of_a_normal_force_is_as_exact_as_the_axes_differ():
    """An ellipsoid that is nearly a ball, by 1e-12: of products half of the digits were left."""
    c, gamma = parameters('ellipsoid'), (0.6, 0.64, 0.48)
    c = c._replace(size=(0.2 + 2.0 ** -40, 0.2, 0.2), middle=(0.0, 0.0, 0.0))
    a, b, _ = map(Fraction, c.size)
    x, y, z = map(Fraction, gamma)
    sigma = math.sqrt(a * a * x * x + b * b * (y * y + z * z))
    expected = 0.0, (a * a - b * b) * z * x / sigma, (b * b - a * a) * x * y / sigma
    assert tilting(c, gamma) == near([float(one) for one in expected], rel=1e-15)


@pytest.mark.parametrize('seed', range(3))
@pytest.mark.parametrize('surface', SURFACES)
def test_the_lowest_point_moves_in_space_as_the_body_turns_and_over_its_surface(surface, seed):
    """Below the middle of a ball it stays, not but for the rounding of its two motions."""
    c, gamma, omega = parameters(surface), axes(seed)[2], (3.0, -2.0, 5.0)
    moved = shifted(c.kind, c.size, gamma, tuple(np.cross(gamma, omega)))
    expected = np.cross(omega, lever(c, gamma)) + moved
    assert swept(c, gamma, omega) == pytest.approx(expected, abs=2e-15)
    about_middle = swept(c._replace(middle=(0.0, 0.0, 0.0)), gamma, omega)
    assert (about_middle == (0.0, 0.0, 0.0)) == (surface == 'sphere')
    if surface == 'torus':    # its tube has no part in it
        assert swept(c._replace(size=(0.2, 0.07, 0.0)), gamma, omega) == swept(c, gamma, omega)


@pytest.mark.parametrize('seed', range(4))
def test_the_response_is_how_a_force_accelerates_the_point(seed):
    """G f = f/m + (I^-1 (r x f)) x r, along the axes of the plane; with N goes a couple."""
    c, rows = parameters('ellipsoid'), axes(seed)
    r, wrung = lever(c, rows[2]), (0.01, -0.02, 0.03)
    pressed = plus(tilting(c, rows[2]), wrung)
    G = np.array(response(c.mass, c.inverse, rows, r, pressed))
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


def test_rolling_friction_without_a_film_knows_a_body_that_lies_flat():
    """There the film would be infinite."""
    c = parameters('disk', ', rolling_friction: {viscous: 0.3}')
    viscous, wrung, speed, film = couples(c, (0.0, 0.0, 1.0), (0.3, 0.4, 0.0))
    assert (speed, film, wrung) == (0.5, 0.0, (0.0, 0.0, 0.0))
    assert np.isfinite(viscous).all()


@pytest.mark.parametrize(('effects', 'flat'), [
    ('', 1e-10), (', rolling_friction: {dry: 0.02}', 1e-6),
    (', rolling_friction: {viscous: 0.02}', 1e-6), (', air_film: {viscosity: 1}', 1e-4),
    (', rolling_friction: {dry: 0.02}, air_film: {viscosity: 1}', 1e-4)])
def test_a_ring_is_flat_below_an_angle_that_its_friction_tells(effects, flat):
    c, gamma = parameters('disk', effects), (0.6 * 3e-5, -0.8 * 3e-5, 1.0)
    assert inclination(gamma) == near(3e-5, rel=1e-15)
    assert above_flat(c, gamma) == near(3e-5 - flat, rel=1e-14)
    assert above_flat(parameters('sphere'), gamma) == 1.0


def test_the_gap_of_a_flight_through_flat_is_that_below_the_lowest_point():
    """It counts from the height that the lowest point would have if the ring lay flat."""
    c, gamma = parameters('disk'), (0.06, -0.08, math.sqrt(0.99))
    assert gap_of(c, 0.5, gamma) == 0.5
    assert gap_of(c._replace(level=1.0), 0.5, gamma) == near(0.5 - 0.2 * 0.1, rel=1e-15)


def test_the_phases_and_the_surfaces_are_told_apart():
    disk, torus, sphere = map(parameters, ('disk', 'torus', 'sphere'))
    assert [is_disk(c) for c in (disk, torus, sphere)] == [True, False, False]
    assert [grips(torus._replace(way=way, rim=rim)) for way, rim in (
        ((1.0, 0.0), 0.0), (HELD, 0.0), ((1.0, 0.0), 1e-9), (HELD, 1e-9))] == [
            False, True, True, True]
    assert tangent((0.6 * 0.1, -0.8 * 0.1, 0.9)) == near((0.8, 0.6, 0.0), rel=1e-15)
    assert tangent((0.0, 0.0, 1.0)) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize('seed', range(2))
def test_a_patch_is_told_how_forces_and_couples_spin_the_body(seed):
    """The spin about n grows by n . I^-1 torque; a couple about n moves the point, too."""
    c, rows = parameters('ellipsoid'), axes(seed)
    r, wrung, torque = np.array(lever(c, rows[2])), (0.01, -0.02, 0.03), (0.5, -0.2, 0.7)
    E, inverse = np.array(rows), np.linalg.inv(np.array(c.inertia))
    turned, moved, (driven, stiff) = spinning(
        c.inverse, rows, tuple(r), torque, plus(tilting(c, rows[2]), wrung))
    for k in range(3):
        couple = np.cross(r, E[k]) + (np.array(wrung) if k == 2 else 0.0)
        assert turned[k] == near(E[2] @ inverse @ couple, rel=1e-12)
    assert moved == pytest.approx(E @ np.cross(inverse @ E[2], r), rel=1e-12, abs=1e-15)
    assert driven == near(E[2] @ inverse @ torque, rel=1e-12)
    assert stiff == near(E[2] @ inverse @ E[2], rel=1e-12)


def test_the_gyroscopic_part_of_a_tensor_is_what_differs_from_its_middle_entry():
    c = parameters('ellipsoid')
    expected = np.array(c.inertia) - 0.04 * np.eye(3)
    assert np.array(c.uneven) == pytest.approx(expected, abs=1e-17)
    assert sorted(np.diag(c.uneven))[1] == 0.0


def test_a_phase_begins_with_numbers_that_stand_for_none():
    c = parameters('ellipsoid', ', sliding_friction: {mu: 0.3}, spinning_friction: {radius: 0.01}')
    assert (c.patch, c.way, c.until) == (0.01, (1.0, 0.0), math.inf)
    assert [c.mode, c.swift, c.creep, c.side, c.lag, c.wide, c.onset, c.turn, c.since, c.slack,
            c.rim, c.level, c.began, *c.origin] == [0.0] * 15


@pytest.mark.parametrize('mu', ['0', '.inf'])
def test_a_patch_needs_a_friction_that_slips(mu):
    with pytest.raises(BadInput, match='a finite mu above 0'):
        parameters('ellipsoid', f', sliding_friction: {{mu: {mu}}}, '
                   'spinning_friction: {radius: 0.01}')


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
