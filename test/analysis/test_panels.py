# SPDX-License-Identifier: Apache-2.0
"""The curves of a report, from made-up numbers: what is shown, where it is broken, its limits."""

import types

import numpy as np
import pytest

from rigid_body_sim.analysis import panels
from rigid_body_sim.analysis.history import Mark
from rigid_body_sim.analysis.panels import Line

GAPS = types.SimpleNamespace(start=10**9, history=types.SimpleNamespace(marks=(
    Mark(10**9, 'commands', '', {}),
    Mark(3 * 10**9, 'gap', '', {}))), topics=('angular_velocity',))
"""A recording that starts at 1 s, with a hole after 2 s of it."""


def curve(*columns):
    """Return a stand-in of a Curve with times and columns."""
    times, *values = (np.array(column, dtype=float) for column in columns)
    return types.SimpleNamespace(curve=lambda which=0: (times, values[which]))


def test_curves_are_broken_after_a_hole_and_nowhere_else():
    omega = curve([0, 1, 2, 3], [1, 2, 3, 4], [5, 6, 7, 8], [9, 8, 7, 6])
    measured = types.SimpleNamespace(source=GAPS, angular_velocity=omega)
    panel = panels.angular_velocity(measured)
    assert [line.name for line in panel.lines] == ['x', 'y', 'z']
    for line, shown in zip(panel.lines, ([1, 2, 3], [5, 6, 7], [9, 8, 7]), strict=True):
        np.testing.assert_array_equal(line.x, [0, 1, 2, np.nan, 3])
        np.testing.assert_array_equal(line.y[:3], shown)
        assert np.isnan(line.y[3])
    silent = types.SimpleNamespace(source=types.SimpleNamespace(topics=()))
    assert panels.angular_velocity(silent) is None


def test_angles_are_broken_where_they_jump_by_more_than_half_a_turn():
    line = panels._unwound(Line('a', np.arange(5.0), np.array([0.0, np.pi, -3.0, 0.1, 3.4])))
    np.testing.assert_array_equal(line.x, [0, 1, np.nan, 2, 3, np.nan, 4])
    np.testing.assert_array_equal(line.y, [0, np.pi, np.nan, -3, 0.1, np.nan, 3.4])


def travelling(times, position):
    columns = (np.array(times), None, None, np.array(position, dtype=float))
    samples = types.SimpleNamespace(columns=lambda: columns)
    return types.SimpleNamespace(motion=types.SimpleNamespace(samples=samples))


def test_the_velocity_of_a_travel_is_the_slope_of_its_positions():
    """At the ends that of one step, between them that of the two steps beside."""
    position, velocity = panels.travel(travelling(
        [0.0, 0.5, 1.0], [[1, 0, 2], [2, 0, 2], [5, 0, 2]]))
    assert [line.name for line in position.lines] == ['x', 'y', 'z']
    assert [list(line.y) for line in position.lines] == [[1, 2, 5], [0, 0, 0], [2, 2, 2]]
    assert [list(line.y) for line in velocity.lines] == [[2, 4, 6], [0, 0, 0], [0, 0, 0]]
    assert (position.name, velocity.name) == ('position', 'velocity')
    assert not position.log and not position.steps


@pytest.mark.parametrize('measured', [
    types.SimpleNamespace(motion=None),
    types.SimpleNamespace(motion=types.SimpleNamespace(samples=types.SimpleNamespace(
        columns=tuple))),
    travelling([0.0, 1.0], [[0, 0, 0], [1, 0, 0]]),
    travelling([0.0, 1.0, 2.0], 3 * [[1, 2, 3]])])
def test_a_body_that_stays_where_it_is_has_no_travel(measured):
    assert panels.travel(measured) == []


def test_the_lateness_of_each_second_holds_to_its_end():
    """In us, from 1 us on; up to a ms, or twice the latest."""
    def shown(*groups):
        return panels.lateness(types.SimpleNamespace(
            source=GAPS, punctuality=types.SimpleNamespace(curve=lambda: np.array(groups))))
    panel = shown([1e9, 2e9, 500, 4e3, 6e5], [2e9, 4e9, 2e3, 5e3, 7e5])
    assert panel.steps and panel.log and panel.limits == (1.0, 1400.0)
    found = {line.name: (list(line.x), list(line.y)) for line in panel.lines}
    assert found == {'p50': ([0, 1, 3], [1, 2, 2]), 'p99': ([0, 1, 3], [4, 5, 5]),
                     'max': ([0, 1, 3], pytest.approx([600, 700, 700], abs=1e-9))}
    assert shown([1e9, 2e9, 1e3, 1e3, 1e3]).limits == (1.0, 1000.0)
    assert panels.lateness(types.SimpleNamespace(punctuality=types.SimpleNamespace(
        curve=lambda: np.empty((0, 5))))) is None


