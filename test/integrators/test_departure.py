# SPDX-License-Identifier: Apache-2.0
"""Internal dissipation near a principal axis: its linear equations, and when they take over."""

import math

import mpmath
import numpy as np
import pytest
import yaml
from near import near
from scipy.linalg import expm

from rigid_body_sim.integrators.departure import (
    FOLDS,
    NEAR,
    Arriving,
    Departing,
    _times_exp,
    applies,
    arrival,
    departure,
    relaxing,
)
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

SKEW = np.array(matrix(0.1, -0.5, 0.7, 0.5))    # body axes of the principal ones, columns
CENTER = np.array([0.1, 0.2, -0.3])
C = 0.3
TORQUE = {'torque': {'value': [0.0, 0.0, 1.0]}}


def scene_of(moments, c=C, axes=SKEW, effects=(), constraint='free', center=CENTER):
    """Return a body with principal moments along some axes that dissipation relaxes."""
    inertia = axes @ np.diag(moments) @ axes.T
    return parse_scene(yaml.safe_dump({
        'scene': 'departs', 'constraint': constraint, 'initial': {},
        'body': {'mass': 2.0, 'inertia': (0.5 * (inertia + inertia.T)).tolist(),
                 'center_of_mass': center.tolist()},
        'effects': [*([{'internal_dissipation': {'coefficient': c}}] if c else []), *effects]}))


def state_of(scene, omega, axes=SKEW):
    """Return a state at 2 s with omega along the principal axes."""
    vector = scene.initial.vector.copy()
    vector[0], vector[1:5], vector[5:8] = 2.0, (0.5, 0.1, -0.5, 0.7), axes @ omega
    vector[8:] = 1.0, -2.0, 3.0, 0.5, 0.25, -0.75
    return vector


MOTIONS = {
    'from the least moment': ((1.0, 2.0, 2.5), 0, 1.5, C),
    'from the middle one': ((1.0, 2.0, 2.5), 1, -1.5, 0.1),
    'from the least without turns': ((1.0, 2.0, 2.5), 0, 0.05, 300.0),
    'to the largest': ((1.0, 2.0, 2.5), 2, 1.5, C),
    'to the largest without turns': ((1.0, 2.0, 2.5), 2, -1.5, 3.0),
    'to the one that differs': ((1.5, 1.5, 2.5), 2, 1.5, C),
    'beside an equal one': ((1.0, 2.0, 2.0), 2, 1.5, C),
    'of a sphere': ((2.0, 2.0, 2.0), 2, 1.5, C)}


@pytest.mark.parametrize(('moments', 'k', 'spin', 'c'), MOTIONS.values(), ids=MOTIONS)
def test_a_departure_is_the_solution_of_its_linear_equations(moments, k, spin, c):
    """Beside the exponential of the matrix; momentum stays, and the centre moves evenly."""
    # axes of equal moments are those of the body
    axes = SKEW if moments[1] < moments[2] else np.eye(3)
    scene = scene_of(moments, c, axes)
    i, j, omega = (k + 1) % 3, (k + 2) % 3, np.zeros(3)
    omega[[i, j, k]] = 2e-11 * spin, -1e-11 * spin, spin
    start = state_of(scene, omega, axes)
    Ii, Ij, Ik = (moments[n] for n in (i, j, k))
    fall = c * Ik * spin * spin
    rates = np.array([[-fall * (Ik - Ii) / Ii, (Ij - Ik) / Ii * spin],
                      [(Ik - Ii) / Ij * spin, -fall * (Ik - Ij) / Ij]])
    found = departure(scene, start)
    assert found.begin == 2.0
    grows = np.linalg.eigvals(rates).real.max() > 1e-9
    assert grows == math.isfinite(found.end)
    turn, inertia = np.array(matrix(*start[1:5])), axes @ np.diag(moments) @ axes.T
    momentum = turn @ inertia @ start[5:8]
    drift = start[11:] + turn @ np.cross(start[5:8], CENTER)
    out = np.empty(14)
    for elapsed in (0.0, 0.2, 0.7, 1.9):
        found.state(2.0 + elapsed, out)
        assert out[0] == 2.0 + elapsed
        across = expm(rates * elapsed) @ omega[[i, j]]
        along = axes.T @ out[5:8]
        # measured: 1.1e-15, 3.3e-16, 1.6e-15, 9e-16, 3.3e-16 and 5e-16
        assert along[[i, j]] == pytest.approx(across, abs=1e-5 * NEAR)
        assert along[k] == near(spin, rel=1e-14)
        here = np.array(matrix(*out[1:5]))
        assert here @ inertia @ out[5:8] == pytest.approx(momentum, abs=2e-14)
        assert out[8:11] + here @ CENTER == pytest.approx(
            start[8:11] + turn @ CENTER + drift * elapsed, abs=1e-14)
        assert out[11:] + here @ np.cross(out[5:8], CENTER) == pytest.approx(drift, abs=1e-14)
        # the body turns about the axis by what it turns in the plane across it
        turned = (turn @ axes).T @ here @ axes
        assert np.cos(spin * elapsed) == pytest.approx(turned[i, i], abs=1e-14)
        assert np.sin(spin * elapsed) == pytest.approx(turned[j, i], abs=3e-10)    # the tilt


