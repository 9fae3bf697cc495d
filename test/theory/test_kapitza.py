# SPDX-License-Identifier: Apache-2.0
"""Kapitza's pendulum: Mathieu functions of SciPy, a pivot at rest, and a fast drive."""

import math

import pytest
from near import near
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from rigid_body_sim.theory import kapitza as theory

G, LENGTH, W = 9.81, 0.2, 30.0


def amplitude_of(characteristic):
    """Return the amplitude (m) at which a Mathieu function is periodic.

    With x = w t/2 the tilt obeys y'' + (a - 2 q cos(2 x)) y = 0, a = -4 g/(l w^2), q = 2 A/l.
    """
    a = -4.0 * G / (LENGTH * W * W)
    return 0.5 * LENGTH * brentq(lambda q: characteristic(q) - a, 1e-3, 2.0, xtol=1e-15)


# measured: 2e-14, 6e-14 and 1.2e-13
def test_the_edges_of_stability_are_those_of_mathieu_functions():
    lowest = amplitude_of(lambda q: mathieu_a(0, q))
    assert theory.edge(W, G, LENGTH) == near(lowest, rel=1e-10)
    assert theory.trace(lowest, W, G, LENGTH) == near(2.0, rel=1e-11)
    assert theory.trace(amplitude_of(lambda q: mathieu_b(1, q)), W, G, LENGTH) == near(
        -2.0, rel=1e-11)


# measured: at most 1e-13
@pytest.mark.parametrize(('g', 'function'), [(G, math.cosh), (-G, math.cos)])
def test_on_a_pivot_at_rest_it_falls_or_hangs(g, function):
    angle = 2.0 * math.pi / W * math.sqrt(abs(g) / LENGTH)
    assert theory.trace(0.0, W, g, LENGTH) == near(2.0 * function(angle), rel=1e-12)


def test_a_fast_drive_holds_it_upright_at_the_slow_rate():
    """The deviation of the averaged rate shrinks as 1/w^2 at the same A w."""
    speed = 1.5 * theory.threshold(G, LENGTH)
    assert theory.threshold(G, LENGTH) == near(math.sqrt(3.924), rel=1e-15)
    deviations = []
    for w in (200.0, 400.0):
        slow = theory.slow_rate(speed / w, w, G, LENGTH)
        angle = math.acos(0.5 * theory.trace(speed / w, w, G, LENGTH))
        deviations.append(angle * w / (2.0 * math.pi * slow) - 1.0)
    # measured: 0.0034 and 0.0008
    assert abs(deviations[0]) < 0.005
    assert deviations[0] / deviations[1] == near(4.0, rel=0.05)
    assert theory.slow_rate(theory.threshold(G, LENGTH) / W * 1.25, W, G, LENGTH) == near(
        math.sqrt((1.25**2 - 1.0) * G / LENGTH), rel=1e-14)
