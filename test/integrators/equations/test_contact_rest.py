# SPDX-License-Identifier: Apache-2.0
"""The end of the motion of a body on a plane: a patch that grips, a ring that jams."""

import numpy as np
import pytest
from mechanics.contact.test_touch import scene_of
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.integrators.equations import contact_rest
from rigid_body_sim.integrators.equations.contact_rest import (
    about_tube,
    comes_down,
    grip_patch,
    halt,
    hastens,
    is_clamped,
    jams,
    lay,
    lies,
    pause,
    rise,
    rolls,
    spins,
    tip,
    tipping,
    topple,
)
from rigid_body_sim.integrators.equations.contact_views import (
    GLIDING,
    LEDGER,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
)
from rigid_body_sim.mechanics.contact.numbers import contact_parameters
from rigid_body_sim.mechanics.contact.parameters import CONTACT, LOW
from rigid_body_sim.mechanics.contact.touch import FILMY, FLAT

pytestmark = pytest.mark.without_numba


def unknowns(q, omega=(0.0, 0.0, 0.0)):
    """Return the unknowns of a body, with an impulse in its ledger."""
    y = np.zeros(UNKNOWNS.size)
    start = UNKNOWNS.load(y.tolist())
    UNKNOWNS.store(y, start._replace(q=q, omega=omega, ledger=start.ledger._replace(
        impulse=(0.1, -0.2, 0.3))))
    return y


@pytest.mark.parametrize('effects', [
    '', ', sliding_friction: {mu: 0.6}, spinning_friction: {radius: 0.01}'])
def test_a_patch_that_grips_takes_the_spin_about_the_normal_alone(effects):
    """What omega loses is along the normal, and I times that is the angular impulse."""
    p = contact_parameters(scene_of('sphere', effects))
    turn, omega = Rotation.random(random_state=4), np.array([3.0, -8.0, 5.0])
    y, normal = unknowns(tuple(turn.as_quat().tolist()), tuple(omega.tolist())), turn.inv().apply(
        [0.0, 0.0, 1.0])
    assert spins(p, y) == near((0.01 if effects else 0.0) * (normal @ omega), rel=1e-14)
    grip_patch(p, y)
    found = UNKNOWNS.load(y.tolist())
    change = -(normal @ omega) * normal if effects else np.zeros(3)
    inertia = np.array([[0.03, 0.001, 0.0], [0.001, 0.04, 0.002], [0.0, 0.002, 0.05]])
    assert found.omega == near(omega + change, rel=1e-14)
    # measured: 6e-17
    assert found.ledger.impulse == pytest.approx(
        np.array([0.1, -0.2, 0.3]) + turn.apply(inertia @ change), abs=1e-15)


@pytest.mark.parametrize(('surface', 'effects', 'tilt', 'jammed'), [
    ('torus', ', rolling_friction: {dry: 0.01}', 0.9 * LOW, True),
    ('disk', ', rolling_friction: {viscous: 0.01}', 0.9 * LOW, True),
    ('disk', ', air_film: {viscosity: 1.8e-5}', 0.9 * LOW, True),
    ('disk', '', 0.9 * LOW, False), ('disk', ', rolling_friction: {dry: 0.01}', 1.1 * LOW, False),
    ('sphere', ', rolling_friction: {dry: 0.01}', 0.9 * LOW, False)])
def test_rolling_friction_of_any_kind_jams_a_ring_that_lies_low(surface, effects, tilt, jammed):
    p = contact_parameters(scene_of(surface, ', sliding_friction: {mu: 0.6}' + effects))
    assert bool(jams(p, unknowns((np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))))) is jammed


@pytest.mark.parametrize(('surface', 'tilt', 'flat'), [
    ('torus', 0.0, True), ('torus', np.pi, True), ('torus', 0.4, False), ('disk', 0.0, True),
    ('disk', 0.4, False), ('sphere', 0.0, False)])
def test_only_a_ring_can_lie_flat(surface, tilt, flat):
    p = contact_parameters(scene_of(surface, ', sliding_friction: {mu: 0.6}'))
    assert bool(lies(p, unknowns((np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt))))) is flat


MODE, INERTIA = CONTACT.part('mode').first, np.array(
    [[0.03, 0.001, 0.0], [0.001, 0.04, 0.002], [0.0, 0.002, 0.05]])
MIDDLE = np.array([0.02, -0.01, 0.03])    # of the sphere, from the centre of mass


