# SPDX-License-Identifier: Apache-2.0
"""Bounds of what potentials and drives can do, by hand, and never below what happens."""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.mechanics.bounds import (
    angles_turned,
    borne,
    cancelling,
    drive,
    drives,
    falling,
    passed,
    pushed_unbounded,
    relaxation,
    resting,
    swing_momentum,
    swing_rate,
    unbounded,
)
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene


def scene(constraint, effects, inertia=(2.0, 3.0, 4.0)):
    return parse_scene(f'scene: s\nbody: {{mass: 2.0, inertia: {list(inertia)}, '
                       f'center_of_mass: [0.3, 0, 0.4]}}\nconstraint: {constraint}\n'
                       f'effects: [{effects}]\ninitial: {{}}\n')


TORQUE = 'torque: {value: [0, 3, 4]}'
SPRING = 'spring: {stiffness: 5.0, at: [0, 0, 1], anchor: [1, 0, 2]}'
HINGE = '{hinge: {axis: [0, 1, 0], through: [0, 0, 0.4]}}'


def test_a_drive_turns_a_body_about_its_least_moment():
    """5 N m: over 2 for a free body; about a point the body of 2 + 2*0.16 is no lighter."""
    assert drive(scene('free', TORQUE), None) == pytest.approx(2.5)
    assert drive(scene('free', 'torque: {value: [0, 0, 1]}'), None) == 0.5
    held = scene('pivot', TORQUE)
    least = min(held.constraint.inertia(held.body).moments)
    assert drive(held, None) == pytest.approx(5.0 / least)


def test_a_drive_turns_a_hinged_body_about_its_hinge():
    """3 + 2 * 0.3^2 about the hinge, whatever the other moments are."""
    assert drive(scene(HINGE, TORQUE), None) == pytest.approx(5.0 / 3.18)


def test_an_axis_without_moment_takes_no_torque_and_does_not_count():
    assert drive(scene('free', TORQUE, (2.0, 2.0, 0.0)), None) == pytest.approx(2.5)


def test_what_nothing_drives_has_no_bound_but_zero():
    assert drive(scene('free', ''), None) == 0.0
    assert swing_rate(scene('pivot', '')) == 0.0


@pytest.mark.parametrize(('constraint', 'lever'), [('free', 0.0), ('pivot', 0.5), (HINGE, 0.3)])
def test_a_held_force_drives_by_its_lever_about_what_holds_the_body(constraint, lever):
    one = scene(constraint, '')
    alone = drive(one, Wrench(torque=(0.0, 0.0, 2.0)))
    both = drive(one, Wrench(force=(6.0, 0.0, 8.0), torque=(0.0, 0.0, 2.0)))
    assert alone > 0.0
    assert both == pytest.approx(alone * (2.0 + 10.0 * lever) / 2.0)
    driven = drive(scene(constraint, TORQUE), Wrench(torque=(0.0, 0.0, 2.0)))
    assert driven == pytest.approx(alone * 7.0 / 2.0)


def test_a_weight_that_gives_a_joule_swings_the_body_by_it():
    """M g r is 2 * 5/3 * 0.3 J, and the moment 3.18 kg m^2."""
    rate = swing_rate(scene(HINGE, f'gravity: {{g: {5.0 / 3.0!r}}}'))
    assert rate == near(2.0 * math.sqrt(1.0 / 3.18), rel=1e-14)


def test_a_pendulum_let_go_upright_reaches_its_swing_rate_and_no_more():
    """At the bottom: I omega^2/2 = 2 M g r."""
    rate = swing_rate(scene(HINGE, 'gravity: {g: 10}'))
    assert rate == pytest.approx(math.sqrt(4.0 * 2.0 * 10.0 * 0.3 / 3.18))


def test_a_swinging_body_counts_by_the_middle_moment_about_its_point():
    held = scene('pivot', 'gravity: {g: 10}')
    middle = sorted(held.constraint.inertia(held.body).moments)[1]
    assert swing_rate(held) == pytest.approx(math.sqrt(4.0 * 2.0 * 10.0 * 0.5 / middle))


def test_dry_friction_at_a_hinge_bears_its_torque_over_the_moment():
    assert borne(scene(HINGE, 'dry_friction: {torque: 2.0}')) == pytest.approx(2.0 / 3.18)
    assert borne(scene(HINGE, 'gravity: {g: 10}')) == 0.0


@pytest.mark.parametrize(('effects', 'expected'), [
    ('', False), ('gravity: {g: 10}', False), (SPRING, True),
    (f'gravity: {{g: 10}}, {SPRING}', True),
    ('strike: {impulse: [1, 0, 0], time: 1.0}', False)])
