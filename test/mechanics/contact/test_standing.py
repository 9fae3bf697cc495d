# SPDX-License-Identifier: Apache-2.0
"""The force of a plane on a body at one instant, compared with the motion that follows."""

import math
import types

import numpy as np
import pytest
from integrators.equations.test_contact_rates import CASES, EFFECTS, SLOPE, row_of
from mechanics.contact.test_touch import scene_of
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.integrators.equations.contact_views import CREEPING, FLIGHT
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.mechanics.contact import standing as module
from rigid_body_sim.mechanics.contact.laws import System
from rigid_body_sim.mechanics.contact.standing import Standing
from rigid_body_sim.mechanics.contact.touch import tangent
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.surfaces import KINDS, lowest

MASS, INERTIA = 2.0, np.array([[0.03, 0.001, 0.0], [0.001, 0.04, 0.002], [0.0, 0.002, 0.05]])
MIDDLE, SIZE = np.array([0.02, -0.01, 0.03]), (0.2, 0.15, 0.1)
ELLIPSOID = 'ellipsoid: {semi_axes: [0.2, 0.15, 0.1], center: [0.02, -0.01, 0.03]}'
NORMAL = np.array([0.0, 0.6, 0.8])
WEIGHT, COUPLE = np.array([0.0, 0.0, -9.81 * MASS]), np.array([0.01, -0.02, 0.03])


def standing(effects='', surface=ELLIPSOID, table='{table: {normal: [0, 0.6, 0.8]}}'):
    return Standing(parse_scene(
        f'scene: s\nbody: {{mass: {MASS}, inertia: {INERTIA.tolist()}, surface: {{{surface}}}}}\n'
        f'constraint: {table}\neffects: [gravity: {{g: 9.81}}{effects}]\n'
        'initial: {position: [0, 0, 1]}\n'))


def to_lowest(turn):
    """Return the lowest point of the body, from the centre of mass, world axes."""
    gamma = turn.inv().apply(NORMAL)
    return turn.apply(MIDDLE + lowest(KINDS['ellipsoid'], SIZE, tuple(gamma.tolist())))


def slip_of(turn, omega, velocity):
    """Return the velocity (world) of the body's point that is lowest now."""
    return velocity + np.cross(turn.apply(omega), to_lowest(turn))


def touching(seed, slip=None):
    """Return (turn, omega, position, velocity) of a body on the plane; `slip` is the point's."""
    draw = np.random.default_rng(seed)
    turn, omega = Rotation.random(random_state=seed), draw.normal(size=3)
    position = -to_lowest(turn) + np.cross(NORMAL, draw.normal(size=3))
    velocity = -np.cross(turn.apply(omega), to_lowest(turn))
    return turn, omega, position, velocity + (0.0 if slip is None else slip)


def on_body(one, turn, omega, position, velocity, force=WEIGHT, couple=COUPLE):
    rows = tuple(map(tuple, turn.as_matrix().tolist()))
    found = one.force(rows, *(tuple(x.tolist()) for x in (omega, position, velocity)),
                      tuple(force.tolist()), tuple(couple.tolist()))
    return tuple(map(np.array, found))


def change_of_slip(turn, omega, velocity, force, couple):
    """Return u' under a force (world) at the lowest point and a couple (body) from the plane.

    By differences along the motion of the body: Newton's and Euler's equations.
    """
    arm = turn.inv().apply(np.cross(to_lowest(turn), force)) + couple + COUPLE
    rate = np.linalg.solve(INERTIA, arm - np.cross(omega, INERTIA @ omega))
    push, h = (force + WEIGHT) / MASS, 1e-5

    def later(t):
        then = turn * Rotation.from_rotvec(omega * t + 0.5 * rate * t * t)
        return slip_of(then, omega + rate * t, velocity + push * t)
    return (later(h) - later(-h)) / (2.0 * h)


CROSS = np.cross(NORMAL, [1.0, 0.0, 0.0])