def sphere_of(mode):
    """Return (numbers, unknowns, turn, omega, lever in axes of the plane) of a sphere that turns.

    It has a radius of 0.2 m; its lowest point slides.
    """
    p = contact_parameters(scene_of('sphere', ', sliding_friction: {mu: 0.6}'))
    p[MODE] = mode
    turn, omega = Rotation.random(random_state=4), np.array([3.0, -8.0, 5.0])
    y = unknowns(tuple(turn.as_quat().tolist()), tuple(omega.tolist()))
    UNKNOWNS.part('u').store(y, (0.4, -0.3, 0.0))
    return p, y, turn, omega, turn.apply(MIDDLE) - [0.0, 0.0, 0.2]


@pytest.mark.parametrize(('mode', 'slides'), [(ROLLING, 0.0), (SLIDING, 1.0)])
def test_what_halts_a_body_takes_its_energy_and_its_angular_momentum(mode, slides):
    """The centre of mass of what rolls goes by -omega x r, that of what slides by u more."""
    p, y, turn, omega, r = sphere_of(mode)
    v = slides * np.array([0.4, -0.3, 0.0]) - np.cross(turn.apply(omega), r)
    y[LEDGER.part('struck').first] = 7.0
    halt(p, y)
    found = UNKNOWNS.load(y.tolist())
    assert found.omega == found.u == (0.0, 0.0, 0.0)
    assert found.ledger.struck == near(7.0 + 0.5 * (omega @ INERTIA @ omega + 2.0 * v @ v),
                                       rel=1e-14)
    # measured: 0 and 6e-17
    assert found.ledger.impulse == pytest.approx(
        np.array([0.1, -0.2, 0.3]) - turn.apply(INERTIA @ omega), abs=1e-15)


@pytest.mark.parametrize(('mode', 'slides'), [(ROLLING, 0), (SLIDING, 1), (GLIDING, 1)])
def test_a_sphere_that_pauses_keeps_its_spin_and_in_a_slip_the_velocity_of_its_mass(mode, slides):
    p, y, turn, omega, r = sphere_of(mode)
    normal = turn.inv().apply([0.0, 0.0, 1.0])
    change = (normal @ omega) * normal - omega
    pause(p, y)
    found = UNKNOWNS.load(y.tolist())
    assert found.omega == near(omega + change, rel=1e-13)
    u = np.array([0.4, -0.3, 0.0]) + slides * np.cross(turn.apply(change), r)
    # measured: 2e-16 and 6e-17
    assert found.u == pytest.approx((u[0], u[1], 0.0), abs=2e-15)
    assert found.ledger.impulse == pytest.approx(
        np.array([0.1, -0.2, 0.3]) + turn.apply(INERTIA @ change), abs=1e-15)


def test_a_disk_that_pauses_keeps_all_but_its_turn_across_the_rim():
    """Inclined by 0.3 about its x axis, it rolls by its turn about the one that goes down, b."""
    p = contact_parameters(scene_of('disk', ', sliding_friction: {mu: 0.6}'))
    p[MODE] = ROLLING
    y = unknowns((np.sin(0.15), 0.0, 0.0, np.cos(0.15)), (3.0, -8.0, 5.0))
    b = np.array([0.0, np.cos(0.3), -np.sin(0.3)])    # at right angles to the normal and to x
    pause(p, y)
    omega = np.array([3.0, -8.0, 5.0])
    assert UNKNOWNS.load(y.tolist()).omega == near(omega - (b @ omega) * b, rel=1e-14)


def disk(mode=ROLLING, tilt=0.0, omega=(0.0, 0.0, 0.0), film=False, turned=0.0, over=False):
    """Return (numbers, unknowns) of a disk turned about the normal, then inclined about its x."""
    p = contact_parameters(scene_of('disk', ', sliding_friction: {mu: .inf}' + (
        ', air_film: {viscosity: 1.8e-5}' if film else ', rolling_friction: {dry: 0.01}')))
    p[MODE] = mode
    sine, cosine, half = np.sin(0.5 * turned), np.cos(0.5 * turned), 0.5 * tilt
    x, y, z, w = (cosine, sine, 0.0, 0.0) if over else (0.0, 0.0, sine, cosine)
    q = np.array([x + half * w, y + half * z, z - half * y, w - half * x]) / np.hypot(1.0, half)
    return p, unknowns(tuple(q.tolist()), omega)


def level_part(y):
    """Return the normal along the plane of the disk, to the last bit where it is small."""
    x, y, z, w = UNKNOWNS.load(y.tolist()).q
    return np.array([2.0 * (x * z - y * w), 2.0 * (y * z + x * w)])


