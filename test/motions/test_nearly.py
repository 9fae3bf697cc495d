# SPDX-License-Identifier: Apache-2.0
"""Tops whose moments differ in the last digits: taken as symmetric, with a known error."""

import json
import math
import pathlib
import sys
import types

import numpy as np
import pytest
from mpmath import mpf
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.motions import nearly
from rigid_body_sim.motions.nearly import nearly_absorbing
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'data'))
from heavy_body import Flow

SLOW = {'initial': {'euler_zyz': [0.0, 1.5, 0.3], 'angular_velocity': [0.1, 0.2, 0.0]}}
OVER = {'initial': {'euler_zyz': [0.0, 3.1, 0.3], 'angular_velocity': [11.0, 0.0, 0.0]}}


def top(difference, **changes):
    """Return a heavy top whose first two moments differ by that share."""
    return load_scene('heavy_top', {'body.inertia': [0.03, 0.03 * (1.0 + difference), 0.01],
                                    **changes})


def error_of(simulation, times):
    """Return the largest error of the attitude (rad) at times, by 30 digits."""
    scene = simulation.scene
    flow = Flow(100, [mpf(moment) for moment in scene.body.about_origin.moments],
                [mpf(scene.body.mass) * mpf(9.81) * mpf(x) for x in scene.body.center_of_mass])
    flow.start(scene.initial.orientation, scene.initial.angular_velocity)
    return max(angle_between(*q, *map(float, flow.go(time)[0]))
               for time, q in zip(times, simulation.states(times).orientation, strict=True))


@pytest.mark.without_numba
def test_moments_that_differ_in_the_last_digit_take_the_closed_form():
    """One part in 1e15, at default settings: the error over 100 s stays below what is asked."""
    simulation = Simulation(top(1e-15))
    assert simulation.choice.method == 'exact'
    assert simulation.choice.expected_error < 1e-12
    # worst measured: 3e-16
    assert error_of(simulation, [1.0]) <= 1e-15
    simulation.advance(1000)
    assert abs(simulation.ledger()['energy_residual']) <= 5e-15


@pytest.mark.parametrize('start', [SLOW, OVER])
@pytest.mark.parametrize('difference', [1e-14, 1e-11])
def test_the_expected_error_knows_what_is_left_out(start, difference):
    """A slow top's spin is not kept by unequal moments: the error grows as the time squared."""
    simulation = Simulation(top(difference, **start), accuracy=1e-6, horizon=2.0)
    assert simulation.choice.method == 'exact'
    found = error_of(simulation, [1.0, 1.5, 2.0])
    floor = 1e-14
    # measured: 2.0 to 2.6 times
    assert found <= simulation.choice.expected_error <= 6.0 * found + floor


def rounded_needle():
    """Return a needle whose two large moments are one double at the pivot, but not exactly."""
    return parse_scene(json.dumps({
        'scene': 'needle', 'constraint': 'pivot', 'effects': [{'gravity': {'g': 1.0}}],
        'body': {'mass': 0.5, 'inertia': [0.037, math.nextafter(0.037, 1.0), 3.7e-8],
                 'center_of_mass': [0, 0, 0.25]},
        'initial': {'orientation': [0.1, 0.5, -0.2, 0.8], 'angular_velocity': [3, -2, 1]}}))


@pytest.mark.without_numba
def test_what_the_parallel_axis_theorem_rounds_away_counts_for_a_needle():
    """I1 - I2 = 7e-18 kg m^2 spins it about an axis of 4e-8, by w1 w2 t^2/2 times that."""
    scene, horizon = rounded_needle(), 5.0
    I1, I2, _ = scene.body.about_origin.moments
    assert I1 == I2 and scene.body.about_origin.differences[2] == near(-2.0 ** -57, 1e-9)
    choice = choose(scene, 'exact', accuracy=1e-6, horizon=horizon)
    # measured: 2.5e-9 by 64-bit mantissas
    assert 1e-9 < choice.expected_error < 1e-8
    assert choose(scene, accuracy=1e-6, horizon=horizon).method == 'exact'
    # too long for the sum of what is left out: nobody knows
    assert choose(scene, 'exact', horizon=1e5).expected_error == math.inf


@pytest.mark.without_numba
@pytest.mark.parametrize(('start', 'floor'), [
    (SLOW['initial'], 1e-14), ({'tilt': 0.5, 'angular_velocity': [1.0, 0.5, 30.0]}, 1e-14),
    ({'tilt': 0.0, 'angular_velocity': [0.0, 0.0, 1.0]}, 2e-11)],    # half an ulp of the start
    ids=['slow', 'spins', 'upright'])
@pytest.mark.parametrize('off', [1e-17, 1e-13])
def test_a_centre_of_mass_beside_the_axis_is_known_too(start, floor, off):
    """It pulls an upright top over, which would stand for ever without it."""
    scene = load_scene('heavy_top', {
        'body.center_of_mass': [off, -0.3 * off, 0.1], 'initial': start})
    simulation = Simulation(scene, integrator='exact', accuracy=1e-6, horizon=2.0)
    found = error_of(simulation, [1.0, 1.5, 2.0])
    # measured: 1.3 to 2.5 times
    assert found <= simulation.choice.expected_error + floor <= 3.0 * found + 2.0 * floor
    limit = simulation.choice.expected_error
    assert choose(scene, accuracy=2.0 * max(limit, 1e-12), horizon=2.0).method == 'exact'