def test_a_spring_has_no_bound_and_a_strike_needs_none(effects, expected):
    """A spring pulls the more the longer it is; a strike does not act between two looks."""
    assert unbounded(scene('pivot', effects)) is expected


@pytest.mark.parametrize(('effects', 'expected'), [
    ('gravity: {g: 10}', False), ('drag: {angular: 0.1}', False), (SPRING, True),
    ('potential: {energy: "0.5*qz^2"}', True), ('torque: {value: ["sin(t)", 0, 0]}', True),
    ('torque: {value: ["-wx", 0, 0], books: heat}', False)])
def test_heat_slows_a_body_and_what_else_has_no_bound_pushes_it(effects, expected):
    assert pushed_unbounded(scene('pivot', effects)) is expected


PULSE = 'torque: {times: [1, 3], values: [[0, 3, 4], [0, 0, 0]]}'


@pytest.mark.parametrize(('constraint', 'least'), [('free', 2.0), (HINGE, 3.18)])
def test_drives_change_where_a_torque_jumps(constraint, least):
    """5 N m from 1 to 3 s; a torque of 2 N m adds to it all the time."""
    both = f'{PULSE}, torque: {{value: [2, 0, 0], frame: world}}'.replace(
        'torque: {times', 'torque: {frame: world, times')
    assert drives(scene(constraint, both)) == [
        (0.0, near(2.0 / least, rel=1e-15)), (1.0, near(7.0 / least, rel=1e-15)),
        (3.0, near(2.0 / least, rel=1e-15))]
    assert drive(scene(constraint, both), None) == near(7.0 / least, rel=1e-15)
    assert drives(scene(constraint, '')) == [(0.0, 0.0)]


def test_where_a_potential_has_no_bounds_a_body_may_swing_with_its_energy():
    """sqrt(2 I U), 8 J: about the hinge 3.18 kg m^2; a free body about its largest moment, 4."""
    torsion = 'spring: {stiffness: 5.0}'
    assert swing_momentum(scene(HINGE, torsion), 8.0) == near(math.sqrt(16.0 * 3.18), rel=1e-14)
    assert swing_momentum(scene('free', SPRING), 8.0) == 8.0
    assert swing_momentum(scene(HINGE, torsion)) == 0.0
    # what gravity can give is known
    held = scene(HINGE, 'gravity: {g: 10}')
    assert swing_momentum(held, 1e9) == swing_momentum(held)


def test_a_body_passes_through_what_torques_gave_until_they_jumped():
    """5 N m for 2 s, then another 3 N m: 10 N m s at 3 s, 13 N m s at 4 s, 100/8 and 169/8 J."""
    stopped = scene(
        'free', 'torque: {times: [1, 3, 4], values: [[0, 3, 4], [0, 0, -3], [0, 0, 0]]}')
    at_rest = 2.0 * 2.0 ** -120, 4.0 * 2.0 ** -60    # 2^-60 rad/s
    assert passed(stopped, 2.9, 0.0) == resting(stopped) == at_rest
    assert passed(stopped, 3.0, 0.0) == (12.5, 10.0)
    assert passed(stopped, 100.0, 0.0) == (169.0 / 8.0, 13.0)
    assert passed(scene('free', TORQUE), 100.0, 0.0) == at_rest
    let_go = scene(HINGE, 'gravity: {g: 10}')
    assert passed(let_go, 1.0, 0.0) == (near(12.0, rel=1e-14), swing_momentum(let_go))


def test_terms_that_may_cancel_are_potentials_and_expressions():
    """1 + tanh is about 1 where tanh passes zero; forces count with their levers."""
    soft = "torque: {value: [0, 0, '3*(1 + tanh(t - 5))']}"
    held = "torque: {value: [0, 0, '1 - 2*angle']}"
    turning, moving = cancelling(scene('free', soft), 100.0)
    assert (turning, moving) == (near(3.0 * 1.3 / 2.0, rel=0.1), 0.0)
    assert cancelling(scene('free', 'torque: {value: [0, 0, 3]}'), 100.0) == (0.0, 0.0)
    hinged = scene(HINGE, f'gravity: {{g: 10}}, {held}')
    assert cancelling(hinged, 100.0) == (
        near(swing_rate(hinged)**2 + 1.0 / 3.18, rel=1e-14), 0.0)
    pushed = "force: {value: ['1 - tanh(t)', 0, 0], at: [0, 0, 3]}"
    lever = math.dist((0.0, 0.0, 3.0), scene('free', soft).body.center_of_mass)
    alone, _ = cancelling(scene('free', "torque: {value: ['1 - tanh(t)', 0, 0]}"), 100.0)
    turning, moving = cancelling(scene('free', pushed), 100.0)
    assert turning == near(lever * alone, rel=1e-14)
    assert moving == near(alone, rel=1e-14)    # the least moment is 2 kg m^2, the mass 2 kg
    # a bearing bears what would move the body
    assert cancelling(scene('pivot', pushed), 100.0)[1] == 0.0