@pytest.mark.parametrize('over', [False, True])
@pytest.mark.parametrize('spin', [0.0, 30.0, -30.0])
@pytest.mark.parametrize('tilt', [0.0, 0.9 * FLAT])
def test_the_lowest_point_of_a_ring_that_tips_is_the_one_that_goes_down_first(tilt, spin, over):
    """Its inclination grows along itself: gamma' = gamma x omega, which the spin turns, too.

    What is between the levels of two attitudes is in the impulse.
    """
    wx, wy, side = 300.0 * FLAT, -400.0 * FLAT, -1.0 if over else 1.0
    p, y = disk(tilt=tilt, omega=(wx, wy, spin), turned=0.7, over=over)
    before = matrix_of(y)
    assert tip(p, y, 0.0)
    gx, gy = level_part(y)
    dx, dy = gy * spin - side * wy, side * wx - gx * spin
    assert np.hypot(gx, gy) == near(max(tilt, contact_rest.TIPPED), rel=1e-9)
    assert (gx * dx + gy * dy) / np.hypot(gx, gy) / np.hypot(dx, dy) == near(1.0, rel=1e-12)
    # measured: 1e-14
    assert abs(gx * dy - gy * dx) <= 1e-12 * np.hypot(gx, gy) * np.hypot(dx, dy)
    turned = (matrix_of(y) - before) @ INERTIA @ [wx, wy, spin]
    assert UNKNOWNS.load(y.tolist()).ledger.impulse == pytest.approx(
        np.array([0.1, -0.2, 0.3]) + turned, abs=2e-15)    # measured: 3e-16


def matrix_of(y):
    return Rotation.from_quat(UNKNOWNS.load(y.tolist()).q).as_matrix()


@pytest.mark.parametrize(('omega', 'spin'), [
    ((3e-6, -4e-6, 2e-5), 2e-5), ((3e-6, -4e-6, -2e-5), -2e-5), ((3e-6, 4e-6, 0.9e-5), 0.0)])
@pytest.mark.parametrize(('tilt', 'levels'), [(0.9 * contact_rest.LEVEL, True),
                                              (1.1 * contact_rest.LEVEL, False)])
def test_a_ring_that_turns_too_slowly_to_tip_keeps_its_spin_and_is_levelled(
        omega, spin, tilt, levels):
    """Slower than 1e-5 rad/s, it rests; 2^-49 of inclination are rounding."""
    p, y = disk(tilt=tilt, omega=omega, turned=0.7)
    assert not tip(p, y, 1e-5)
    assert UNKNOWNS.load(y.tolist()).omega == (0.0, 0.0, spin)
    assert np.hypot(*level_part(y)) == near(0.0 if levels else tilt, rel=1e-9)
    for steep in (disk(tilt=2.0 * FLAT, omega=(1.0, 0.0, 0.0)), sphere_of(ROLLING)[:2]):
        kept = steep[1].copy()
        assert not tip(*steep, 1e-5)
        assert steep[1].tolist() == kept.tolist()


@pytest.mark.parametrize('spin', [30.0, -30.0])
def test_a_spin_turns_the_way_in_which_a_ring_tips_by_no_more_than_a_right_angle(spin):
    """Where it turns the axis faster than the ring tips: from (-wy, wx) to (wx, wy) or back."""
    p, y = disk(omega=(3e-18, -4e-18, spin))
    assert tip(p, y, 0.0)
    assert level_part(y) == near(np.copysign(2.0 ** -56, spin) * np.array([0.6, -0.8]), rel=1e-9)


@pytest.mark.parametrize('spin', [30.0, -30.0])
def test_a_ring_tips_that_turns_faster_than_a_strike_about_the_normal_turns_it(spin):
    """Four times its spin and its inclination, and 1e-5 rad/s."""
    for share in (0.99, 1.01):
        p, y = disk(tilt=0.5 * FLAT, omega=(0.0, share * (1e-5 + 60.0 * FLAT), spin))
        assert bool(tip(p, y, 1e-5)) is (share > 1.0)


@pytest.mark.parametrize(('over', 'side'), [(False, 1.0), (True, -1.0)])
@pytest.mark.parametrize('way', [(3.0, 4.0), (-5.0, 2.0)])
@pytest.mark.parametrize('tilt', [0.0, 1e-9])
def test_a_couple_topples_a_ring_the_way_in_which_it_turns_it(way, tilt, over, side):
    """The normal goes along itself x omega; never by less than 2^-56."""
    _, y = disk(tilt=tilt, turned=0.7, over=over)
    topple(y, way)
    wanted = side * max(tilt, 2.0 ** -56) * np.array([-way[1], way[0]]) / np.hypot(*way)
    assert level_part(y) == near(wanted, rel=1e-9)


@pytest.mark.parametrize(('mode', 'pace', 'share', 'down'), [
    (ROLLING, 7.0, 0.99, True), (ROLLING, 7.0, 1.01, False),
    (SLIDING, 0.25, 1.99, True), (SLIDING, 0.25, 2.01, False)])