@pytest.mark.parametrize('seed', range(6))
def test_a_body_that_slips_is_held_on_the_plane_by_a_force_on_the_cone(seed):
    slip = 0.7 * np.cos(seed) * np.array([1.0, 0.0, 0.0]) + 0.7 * np.sin(seed) * CROSS
    state = touching(seed, slip)
    force, couple, lever = on_body(standing(', sliding_friction: {mu: 0.1}'), *state)
    turn, omega, _, velocity = state
    assert turn.apply(lever) == pytest.approx(to_lowest(turn), abs=1e-14)
    assert not couple.any()
    N = force @ NORMAL
    assert N > 0.0
    assert force - N * NORMAL == pytest.approx(-0.1 * N * slip / 0.7, abs=1e-12)
    moved = change_of_slip(turn, omega, velocity, force, couple)
    assert moved @ NORMAL == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize('mu', ['.inf', '50'])
@pytest.mark.parametrize('seed', range(6))
def test_a_body_that_rolls_goes_on_rolling_where_friction_can_hold_it(seed, mu):
    one = standing(f', sliding_friction: {{mu: {mu}}}, '
                   'rolling_friction: {dry: 0.01, viscous: 0.2}')
    state = touching(seed)
    force, couple, _ = on_body(one, *state)
    turn, omega, _, velocity = state
    assert force @ NORMAL > 0.0
    assert couple @ omega < 0.0
    moved = change_of_slip(turn, omega, velocity, force, couple)
    assert moved == pytest.approx(np.zeros(3), abs=1e-6)


@pytest.mark.parametrize('seed', range(4))
def test_where_friction_cannot_hold_it_slip_begins_along_its_own_change(seed):
    state = touching(seed)
    turn, omega, _, velocity = state
    force, couple, _ = on_body(standing(', sliding_friction: {mu: 0.01}'), *state)
    N = force @ NORMAL
    friction = force - N * NORMAL
    assert np.linalg.norm(friction) == pytest.approx(0.01 * N)
    moved = change_of_slip(turn, omega, velocity, force, couple)
    assert moved @ NORMAL == pytest.approx(0.0, abs=1e-6)
    assert moved / np.linalg.norm(moved) == pytest.approx(-friction / np.linalg.norm(friction),
                                                          abs=1e-6)


@pytest.mark.parametrize('seed', range(6))
def test_a_small_patch_that_spins_while_its_body_rolls_holds_with_what_the_spin_leaves(seed):
    """Its slip is the one of Coulomb's law, but for rounding, or below the rounding of a state."""
    mu, slip = 3.0, np.zeros(3)
    for rho in (1e-13, 1e-9):
        state = touching(seed, slip)
        turn, omega, _, velocity = state
        force, couple, _ = on_body(standing(
            f', sliding_friction: {{mu: {mu}}}, spinning_friction: {{radius: {rho}}}'), *state)
        N, gamma = force @ NORMAL, turn.inv().apply(NORMAL)
        along = force - N * NORMAL
        left, spin = (mu * N) ** 2 - along @ along, gamma @ omega
        assert N > 0.0 < left
        assert change_of_slip(turn, omega, velocity, force, couple) == pytest.approx(
            np.zeros(3), abs=1e-6)
        against = -math.copysign(rho * math.sqrt(left), spin)
        assert couple == near(against * gamma, rel=1e-7)
        slip = -1e-9 * abs(spin) / math.sqrt(left) * along


def test_without_friction_the_plane_pushes_along_its_normal():
    turn, omega, position, velocity = touching(1)
    force, couple, _ = on_body(standing(), turn, omega, position, velocity)
    assert np.cross(force, NORMAL) == pytest.approx(np.zeros(3), abs=1e-14)
    assert force @ NORMAL > 0.0
    moved = change_of_slip(turn, omega, velocity, force, couple)
    assert moved @ NORMAL == pytest.approx(0.0, abs=1e-6)


def test_what_does_not_touch_or_leaves_or_is_pulled_off_feels_nothing():
    one = standing(', sliding_friction: {mu: 0.3}')
    turn, omega, position, velocity = touching(2)
    for lift, speed, force in (
            (1e-6, 0.0, WEIGHT), (0.0, 1e-6, WEIGHT), (0.0, 0.0, -9.0 * WEIGHT)):
        found = on_body(one, turn, omega, position + lift * NORMAL, velocity + speed * NORMAL,
                        force)
        assert not found[0].any()
        assert not found[1].any()
    # rounding of a gap and of a speed is none
    for lift, speed in ((1e-14, 0.0), (0.0, 1e-14), (-1e-3, -1e-3)):
        assert on_body(one, turn, omega, position + lift * NORMAL,
                       velocity + speed * NORMAL)[0].any()


