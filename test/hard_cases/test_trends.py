# SPDX-License-Identifier: Apache-2.0
"""The statistical test of long runs, on made-up numbers: what a trend is, in its own scatter."""

import math
import types

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases import trends


@pytest.mark.parametrize(('means', 'scatter', 'sigmas'), [
    # over -1, 0, 1 the slope has the uncertainty scatter/sqrt(2)
    ([0.0, 1.0, 2.0], 0.5, math.sqrt(8.0)), ([5.0, 4.0, 3.0], 0.5, math.sqrt(8.0)),
    ([0.0, 7.0, 1.0], 2.0, math.sqrt(0.125)), ([1.0, 1.0, 1.0], 0.0, 0.0),
    ([1.0, 2.0, 3.0], 0.0, math.inf)])
def test_a_slope_is_counted_in_its_uncertainty(means, scatter, sigmas):
    assert trends.slope_in_sigmas(np.array(means), scatter) == near(sigmas, rel=1e-14)


def test_residuals_are_relative_to_the_first_value_or_to_the_mean():
    turns, omega = Rotation.random(4, random_state=7), np.arange(1.0, 13.0).reshape(4, 3)
    energy, square = np.array([2.0, 3.0, 1.0, 2.0]), np.array([4.0, 2.0, 4.0, 8.0])
    states = types.SimpleNamespace(orientation=2.0 * turns.as_quat(), angular_velocity=omega)

    def found(mechanism):
        return trends.residuals(types.SimpleNamespace(
            diagnose=lambda given: (energy, square), scene=types.SimpleNamespace(
                constraint=types.SimpleNamespace(mechanism=mechanism),
                body=types.SimpleNamespace(about_origin=types.SimpleNamespace(
                    moments=(2.0, 2.0, 3.0))))), states)
    free = found(Mechanism.FREE)
    assert {name: list(values) for name, values in free.items()} == {
        'norm of q': pytest.approx([3.0] * 4), 'energy': [0.0, 0.5, -0.5, 0.0],
        'L': [0.0, -0.5, 0.0, 1.0]}
    top = found(Mechanism.POINT)
    # the vertical part of R I omega, and the part along the axis: 3 omega3 is 9, 18, 27, 36
    vertical = turns.apply(omega * (2.0, 2.0, 3.0))[:, 2]
    assert set(top) == {'norm of q', 'energy', 'p_alpha', 'p_gamma'}
    assert top['p_alpha'] == pytest.approx(vertical / vertical.mean() - 1.0, abs=1e-13)
    assert top['p_gamma'] == pytest.approx([0.0, 1.0, 2.0, 3.0])


@pytest.mark.parametrize(('slope', 'noise', 'sigmas'), [
    # block means s times -1, -1/3, 1/3, 1: a slope s of the uncertainty scatter/sqrt(20/9).
    # They scatter by s sqrt(5/9) themselves, so 2 sigmas; or less than a thousand roundings do
    (0.25, 0.0, 2.0), (5e-4, 0.5, 1e-3 * math.sqrt(20.0 / 9.0) * math.sqrt(1000.0))])
@pytest.mark.parametrize('other', [0.0, 1.0])
@pytest.mark.parametrize('step', [21.6, 1e-3])
def test_a_day_is_judged_by_the_means_of_its_blocks(
        monkeypatch, slope, noise, sigmas, other, step):
    """4000 states over 86,400 s, in 4 blocks; one quantity or another has the worst slope."""
    seen = []

    def residuals(simulation, times):
        seen.extend(times.tolist())
        assert len(times) <= 300
        ticks = np.rint(times / step)
        block = (ticks - 1) // 1000
        jitter = np.where(ticks % 2 == 0, 1.0, -1.0)
        made = 0.5 + slope * (2.0 * block / 3.0 - 1.0) + noise * jitter
        quiet = jitter
        return {'one': quiet, 'two': made} if other else {'one': made, 'two': quiet}
    monkeypatch.setattr(trends, 'BLOCKS', 4)
    monkeypatch.setattr(trends, 'TICKS', 4000)
    monkeypatch.setattr(trends, 'AT_ONCE', 300)
    monkeypatch.setattr(trends, 'LONG', step == 1e-3)
    monkeypatch.setattr(trends, 'residuals', residuals)
    monkeypatch.setattr(trends, 'Simulation', lambda scene: types.SimpleNamespace(
        states=lambda times: times))
    found = trends.anchored('free_body')
    assert found.error == near(sigmas, rel=1e-5)    # 1e-6 of it is in the squares
    assert (found.bound, found.unit) == (5.0, 'sigma')
    assert seen == near([step * k for k in range(1, 4001)], rel=1e-14)


def test_long_runs_are_cases_of_whole_blocks():
    assert trends.TICKS in (64_000, 100_000_000) and not trends.TICKS % trends.BLOCKS
    assert [(case.group, case.name) for case in trends.cases()] == [
        (5, 'free body, a day'), (5, 'heavy top, a day'),
        (5, 'free body, anchored anew at each tick')]


@pytest.mark.parametrize('column', [0, 1])
def test_a_walk_is_judged_by_its_mean_step(monkeypatch, column):
    """Steps of 0.5, 0.1, 0.6 of the first value: 0.4 on average, 0.216 beside that."""
    asked = []

    def walk(parameters, start, ticks, every, moments, out):
        asked.append((ticks, every, list(moments)))
        out[:, 2] = -9e-15
        out[:, 1 - column] = [1.0, 1.5, 1.0, 1.5]
        out[:, column] = [2.0, 3.0, 3.2, 4.4]
    monkeypatch.setattr(trends, 'BLOCKS', 4)
    monkeypatch.setattr(trends, 'TICKS', 64_000)
    monkeypatch.setattr(trends, 'walk', walk)
    found = trends.anchored_anew()
    assert found.error == near(0.4 / math.sqrt(0.14 / 9.0), rel=1e-12)
    assert (found.bound, found.unit) == (5.0, 'sigma')
    moments = list(load_scene('free_body').body.about_center.moments)
    assert asked == [(64_000, 16_000, moments)]


def test_a_walk_that_loses_the_length_of_its_quaternion_is_no_case(monkeypatch):
    def walk(parameters, start, ticks, every, moments, out):
        out[:] = 1.0
        out[:, 2] = -1.1e-14
    monkeypatch.setattr(trends, 'walk', walk)
    with pytest.raises(AssertionError), np.errstate(invalid='ignore'):
        trends.anchored_anew()


@pytest.mark.without_numba
@pytest.mark.parametrize('moments', [(1.0, 0.0, 0.0), (0.0, 2.0, 0.0), (0.0, 0.0, 3.0)])
def test_a_walk_goes_by_milliseconds_and_notes_what_it_is_asked_for(moments):
    """With one moment alone the two sums are I w^2 and I^2 w^2 of one component."""
    scene = load_scene('free_body')
    out, start = np.empty((3, 3)), scene.initial.vector
    before = start.copy()
    trends.walk(trends.free_body.parameters(scene), start, 12, 4, np.array(moments), out)
    there = Simulation(scene).states(np.array([4e-3, 8e-3, 12e-3])).angular_velocity
    assert out[:, 0] == near(there**2 @ np.array(moments), rel=1e-12)
    assert out[:, 1] == near(there**2 @ np.square(moments), rel=1e-12)
    assert np.abs(out[:, 2]).max() < 1e-14 and np.array_equal(start, before)