def test_a_centre_of_mass_that_would_show_is_left_to_methods():
    """An upright top with a seed of 1e-13 m falls; one part in 1e9 is too far from the axis."""
    falls = {'tilt': 0.0, 'angular_velocity': [0.0, 0.0, 1.0]}
    for off, accuracy in ((1e-13, 1e-9), (1e-9, 1e-2)):
        found = nearly_absorbing(load_scene('heavy_top', {
            'body.center_of_mass': [off, 0.0, 0.1], 'initial': falls}), 2.0)
        assert found is None or found.error > accuracy


@pytest.mark.without_numba
@pytest.mark.parametrize(('time', 'method'), [(1.0, 'taylor'), (5.0, 'exact')])
def test_a_top_that_is_struck_on_its_way_is_left_to_methods(time, method):
    """Upright it is told 5e-15; struck, it errs by 4e-12, which was told as 2e-13."""
    scene = load_scene('heavy_top', {
        'body.inertia': [0.1, 0.1 * (1.0 + 1e-11), 0.06],
        'initial': {'tilt': 0.001, 'spin': 3.0},
        'effects': [{'gravity': {'g': 3.7}},
                    {'strike': {'impulse': [0.08, -0.05, 0.03], 'point': [0.03, -0.04, 0.1],
                                'time': time, 'frame': 'body'}}]})
    assert choose(scene, accuracy=1e-11, horizon=4.0).method == method
    told = choose(scene, 'exact', accuracy=1e-11, horizon=4.0).expected_error
    assert (told == math.inf) == (time < 4.0)


@pytest.mark.parametrize(('difference', 'accuracy'), [(1e-13, 1e-12), (1e-10, 1e-9), (1e-6, 1e-2)])
def test_a_difference_that_would_show_is_left_to_methods(difference, accuracy):
    """Beyond the accuracy, and always beyond one part in 1e9."""
    found = nearly_absorbing(top(difference, **SLOW), 100.0)
    assert found is None or found.error > accuracy
    assert nearly_absorbing(load_scene('heavy_top'), 100.0) is None


def turned(moments, omega, time):
    """Return omega of many free bodies after a short time, by a step of Runge and Kutta."""
    I1, I2, I3 = moments

    def rates(w):
        return np.array([(I2 - I3) / I1 * w[1] * w[2], (I3 - I1) / I2 * w[2] * w[0],
                         (I1 - I2) / I3 * w[0] * w[1]])
    k1 = rates(omega)
    k2 = rates(omega + 0.5 * time * k1)
    k3 = rates(omega + 0.5 * time * k2)
    k4 = rates(omega + time * k3)
    return omega + time / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@pytest.mark.parametrize(('equal', 'beyond'), [
    ((3.1, 2.0, 2.0), (0.0, 1e-3, -1e-3)), ((2.0, 3.1, 2.0), (-1e-3, 0.0, 1e-3)),
    ((2.0, 2.0, 3.1), (1e-3, -1e-3, 0.0)), ((2.0, 2.0, 2.0), (1e-3, -7e-4, 2e-4))])
def test_kicks_are_what_symmetric_moments_leave_out_of_eulers_equations(equal, beyond):
    """In a time too short for a kick to turn: omega of unequal moments less that of equal ones."""
    time = 1e-4
    start = np.random.default_rng(7).normal(size=(3, nearly.STRETCHES))
    unequal = [moment + more for moment, more in zip(equal, beyond, strict=True)]
    differences = [unequal[axis - 2] - unequal[axis - 1] for axis in range(3)]
    ends, middles = turned(equal, start, time), turned(equal, start, 0.5 * time)
    sums = [sum(share * w[(axis + 1) % 3] * w[(axis + 2) % 3] for share, w in
                ((1.0, start), (4.0, middles), (1.0, ends))) * time / 6.0 for axis in range(3)]
    inertia = types.SimpleNamespace(moments=unequal, differences=differences)
    kicks = nearly._kicks(inertia, equal, ends - start, sums)
    expected = turned(unequal, start, time) - ends
    apart, size = np.abs(kicks - expected).max(axis=1), np.abs(expected).max(axis=1)
    # measured: 5e-4, for the second order of the differences
    assert (apart < 2e-3 * size).all()


@pytest.mark.parametrize(('equal', 'moments', 'differences', 'expected'), [
    # the same double, and what rounding lost
    ((2.0, 2.0, 3.0), (2.0, 2.0, 3.0), (-1.0, 1.0, 4e-17), (2e-17, -2e-17, 0.0)),
    # a sphere made heavier by all that it is given, along each axis alike
    ((2.0, 2.0, 2.0), (2.5, 2.5, 2.5), (0.0, 0.0, 0.0), (0.5, 0.5, 0.5)),
    ((2.0, 2.0, 2.0), (2.5, 2.25, 2.0), (0.25, -0.5, 0.25), (0.5, 0.25, 0.0)),
    ((1.0, 2.0, 3.0), (1.0, 2.0, 3.0), (-1.0, 2.0, -1.0), (0.0, 0.0, 0.0))])
