# SPDX-License-Identifier: Apache-2.0
"""Instruments beside scipy's rotations and differences of the angles that they read."""

import types

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.study.scenes import instruments

TURNS = Rotation.random(20, random_state=4)
OMEGA = np.random.default_rng(4).normal(size=(20, 3))
STATES = types.SimpleNamespace(orientation=TURNS.as_quat(), angular_velocity=OMEGA)
MOMENTS = (1.0, 2.0, 2.5)


def test_axes_and_vectors_in_the_world_are_those_of_the_rotation():
    assert instruments.axes(STATES) == pytest.approx(TURNS.as_matrix(), abs=1e-14)
    assert instruments.omega_in_world(STATES) == pytest.approx(TURNS.apply(OMEGA))
    assert instruments.momentum_in_world(MOMENTS)(STATES) == pytest.approx(
        TURNS.apply(OMEGA * MOMENTS))
    for k in range(3):
        assert (instruments.omega(k)(STATES) == OMEGA[:, k]).all()


def test_angles_are_those_of_euler_z_y_z():
    alpha, beta, gamma = TURNS.as_euler('ZYZ').T
    for read, angle in ((instruments.alpha, alpha), (instruments.beta, beta),
                        (instruments.gamma, gamma)):
        assert np.exp(1j * read(STATES)) == pytest.approx(np.exp(1j * angle), abs=1e-12)


@pytest.mark.parametrize(('rate', 'angle'), [
    (instruments.alpha_rate, instruments.alpha), (instruments.beta_rate, instruments.beta)])
def test_rates_are_the_slopes_of_the_angles(rate, angle):
    h = 1e-6

    def turned(time):
        turns = TURNS * Rotation.from_rotvec(OMEGA * time)
        return types.SimpleNamespace(orientation=turns.as_quat())
    change = np.exp(1j * (angle(turned(h)) - angle(turned(-h))))
    assert rate(STATES) == pytest.approx(np.angle(change) / (2.0 * h), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize('angle', [0.0, 1e-9, 0.7, np.pi / 2, 3.0])
def test_the_angle_between_vectors_is_accurate_where_it_is_small(angle):
    u = TURNS.apply([0.0, 0.0, 2.0])
    v = TURNS.apply([np.sin(angle), 0.0, np.cos(angle)])
    assert instruments.angle_between(u, v) == pytest.approx(
        np.full(20, angle), rel=1e-6, abs=3e-16)
    for shape in ((3,), (4, 5, 3)):    # of one pair, and of pairs in a grid
        some = [np.resize(vectors, shape) for vectors in (u, v)]
        assert instruments.angle_between(*some) == pytest.approx(
            np.full(shape[:-1], angle), rel=1e-6, abs=3e-16)
