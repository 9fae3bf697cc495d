# SPDX-License-Identifier: Apache-2.0
"""Held and free bodies with rotors and constant forces, in closed form: matched by what acts."""

import json
import pathlib
import sys

import numpy as np
import pytest
from mpmath import mpf

from rigid_body_sim.mechanics.pulls import weight_of
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.numerics.rotations import angle_between, multiply, rotate
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'data'))
from heavy_body import Flow

pytestmark = pytest.mark.without_numba

TOP = {'mass': 2.0, 'inertia': [0.03, 0.03, 0.01], 'center_of_mass': [0.0, 0.0, 0.1]}
STANDING = {'mass': 2.0, 'inertia': [0.01, 0.03, 0.03], 'center_of_mass': [-0.1, 0.0, 0.0]}
OTHER = {'mass': 2.0, 'inertia': [0.03, 0.05, 0.07], 'center_of_mass': [0.1, 0.02, 0.05]}
BALANCED = {'mass': 2.0, 'inertia': [0.03, 0.03, 0.01]}
SPHERE = {'mass': 2.0, 'inertia': [0.03, 0.03, 0.03]}
HINGE = {'hinge': {'axis': [1.0, 0.0, 0.0], 'through': [0.0, 0.01, 0.0]}}
START = {'orientation': [0.1, 0.5, -0.2, 0.8], 'angular_velocity': [1.0, 0.5, 30.0]}
SWING = {'orientation': [0.1, 0.5, -0.2, 0.8], 'rate': 3.0}
GRAVITY = {'gravity': {'g': 9.81}}
TIMES = 0.0, 0.3, 1.7, 20.0


def rotor(*axis, momentum=0.4):
    return {'rotor': {'axis': list(axis), 'momentum': momentum}}


def force(*value, **more):
    return {'force': {'value': list(value), 'frame': 'world', **more}}


def scene_of(body, constraint, effects, start=None):
    """Return a scene."""
    start = start or (SWING if isinstance(constraint, dict) else START)
    return parse_scene(json.dumps({'scene': 'x', 'body': body, 'constraint': constraint,
                                   'effects': effects, 'initial': start}))


def apart(one, other, times=TIMES):
    """Return the largest angle between the attitudes of two scenes, rad."""
    first, second = (Simulation(scene, integrator='exact').states(times) for scene in (one, other))
    return max(angle_between(*p, *q)
               for p, q in zip(first.orientation, second.orientation, strict=True))


@pytest.mark.parametrize(('motion', 'body', 'constraint', 'effects'), [
    ('lagrange_top', TOP, 'pivot', [GRAVITY, rotor(0, 0, 1)]),
    ('lagrange_top', STANDING, 'pivot', [GRAVITY, rotor(1, 0, 0), rotor(-2, 0, 0)]),
    ('lagrange_top', BALANCED, 'pivot', [GRAVITY, rotor(0, 0, -1)]),
    ('lagrange_top', TOP, 'pivot', [GRAVITY, force(0, 0, -5)]),
    ('leaning_top', TOP, 'pivot', [GRAVITY, force(0, 0, 50)]),
    ('leaning_top', TOP, 'pivot', [GRAVITY, force(3, 0, 0), rotor(0, 0, 1)]),
    ('leaning_top', STANDING, 'pivot', [{'gravity': {'g': [1, 2, 3]}}]),
    ('damped_body', OTHER, 'pivot', [GRAVITY, force(0, 0, 19.62)]),
    ('damped_body', OTHER, 'free', [GRAVITY, force(1, 2, -3)]),
    ('driven_body', BALANCED, 'free', [GRAVITY, rotor(0, 0, 1)]),
    ('driven_body', BALANCED, 'free', [rotor(0, 0, 1), {'torque': {'value': [0, 0, -0.1]}}]),
    ('driven_body', SPHERE, 'free', [rotor(1, 2, 3)]),
    ('driven_body', SPHERE, 'free', [rotor(1, 2, 2), {'torque': {'value': [-1, -2, -2]}}]),
    ('driven_body', BALANCED, 'pivot', [
        {'force': {'value': [0.3, 0, 0], 'at': [0, 0.2, 0]}}, {'force': {'value': [5, 4, 3]}}]),
    ('pendulum', OTHER, HINGE, [GRAVITY, rotor(0.3, 0.2, 1)]),
    ('pendulum', OTHER, HINGE, [GRAVITY, force(0, 0, -5)]),
    ('leaning_pendulum', OTHER, HINGE, [GRAVITY, force(0, 3, 0)]),
    ('leaning_pendulum', OTHER, HINGE, [{'gravity': {'g': [1, 2, 3]}}, rotor(0, 0, 1)]),
    (None, TOP, 'pivot', [GRAVITY, rotor(0, 1e-9, 1)]),
    (None, OTHER, 'pivot', [rotor(0, 0, 1)]),
    (None, TOP, 'pivot', [GRAVITY, force(0, 0, -5, at=[0, 0, 0.2])]),
    ('lagrange_top', TOP, 'pivot', [GRAVITY, {'force': {'value': [0, 0, -5]}}]),
    (None, TOP, 'pivot', [GRAVITY, {'force': {'value': [0, 1, -5]}}]),
    (None, SPHERE, 'free', [rotor(1, 2, 2), {'torque': {'value': [1, 0, 0]}}]),
    (None, SPHERE, 'free', [rotor(1, 2, 2),
                            {'torque': {'value': [1, 0, 0], 'frame': 'world'}}]),
    (None, TOP, 'free', [rotor(0, 1, 1)]),
    (None, BALANCED, 'free', [{'force': {'value': [0, 0, -5]}}])])
