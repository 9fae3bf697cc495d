# SPDX-License-Identifier: Apache-2.0
"""The sleeping top's quantities, measured on made-up motions."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.study.scenes import sleeping_top

TOP = types.SimpleNamespace(I1=0.02, I3=0.01, Mgl=1.5)


@pytest.mark.parametrize('seed', [1e-6, 1e-3, 0.3, 4.0])
def test_at_the_threshold_a_seed_leads_as_far_as_its_energy_does(seed):
    """By hand: P^2 = 4 I1 M g l, x = tan^2(beta/2), e = I1 seed^2/(2 M g l): 2 x^2 = e (1 + x)."""
    e = TOP.I1 * seed * seed / (2.0 * TOP.Mgl)
    beta = 2.0 * math.atan(math.sqrt(0.25 * (e + math.sqrt(e * e + 8.0 * e))))
    top = types.SimpleNamespace(crossings=lambda *_: [0.7], read=lambda _, time: [time])
    run = types.SimpleNamespace(variant=lambda _: top)
    threshold = 2.0 * math.sqrt(TOP.I1 * TOP.Mgl)
    [tilt] = sleeping_top._at_the_threshold(run, TOP, threshold, seed)
    # below a hundredth the quartic term alone is taken
    assert tilt.predicted == near(beta, rel=1e-6 if beta < 0.01 else 1e-8)    # 5e-9; 1.1e-9
    assert (tilt.measured, tilt.unit) == (0.7, 'rad')


def sides(monkeypatch, ratio, across=(3e-6, 4e-6)):
    """Return what is checked of a top with P_gamma^2 at a ratio to its threshold, 12 kg m^2/s."""
    top = types.SimpleNamespace(beta=0.0, I1=4.0, I3=2.0, Mgl=9.0,
                                P_gamma=12.0 * math.sqrt(ratio))
    monkeypatch.setattr(sleeping_top, 'Top', lambda _: top)
    for name in ('_stable', '_falling', '_at_the_threshold'):
        monkeypatch.setattr(
            sleeping_top, name, lambda run, top, *given, name=name: [(name, *given)])
    run = types.SimpleNamespace(scene=types.SimpleNamespace(name='top'),
                                at=lambda time: types.SimpleNamespace(
                                    angular_velocity=np.array([*across, 99.0]) + time))
    return list(sleeping_top.check(run))


@pytest.mark.parametrize(('ratio', 'own'), [
    (4.0, [('_stable', 12.0, 5e-6, 4.0)]),
    # nine digits name it, but its own spin is run
    (2.0000000044, [('_stable', 6.0 * math.sqrt(2.0000000044), 5e-6, 2.000000004)]),
    (0.25, [('_falling', 3.0, 5e-6, 0.25)]),
    (1.0, []), (1.0 + 5e-7, []), (1.0 - 8e-7, []), (1.001, []),
    (1.0 + 1.2e-6, [('_stable', 6.0 * math.sqrt(1.0 + 1.2e-6), 5e-6, 1.0000012)]),
    (1.0 - 2e-6, [('_falling', 6.0 * math.sqrt(1.0 - 2e-6), 5e-6, 0.999998)])])
def test_both_sides_are_checked_and_the_scene_s_own_unless_it_is_at_the_threshold(
        monkeypatch, ratio, own):
    found = sides(monkeypatch, ratio)
    expected = [*own, ('_stable', 6.0 * math.sqrt(1.001), 5e-6, 1.001),
                ('_falling', 6.0 * math.sqrt(0.999), 5e-6, 0.999),
                ('_at_the_threshold', 12.0, 5e-6)]
    assert [one[0] for one in found] == [one[0] for one in expected]
    for one, other in zip(found, expected, strict=True):
        assert one[1:] == near(other[1:], rel=1e-14)    # measured: no error


def test_a_top_without_a_push_gets_a_small_one(monkeypatch):
    assert sides(monkeypatch, 4.0, (0.0, 0.0))[-1] == (
        '_at_the_threshold', 12.0, sleeping_top.SEED)
