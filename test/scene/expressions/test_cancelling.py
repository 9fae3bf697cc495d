# SPDX-License-Identifier: Apache-2.0
"""Sizes of terms that may cancel, by hand."""

import math

import pytest
from near import near

from rigid_body_sim.scene.expressions import reader
from rigid_body_sim.scene.expressions.cancelling import (
    balancing,
    cancelling,
    cancelling_or_balancing,
)
from rigid_body_sim.scene.expressions.source import STATE_NAMES
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import State


def of(*texts, horizon=100.0, **parameters):
    names = {'t', 'x', 'wx', 'rate', 'angle', 'qx', 'qw', *parameters}
    return cancelling(tuple(reader.read(text, names, 'x') for text in (*texts, '0', '0')[:3]),
                      tuple(parameters.items()), horizon)


@pytest.mark.parametrize(('text', 'expected'), [
    ('3', 0.0), ('3 - 2', 0.0), ('sin(300*t)', 0.0), ('5*exp(-t)', 0.0), ('exp(-t) + 1', 0.0),
    ('exp(-t) - 1', 2.0), ('0.5*(1 + tanh((t - 50)/0.1))', 1.0), ('1 - tanh(t)', 2.0),
    ('-(1 - tanh(t))', 2.0), ('abs(1 - tanh(t))', 2.0), ('(1 - tanh(t))/4', 0.5),
    ('(1 - tanh(t))/(2 + cos(t))', 2.0), ('(1 - tanh(t))/cos(t)', 0.0),
    ('(1 - tanh(t))/(1 + wx^2)', 0.0),
    ('tanh(t - 50) - tanh(t - 60)', 2.0), ('sin(t) + 0.5*cos(t)', 1.5),
    ('(1 - exp(-t))*3', 6.0), ('where(t < 5, 1 - tanh(t), 0)', 2.0),
    ('max(2*(exp(-t) - 1), 1 - tanh(t))', 4.0),
    ('sin(1 - tanh(t))', 0.0), ('(t - 50)^2', 0.0),    # within a function
    ('-5*(angle - 1)', 5.0), ('5 - 5*angle - 2*rate', 5.0),
    ('-k*(angle - 1) - c*rate', 2.0 * 3.0), ('qx*qw - qw', 0.0),
    ('0.5 - 0.1*wx', 0.5), ('wx - rate', 0.0), ('x*(1 - tanh(t))', 0.0)])
def test_sums_whose_terms_may_have_opposite_signs_count(text, expected):
    parameters = {'k': 3.0, 'c': 7.0} if 'k*' in text else {}
    found = of(text, **parameters)
    # the terms count where they are smallest; a term that is 1 elsewhere is there a third at least
    assert 0.2 * expected <= found <= (1.0 + 1e-12) * expected
    assert (found > 0.0) == (expected > 0.0)


def test_what_explodes_later_is_no_reason_to_follow_less_closely_now():
    assert 3.0 < of('exp(50*t) - 2', horizon=5.0) < 5.0


def test_the_time_goes_up_to_the_horizon():
    assert of('t - 3', horizon=4.0) == near(3.0 + 4.0 / 256, rel=1e-12)
    assert of('sin(t) + 0.5', horizon=3.0) == 0.0
    assert 0.5 < of('sin(t) + 0.5', horizon=4.0) < 0.6


HELD = parse_scene("""
scene: held
body: {mass: 2.0, inertia: [1.0, 1.0, 1.0], center_of_mass: [0.0, 0.0, 0.5]}
constraint: {hinge: {axis: [1, 0, 0]}}
effects: []
initial: {angle: 0.75}
""")
HUNG = parse_scene("""
scene: hung
body: {mass: 2.0, inertia: [1.0, 1.0, 1.0]}
constraint: {pivot: {at: [0, 0, 0.5]}}
effects: []
initial: {orientation: [1, 0, 0, 1]}
""")
FREE = parse_scene("""
scene: free
body: {mass: 2.0, inertia: [1.0, 1.0, 1.0], center_of_mass: [0.0, 0.0, 0.5]}
constraint: free
effects: []
initial: {orientation: [1, 0, 0, 0], position: [0.1, 0.2, 0.3]}
""")


@pytest.mark.parametrize(('scene', 'text', 'expected'), [
    (HELD, '-5*angle', 3.75), (HELD, '-5*(angle - 1)', 1.25 + 5.0 * 1.75),
    (HELD, '-5*angle - 2*rate', 3.75), (HELD, '7', 0.0), (HELD, '-2*rate', 0.0),
    (FREE, '10*z', 3.0), (FREE, '10*(z - 0.5)', 10.0 * (0.3 + 0.5) + 2.0), (FREE, '3*x + y', 0.5),
    # a quarter turn about x: the body's origin is 0.5 m before the pivot along y
    (HUNG, '2*y', 1.0),
    (FREE, 'vz + 2*qx', 2.0)])
def test_laws_of_the_place_count_where_a_body_starts(scene, text, expected):
    """Others balance what they give there, if the body rests."""
    tree = reader.read(text, STATE_NAMES, 'x')
    zero = reader.read('0', STATE_NAMES, 'x')
    found = balancing((tree, zero, zero), (), scene.frame, scene.initial, 100.0)
    assert found == near(expected, rel=1e-15)
    # of a body that moves what may cancel counts, wherever it is
    for place in (7, 12):
        vector = scene.initial.vector.copy()
        vector[place] = 1e-3
        law = (tree, zero, zero), (), scene.frame, State(vector), 100.0
        assert balancing(*law) == 0.0
        assert cancelling_or_balancing(*law) == (
            5.0 if ' - 1)' in text or ' - 0.5)' in text else 0.0)


def test_three_components_are_a_vector():
    one = of('exp(-t) - 1')
    assert of('exp(-t) - 1', '0', '2*(exp(-t) - 1)') == near(math.sqrt(5.0) * one, rel=1e-15)