def test_what_acts_decides(motion, body, constraint, effects):
    """A rotor along the axis of a top, and forces at the centre of mass in world axes."""
    found = absorbing_motion(scene_of(body, constraint, effects))
    assert (found and found.__name__.rpartition('.')[-1]) == motion


@pytest.mark.parametrize('momentum', [0.4, -0.31, 1e-7])
@pytest.mark.parametrize(('body', 'axis'), [(TOP, (0, 0, 1)), (STANDING, (1, 0, 0))])
def test_a_top_with_a_rotor_meets_the_equations_of_motion(body, axis, momentum):
    """The full equations in 30 digits: I omega' = (I omega + h) x omega - M g c x gamma."""
    scene = scene_of(body, 'pivot', [GRAVITY, rotor(*axis, momentum=momentum)])
    h = [mpf(momentum) * one for one in axis]
    arm = [mpf(2.0) * mpf(9.81) * mpf(one) for one in scene.body.center_of_mass]
    flow = Flow(100, [mpf(one) for one in scene.body.about_origin.moments], arm, h)
    flow.start(scene.initial.orientation, scene.initial.angular_velocity)
    found = Simulation(scene).states(TIMES[:3])
    for time, q, omega in zip(TIMES, found.orientation, found.angular_velocity, strict=False):
        attitude, rates = flow.go(time)
        # worst measured: 1.2e-15 rad, 4e-15 of the rates
        assert angle_between(*q, *map(float, attitude)) <= 8e-15
        assert np.abs(omega - np.array(rates, float)).max() <= 2e-14 * 30.0


@pytest.mark.parametrize(('body', 'constraint', 'start'), [
    (TOP, 'pivot', START), (STANDING, 'pivot', START), (OTHER, HINGE, SWING)])