def test_springs_and_potentials_count_as_they_are_at_the_start():
    """2 kg; forces act at an arm about the centre of mass, (0.3, 0, 0.4) m, of at least 2 kg m^2.

    5 (z - 2) N of a potential are 10 N at the origin. The spring pulls with 5 sqrt(2) N at z = 1,
    where 1 - 2 may cancel: 15 N more, and some of its rotation.
    """
    well = scene('free', "potential: {energy: '2.5*(z - 2)^2'}")
    assert cancelling(well, 100.0) == (2.5, 5.0)
    turning, moving = cancelling(scene('free', SPRING), 100.0)
    assert 15.0 + 5.0 * math.sqrt(2.0) <= 2.0 * moving < 40.0
    assert turning == near(math.hypot(0.3, 0.6) * moving, rel=1e-14)
    torsion = scene(HINGE, 'spring: {stiffness: 5.0, angle: 0.7}')
    assert cancelling(torsion, 100.0) == (near(3.5 / 3.18, rel=1e-14), 0.0)


def test_a_magnet_in_a_field_that_changes_counts_and_another_has_bounds():
    """2 A m^2 in 1 + tanh(t - 5) T beside it: about 2 N m where tanh passes zero."""
    moment = 'magnetic: {{moment: [0, 0, 2], field: [{}, 0, 0]}}'.format
    turning, moving = cancelling(scene('free', moment("'1 + tanh(t - 5)'")), 100.0)
    assert 0.9 < turning < 1.5
    assert moving == 0.0
    steady = scene('pivot', moment('3'))
    assert cancelling(steady, 100.0) == (swing_rate(steady)**2, 0.0)


def test_heat_relaxes_a_body_at_the_rate_of_its_wobble_and_down_its_potentials():
    """By c L^2 (1/I_i - 1/I_max), and by c M g r = c 2 10 0.5."""
    heat = 'internal_dissipation: {coefficient: 0.7}'
    free = scene('free', heat)
    assert relaxation(free, 3.0) == near(0.7 * 9.0 * (1.0 / 2.0 - 1.0 / 4.0), rel=1e-14)
    assert falling(free) == relaxation(scene('pivot', ''), 3.0) == 0.0
    assert falling(scene('pivot', f'{heat}, gravity: {{g: 10}}')) == near(7.0, rel=1e-14)
    assert falling(scene('pivot', 'gravity: {g: 10}')) == 0.0
    pulled = scene('pivot', f'{heat}, {SPRING}')
    assert falling(pulled) == math.inf


def test_a_swing_has_the_momentum_of_its_rate_about_the_largest_moment():
    """M g r = 10 J about the origin, where the centre of mass is 0.5 m off."""
    tensor = np.diag([2.0, 3.0, 4.0]) + 2.0 * (0.25 * np.eye(3) - np.outer(*[[0.3, 0, 0.4]] * 2))
    _, middle, most = np.linalg.eigvalsh(tensor)
    assert swing_momentum(scene('pivot', 'gravity: {g: 10}')) == pytest.approx(
        math.sqrt(4.0 * 10.0 / middle) * most)
    assert swing_momentum(scene(HINGE, 'gravity: {g: 10}')) == pytest.approx(
        math.sqrt(4.0 * 2.0 * 10.0 * 0.3 * 3.18))


def test_on_a_plane_a_body_turns_with_the_momentum_of_a_fall_by_its_size():
    egg = parse_scene('scene: s\nbody: {mass: 2, shape: {ellipsoid: {semi_axes: [0.2, 0.3, 0.1]}}}'
                      '\nconstraint: {table: {}}\neffects: [gravity: {g: 10}, sliding_friction: '
                      '{mu: 0.2}]\ninitial: {}\n')
    assert swing_momentum(egg) == pytest.approx(2.0 * 0.3 * math.sqrt(10.0 * 0.3))


