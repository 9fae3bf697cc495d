# SPDX-License-Identifier: Apache-2.0
"""The parts of a step of a body on a plane, each beside its formula."""

import math

import numpy as np
import pytest
from near import near
from scipy.integrate import DOP853
from scipy.spatial.transform import Rotation

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations.contact_views import (
    FLIGHT,
    ROLLING,
    ROW,
    SLIDING,
)
from rigid_body_sim.integrators.marching import contact_step
from rigid_body_sim.integrators.marching.contact_step import (
    COUPLED,
    FRESH,
    KIND,
    LARGE,
    LEVEL,
    MODE,
    OMEGA,
    SIZE,
    STAGES,
    TRIED,
    U,
)
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.scene.surfaces import ELLIPSOID, TORUS

pytestmark = pytest.mark.without_numba


def room():
    return np.zeros((contact_step.WORK_ROWS, ROW.size))


@pytest.mark.parametrize(('mode', 'kind', 'level', 'share', 'nears'), [
    (FLIGHT, TORUS, 0.0, 0.49, True), (FLIGHT, TORUS, 0.0, 0.51, False),
    (ROLLING, TORUS, 0.0, 0.49, False), (FLIGHT, ELLIPSOID, 0.0, 0.49, False),
    (FLIGHT, TORUS, 1.0, 0.49, False)])
@pytest.mark.parametrize('turn', [0.0, math.pi])
def test_a_ring_in_flight_turns_through_flat_in_no_step(mode, kind, level, share, nears, turn):
    """At (3, 4, -9) rad/s it turns by 0.1 rad in 0.02 s; its inclination is sin 0.2 = 0.1987."""
    p, y = np.zeros(CONTACT.size), np.zeros(SIZE)
    p[MODE], p[KIND], p[LEVEL] = mode, kind, level
    y[:4] = Rotation.from_rotvec([turn + 0.2, 0.0, 0.0]).as_quat()
    y[OMEGA:U] = 3.0, 4.0, -9.0
    assert bool(contact_step.nears_flat(p, y, 0.02, share)) is nears


def test_a_step_that_a_ring_may_turn_through_flat_in_is_refused():
    p, y = np.zeros(CONTACT.size), np.zeros(SIZE)
    p[MODE], p[KIND], y[3], y[OMEGA] = FLIGHT, TORUS, 1.0, 1.0
    assert contact_step.step_from(p, room(), y, np.zeros(SIZE), 1e-9) == math.inf


def test_an_unknown_counts_beside_the_scale_of_its_kind():
    """Of rad/s 4, of m/s 5, of m 8; a time counts by the turn in it, an attitude as it is."""
    found = [contact_step.weight_of(n, (4.0, 5.0, 8.0)) for n in range(COUPLED)]
    assert found == [1.0] * 4 + [0.25] * 3 + [0.2] * 3 + [0.125] * 3 + [4.0]


@pytest.mark.parametrize(('value', 'change', 'sound'), [
    (1.0, 2.0 ** -60, True), (3.0, -0.7, True), (0.5 * LARGE, 0.49 * LARGE, True),
    (0.5 * LARGE, 0.51 * LARGE, False), (-0.5 * LARGE, -0.51 * LARGE, False),
    (1.0, math.nan, False), (1.0, math.inf, False)])
def test_what_a_sum_loses_is_kept(value, change, sound):
    w, y = room(), np.zeros(SIZE)
    y[6] = value
    with np.errstate(invalid='ignore'):
        assert bool(contact_step.add(w, y, 6, change)) is sound
    if sound and abs(value) < 10.0:
        assert w[FRESH, 6] == value + change
        # exact where the value is the larger one
        assert math.fsum([w[FRESH, 6], w[TRIED, 6], -value, -change]) == 0.0
    assert not np.delete(w, 6, axis=1).any()


@pytest.mark.parametrize('norm', [1.0, 1.0 + 1e-9, 0.5])
def test_an_attitude_gets_the_norm_1_and_keeps_what_is_lost_across_it(norm):
    """What lies along it makes it no longer."""
    w = room()
    q, short = Rotation.random(random_state=3).as_quat(), np.array([1e-3, -2e-3, 3e-3, 4e-3])
    w[FRESH, :4], w[TRIED, :4], w[TRIED, 4] = norm * q, short, 7.0
    contact_step.normalise(w)
    assert w[FRESH, :4] == pytest.approx(q, abs=2e-16)
    # measured: 2e-19
    assert w[TRIED, :4] == pytest.approx(short - (short @ q) * q, abs=2e-16)
    assert w[TRIED, 4] == 7.0