@pytest.mark.parametrize('direction', [(1.0, -2.0, 3.0), (0.0, 0.0, 1.0), (-1.0, 1e-9, -1e-9)])
def test_a_leaning_weight_is_a_weight_in_a_turned_world(body, constraint, start, direction):
    """The same motion, turned by hand, with gravity along -z."""
    g = 7.3 * np.array(direction) / np.linalg.norm(direction)
    leaning = scene_of(body, constraint, [{'gravity': {'g': g.tolist()}}], start)
    down, z = g / np.linalg.norm(g), np.array([0.0, 0.0, -1.0])
    half = down + z if np.abs(down + z).max() > 1e-3 else np.array([1.0, 0.0, 0.0])
    x, y, w = half / np.linalg.norm(half)
    turn = (x, y, w, 0.0)    # half a turn about the middle of both directions
    assert np.abs(np.array(rotate(*turn, *down)) - z).max() < 1e-15
    straight = scene_of(body, constraint, [{'gravity': {'g': 7.3}}], start | {
        'orientation': list(multiply(*turn, *leaning.initial.orientation))})
    found, expected = (Simulation(scene, integrator='exact').states(TIMES)
                       for scene in (leaning, straight))
    for q, p, v, u in zip(found.orientation, expected.orientation, found.velocity,
                          expected.velocity, strict=True):
        # a start turned by hand is rounded: worst measured 2e-14 in 20 s of 30 rad/s
        assert angle_between(*multiply(*turn, *q), *p) < 2e-13
        assert np.abs(np.array(rotate(*turn, *v)) - u).max() < 2e-13


@pytest.mark.parametrize(('one', 'other'), [
    (scene_of(TOP, 'pivot', [GRAVITY, force(0, 0, -5)]),
     scene_of(TOP, 'pivot', [{'gravity': {'g': 9.81 + 2.5}}])),
    (scene_of(OTHER, HINGE, [GRAVITY, force(0, 0, -5), rotor(0.3, 0.2, 1)]),
     scene_of(OTHER, HINGE, [{'gravity': {'g': 9.81 + 2.5}}])),
    (scene_of(OTHER, 'pivot', [GRAVITY, force(0, 0, 19.62)]), scene_of(OTHER, 'pivot', [])),
    (scene_of(BALANCED, 'free', [rotor(0, 0, 1)]), scene_of(BALANCED, 'pivot', [rotor(0, 0, 1)])),
    (scene_of(SPHERE, 'free', [rotor(1, 2, 3)]), scene_of(SPHERE, 'pivot', [
        rotor(1, 2, 3), {'torque': {'value': [1e-300, 2e-300, 3e-300]}}]))],
    ids=['top', 'pendulum', 'no weight', 'two closed forms', 'sphere'])
def test_scenes_that_say_the_same_move_alike(one, other):
    # worst measured: 2e-14
    assert apart(one, other) < 2e-13


@pytest.mark.parametrize(('body', 'constraint', 'effects', 'works'), [
    (TOP, 'pivot', [GRAVITY, rotor(0, 0, 1)], False),
    (TOP, 'pivot', [GRAVITY, force(3, 0, -1), rotor(0, 0, 1)], True),
    (OTHER, 'pivot', [GRAVITY, force(0, 0, 19.62)], True),
    (OTHER, HINGE, [GRAVITY, force(0, 3, 0), rotor(0, 0, 1)], True),
    (BALANCED, 'free', [GRAVITY, force(1, 2, -3), rotor(0, 0, 1)], True)])
def test_the_ledger_knows_work_and_rotors(body, constraint, effects, works):
    """A force that a scene lists does work, though it is as good as weight for the motion."""
    simulation = Simulation(scene_of(body, constraint, effects), rate=10.0)
    assert simulation.choice.method == 'exact'
    simulation.advance(7)
    work = abs(simulation.ledger()['work'])
    assert work > 1e-3 if works else work < 1e-14
    simulation.impulse(torque=(1e-2, 2e-2, 0.0))
    simulation.advance(30)
    ledger = simulation.ledger()
    # worst measured: 2e-15
    assert abs(ledger['energy_residual']) < 1e-14
    assert ledger['momentum_residual'] < 1e-14


def test_a_force_that_cancels_the_weight_but_for_rounding_leaves_none():
    """3 g is no double: what is left of it is rounding, and no weight of 3e-15 N."""
    heavy = {**TOP, 'mass': 3.0}
    scene = scene_of(heavy, 'pivot', [GRAVITY, force(0, 0, 3 * 9.81)])
    assert weight_of(scene) == 0
    assert weight_of(scene_of(heavy, 'pivot', [GRAVITY, force(0, 0, 29.4)])) > 0.009
    assert weight_of(scene_of(heavy, 'pivot', [GRAVITY, force(0, 0, 29.5)])) is None