def test_the_mean_of_a_rate_that_decays_is_bounded_closely():
    """Its own mean is (r - r')/ln(r/r'): 1.00008 of it are told at a half, 1.0084 at a tenth."""
    for share, most in ((0.5, 1.0001), (0.1, 1.009), (1e-2, 1.1)):
        turned = np.empty(2)
        angles_turned(np.array([0.0, 2.0]), np.array([3.0, 3.0 * share]), math.inf, turned)
        exact = 2.0 * 3.0 * (1.0 - share) / -math.log(share)
        assert turned[0] == 0.0
        assert 1.0 <= turned[1] / exact < most
    # of one that ends in between a sixth of the first rate counts
    angles_turned(np.array([0.0, 2.0]), np.array([3.0, 0.0]), math.inf, turned)
    assert turned[1] == near(1.0, rel=1e-15)


def test_a_run_that_is_not_a_number_has_no_angle():
    turned = np.empty(3)
    for rates in ([1.0, math.nan, 1.0], [1.0, 1.0, math.nan], [math.nan, 1.0, 1.0]):
        angles_turned(np.arange(3.0), np.array(rates), math.inf, turned)
        assert math.isnan(turned[2])


@pytest.mark.parametrize('effect', [
    'torque: {value: [0, 6, 8]}', 'torque: {times: [0], values: [[0, 6, 8]]}',
    # 10 N at 1 m from the centre of mass
    'force: {value: [10, 0, 0], at: [0.3, 0.8, -0.2]}',
    'force: {value: [0, 8, -6], at: [-0.7, 0, 0.4]}',
    'gravity_gradient: {orbit: {rate: 2.0, normal: [0, 0, 1], toward: [1, 0, 0]}}'])
@pytest.mark.parametrize('inertia', [(2.0, 3.0, 4.0), (4.0, 4.0 + 1e-6, 1e-6), (2.0, 2.0, 0.0)])
def test_drives_turn_a_body_about_each_axis_by_the_moment_there(inertia, effect):
    """6 and 8 N m, or 3 n^2/2 times the differences of moments, n = 2 rad/s.

    It is at most all of it about the least moment; about an axis without one no torque turns.
    """
    found = drives(scene('free', effect, inertia))[-1][1]
    torques = (0.0, 6.0, 8.0)
    if 'orbit' in effect:
        torques = 6.0 * (inertia[1] - inertia[2]), 6.0 * (inertia[2] - inertia[0]), 6.0 * (
            inertia[0] - inertia[1])
    expected = math.hypot(*(torque / moment for torque, moment in zip(
        torques, inertia, strict=True) if moment))
    least = min(moment for moment in inertia if moment)
    size = 6.0 * (max(inertia) - min(inertia)) if 'orbit' in effect else 10.0
    assert found == near(min(expected, size / least), rel=1e-8)


@pytest.mark.parametrize('effect', [
    'torque: {value: [0, 6, 8], frame: world}',
    'rotor: {axis: [1, 0, 0], inertia: 1, rate: 1, torque: 10}'])
def test_what_is_not_constant_in_the_body_may_turn_it_about_any_axis(effect):
    slim = scene('free', effect, (4.0, 4.0, 1e-3))
    assert drives(slim) == [(0.0, near(1e4, rel=1e-14))]


def test_a_force_in_world_axes_turns_a_body_about_each_axis_by_its_lever_across_it():
    """0.7 N, 7 m from the centre of mass."""
    force = 'force: {value: [0.2, 0.3, 0.6], at: [2.3, 3, 6.4], frame: world}'
    for inertia in ((4.0, 5.0, 6.0), (4.0, 4.0, 1e-3)):
        moments = [0.7 * math.hypot(*across) / moment for across, moment in zip(
            ((3.0, 6.0), (6.0, 2.0), (2.0, 3.0)), inertia, strict=True)]
        expected = min(math.hypot(*moments), 4.9 / min(inertia))
        assert drives(scene('free', force, inertia)) == [(0.0, near(expected, rel=1e-14))]
    along = force.replace('2.3, 3, 6.4', '0.3, 0, 7.4')
    assert drives(scene('free', along, (4.0, 4.0, 1e-3))) == [
        (0.0, near(math.hypot(4.9 / 4.0, 4.9 / 4.0), rel=1e-14))]


def test_of_a_torque_in_pieces_the_one_that_turns_most_counts_and_none_does_not():
    """0.05 N m across a slim body, 0.05 about it; where it is over, only the first."""
    pieces = 'torque: {times: [0, 1], values: [[0.03, 0.04, 0], LAST]}'
    for last, share in (('[0, 0, 0.05]', 1.0), ('[0, 0, 0]', 1e-3 / 4.0)):
        found = drives(scene('free', pieces.replace('LAST', last), (4.0, 4.0, 1e-3)))
        assert found[0] == (0.0, near(share * 0.05 / 1e-3, rel=1e-14))
