# SPDX-License-Identifier: Apache-2.0
"""The first step of a flight: no hop hides within it."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations.contact_views import FLIGHT, ROLLING, ROW, UNKNOWNS
from rigid_body_sim.integrators.marching import contact_march, contact_phase
from rigid_body_sim.integrators.marching.contact_phase import (
    GAP,
    MODE,
    SWIFT,
    TIME,
    Phase,
    _hop,
)
from rigid_body_sim.mechanics.contact.parameters import CONTACT

pytestmark = pytest.mark.without_numba

PLACE = UNKNOWNS.part('place').first
FAINT = 2.0 ** -9    # m/s, half of what is rounding


def hop(v, a, j, pace=1.0):
    """Return how long the first step may be where the gap is v t + a t^2/2 + j t^3/6."""
    seen = []

    def rate(p, y, row):
        t = y[TIME]
        row[TIME], row[PLACE], row[GAP] = 1.0, 3.0, v + t * (a + 0.5 * j * t)
        seen.append((t, y[PLACE]))
    p, y, work = np.zeros(CONTACT.size), np.zeros(UNKNOWNS.size), np.zeros((3, ROW.size))
    p[SWIFT] = 4.0
    rate(p, y, work[0])
    found = _hop(types.SimpleNamespace(rate=rate, ROUNDING=2.0 ** -10), p, y, work, pace)
    short = 2.0 ** -12 / pace
    assert seen == [(n * short, 3.0 * n * short) for n in range(3)]
    return found


@pytest.mark.parametrize(('v', 'a', 'j', 'end'), [
    (1.0, -10.0, 0.0, 0.2), (3.0, -4.0, 5.0, 1.5),     # a parabola: 2 v/|a|
    (0.0, 2.0, -3.0, 2.0), (FAINT, 2.0, -3.0, 2.0), (-1.0, 2.0, -3.0, 2.0),    # 3 a/|j|
    (1.0, 0.0, -6.0, 1.0), (6.0, 1.0, -9.0, 2.0),      # the root of 6 v/|j|
    (1.0, 4.0, -6.0, 2.0),                             # the longer of both
    (4.0 * FAINT, -1.0, 0.0, 8.0 * FAINT),
    (FAINT, -1.0, 0.0, math.inf), (2.0 * FAINT, -1.0, 0.0, math.inf),    # rounding is no hop
    (0.0, -1.0, -1.0, math.inf), (-1.0, -1.0, 0.0, math.inf),
    (1.0, 0.0, 0.0, math.inf), (0.0, 1.0, 0.0, math.inf), (0.0, 1.0, 1.0, math.inf),
    (FAINT, 0.0, -6.0, 0.0)])
@pytest.mark.parametrize('pace', [1.0, 4.0])
def test_the_first_step_of_a_flight_is_no_longer_than_one_and_a_half_of_its_hop(
        v, a, j, end, pace):
    """Each is seen 2^-12/pace and twice that later: differences of a quadratic are exact."""
    assert hop(v, a, j, pace) == near(1.5 * end, rel=1e-7)    # the rounding of v: 2^-53/2^-24


@pytest.mark.parametrize(('mode', 'planned', 'taken'), [
    (FLIGHT, 1.0, 0.3), (FLIGHT, 0.1, 0.1), (ROLLING, 1.0, 1.0),
    (FLIGHT, 2.0 ** 22, 4.0)])    # a hop below 2^-20 of a step is rounding
def test_a_phase_begins_with_the_step_that_is_planned_or_with_that_of_its_hop(
        monkeypatch, mode, planned, taken):
    """The gap is t - 5 t^2: a hop of 0.2 s."""
    def rate(p, y, row):
        row[TIME], row[GAP] = 1.0, 1.0 - 10.0 * y[TIME]

    def begin(p, rates, front, meta, y):
        meta[contact_march.PLANNED] = planned
    monkeypatch.setattr(contact_phase, 'lies_low', lambda *_: False)
    bound = types.SimpleNamespace(
        kernels_of=lambda *_: types.SimpleNamespace(begin=begin),
        rates=types.SimpleNamespace(rate=rate, ROUNDING=2.0 ** -10))
    p = np.zeros(CONTACT.size)
    p[MODE], p[SWIFT] = mode, 1.0
    phase = Phase(bound, p, np.zeros(UNKNOWNS.size), 1e-9, np.zeros((3, ROW.size)), 1.0)
    assert phase._meta[contact_march.PLANNED] == near(taken, rel=1e-7)
