# SPDX-License-Identifier: Apache-2.0
"""How far runs are apart."""

import math

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.choice import comparison
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, VELOCITY


def test_runs_are_apart_by_the_angle_between_them():
    states, others = np.zeros((2, 3, 14))
    for k, angle in enumerate((0.0, 0.5, 3.0)):
        states[k, 1:5] = Rotation.from_rotvec([0.0, 0.0, 1.0]).as_quat()
        others[k, 1:5] = Rotation.from_rotvec([0.0, 0.0, 1.0 + angle]).as_quat()
    assert comparison.apart(states, others) == pytest.approx([0.0, 0.5, 3.0], abs=1e-15)
    others[1, 1] = math.nan
    assert comparison.apart(states, others)[1] == math.inf


def test_the_mean_of_finer_runs_errs_less_than_each_of_them():
    """Runs turned by 1, 2 and 3 nrad about z are 2 nrad from the true one, in mean."""
    true, finer = np.zeros((4, 14)), np.zeros((3, 4, 14))
    true[:, 4] = 1.0
    for one, angle in zip(finer, (1e-9, 2e-9, 3e-9), strict=True):
        one[:, 1:5] = Rotation.from_rotvec([0.0, 0.0, angle]).as_quat()
    finer[1] *= -1.0    # the same attitude
    turned = finer[0].copy()
    turned[:, 1:5] = Rotation.from_rotvec([0.0, 0.0, 5e-9]).as_quat()
    assert comparison.apart_from_mean(true, list(finer)) == near(2e-9, rel=1e-7)
    assert comparison.apart_from_mean(turned, list(finer)) == near(3e-9, rel=1e-7)
    gave_up = np.full((4, 14), math.nan)
    assert comparison.apart_from_mean(true, [finer[0], gave_up]) == near(1e-9, rel=1e-7)
    assert (comparison.apart_from_mean(true, [gave_up]) == math.inf).all()
    gave_up[:3] = finer[0, :3]    # at the last time only
    assert comparison.apart_from_mean(true, [finer[0], gave_up]) == near(1e-9, rel=1e-7)


def test_a_mean_attitude_is_that_of_the_finite_runs_whatever_the_signs_of_their_quaternions():
    """Of turns about z: the sums of the sines and of the cosines of half their angles."""
    angles = np.array([[0.1, 0.7, -0.4], [0.2, 0.3, 2.0], [0.0, -1.0, 0.5], [1.5, 1.0, 0.9],
                       [0.3, 0.4, 0.5]])
    signs = np.array([[1, -1, 1], [1, 1, -1], [-1, 1, -1], [-1, 1, 1], [1, -1, -1]])
    runs = np.zeros((4, 5, 14))
    runs[:3, :, 3], runs[:3, :, 4] = signs.T * np.sin(0.5 * angles.T), signs.T * np.cos(
        0.5 * angles.T)
    runs[3, :, 4], runs[3, 2, 1] = 1.0, math.nan    # left out
    true = np.zeros((5, 14))
    true[:, 4] = 1.0
    for order in (0, 1, 2, 3), (2, 3, 0), (3, 1):
        halves = 0.5 * angles[:, [one for one in order if one < 3]]
        mean = 2.0 * np.arctan2(np.sin(halves).sum(axis=1), np.cos(halves).sum(axis=1))
        found = comparison.apart_from_mean(true, [runs[one] for one in order])
        assert found == near(np.abs(mean), rel=2e-15)    # worst measured: 2.3e-16
    # no run is finite: beside the first of them
    gave_up = runs[0].copy()
    gave_up[3:, ORIENTATION] = math.nan
    found = comparison.apart_from_mean(true, [gave_up, np.full((5, 14), math.nan)])
    assert found == near([0.1, 0.2, 0.0, math.inf, math.inf], rel=2e-15)


