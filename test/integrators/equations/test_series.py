# SPDX-License-Identifier: Apache-2.0
"""The numbers that power series of a turning body take of what acts, and which scenes have any."""

import numpy as np
import pytest
from mechanics.contact.test_touch import scene_of
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations.series import (
    SERIES,
    Series,
    has_formulas,
    has_phases,
)
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

GRAVITY, DRAG = 'gravity: {g: [1, 2, -3]}', 'drag: {linear: 0.3}'
FORCE = 'force: {value: [1, 2, -6], at: [0.1, -0.2, 0.3]}'
TORQUE = 'torque: {value: [0.1, 0.2, -0.4]}'


def scene(effects, constraint='free'):
    """Return a scene of 2 kg whose centre of mass lies beside its origin."""
    return parse_scene(
        'scene: s\nbody: {mass: 2.0, inertia: [3.0, 4.0, 5.0], center_of_mass: [0.7, 0.2, -0.3]}\n'
        f'constraint: {constraint}\neffects: [{", ".join(effects)}]\ninitial: {{}}\n')


@pytest.mark.parametrize(('effects', 'constraint', 'falls', 'pushed'), [
    ([GRAVITY], 'free', True, False), ([DRAG], 'free', True, False),
    ([DRAG, TORQUE], 'free', True, False), ([TORQUE], 'free', False, False),
    ([GRAVITY], 'pivot', False, True),
    ([GRAVITY, TORQUE], 'pivot', False, True), ([GRAVITY, TORQUE], 'free', True, False),
    ([TORQUE], 'pivot', False, False)])
def test_a_free_body_falls_under_forces_and_one_that_is_held_is_turned_by_them(
        effects, constraint, falls, pushed):
    one = Series(scene(effects, constraint))
    assert (one.falls, one.pushed) == (falls, pushed)


def test_a_fall_is_that_of_the_force_and_the_drag_over_the_mass():
    held = SERIES.load(Series(scene([GRAVITY, DRAG])).parameters(0.0).tolist())
    assert held.falling.fall.a == near((1.0, 2.0, -3.0), rel=1e-15)
    assert held.falling.fall.slowing == near(0.15, rel=1e-15)
    assert held.force == near((2.0, 4.0, -6.0), rel=1e-15)


@pytest.mark.parametrize('q', [(0.0, 0.0, 0.0, 1.0), (0.1, -0.5, 0.5, 0.7)])
def test_a_force_turns_a_held_body_by_its_arm_over_the_moments(q):
    """By I^-1 (T + r x R^-1 F), of which the series have the product with R^-1 F apart."""
    one = Series(scene([GRAVITY, TORQUE], 'pivot'))
    held = SERIES.load(one.parameters(0.0).tolist())
    fx, fy, fz = rotate_back(*q, *held.force)
    found = np.array([held.pull[0] * fy + held.pull[1] * fz, held.pull[2] * fz + held.pull[3] * fx,
                      held.pull[4] * fx + held.pull[5] * fy])
    # about the pivot: 2 kg beside it by (0.7, 0.2, -0.3) m
    arm = np.array([0.7, 0.2, -0.3])
    tensor = np.diag([3.0, 4.0, 5.0]) + 2.0 * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    moments, axes = np.array(one.frame.moments), one.frame.axes
    assert sorted(moments) == near(np.linalg.eigvalsh(tensor), rel=1e-14)
    turned = np.cross(rotate_back(*axes, *arm), (fx, fy, fz)) / moments
    assert found == pytest.approx(turned, abs=1e-14)
    assert held.constant == pytest.approx(rotate_back(*axes, 0.1, 0.2, -0.4) / moments, abs=1e-15)


def test_a_couple_of_the_world_and_a_hinge_are_told():
    couple = Series(scene([GRAVITY, 'torque: {frame: world, value: [0.1, 0.2, -0.4]}']))
    hinged = Series(scene([GRAVITY], '{hinge: {axis: [0, 0, 1]}}'))
    assert (couple.coupled, couple.hinged) == (True, False)
    assert (hinged.coupled, hinged.hinged) == (False, True)


def test_one_drag_on_the_turns_is_enough_to_have_some():
    slowed = 'drag: {angular: 0.2}'
    assert [Series(scene(effects)).dragged for effects in (
        [GRAVITY, slowed], [slowed, TORQUE], [GRAVITY, TORQUE])] == [True, True, False]


@pytest.mark.parametrize('axis', [
    (0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (0.0, 0.8, 0.6), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0),
    (0.0, 0.6, -0.8), (2.0 / 7.0, -3.0 / 7.0, -6.0 / 7.0), (0.0, 0.0, -1.0)])
def test_a_hinge_is_the_third_axis_of_its_frame_up_or_down(axis):
    """Its moment is n . I n and M times the square of the distance of the centre from it."""
    frame = Series(scene([GRAVITY], f'{{hinge: {{axis: {list(axis)}}}}}')).frame
    up, arm = np.array(axis) if axis[2] >= 0.0 else -np.array(axis), np.array([0.7, 0.2, -0.3])
    assert rotate(*frame.axes, 0.0, 0.0, 1.0) == pytest.approx(up, abs=1e-15)
    assert np.linalg.norm(frame.axes) == near(1.0, rel=1e-15)
    moment = up @ np.diag([3.0, 4.0, 5.0]) @ up + 2.0 * np.sum(np.cross(up, arm) ** 2)
    assert frame.moments == near((0.0, 0.0, moment), rel=1e-14)
    away = np.cross(up, rotate(*frame.axes, *frame.arm))
    assert away == pytest.approx(np.cross(up, arm), abs=1e-15)


@pytest.mark.parametrize(('effects', 'have'), [
    ([GRAVITY], False), ([GRAVITY, "torque: {value: ['wx', 0, 0]}"], True),
    ([GRAVITY, 'internal_dissipation: {coefficient: 0.02}'], False)])
def test_one_formula_is_enough_to_have_some(effects, have):
    assert has_formulas(scene(effects)) is have


def test_one_effect_without_series_is_enough_to_refuse():
    with pytest.raises(BadInput, match='taylor cannot run the scene s'):
        Series(scene([GRAVITY, 'internal_dissipation: {coefficient: 0.02}']))


@pytest.mark.parametrize(('laws', 'effects', 'have'), [
    (', sliding_friction: {mu: 0.3}', '', True), ('', '', True),
    (', rolling_friction: {viscous: 0.02}', '', True),
    (', sliding_friction: {mu: 0.3}, rolling_friction: {dry: 0.01}', '', False),
    (', sliding_friction: {mu: 0.3}, spinning_friction: {radius: 0.02}', '', False),
    (', sliding_friction: {mu: 0.3}', ', torque: {value: [0.1, 0, 0]}', False),
    (', sliding_friction: {mu: 0.3}', ', drag: {linear: 0.2}', False)])
def test_a_phase_on_a_plane_has_series_under_fields_alone(laws, effects, have):
    assert has_phases(scene_of('ellipsoid', effects + laws)) is have
