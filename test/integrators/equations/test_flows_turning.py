# SPDX-License-Identifier: Apache-2.0
"""The flows of compositions: kicks by hand, and what their sums carry, in exact numbers."""

import math
from fractions import Fraction

import numpy as np
import pytest
from near import near

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import euler, flows_flying, flows_hinged, flows_turning
from rigid_body_sim.integrators.equations.free_turn import turned_freely
from rigid_body_sim.numerics.rotations import multiply

pytestmark = pytest.mark.without_numba

MASS, H = 2.5, 0.3
Q = (0.1, -0.5, 0.5, 0.7)
Y = (*Q, 1.0, -2.0, 3.0, 4.0, -5.0, 6.0, 7.0, -8.0, 9.0)
C = tuple((-1.0) ** k * (k + 1.0) * 1e-18 for k in range(13))
ROWS = {name: np.random.default_rng(seed).normal(size=(3, 10)).round(3)
        for seed, name in enumerate(('torque', 'turning', 'force'))}
MOMENTS = [(0.3, 0.7, 0.9), (0.0, 0.7, 0.9), (0.3, 0.0, 0.9), (0.3, 0.7, 0.0)]


def linear(name):
    """Return the source of a kernel that is another linear function of each argument."""
    return (f'def {name}(p, *state):\n    return tuple(sum(a * b for a, b in zip(row, state)) '
            f'for row in {ROWS[name].tolist()})\n')


def parameters(moments):
    """Return the parameters of a body; one without a moment about an axis is not turned there."""
    p = np.zeros(euler.FIXED)
    p[euler.MASS] = MASS
    p[euler.MOMENTS:euler.MOMENTS + 3] = moments
    p[euler.INVERSE:euler.INVERSE + 3] = [1.0 / one if one else 0.0 for one in moments]
    return p


def flows(flies):
    """Return the flows of a body that turns, or that flies, too."""
    rotation = {name: linear(name) for name in ('torque', 'turning')}
    if not flies:
        return specialise(flows_turning, **rotation)
    module = flows_turning.__name__
    return specialise(flows_flying, force=linear('force'), **rotation, **{
        f'rotation_{name}': f'{module}:{name}' for name in ('drift', 'added', 'turned')})


def exactly(y, c):
    """Return the sums that doubles and what they lost stand for."""
    return [Fraction(a) + Fraction(b) for a, b in zip(y, c, strict=True)]


def forces(y):
    """Return torque, turning rate and force at a state."""
    state = np.array([*y[:7], *(y[10:] if len(y) > 7 else (0.0, 0.0, 0.0))])
    return [ROWS[name] @ state for name in ('torque', 'turning', 'force')]


def after(y, time, torque, rate, force, moments):
    """Return a state after torque, turning rate and force have acted as they are for a time."""
    turn = time * np.array(rate)
    half = 0.5 * np.linalg.norm(turn)
    q = multiply(*y[:4], *(math.sin(half) / (2.0 * half) * turn), math.cos(half))
    grown = [time * t / one if one else 0.0 for t, one in zip(torque, moments, strict=True)]
    moved = [*y[7:10], *(np.array(y[10:]) + time * force / MASS)] if len(y) > 7 else []
    return np.array([*(q / np.linalg.norm(q)), *np.add(y[4:7], grown), *moved])


@pytest.mark.parametrize('flies', [False, True])
@pytest.mark.parametrize('moments', MOMENTS)
def test_a_kick_is_what_acts_times_the_time_and_loses_nothing(flies, moments):
    """It adds h Gamma/I to omega and h F/M to v; the rest stays, and so does what was lost."""
    y, c = (Y, C) if flies else (Y[:7], C[:7])
    torque, _, force = forces(y)
    added = [0.0] * 4 + [H * t / one if one else 0.0
                         for t, one in zip(torque.tolist(), moments, strict=True)]
    added += [0.0] * 3 + [H * f / MASS for f in force.tolist()] if flies else []
    found = exactly(*flows(flies).kick(parameters(moments), y, c, H))
    for one, before, more in zip(found, exactly(y, c), added, strict=True):
        # measured: 2e-16 of what is added
        assert abs(one - before - Fraction(more)) <= 1e-15 * abs(more)


@pytest.mark.parametrize('flies', [False, True])
@pytest.mark.parametrize('moments', MOMENTS)
def test_a_kick_with_heat_is_the_midpoint_rule(flies, moments):
    """What acts halfway, at the state that what acts at first leads to, acts all the time."""
    y, c = (Y, C) if flies else (Y[:7], C[:7])
    halfway = after(y, 0.5 * H, *forces(y), moments)
    expected = after(y, H, *forces(halfway), moments)
    found, lost = flows(flies).kick_with_heat(parameters(moments), y, c, H)
    # measured: 3e-16
    assert found == near(expected, rel=4e-15)
    # q is new and has lost nothing; what does not change keeps what it has lost
    assert lost[:4] == (0.0, 0.0, 0.0, 0.0)
    for k in (*(4 + n for n in range(3) if not moments[n]), *(range(7, 10) if flies else ())):
        assert (found[k], lost[k]) == (y[k], c[k])
    # the sums add what they have lost before, too
    more = flows(flies).kick_with_heat(parameters(moments), y, (0.0,) * len(y), H)
    for k, (one, other) in enumerate(zip(exactly(found, lost), exactly(*more), strict=True)):
        assert float(one - other) == (0.0 if k < 4 else near(c[k], rel=1e-12))


def test_a_drift_of_a_body_that_flies_goes_straight_on_and_turns_freely():
    p = parameters(MOMENTS[0])
    y, c = flows(True).drift(p, Y, C, H)
    (q, lost), more = turned_freely(p, Y[:7], C[:7], H), [H * v for v in Y[10:]]
    assert (y[:7], c[:7]) == (q, lost)
    assert (y[10:], c[10:]) == (Y[10:], C[10:])
    found, before = exactly(y[7:10], c[7:10]), exactly(Y[7:10], C[7:10])
    for one, start, step in zip(found, before, more, strict=True):
        assert abs(float(one - start - Fraction(step))) < 1e-30    # measured: 4.7e-32


def test_flows_of_a_hinge_are_the_same_in_one_angle():
    """The growth of the rate is -2 phi - 3 phi': a spring with a damper."""
    bound = specialise(
        flows_hinged, rate='def rate(p, y):\n    return y[1], -2.0*y[0] - 3.0*y[1]\n')
    y, c = (0.7, -1.3), (3e-18, -5e-18)
    before = exactly(y, c)

    def added(flow):
        return [float(one - start) for one, start in
                zip(exactly(*flow(None, y, c, H)), before, strict=True)]
    growth = -2.0 * 0.7 + 3.0 * 1.3
    assert added(bound.drift) == near([H * -1.3, 0.0], rel=1e-15)
    assert added(bound.kick) == near([0.0, H * growth], rel=1e-15)
    halfway = -2.0 * 0.7 - 3.0 * (-1.3 + 0.5 * H * growth)
    assert added(bound.kick_with_heat) == near([0.0, H * halfway], rel=1e-15)
