# SPDX-License-Identifier: Apache-2.0
"""The rows of a confirmed scene: its quantities by each way, and the ways compared."""

import types

import numpy as np
import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes import confirm
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.study.scenes.systems import System


def scene(name='made', kind='pivot', effects=('gravity', 'drag')):
    return types.SimpleNamespace(
        name=name, constraint=types.SimpleNamespace(kind=kind),
        effects=[types.SimpleNamespace(name=effect) for effect in effects])


def check(run):
    for name in ('first', 'second'):
        yield Quantity(name, 1.0, run.method, 0.5)


@pytest.fixture
def made(monkeypatch):
    """Give a made-up scene, which two ways move: by `angle` and `rate` apart at the end alone."""
    apart = types.SimpleNamespace(angle=0.0, rate=0.0, spin=4.0, ways=['exact', 'dop8', 'auto'])

    class Run:
        def __init__(self, scene, method, accuracy):
            assert accuracy == 1e-5
            self.method = method

        def states(self, times):
            assert (times[0], times[-1]) == (0.0, 12.5)
            other = (self.method == 'dop8') * (times == 12.5)
            half, spin = 0.5 * apart.angle * other, apart.spin * np.cos(times)
            spin[0] *= 2.0
            return types.SimpleNamespace(
                orientation=np.stack([0.0 * half, np.sin(half), 0.0 * half, np.cos(half)], 1),
                angular_velocity=np.stack([0.6 * spin + apart.rate * other, 0.8 * spin,
                                           0.0 * half], 1))
    monkeypatch.setattr(confirm, 'SYSTEMS', {'made': System(check, 12.5, 0.02, 1e-5)})
    monkeypatch.setattr(confirm, 'load_scene', scene)
    monkeypatch.setattr(confirm, 'Experiment', Run)
    monkeypatch.setattr(confirm, 'methods_for', lambda _: apart.ways)
    return apart


@pytest.mark.parametrize(('angle', 'rate', 'spin', 'expected'), [
    (0.03, 0.0, 4.0, 0.03), (-0.03, 0.04, 4.0, 0.03), (0.01, -0.4, 4.0, 0.05),
    (0.01, 0.4, 0.0, 0.4), (0.0, 0.0, 0.0, 0.0)])
def test_two_ways_differ_by_an_angle_or_by_a_share_of_the_largest_rate(
        made, angle, rate, spin, expected):
    made.angle, made.rate, made.spin = angle, rate, spin
    *rows, last = confirm.confirm(scene())
    assert [{way: (one.name, one.measured) for way, one in row.items()} for row in rows] == [
        {way: (name, way) for way in ('exact', 'dop8')} for name in ('first', 'second')]
    [both] = last.values()
    assert list(last) == ['both']
    assert (both.name, both.predicted, both.tolerance, both.absolute) == (
        'attitude and omega, exact against dop8, 12.5 s', 0.0, 0.02, True)
    assert both.measured == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_one_way_has_nothing_to_be_compared_with(made):
    made.ways = ['dop8', 'auto']
    assert [list(row) for row in confirm.confirm(scene())] == [['dop8'], ['dop8']]


@pytest.mark.parametrize(('other', 'says'), [
    (scene('unknown'), 'no formula'), (scene(kind='free'), 'constraint here: free'),
    (scene(effects=['gravity']), 'effects here: gravity'),
    (scene(effects=()), 'effects here: none')])
def test_another_scene_is_refused(made, other, says):
    with pytest.raises(BadInput) as refusal:
        confirm.confirm(other)
    assert says in refusal.value.problem


def test_shapes_are_measured_by_both_methods(monkeypatch):
    monkeypatch.setattr(confirm.inertia_tensors, 'check', lambda method: [
        Quantity(name, 1.0, method, 0.5) for name in ('rod', 'box')])
    assert [{way: (one.name, one.measured) for way, one in row.items()}
            for row in confirm.confirm_shapes()] == [
        {way: (name, way) for way in ('quadrature', 'blow')} for name in ('rod', 'box')]