@pytest.mark.parametrize(('moments', 'k', 'spin', 'c'), list(MOTIONS.values())[:2])
def test_a_departure_ends_before_what_it_leaves_out_counts(moments, k, spin, c):
    scene, omega = scene_of(moments, c), np.zeros(3)
    omega[[k - 2, k - 1, k]] = 3e-14, -2e-14, spin
    found, out = departure(scene, state_of(scene, omega)), np.empty(14)
    sizes = []
    for time in np.linspace(2.0, found.end, 200):
        found.state(time, out)
        sizes.append(np.hypot(*np.delete(SKEW.T @ out[5:8], k)))
    # measured: 0.28 and 0.25 of NEAR
    assert 0.1 * NEAR * abs(spin) < max(sizes) <= NEAR * abs(spin)
    omega[[k - 2, k - 1]] = 6e-10 * spin, 7e-10 * spin    # near, and not for as long as it says
    assert departure(scene, state_of(scene, omega)) is None


def test_the_end_holds_for_components_that_grow_by_a_turn():
    """Their rates are those of a matrix whose norm is up to twice its largest coefficient.

    Here, where dissipation all but stops the turns, it is 1.15 omega, the coefficient 0.75 omega.
    """
    scene = scene_of((1.0, 2.0, 2.5), c=9.165 / 1.5, axes=np.eye(3))
    out, largest = np.empty(14), 0.0
    for angle in np.linspace(0.0, np.pi, 9):
        for power in np.linspace(-26.0, -18.0, 17):
            small = 10.0**power * np.array([np.cos(angle), np.sin(angle)])
            found = departure(scene, state_of(scene, np.array([1.5, *small]), np.eye(3)))
            found.state(found.end, out)
            largest = max(largest, np.hypot(*out[6:8]) / (1.5 * NEAR))
    assert 0.5 < largest <= 1.0    # measured: 0.58


def test_the_folds_end_where_the_components_are_near():
    assert 0.5 < math.exp(-FOLDS) / NEAR < 2.5    # 2.06


@pytest.mark.parametrize(('small', 'departs', 'arrives'), [
    (0.99e-9, True, True), (1.01e-9, False, False), (1e-300, True, True), (0.0, False, True)])
def test_a_state_is_near_an_axis_where_products_are_rounding(small, departs, arrives):
    scene = scene_of((1.0, 2.0, 2.5), axes=np.eye(3))
    vector = state_of(scene, np.array([0.6 * small, -0.8 * small, -1.0]), np.eye(3))
    assert (departure(scene, vector) is not None) == departs
    assert (arrival(scene, vector) is not None) == arrives
    off = state_of(scene, np.array([-1.0, 0.6 * small, 0.8 * small]), np.eye(3))
    assert (arrival(scene, off) is not None) == (small == 0.0)    # the axis of the least moment


@pytest.mark.parametrize('k', range(2))
def test_a_needle_departs_from_no_axis(k):
    scene, omega = scene_of((2.0, 2.0, 0.0), axes=np.eye(3)), np.zeros(3)
    omega[[k, 1 - k]] = 1.0, 1e-12
    assert departure(scene, state_of(scene, omega, np.eye(3))) is None


@pytest.mark.parametrize(('moments', 'rate'), [
    ((2.0, 3.0, 4.5), 0.3 * (21.0 / 4.5) * 1.25), ((4.5, 3.0, 2.0), 0.3 * (21.0 / 4.5) * 1.25),
    ((2.0, 2.0, 2.0), 0.0), ((2.0, 2.0, 0.0), 0.0)], ids=['body', 'turned', 'sphere', 'needle'])
def test_the_last_axis_is_near_after_twenty_folds_of_the_slowest_rate(moments, rate):
    """L = (1, 4, 2) N m s; the rate is c L^2/I_3 (I_3 - I_1)/I_1."""
    scene = scene_of(moments, axes=np.eye(3))
    omega = np.array([1.0, 4.0, 2.0]) / np.maximum(moments, 1.0)
    found = relaxing(scene, state_of(scene, omega, np.eye(3)))
    assert found == (near(FOLDS / rate, rel=1e-13) if rate else math.inf)