def test_what_a_moment_has_beyond_the_one_taken_for_it(equal, moments, differences, expected):
    inertia = types.SimpleNamespace(moments=moments, differences=differences)
    assert nearly._left_out(inertia, equal) == near(expected, rel=1e-15)


def test_the_error_of_a_sphere_that_is_none_is_twice_what_it_is():
    scene = parse_scene(
        'scene: ball\nbody: {mass: 1, inertia: [1.0, 1.00000000003, 0.99999999995]}\n'
        'constraint: free\neffects: []\ninitial: {angular_velocity: [1.0, 2.0, 3.0]}\n')
    found = nearly_absorbing(scene, 10.0)
    # as a body of three moments, which has a closed form of its own
    turns = Simulation(scene, 'exact').states([10.0]).orientation[0]
    ball = Simulation(found.scene, 'exact').states([10.0]).orientation[0]
    assert found.error == near(nearly.TWICE * angle_between(*turns, *ball), rel=1e-3)    # 2e-4


def test_a_small_change_of_attitude_is_a_vector_whichever_sign_quaternions_have():
    chance = np.random.default_rng(3)
    p, small = Rotation.random(40, random_state=5), 1e-6 * chance.normal(size=(40, 3))
    signs = np.where(np.arange(40) % 3 == 0, -1.0, 1.0)[:, None]
    found = nearly._between(p.as_quat(), signs * (Rotation.from_rotvec(small) * p).as_quat())
    # measured: 4e-16, from the rounding of quaternions
    assert np.abs(found - small).max() < 2e-15


A, CLOSE, FAR = 0.3, 0.3 * (1.0 + 6e-10), 0.3 * (1.0 + 2e-9)
CHAINED = 0.3 * (1.0 + 1.2e-9)


@pytest.mark.parametrize('order', [(0, 1, 2), (1, 2, 0), (2, 1, 0), (0, 2, 1)])
@pytest.mark.parametrize(('moments', 'equal'), [
    ((A, CLOSE, 0.5), (0.5 * (A + CLOSE),) * 2 + (0.5,)),
    ((0.1, A, CLOSE), (0.1,) + (0.5 * (A + CLOSE),) * 2), ((A, FAR, 0.5), (A, FAR, 0.5)),
    ((A, CLOSE, CHAINED), (0.5 * (A + CHAINED),) * 3), ((A, A, 0.5), (A, A, 0.5))])
def test_moments_near_each_other_become_the_middle_of_their_group(order, moments, equal):
    """Where each is near the next, the group is all of them."""
    assert nearly._made_equal(tuple(moments[k] for k in order)) == near(
        tuple(equal[k] for k in order), rel=1e-15)


def body(moments, constraint='pivot', center=(0, 0, 0)):
    """Return a scene of a body with these moments about its origin, under gravity."""
    return parse_scene(json.dumps({
        'scene': 'body', 'constraint': constraint, 'effects': [{'gravity': {'g': 1.0}}],
        'body': {'mass': 0.5, 'inertia': moments, 'inertia_about': 'origin',
                 'center_of_mass': center}, 'initial': {}}))


@pytest.mark.parametrize('k', [0, 1, 2])
def test_moments_that_are_made_equal_differ_by_what_they_were(k):
    """On a hinge no difference turns the body; one that is not made equal counts for nothing."""
    moments = [0.0, 0.0, 0.0]
    moments[k - 2], moments[k - 1], moments[k] = A, CLOSE, 0.5
    scene, equal = body(moments), nearly._made_equal(tuple(moments))
    assert equal[k - 2] == equal[k - 1]
    assert nearly.differ(scene, equal)
    assert not nearly.differ(scene, tuple(moments))
    assert not nearly.differ(body([A if j != k else 0.5 for j in range(3)]), equal)
    hinge = {'hinge': {'axis': [int(j == k) for j in range(3)]}}
    assert not nearly.differ(body(moments, hinge), equal)


@pytest.mark.parametrize('k', [0, 1, 2])
@pytest.mark.parametrize(('off', 'told'), [(9e-11, True), (1.1e-10, False)])
def test_a_centre_of_mass_counts_as_on_the_axis_up_to_a_share_of_its_distance(k, off, told):
    """The share is 1e-9; what is told is its part across the axis of a body held at a point."""
    center, equal = [0.0, 0.0, 0.0], [A, A, A]
    center[k], center[k - 1], equal[k] = -0.1, off, 0.02
    across = [off if j == (k - 1) % 3 else 0.0 for j in range(3)]
    scene = body(equal, center=center)
    assert nearly._off_axis(scene, tuple(equal)) == (across if told else [0.0] * 3)
    assert nearly._off_axis(scene, (0.1, 0.2, 0.3)) == [0.0] * 3
    assert nearly._off_axis(scene, (A, A, A)) == [0.0] * 3
    assert nearly._off_axis(body(equal, 'free', center), tuple(equal)) == [0.0] * 3