ONE = [[0, 0, 0], [0, 0, 0], [0.03, 0, 0.04], [0.1, -0.2, 0.2], [0, 0.06, 0.08], [0, -1, 0],
       [2, 3, -6], [1, 0, 0], [2e200, 3e200, 6e200], [math.nan, 0, 0]]
OTHER = [[0, 0, 0], [0, 0, 1], [0.03, 0.01, 0.04], [0.1, -0.2, -0.2], [math.nan, 0.06, 0.08],
         [0.3, -0.6, 1.2], [4, 4, -4], [1, 0, -7], [0, 0, 0], [0, 0, 0]]
SHARES = [0, 0, 0.01 / 0.05, 0.4 / 0.3, math.inf, 1.3, 3 / 7, 1, 1, math.inf]
"""Vectors of two runs, and the lengths of their differences over the largest of the first ones so
far; nothing is told before the first one that is not zero."""


def velocities_apart(states, others):
    return comparison.velocities_apart(states, others, 0.0)


@pytest.mark.parametrize(('apart', 'places'), [
    (velocities_apart, VELOCITY), (comparison.rates_apart, ANGULAR_VELOCITY)])
@pytest.mark.parametrize('turn', [0, 1, 2])
@pytest.mark.filterwarnings('error')
def test_vectors_are_apart_by_shares_of_the_largest_so_far(apart, places, turn):
    states, others = np.full((2, len(ONE), 14), 5.0)
    states[:, places], others[:, places] = np.roll(ONE, turn, axis=1), np.roll(OTHER, turn, axis=1)
    assert apart(states, others) == near(SHARES, rel=2e-15)    # worst measured: 2.3e-16


def test_what_came_to_rest_before_the_first_look_is_apart_by_shares_of_the_start():
    """3e-17 and 4e-17 of what was 2; a look with more than that counts from then on."""
    states, others = np.zeros((2, 3, 14))
    states[:, VELOCITY.start], others[:, VELOCITY.start] = [1e-17, 4.0, 0.0], [4e-17, 5.0, 1.0]
    assert comparison.velocities_apart(states, others, 2.0) == near(
        [1.5e-17, 0.25, 0.25], rel=1e-15)


def test_momenta_are_apart_by_what_the_moments_make_of_the_rates():
    """L = (1 w_x, 2 w_y, 3 w_z) of the racket at its attitude of the start."""
    states, others = np.zeros((2, 3, 14))
    states[:, 4] = others[:, 4] = 1.0
    states[:, ANGULAR_VELOCITY] = [[2, 1, 1], [1, 0, 0], [1, 3, 2]]
    others[:, ANGULAR_VELOCITY] = [[2, 1, 0], [1, 0.5, 0], [0, 4, 2]]
    scene = load_scene('tennis_racket')
    found = comparison.shares(
        comparison.momenta(scene, states), comparison.momenta(scene, others), 0.0)
    sizes = 17 ** 0.5, 17 ** 0.5, 73 ** 0.5
    assert found == near(np.array([3, 1, 5 ** 0.5]) / sizes, rel=2e-15)    # worst measured: 0


def test_an_error_grows_by_what_it_changes_in_the_second_half():
    """Runs are apart by a rotation in the world, whatever they turn; a reversed one has grown."""
    angles = np.array([5e-9, 2e-9, 1e-9, -1e-9, -1.5e-9, 1e-9])
    states, others = np.zeros((2, 6, 14))
    for k, angle in enumerate(angles):
        turned = Rotation.from_rotvec([0.3 * k, 1.0, k])
        error = Rotation.from_rotvec([angle, 0.0, 0.0])
        states[k, 1:5], others[k, 1:5] = (error * turned).as_quat(), turned.as_quat()
    assert comparison.grown(states, others) == near(2.5e-9, rel=1e-6)
    others[4] *= -1.0    # the same attitude
    assert comparison.grown(states, others) == near(2.5e-9, rel=1e-6)
    assert comparison.grown(states[-1:], others[-1:]) == 0.0
    others[4, 1] = math.nan
    assert comparison.grown(states, others) == math.inf
