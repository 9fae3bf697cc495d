# SPDX-License-Identifier: Apache-2.0
"""Predicted lines against formulas worked out by hand, or another form of them."""

import math
import types

import pytest
from near import near
from scipy.special import ellipk

from rigid_body_sim.analysis import lines
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import parse_scene

HALF = math.sqrt(0.5)
ALONG, ABOUT_X = (0.0, 0.0, 0.0, 1.0), (HALF, 0.0, 0.0, HALF)    # principal axes in the body's


def inertia(*moments, axes=ALONG):
    return types.SimpleNamespace(moments=moments, axes=axes)


def told(found):
    """Return name -> (frequency times 2 pi, axes, components)."""
    return {line.name: (math.tau * line.frequency, line.axes, line.components) for line in found}


@pytest.mark.parametrize(('body', 'omega', 'slow', 'fast'), [
    # equal moments I and the other, J: w_J |J - I|/I in the body, |L|/I in space
    (inertia(2.0, 2.0, 3.0), (1.0, 2.0, 4.0), 2.0, math.sqrt(164.0) / 2.0),
    (inertia(2.0, 2.0, 3.0, axes=ABOUT_X), (1.0, 4.0, 2.0), 2.0, math.sqrt(164.0) / 2.0),
    (inertia(2.0, 1.0, 2.0), (3.0, 4.0, 5.0), 2.0, math.sqrt(152.0) / 2.0)])
def test_a_free_symmetric_top(body, omega, slow, fast):
    found = told(lines._free(body, omega))
    assert found == {'Ω = ω₃(I₃-I₁)/I₁': (near(slow, 1e-14), 'body', (0, 1, 2)),
                     'L/I₁': (near(fast, 1e-14), 'world', (0, 1, 2))}


def test_a_free_asymmetric_top_has_three_harmonics_of_its_period():
    """4 K(k)/lambda, with lambda and k of Landau and Lifshitz, section 37, for L^2 > 2 E I2."""
    (I1, I2, I3), (w1, w2, w3) = (1.0, 2.0, 3.0), (1.0, 0.5, 2.0)
    twice_E = I1 * w1**2 + I2 * w2**2 + I3 * w3**2
    square = (I1 * w1)**2 + (I2 * w2)**2 + (I3 * w3)**2
    rate = math.sqrt((I3 - I2) * (square - twice_E * I1) / (I1 * I2 * I3))
    m = (I2 - I1) * (twice_E * I3 - square) / ((I3 - I2) * (square - twice_E * I1))
    found = told(lines._free(inertia(2.0, 3.0, 1.0), (w2, w3, w1)))
    for k in (1, 2, 3):
        expected = math.tau * k * rate / (4.0 * ellipk(m))
        assert found.pop(f'{k}/T') == (near(expected, 1e-12), 'body', (0, 1, 2))    # 3e-16
    assert not found


TOP = """
scene: top
body: {{mass: 2.0, inertia: [3.0, 3.0, 4.0], inertia_about: origin, center_of_mass: [0, 0, 0.5]}}
constraint: pivot
effects: [gravity: {{g: {g}}}]
initial: {{euler_zyz: [0.0, 1.0, 0.0], angular_velocity: [{sine}, 0, {along}]}}
"""


@pytest.mark.parametrize('sign', [1, -1])
def test_a_top_that_precesses_evenly(sign):
    """A steady precession W at an angle a obeys I1 W^2 cos a - I3 w3 W + M g l = 0.

    Of the world's components of omega only the horizontal ones change then, with W.
    """
    rate, angle = 0.5 * sign, 1.0
    along = (3.0 * rate**2 * math.cos(angle) + 2.0 * 10.0 * 0.5) / (4.0 * rate)
    scene = parse_scene(TOP.format(g=10.0, sine=-rate * math.sin(angle), along=along))
    found = told(lines.predicted_lines(scene))
    assert found['precession'] == (near(0.5, 1e-9), 'world', (0, 1))            # 1e-15
    if 'nutation' in found:
        assert found['nutation'][1:] == ('world', (2,))


def test_the_nutation_of_a_fast_top():
    """Small nutation of a fast top: I3 w3/I1, here up to M g l/(I1 w3^2), 3e-6, of it."""
    scene = parse_scene(TOP.format(g=10.0, sine=0.0, along=1e3))
    found = told(lines.predicted_lines(scene))
    assert found['nutation'] == (near(4e3 / 3.0, 1e-5), 'world', (2,))          # 1e-6
    assert found['precession'] == (near(10.0 / 4e3, 1e-5), 'world', (0, 1))     # 1e-6