def test_a_ring_comes_down_where_its_tipping_ends_before_it_counts_as_inclined(
        mode, pace, share, down):
    """Slowed at 5 rad/s^2 the rate w goes on for w^2/10; in a slip rates are over its pace."""
    tilt = 0.6 * FLAT
    rate = share * np.sqrt(2.0 * 5.0 * 0.4 * FLAT)
    p, y = disk(mode, tilt, (0.6 * rate, -0.8 * rate, 9.0))
    row = np.zeros(ROW.size)
    UNKNOWNS.part('omega').store(row, (-0.6 * 5.0, 0.8 * 5.0, 2.0))
    row[ROW.part('pace').first] = pace
    assert bool(comes_down(p, y, row)) is down
    _, steep = disk(mode, 1.01 * FLAT, (-6e-5, 8e-5, 9.0))    # it tips on, ever faster
    assert not comes_down(p, steep, row)


@pytest.mark.parametrize(('tilt', 'rises', 'tips', 'clamped'), [
    (0.0, 0.9e-9, 0.0, True), (0.0, 1.1e-9, 0.0, False), (0.0, -1.1e-9, 0.0, False),
    (0.0, 0.0, 4.9e-9, True), (0.0, 0.0, 5.1e-9, False),
    (0.1 * FLAT, 5.009e-7, 0.0, True), (0.1 * FLAT, 5.011e-7, 0.0, False),
    (0.1 * FLAT, 0.0, 4.04e-7, True), (0.1 * FLAT, 0.0, 4.06e-7, False)])
def test_ideal_friction_clamps_a_disk_that_lies_flat_and_does_not_rise_or_tip(
        tilt, rises, tips, clamped):
    """But for 1e-9 m/s, or that over 0.2 m, and what its slope makes of 5 m/s, or 4 times 1 rad/s.

    Not one whose centre of mass is above its rim.
    """
    p, y = disk(tilt=tilt, omega=(tips, 0.0, 1.0 if tilt else 0.0))
    velocity, middle = (3.0, 4.0, rises), CONTACT.part('middle').first
    assert bool(is_clamped(p, y, velocity, 1e-9)) is clamped
    p[middle + 1] = 0.01
    assert bool(is_clamped(p, y, velocity, 1e-9)) is clamped
    for place, number in ((middle + 2, 0.01), (CONTACT.part('mu').first, 0.6)):
        other = p.copy()
        other[place] = number
        assert not is_clamped(other, y, velocity, 1e-9)


def test_a_ring_moves_about_its_tube_as_it_inclines_and_along_its_rim_as_it_turns_across_it():
    """Inclined by 0.3 about its x axis: there b is (0, cos 0.3, -sin 0.3) on the body."""
    turn, omega = Rotation.from_rotvec([0.0, 0.0, 0.7]) * Rotation.from_rotvec(
        [0.3, 0.0, 0.0]), (3.0, -8.0, 5.0)
    y = unknowns(tuple(turn.as_quat().tolist()), omega)
    across = -8.0 * np.cos(0.3) - 5.0 * np.sin(0.3)
    torus = contact_parameters(scene_of('torus', ', sliding_friction: {mu: 0.6}'))
    assert tipping(torus, y) == near((-0.05 * 3.0, across), rel=1e-13)
    assert about_tube(torus, y, 2.0, 5.0) == near(5.0 * np.cos(0.7) - 2.0 * np.sin(0.7), rel=1e-14)
    assert rise(torus, y) == near(0.2 * np.sin(0.3), rel=1e-14)
    row = np.zeros(ROW.size)
    UNKNOWNS.part('omega').store(row, (1.0, 2.0, -3.0))
    assert hastens(row, y) == near(2.0 * np.sin(0.3) - 3.0 * np.cos(0.3), rel=1e-14)
    # the lowest point goes around the axis of a disk at `across` over the sine
    assert rolls(disk()[0], y) == near(-0.2 * across / np.sin(0.3), rel=1e-13)


@pytest.mark.parametrize(('over', 'flip'), [(False, 0.0), (True, np.pi)])
def test_a_ring_that_is_laid_down_heats_by_its_height(over, flip):
    """It is 0.2 m times the inclination; 2^-49 of it are rounding."""
    p, y = disk(tilt=0.5 * FILMY, film=True, turned=0.7, over=over)
    lay(p, y, 3.0)
    assert y[LEDGER.part('struck').first] == near(3.0 * 0.2 * 0.5 * FILMY, rel=1e-9)
    assert np.hypot(*level_part(y)) == 0.0
    level = Rotation.from_rotvec([0.0, 0.0, 0.7]) * Rotation.from_rotvec([flip, 0.0, 0.0])
    assert matrix_of(y) == pytest.approx(level.as_matrix(), abs=1e-9)    # measured: 3e-16
