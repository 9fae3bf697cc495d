# SPDX-License-Identifier: Apache-2.0
"""Predictions and measurements: what counts as met, and formulas that hold in a limit."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.study.scenes import experiment as room
from rigid_body_sim.study.scenes.experiment import Experiment
from rigid_body_sim.study.scenes.limits import limit
from rigid_body_sim.study.scenes.quantity import Quantity


@pytest.mark.parametrize(('predicted', 'measured', 'more', 'error'), [
    (4.0, 5.0, {}, 0.25), (4.0, 3.0, {}, 0.25), (-4.0, -3.0, {}, 0.25), (4.0, 4.0, {}, 0.0),
    ([1.0, -8.0], [1.5, -7.0], {}, 0.125), ([1.0, -8.0], [3.0, -8.0], {}, 0.25),
    (4.0, 5.0, {'absolute': True}, 1.0), (0.0, 1e-9, {'absolute': True}, 1e-9),
    (0.0, 1e-9, {}, math.inf), (0.0, 0.0, {}, 0.0),
    (4.0, 3.0, {'bound': True}, 0.0), (4.0, 5.0, {'bound': True}, 0.25),
    ([4.0, 4.0], [3.0, 4.4], {'bound': True}, 0.1)])
def test_an_error_is_relative_to_the_largest_prediction(predicted, measured, more, error):
    assert Quantity('q', predicted, measured, 1.0, **more).error == pytest.approx(error)


def test_a_quantity_passes_up_to_its_tolerance_and_never_as_nan():
    assert Quantity('q', 4.0, 5.0, 0.25).passed
    assert not Quantity('q', 4.0, 5.0, 0.2499).passed
    assert not Quantity('q', 4.0, math.nan, 1e9).passed
    assert not Quantity('q', 0.0, 1e-9, 1e9).passed


def test_what_the_notes_write_is_compared_too():
    assert Quantity('q', 4.0, 4.0, 1.0).error_as_written is None
    assert Quantity('q', 4.0, 5.0, 1.0, as_written=3.0).error_as_written == pytest.approx(0.5)


@pytest.mark.parametrize('order', [1, 2])
@pytest.mark.parametrize('left', [0.0, 0.01])
def test_a_limit_is_found_from_three_values_with_its_order(order, left):
    values = [0.4, 0.2, 0.1]
    ratios = [1.0 + left + 3.0 * p ** order - 5.0 * p ** (2 * order) for p in values]
    slope, end = limit('rate', 'tilt', values, ratios, order, 0.5, 1e-9, as_written=2.0)
    assert end.measured == pytest.approx(1.0 + left, abs=1e-12)
    assert (end.predicted, end.tolerance, end.as_written) == (1.0, 1e-9, 2.0)
    deviations = np.array(ratios) - 1.0
    assert slope.measured == pytest.approx(
        math.log(abs(deviations[1] / deviations[2])) / math.log(2.0))
    assert (slope.predicted, slope.tolerance, slope.absolute) == (order, 0.5, True)
    pure = limit('rate', 'tilt', values, [1.0 + 2.0 * p ** order for p in values], order, 0.5, 1.0)
    assert pure[0].measured == pytest.approx(order)


def experiment(value):
    """Return an Experiment whose states are the readings themselves."""
    one = object.__new__(Experiment)
    one.simulation = types.SimpleNamespace(states=lambda times: np.array(list(map(value, times))))
    return one


def test_crossings_are_the_zeros_of_a_reading_in_the_sense_asked():
    one = experiment(math.sin)
    pi = math.pi

    def same(states):
        return states
    assert one.crossings(same, 1.0, 10.0, 20) == near([pi, 2 * pi, 3 * pi], rel=1e-15)
    assert one.crossings(same, 1.0, 10.0, 20, rising=True) == pytest.approx([2 * pi])
    assert one.crossings(same, 1.0, 10.0, 20, rising=False) == pytest.approx([pi, 3 * pi])
    assert one.crossings(same, 3.3, 6.0, 20).tolist() == []


@pytest.mark.parametrize(('order', 'expected'), [(1, math.cos(2.0)), (2, -math.sin(2.0)),
                                                 (3, -math.cos(2.0))])
def test_a_derivative_is_that_of_the_reading(order, expected):
    one = experiment(lambda time: math.sin(2.0 * time) / 2.0 ** order)
    assert one.derivative(lambda states: states, 1.0, 0.3, order) == pytest.approx(
        expected, abs=1e-9)


def test_a_polynomial_of_degree_16_is_differentiated_without_error():
    """By hand: T_16 has the slope 0 and the second derivative -16^2 in the middle."""
    one = experiment(lambda time: math.cos(16.0 * math.acos(2.0 * (time - 0.25))))
    # measured: no error
    assert one.derivative(lambda states: states, 0.25, 0.5, 2) == near(-1024.0, rel=1e-10)


def test_a_variant_is_the_changed_scene_by_the_same_method_if_that_can_run_it(monkeypatch):
    monkeypatch.setattr(room, 'Simulation', lambda *given: given)
    run = Experiment(load_scene('driven_body'), 'exact', 1e-7)
    other = run.variant({'torque.value': np.array([0.0, 0.0, 0.25])})
    assert other.simulation == (other.scene, 'exact', 1e-7)
    assert tuple(other.scene.effect('torque').values[0]) == (0.0, 0.0, 0.25)
    other = run.variant({'torque.value': [0.0, 0.0, 0.1]}, {'body.inertia': '[0.8, 1.0, 1.3]'})
    assert other.simulation == (other.scene, 'dop8', 1e-7)
    assert tuple(other.scene.body.about_center.moments) == (0.8, 1.0, 1.3)