@pytest.mark.parametrize(('settings', 'wrench', 'expected'), [
    ({}, None, True), ({}, object(), False), ({'constraint': 'pivot'}, None, False),
    ({'effects': [TORQUE]}, None, False), ({'c': 0.0, 'effects': [TORQUE]}, None, False)])
def test_it_applies_where_nothing_else_acts(settings, wrench, expected):
    scene = scene_of((1.0, 2.0, 2.5), center=np.zeros(3), **settings)
    assert applies(scene, wrench) == expected


@pytest.mark.parametrize(('value', 'exponent'), [
    (1e-300, 800.0), (2.0, 340.0), (2.0, 360.0), (-1e-250, 355.0), (3.0, -699.0), (3.0, 0.0)])
def test_a_power_beyond_doubles_may_be_a_factor(value, exponent):
    expected = float(mpmath.mpf(value) * mpmath.exp(mpmath.mpf(exponent)))
    assert _times_exp(value, exponent) == near(expected, rel=1e-15)    # 2.2e-16


def test_a_power_below_doubles_is_zero():
    assert _times_exp(3.0, -701.0) == 0.0


class Told:
    """A course that says by out[1] which one it is."""

    def __init__(self, number, omega=lambda time: (0.0, 0.0, 0.0)):
        self._number, self._omega = number, omega

    def state(self, time, out):
        out[:] = 0.0
        out[:2], out[4], out[5:8] = (time, self._number), 1.0, self._omega(time)

    def states(self, times, out):
        for time, row in zip(times, out, strict=True):
            self.state(time, row)

    def entries_until(self, time):
        return time + 100.0


@pytest.mark.parametrize(('end', 'marches', 'until'), [
    (3.0, [3.0, 3.5, 7.0], [1.0, 2.9, 103.0, 103.5]),
    (math.inf, [], [0.5, 0.5, 0.5, 0.5])])    # what is left to lose is the square of NEAR
def test_a_march_goes_on_where_a_departure_ends(end, marches, until):
    near_axis, begun = Told(1.0), []
    near_axis.begin, near_axis.end = 0.5, end

    def march_from(vector):
        begun.append(vector[0])
        return Told(2.0)
    course, times = Departing(near_axis, march_from), np.array([7.0, 1.0, 3.0, 3.5, 2.9])
    out, one = np.zeros((5, 14)), np.zeros(14)
    course.states(times, out)
    assert out[:, 0].tolist() == times.tolist()
    assert sorted(out[out[:, 1] == 2.0, 0]) == marches
    for time, row in zip(times, out, strict=True):
        course.state(time, one)
        assert one[:2].tolist() == row[:2].tolist()
    assert begun == [3.0] * (end == 3.0)
    assert [course.entries_until(time) for time in (1.0, 2.9, 3.0, 3.5)] == until
    assert course.kinks(9.0) == []


def test_a_body_that_arrives_is_seen_at_the_first_of_fixed_times_after_it():
    """They are T, 2 T, 4 T, ... after the start, T as `relaxing` says; it arrives after 3 T."""
    scene = scene_of((1.0, 2.0, 2.5), axes=np.eye(3))
    start = state_of(scene, np.array([0.1, 0.2, 1.0]), np.eye(3))
    T, asked = relaxing(scene, start), []

    def omega(time):
        asked.append(time)
        return (0.1, 0.0, 1.0) if time < 2.0 + 3.0 * T else (1e-12, 0.0, 1.0)
    course = Arriving(scene, Told(5.0, omega), start)
    times = 2.0 + T * np.array([5.0, 0.0, 0.9, 1.0, 3.9, 4.0, 9.0])
    assert course.entries_until(2.0 + 0.9 * T) == 2.0 + 0.9 * T
    assert asked == []
    out, one = np.zeros((7, 14)), np.zeros(14)
    course.states(times, out)
    assert asked[:3] == near(2.0 + T * np.array([1.0, 2.0, 4.0]), rel=1e-15)
    assert (out[:, 1] == 5.0).tolist() == [False, True, True, True, True, False, False]
    for time, row in zip(times, out, strict=True):
        course.state(time, one)
        assert one[:2].tolist() == row[:2].tolist()
    assert len([time for time in asked if time >= 2.0 + 4.0 * T]) == 1
    assert course.entries_until(2.0 + 3.9 * T) == near(2.0 + 3.9 * T, rel=0.0)
    for late in (4.0, 5.0):
        assert course.entries_until(2.0 + late * T) == near(2.0 + 4.0 * T, rel=1e-15)
    again = Arriving(scene, Told(5.0, omega), start)
    again.state(2.0 + T, one)
    assert one[1] == 5.0
    assert again.entries_until(2.0 + 3.0 * T) == near(2.0 + 3.0 * T, rel=0.0)
    assert course.TELLS_EVENTS is False    # it has no function for them
    assert course.kinks(9.0) == []
