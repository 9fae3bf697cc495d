# SPDX-License-Identifier: Apache-2.0
"""Spectra: a sine shows at its frequency with its amplitude, a predicted line where it should."""

import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.analysis.history import History, Segment
from rigid_body_sim.analysis.lines import predicted_lines
from rigid_body_sim.analysis.spectrum import Spectrum
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba


def spectrum_of(times, orientation, omega, scene=None, changes=()):
    segments = [Segment(stamp, scene, 0.0, 0.0) for stamp in (0, *changes)]
    head = types.SimpleNamespace(columns=lambda: (times, orientation, omega, None))
    return Spectrum(types.SimpleNamespace(
        motion=types.SimpleNamespace(head=head),
        source=types.SimpleNamespace(scene=scene, start=0, history=History((), tuple(segments)))))


def of_scene(scene, ticks, rate):
    states = Simulation(scene).states(np.arange(ticks) / rate)
    return spectrum_of(states.time, states.orientation, states.angular_velocity, scene)


def test_a_sine_has_its_amplitude_at_its_frequency():
    times = np.arange(5000) / 500.0
    omega = np.stack([3.0 * np.sin(2.0 * np.pi * 12.34 * times), 0.0 * times + 7.0,
                      0.5 * np.cos(2.0 * np.pi * 40.0 * times)],
                     axis=1)
    spectrum = spectrum_of(times, np.tile([0.0, 0.0, 0.0, 1.0], (5000, 1)), omega)
    body = spectrum.amplitudes['body']
    assert spectrum.frequencies[body[:, 0].argmax()] == pytest.approx(12.34, abs=0.02)
    assert body[:, 0].max() == near(3.0, rel=0.01)
    assert body[:, 2].max() == near(0.5, rel=0.01)
    assert body[:, 1].max() < 1e-12
    assert 40.0 < spectrum.top < 120.0


def test_what_comes_after_a_command_or_a_hole_is_left_out():
    times = np.delete(np.arange(5000) / 500.0, slice(3000, 3010))
    still = np.tile([0.0, 0.0, 0.0, 1.0], (len(times), 1)), np.zeros((len(times), 3))
    assert spectrum_of(times, *still).seconds == pytest.approx(6.0)
    assert spectrum_of(times, *still, changes=(4 * 10**9,)).seconds == pytest.approx(4.0)
    assert spectrum_of(times[:50], still[0][:50], still[1][:50]).seconds == 0.0


@pytest.mark.parametrize(('name', 'ticks', 'rate', 'expected', 'tolerance'), [
    # measured - predicted, relative
    ('asymmetric_top', 10_000, 250.0, {'1/T'}, 1e-4),                   # 2e-6
    ('symmetric_top', 20_000, 100.0, {'Ω = ω₃(I₃-I₁)/I₁', 'L/I₁'}, 1e-4),
    ('kater_pendulum', 10_000, 100.0, {'1/T'}, 1e-4),
    ('fast_top', 20_000, 1000.0, {'nutation'}, 1e-4),
    ('heavy_top', 20_000, 250.0, {'nutation', 'precession'}, 1e-4),
])
def test_predicted_lines_are_found(name, ticks, rate, expected, tolerance):
    spectrum = of_scene(load_scene(name), ticks, rate)
    found = {line.name: measured / line.frequency - 1.0
             for line, measured in spectrum.lines if measured is not None}
    assert expected <= set(found)
    for line in expected:
        assert abs(found[line]) < tolerance


def test_a_line_that_is_not_there_is_not_found_in_the_side_lobes_of_others():
    found = {line.name: measured
             for line, measured in of_scene(load_scene('steady_precession'), 20_000, 100.0).lines}
    assert found['nutation'] is None and found['precession'] is not None


def test_the_racket_s_odd_harmonics():
    spectrum = of_scene(
        load_scene('tennis_racket', ['initial.angular_velocity=[0.5, 5.0, 0.1]']), 40_000, 200.0)
    found = {line.name: (measured, line.frequency) for line, measured in spectrum.lines}
    assert found['1/T'][0] == near(found['1/T'][1], rel=1e-4)
    assert found['3/T'][0] == near(found['3/T'][1], rel=1e-4)


@pytest.mark.parametrize(
    'name',
    ['sphere', 'thin_rod', 'billiard_low', 'major_axis_relaxation', 'driven_body', 'sleeping_top'])
def test_nothing_is_predicted_where_there_is_no_such_line(name):
    lines = predicted_lines(load_scene(name))
    assert all(np.isfinite(line.frequency) for line in lines)
    assert {line.name for line in lines} <= ({'L/I₁', 'Ω = ω₃(I₃-I₁)/I₁'} if name == 'thin_rod'
                                             else set())


@pytest.mark.parametrize('override', [
    'body.inertia=[0.03, 0.029, 0.01]', 'body.inertia=[0.029, 0.03, 0.01]',
    'body.center_of_mass=[0.001, 0, 0.1]', 'body.center_of_mass=[0, 0.001, 0.1]'])
def test_nutation_is_predicted_for_a_top_with_equal_moments_and_its_weight_on_the_axis(override):
    assert {line.name for line in predicted_lines(load_scene('heavy_top'))} == {
        'nutation', 'precession'}
    assert predicted_lines(load_scene('heavy_top', [override])) == ()


def test_steady_rotation_and_rest_have_no_period():
    for omega in ([0, 0, 5.0], [0, 5.0, 0], [0, 0, 0]):
        assert predicted_lines(load_scene(
            'tennis_racket', [f'initial.angular_velocity={omega}'])) == ()