def test_only_what_differs_is_shown_of_a_rerun():
    """Zeros among differences are drawn as 1e-18, for an axis of powers."""
    comparison = types.SimpleNamespace(
        largest={'energy': {'difference': 1e-300}, 'position': {'difference': 0.0}},
        curve=lambda name: (np.array([0.0, 1.0, 2.0]), np.array([0.0, 1e-300, 3e-18])))
    [panel] = panels.differences(comparison)
    assert (panel.name, panel.label, panel.log) == (
        'difference_energy', 'difference of\nenergy (J)', True)
    assert list(panel.lines[0].y) == [1e-18, 1e-18, 3e-18]


def residual(of_it, of_values=((), ())):
    found = types.SimpleNamespace(curve=curve(*of_it).curve, values=curve(*of_values),
                                  not_kept_from=[3 * 10**9])
    return panels.residual(found, GAPS, 'energy', 'J')


def test_a_quantity_that_is_not_kept_is_shown_itself_and_one_that_is_by_its_residual():
    kept = residual(([0.0, 2.0, 3.0], [1.0, 2.0, 3.0]), ([0.0], [7.0]))
    assert (kept.name, kept.band) == ('residual_energy', 4.0 * np.finfo(float).eps)
    np.testing.assert_array_equal(kept.lines[0].x, [0, 2, np.nan, 3])
    other = residual(((), ()), ([0.0, 1.0], [7.0, 8.0]))
    assert (other.name, other.label, other.band) == ('energy', 'energy\n(J)', 0.0)
    assert list(other.lines[0].y) == [7.0, 8.0]
    assert residual(((), ())) is None


def followed(slip=None, momentum=None, conserved='L'):
    return types.SimpleNamespace(
        angular_velocity_world=curve(*np.arange(8.0).reshape(4, 2)),
        euler=curve([0.0, 1.0], [3.0, -3.0], [1.0, 1.0], [0.0, 1.0]), momentum=momentum,
        slip=slip, conserved=types.SimpleNamespace(name=conserved))


def test_what_follows_from_the_motion_is_shown_as_far_as_it_is_known(monkeypatch):
    whole = types.SimpleNamespace(start=0, history=types.SimpleNamespace(marks=()))

    def shown(**more):
        return panels.motion(types.SimpleNamespace(motion=followed(**more), source=whole))
    always = ['angular_velocity_world', 'euler_\N{GREEK SMALL LETTER ALPHA}', 'euler_β',
              'euler_\N{GREEK SMALL LETTER GAMMA}']
    assert [panel.name for panel in shown()] == always
    assert [len(panel.lines[0].x) for panel in shown()] == [2, 3, 2, 2]
    momentum = types.SimpleNamespace(judged=1, curve=curve([0.0], [1.0]).curve, not_kept_from=[])
    assert shown(momentum=momentum)[-1].name == 'residual_vector L'
    assert shown(momentum=momentum, conserved='L_z')[-1].name == 'residual_vertical L'
    momentum.judged = 0
    assert [panel.name for panel in shown(momentum=momentum)] == always

    kinds = [{'kind': kind, 'from': 0.5 * k, 'to': 0.5 * k + 0.1}
             for k in range(101) for kind in ('slip', 'roll')]
    monkeypatch.setattr(panels, 'phases', lambda follows: kinds)
    slip = shown(slip=curve([0.0, 1.0], [2.0, 3.0]))[-1]
    assert slip.name == 'slip' and list(slip.lines[0].y) == [2.0, 3.0]
    # at most a hundred
    assert slip.spans == tuple(('slip', 0.5 * k, 0.5 * k + 0.1) for k in range(100))
    assert panels.motion(types.SimpleNamespace(motion=None)) == []


def test_the_ledger_has_its_terms_and_their_residuals():
    times = np.arange(2.0)
    names = ('kinetic', 'potential', 'dissipated', 'work', 'energy_residual', 'momentum_residual')
    terms = {name: k + times for k, name in enumerate(names)}
    joules, balance = panels.energies((times, terms))
    assert {line.name: line.y[0] for line in joules.lines} == {
        'kinetic': 0, 'potential': 1, 'dissipated': 2, 'work': 3}
    assert {line.name: line.y[0] for line in balance.lines} == {'energy': 4, 'momentum': 5}
    assert joules.band == 0.0 and balance.band == 4.0 * np.finfo(float).eps