def test_a_body_held_at_a_point_without_weight_turns_about_it():
    """Of the moments those about the point count, 3 and 4, not those about the centre of mass."""
    found = told(lines.predicted_lines(parse_scene(TOP.format(g=0.0, sine=0.0, along=6.0))))
    assert found['Ω = ω₃(I₃-I₁)/I₁'][0] == near(2.0, 1e-14)
    assert found['L/I₁'][0] == near(8.0, 1e-14)


PENDULUM = """
scene: pendulum
body: {{mass: 2.0, inertia: [3.0, 3.0, 0.5], center_of_mass: [0, 0, -0.5]}}
constraint: {{hinge: {{axis: [0, 1, 0], distance: 0.5}}}}
effects: [gravity: {{g: {g}}}]
initial: {{angle: {angle}{more}}}
"""


@pytest.mark.parametrize(('angle', 'rate', 'm'), [
    # m = sin^2(amplitude/2) = (I w^2/2 + M g l (1 - cos(angle)))/(2 M g l), I = 3.5, M g l = 10
    (1.0, 0.0, math.sin(0.5)**2), (0.0, 2.0, 0.35),
    (1.0, -2.0, 0.35 + math.sin(0.5)**2)])
def test_a_pendulum_swings_with_its_period_at_its_amplitude(angle, rate, m):
    scene = parse_scene(PENDULUM.format(g=10.0, angle=angle, more=f', rate: {rate}'))
    expected = math.tau / (4.0 * ellipk(m) * math.sqrt(3.5 / 10.0))
    assert told(lines.predicted_lines(scene)) == {
        '1/T': (near(expected, 1e-12), 'body', (0, 1, 2))}


@pytest.mark.parametrize(('g', 'angle', 'rate'), [
    (10.0, 0.0, 0.0), (10.0, 0.0, 4.0), (0.0, 1.0, 1.0)])
def test_a_pendulum_at_rest_or_going_round_or_without_weight_does_not_swing(g, angle, rate):
    """It goes round from I w^2/2 > 2 M g l on, here from 3.4 rad/s."""
    scene = parse_scene(PENDULUM.format(g=g, angle=angle, more=f', rate: {rate}'))
    assert lines.predicted_lines(scene) == ()


@pytest.mark.parametrize(('share', 'g'), [(0.8, 10.0), (0.8, 0.1), (0.5, 10.0)])
def test_an_inclined_pendulum_feels_that_share_of_its_weight_which_is_across_its_axis(share, g):
    """Its centre of mass is 0.5 m from the axis and 0.3 m along it, which does not count."""
    turn = f'[{-0.5 * math.pi}, {math.acos(share)}, {0.5 * math.pi}]'    # about x
    text = PENDULUM.format(g=g, angle=1.0, more=f', euler_zyz: {turn}')
    scene = parse_scene(text.replace('center_of_mass: [0, 0, -0.5]',
                                     'center_of_mass: [0, 0.3, -0.5]'))
    expected = math.tau / (4.0 * ellipk(math.sin(0.5)**2) * math.sqrt(3.5 / (share * g)))
    assert told(lines.predicted_lines(scene)) == {
        '1/T': (near(expected, 1e-12), 'body', (0, 1, 2))}


def stand_in(mechanism, weight, strikes=()):
    """Return a scene that is told by its mechanism alone."""
    return types.SimpleNamespace(
        weight=weight, strikes=strikes, initial=types.SimpleNamespace(angular_velocity=(0, 1, 2)),
        constraint=types.SimpleNamespace(mechanism=mechanism),
        body=types.SimpleNamespace(about_center=inertia(2.0, 2.0, 3.0)))


def test_nothing_is_predicted_for_a_scene_that_theory_does_not_know():
    assert len(lines.predicted_lines(stand_in(Mechanism.FREE, 9.81))) == 2
    assert len(lines.predicted_lines(stand_in(Mechanism.FREE, 0.0))) == 2
    for scene in (None, stand_in(Mechanism.FREE, None), stand_in(Mechanism.FREE, 0.0, ('one',)),
                  stand_in(Mechanism.TABLE, 9.81), stand_in(Mechanism.PLANE, 9.81),
                  stand_in(Mechanism.PLANE, 0.0)):
        assert lines.predicted_lines(scene) == ()