def test_a_ball_at_rest_on_a_slope_needs_the_tangent_for_friction():
    """The slope is 3/4; a ball rolls where mu is at least 2/7 of it, and slides with mu N else."""
    ball = ('scene: s\nbody: {mass: 2, shape: {solid_sphere: {radius: 0.1}}, '
            'surface: {sphere: {radius: 0.1}}}\n'
            'constraint: {table: {normal: [0, 0.6, 0.8]}}\n'
            'effects: [gravity: {g: 9.81}, sliding_friction: {mu: %s}]\n'
            'initial: {position: [0, 0.06, 0.08]}\n')
    down = np.array([0.0, 0.8, -0.6])
    rows, still = tuple(map(tuple, np.eye(3).tolist())), (0.0, 0.0, 0.0)
    for mu, share in (('0.25', 2.0 / 7.0), ('0.2', 0.2 * 0.8 / 0.6)):
        one = Standing(parse_scene(ball % mu))
        force, _, _ = one.force(rows, still, (0.0, 0.06, 0.08), still, tuple(WEIGHT), still)
        assert np.array(force) @ NORMAL == pytest.approx(2.0 * 9.81 * 0.8)
        assert np.array(force) @ down == pytest.approx(-2.0 * 9.81 * 0.6 * share)
        assert math.isclose(force[0], 0.0, abs_tol=1e-14)


@pytest.mark.parametrize(('friction', 'tilt', 'lies'), [
    (', rolling_friction: {viscous: 1.0e-3}', 0.99e-6, True),
    (', rolling_friction: {viscous: 1.0e-3}', 1.1e-6, False),
    (', rolling_friction: {dry: 1.0e-4}', 9e-4, True),
    (', air_film: {viscosity: 1.8e-5}', 9e-5, True),
    ('', 1e-7, False)])
def test_a_disk_that_has_come_to_rest_is_held_by_its_face(friction, tilt, lies):
    """At one point of its edge it would fall at once: 4 g/5 downward for its centre."""
    scene = parse_scene(
        'scene: s\nbody: {mass: 2.0, shape: {disk: {radius: 0.5}}}\nconstraint: table\n'
        f'effects: [gravity: {{g: 9.81}}, sliding_friction: {{mu: .inf}}{friction}]\n'
        f'initial: {{euler_zyz: [0.3, {tilt!r}, 0.0], rolling: true}}\n')
    balance = Dynamics(scene).balance(scene.initial.vector)
    if lies:
        assert np.abs(balance.acceleration).max() == 0.0
        assert np.abs(balance.angular_acceleration).max() < 1e-14
        assert balance.force == pytest.approx([0.0, 0.0, 2.0 * 9.81], abs=1e-15)
    else:
        assert balance.acceleration[2] == near(-0.8 * 9.81, rel=1e-3)


@pytest.mark.parametrize(('omega', 'velocity', 'share'), [
    ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0), ((0.0, 0.0, 1e-3), (0.0, 0.0, 0.0), 0.2),
    ((1e-3, 0.0, 0.0), (0.0, 0.0, 0.0), 0.2), ((0.0, 0.0, 0.0), (1e-3, 0.0, 0.0), 0.2),
    ((0.0, 0.0, 0.0), (0.0, -1e-3, 0.0), 0.2)])
def test_a_disk_that_turns_or_moves_at_all_is_not_held_by_its_face(omega, velocity, share):
    """At one point of its edge it falls with 4 g/5: the plane bears the rest of its weight."""
    one = Standing(parse_scene(
        'scene: s\nbody: {mass: 2.0, shape: {disk: {radius: 0.5}}}\nconstraint: table\n'
        'effects: [gravity: {g: 9.81}, sliding_friction: {mu: .inf}, '
        'rolling_friction: {viscous: 1.0e-9}]\n'
        'initial: {euler_zyz: [0.3, 1.0e-7, 0.0], rolling: true}\n'))
    force, _, _ = on_body(one, Rotation.from_rotvec([1e-7, 0.0, 0.0]), np.array(omega),
                          np.array([0.3, 0.2, 0.5e-7]), np.array(velocity), couple=np.zeros(3))
    assert force[2] == near(share * 9.81 * MASS, rel=1e-2)


