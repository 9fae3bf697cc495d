# SPDX-License-Identifier: Apache-2.0
"""Group 5, long runs: no trend, by statistics.

The cases stand in rigid_body_sim/study/hard_cases, each with why it is hard and the reason of its
bound; `hard_cases` prints what is measured.
"""

import math
import types

import numpy as np
import pytest
from hard_cases.judged import judge
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.motions.free_body import free_body
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import States
from rigid_body_sim.study.hard_cases import trends
from rigid_body_sim.study.hard_cases.table import of_group


@pytest.mark.parametrize('case', of_group(5), ids=lambda case: case.name)
def test_case(case):
    # measured: 0.3, 1.1 and 0.5 sigma of 5; with 1e8 ticks 1.6 (free body) and 1.3 (anchored anew)
    judge(case)


@pytest.mark.parametrize(('slope', 'middle', 'scatter', 'sigmas'), [
    # the squares of the places -1, -0.5, 0, 0.5 and 1 add up to 2.5
    (0.3, 7.0, 0.1, 3.0 * math.sqrt(2.5)), (-0.3, 0.0, 0.1, 3.0 * math.sqrt(2.5)),
    (0.0, 0.0, 0.1, 0.0), (0.0, 0.0, 0.0, 0.0), (1e-9, 0.0, 0.0, math.inf)])
def test_a_slope_is_told_in_units_of_its_uncertainty(slope, middle, scatter, sigmas):
    means = middle + slope * np.linspace(-1.0, 1.0, 5)
    assert trends.slope_in_sigmas(means, scatter) == near(sigmas, rel=1e-13)


@pytest.mark.parametrize('mechanism', [Mechanism.FREE, Mechanism.POINT])
def test_residuals_are_relative_to_the_first_values_or_their_mean(mechanism):
    draw, (I1, I3) = np.random.default_rng(5), (0.4, 0.3)
    vector = draw.normal(size=(4, 14))
    energy, square = draw.uniform(1.0, 2.0, size=(2, 4))
    body = types.SimpleNamespace(about_origin=types.SimpleNamespace(moments=(I1, I1, I3)))
    simulation = types.SimpleNamespace(
        diagnose=lambda states: (energy, square), scene=types.SimpleNamespace(
            body=body, constraint=types.SimpleNamespace(mechanism=mechanism)))
    vector[:, 1:5] /= np.linalg.norm(vector[:, 1:5], axis=1, keepdims=True)
    expected = {'norm of q': np.zeros(4), 'energy': energy / energy[0] - 1.0}
    if mechanism is Mechanism.FREE:
        expected['L'] = square / square[0] - 1.0
    else:    # of a top: along the vertical, and along its own axis
        momentum = np.array([I1, I1, I3]) * vector[:, 5:8]
        upward = Rotation.from_quat(vector[:, 1:5]).apply(momentum)[:, 2]
        expected |= {'p_alpha': upward / upward.mean() - 1.0,
                     'p_gamma': momentum[:, 2] / momentum[0, 2] - 1.0}
    found = trends.residuals(simulation, States(vector))
    assert set(found) == set(expected)
    for name, values in expected.items():
        assert found[name] == pytest.approx(values, rel=1e-12, abs=1e-12), name
    found = trends.residuals(simulation, States(vector * np.where(np.arange(14) < 5, 2.0, 1.0)))
    assert found['norm of q'] == near(np.full(4, 3.0), rel=1e-14)


@pytest.mark.without_numba
def test_a_walk_keeps_energy_momentum_and_norm_of_every_so_many_ticks():
    scene, out = load_scene('free_body'), np.full((3, 3), np.nan)
    moments, omega = np.array(scene.body.about_center.moments), scene.initial.angular_velocity
    trends.walk(free_body.parameters(scene), scene.initial.vector, 6, 2, moments, out)
    momentum = moments * omega
    assert out[:, 0] == near(np.full(3, momentum @ omega), rel=1e-13)
    assert out[:, 1] == near(np.full(3, momentum @ momentum), rel=1e-13)
    assert out[:, 2] == pytest.approx(np.zeros(3), abs=1e-14)