def test_the_error_of_a_step_is_that_of_its_two_estimates():
    """The DOP853 of scipy has the same two, and takes their mean over the unknowns."""
    K, scales = np.zeros((STAGES + 1, COUPLED)), (4.0, 5.0, 8.0)
    K[:STAGES] = np.random.default_rng(6).normal(size=(STAGES, COUPLED))
    weights = np.array([contact_step.weight_of(n, scales) for n in range(COUPLED)])
    w = room()
    w[:STAGES, :COUPLED] = K[:STAGES]
    solver = DOP853(lambda t, y: y, 0.0, np.ones(COUPLED), 1.0)
    expected = solver._estimate_error_norm(K, 0.3, 1.0 / weights) * math.sqrt(COUPLED)
    # measured: 2e-16
    assert contact_step.error_of(w, 0.3, scales) == near(expected, rel=1e-14)
    assert contact_step.error_of(room(), 0.3, scales) == 0.0    # nothing moves
    w[:STAGES, :COUPLED] *= 1e200    # the squares leave the range of doubles
    with np.errstate(over='ignore'):
        assert contact_step.error_of(w, 0.3, scales) == math.inf


@pytest.mark.parametrize(('faint', 'told'), [(0.9, False), (1.1, True)])
def test_an_error_below_the_rounding_of_the_step_counts_as_none(faint, told):
    """All stages agree but for one of which the step takes no part: 2^-49 of it is rounding."""
    w = room()
    j = next(j for j in range(STAGES) if contact_step.E5[j] != 0.0)
    w[:STAGES, 0] = 1.0
    ratio = 2.0 ** -49 * faint
    w[:STAGES, 1] = 0.0
    w[j, 1] = ratio / abs(contact_step.E5[j])
    found = contact_step.error_of(w, 0.5, (1.0, 1.0, 1.0))
    assert bool(found > 0.0) is told
    assert contact_step.longest(w, 0.5) == math.inf


@pytest.mark.parametrize('mode', [SLIDING, ROLLING])
def test_a_step_of_what_does_not_end_is_refused(mode):
    w, y, p = room(), np.zeros(SIZE), np.zeros(CONTACT.size)
    p[MODE], y[3] = mode, 1.0
    w[0, OMEGA] = 2.0 * LARGE / contact_step.A[1, 0]
    assert contact_step.step_from(p, w, y, np.zeros(SIZE), 1.0) == math.inf


LINEAR = specialise(contact_step, rate=f'def rate(p, y, row):\n'
                                       f'    row[:{SIZE}] = p[{CONTACT.size}] @ y[:{SIZE}]\n')


def test_a_step_is_that_of_dop853():
    """On linear equations, beside the table of scipy; the ledger depends on what is coupled."""
    draw, h = np.random.default_rng(2), 0.4
    matrix, y, lost = draw.normal(size=(SIZE, SIZE)), draw.normal(size=SIZE), np.zeros(SIZE)
    matrix[:, COUPLED:] = 0.0
    y[:4] /= np.linalg.norm(y[:4])
    p, w, K = [0.0] * CONTACT.size + [matrix], room(), np.zeros((STAGES, SIZE))
    p[MODE] = ROLLING
    for i in range(STAGES):
        K[i] = matrix @ (y + h * DOP853.A[i, :i] @ K[:i])
    w[0, :SIZE], lost[SIZE - 1] = K[0], 0.25
    assert LINEAR.step_from(p, w, y, lost, h) == 0.0
    expected = y + h * DOP853.B @ K + lost
    expected[:4] /= np.linalg.norm(expected[:4])
    # measured: 3e-14 of the largest, since the terms of stages nearly cancel
    assert w[FRESH, :SIZE] == pytest.approx(expected, abs=3e-13 * np.abs(expected).max())
    assert w[1:STAGES, :SIZE] == pytest.approx(K[1:], abs=3e-13 * np.abs(K).max())
    # what is too large to go on from, at its end and in a stage
    for n, most in ((SIZE - 1, 1.1 * LARGE), (0, math.nan)):
        y[n] = most
        with np.errstate(invalid='ignore'):
            assert LINEAR.step_from(p, w, y, lost, 1e-9) == math.inf
        y[n] = 0.5