LOW_TORUS = ((np.sin(2.5e-4), 0.0, 0.0, np.cos(2.5e-4)), -0.2, 0.5)


@pytest.mark.without_numba
@pytest.mark.parametrize('name', [
    'flight', 'glides', 'slides', 'slides and rolls', 'slides as a disk in air',
    'slides with a patch', 'spins on a patch', 'rolls', 'rolls under dry friction', 'is held',
    'slides and is held', 'rolls on a patch', 'creeps', 'creeps with a patch', 'tips'])
def test_the_force_at_an_instant_is_the_one_of_the_phase_that_the_body_is_in(name):
    """The phases (contact_rates.py) are told of it, the balance finds it from the state."""
    surface, effects, mode, slip, changes = CASES[name]
    start = None
    if name == 'tips':    # a torus does so where it is low
        q, along, spin = LOW_TORUS
        n = np.array(matrix(*q)[2])
        start = q, tuple((along * np.array(tangent(tuple(n))) + spin * n).tolist())
    if mode == CREEPING:
        slip = 1e-14, 0.0
    if name in ('is held', 'tips'):    # by enough
        effects = effects.replace('mu: 0.3', 'mu: 5.0')
    if 'held' in name:
        effects = effects.replace('dry: 0.01', 'dry: 2.0')
    c, _, at, row = row_of(surface, effects, mode, slip, changes, start)
    assert row.watched.rolling > 0.0
    assert mode == FLIGHT or row.watched.grip > 0.0
    plane = Rotation.from_quat(c.plane)
    turn, v = plane * Rotation.from_matrix(np.array(at.axes)), np.array(row.velocity)
    height = -np.dot(at.axes[2], at.r) + 0.1 * (mode == FLIGHT)
    force = [0.0, 0.0, -9.81 * c.mass] - 0.2 * plane.apply(v)
    one = Standing(scene_of(surface, EFFECTS + effects, SLOPE))
    found, couple, lever = on_body(
        one, turn, np.array(at.omega), plane.apply([0.7, -0.4, height]), plane.apply(v), force,
        np.array([0.1, -0.2, 0.3]))
    assert found == pytest.approx(plane.apply(row.force), abs=1e-11)    # 3e-13
    assert couple == pytest.approx(np.array(at.axes).T @ row.couple, abs=1e-12)    # 8e-15
    assert lever == pytest.approx(at.r, abs=1e-12)    # 1.1e-14, of a low torus


@pytest.mark.parametrize(('slope', 'rolls', 'growth'), [
    (0.5, 0.0, 0.5 - 0.04), (0.5, -1e-9, 0.5 - 0.04), (0.5, 1e-3, 0.5 - 0.04),
    (0.5, -1e-3, 0.5 + 0.04), (0.02, 0.0, 0.0), (0.02, 1e-9, 0.02 - 0.04),
    (0.02, -1e-9, 0.02 + 0.04)])
@pytest.mark.parametrize('spin', [0.0, 0.7])
@pytest.mark.parametrize('upright', [True, False])
def test_a_ball_begins_to_roll_down_where_friction_does_not_hold_it(
        slope, rolls, growth, spin, upright):
    """It rolls with 5/7 g (sin - C cos) down, and stays where C is more than the slope.

    Rolling friction of a force C N is a couple R C N; while the ball goes up both go against it.
    """
    radius, mass, dry = 0.1, 2.0, 0.04
    one = Standing(parse_scene(
        f'scene: s\nbody: {{mass: {mass}, shape: {{solid_sphere: {{radius: {radius}}}}}, '
        f'surface: {{sphere: {{radius: {radius}}}}}}}\n'
        f'constraint: {{table: {{normal: [{slope}, 0.0, 1.0]}}}}\neffects: [gravity: {{g: 9.81}}, '
        f'sliding_friction: {{mu: 0.9}}, rolling_friction: {{dry: {dry}}}]\n'
        'initial: {position: [0, 0, 1]}\n'))
    size = math.hypot(slope, 1.0)
    n, down = np.array([slope, 0.0, 1.0]) / size, np.array([1.0, 0.0, -slope]) / size
    omega = np.cross(n, down) * rolls / radius + spin * n
    turn = Rotation.from_matrix(np.column_stack((down, np.cross(n, down), n))
                                if upright else np.eye(3))    # its third axis along the normal
    force, couple, _ = on_body(one, turn, turn.inv().apply(omega), radius * n, rolls * down,
                               WEIGHT, np.zeros(3))
    couple = turn.apply(couple)
    a = 5.0 / 7.0 * 9.81 / size * growth
    N = mass * 9.81 / size
    assert force @ n == near(N, rel=1e-12)
    along = mass * (a - 9.81 * slope / size)
    assert force - N * n == pytest.approx(along * down, abs=1e-8)    # 2e-10
    # I omega' = couple - R n x force
    expected = 0.4 * mass * radius * a * np.cross(n, down) + radius * np.cross(n, force)
    assert couple == pytest.approx(expected, abs=1e-7)
    assert np.linalg.norm(couple) == near(radius * N * (dry if growth else slope), rel=1e-6)


def test_a_body_that_is_pulled_off_is_told_by_a_force_that_pulls():
    """Its friction has no direction: N = -b_n/A of a slip along e1, which is then below 0."""
    one = object.__new__(Standing)
    one._c = types.SimpleNamespace(mu=0.3)
    G = ((2.0, 0.3, 0.4), (0.3, 1.5, -0.2), (0.4, -0.2, 1.0))
    N = -3.0 / (1.0 - 0.3 * 0.4)
    found = one._force(System(G, (0.5, 0.7, 3.0)), (0.0, 0.0, 0.0), 1.0)
    assert found == near((-0.3 * N, 0.0, N), rel=1e-14)
    # a slip has one
    found = one._force(System(G, (0.5, 0.7, -3.0)), (0.3, -0.4, 0.0), 1.0)
    N = 3.0 / (1.0 - 0.3 * (0.6 * 0.4 + 0.8 * 0.2))
    assert found == near((-0.3 * N * 0.6, 0.3 * N * 0.8, N), rel=1e-14)


def test_the_way_of_a_slip_that_begins_is_looked_for_against_the_force_that_would_hold(
        monkeypatch):
    """With G = 1 that force is -b = (0.3, -0.4, 1), of which friction gives a tenth of N."""
    asked = []
    monkeypatch.setattr(module, 'departure', lambda system, mu, *guess: (
        asked.append((mu, *guess)) or (0.8, 0.6, 1.0)))
    one = object.__new__(Standing)
    one._c = types.SimpleNamespace(mu=0.1)
    unit = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    found = one._force(System(unit, (-0.3, 0.4, -1.0)), (0.0, 0.0, 0.0), 1.0)
    assert asked == [(0.1, near(-0.6, rel=1e-15), near(0.8, rel=1e-15))]
    assert found == near((-0.08, -0.06, 1.0), rel=1e-14)


@pytest.mark.parametrize(('u', 'spin', 'balances'), [
    # a spin of -2 rad/s under the friction (3, -4, 5) with rho = 0.1: u = -0.04 (3, -4)
    ((-0.12, 0.16, 0.0), -2.0, True), ((0.12, 0.16, 0.0), -2.0, False),
    ((-0.12, -0.16, 0.0), -2.0, False), ((-0.12, 0.16 + 2e-11, 0.0), -2.0, False),
    # what spins no faster than rounding holds
    ((0.0, 0.0, 0.0), -4e-11, False), ((0.0, 0.0, 0.0), -6e-11, True)])
def test_a_slip_is_the_balance_of_a_friction_to_rounding(u, spin, balances):
    one = object.__new__(Standing)
    one._c = types.SimpleNamespace(patch=0.1, size=(0.2,))
    assert one._is_balance(u, spin, 1.0, (3.0, -4.0, 5.0)) == balances
