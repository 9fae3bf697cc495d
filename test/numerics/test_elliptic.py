# SPDX-License-Identifier: Apache-2.0
"""Elliptic integrals and functions against mpmath, near every limit."""

import mpmath as mp
import numpy as np
import pytest
from near import near

from rigid_body_sim.numerics.elliptic import (
    _rf_series,
    _rj_series,
    _spread,
    agm,
    agm_pair,
    carlson_rc,
    carlson_rf,
    carlson_rf_pair,
    carlson_rj,
    complete_k,
    jacobi,
    nome,
)

EPSILON = np.finfo(float).eps
TRIPLES = 10.0 ** np.random.default_rng(11).uniform(-8.0, 3.0, (60, 4))


def worst(pairs):
    """Return the largest relative error of (found, exact)."""
    with mp.workdps(40):
        return float(max(abs(mp.mpf(found) / exact - 1) for found, exact in pairs))


@pytest.fixture(autouse=True)
def forty_digits():
    with mp.workdps(40):
        yield


def test_first_kind():
    # measured 2.0
    assert (worst((carlson_rf(x, y, z), mp.elliprf(x, y, z)) for x, y, z, _ in TRIPLES)
            < 3.0 * EPSILON)
    assert (worst((carlson_rf(0.0, y, z), mp.elliprf(0, y, z)) for _, y, z, _ in TRIPLES)
            < 3.0 * EPSILON)
    assert (worst([(carlson_rf(0.0, 1e-300, 1.0), mp.elliprf(0, 1e-300, 1)),
                   (carlson_rf(2.0, 2.0, 2.0), 1 / mp.sqrt(2))]) < 3.0 * EPSILON)
    for (x, y, z, _), (u, v, w, _) in zip(TRIPLES[:20], TRIPLES[20:40], strict=True):
        both = carlson_rf_pair(x, y, z, u, v, w)
        assert both == near((carlson_rf(x, y, z), carlson_rf(u, v, w)), rel=3.0 * EPSILON)


def test_elementary_limit():
    # measured 1.8
    assert worst((carlson_rc(x, y), mp.elliprc(x, y)) for x, y, _, _ in TRIPLES) < 3.0 * EPSILON
    assert (worst([(carlson_rc(0.0, 1.0), mp.pi / 2), (carlson_rc(3.0, 3.0), 1 / mp.sqrt(3))])
            < 2.0 * EPSILON)


def test_third_kind():
    """R_J is accurate for p far below the others, where the usual duplication loses digits."""
    # measured 3.0
    assert (worst((carlson_rj(x, y, z, p), mp.elliprj(x, y, z, p)) for x, y, z, p in TRIPLES)
            < 5.0 * EPSILON)
    assert (worst((carlson_rj(0.0, y, z, p), mp.elliprj(0, y, z, p)) for _, y, z, p in TRIPLES)
            < 5.0 * EPSILON)
    assert (worst((carlson_rj(x, y, z, z), mp.elliprd(x, y, z)) for x, y, z, _ in TRIPLES)
            < 5.0 * EPSILON)


@pytest.mark.parametrize('off', [(1.0, -0.5, 0.3, -0.25), (1.0, 0.9, -0.8, -1.0),
                                 (-1.0, -0.7, 0.2, 1.0), (0.3, 1.0, -1.0, 0.5),
                                 (-0.6, -1.0, -0.9, 1.0), (1.0, 1.0, 0.8, -1.0)])
def test_the_series_of_the_integrals_hold_to_the_seventh_order(off):
    """Beside arguments 3 % off their mean the eighth order is left out, which is in proportion."""
    x, y, z, p = (1.0 + 0.03 * part for part in off)
    mean = (x + y + z) / 3.0
    assert abs(_rf_series(x, y, mean) / mp.elliprf(x, y, z) - 1) < 0.04 * 0.03 ** 8    # 0.025
    mean = (x + y + z + p + p) / 5.0
    found = _rj_series(x, y, z, mean) / mp.mpf(mean) ** 1.5
    assert abs(found / mp.elliprj(x, y, z, p) - 1) < 0.4 * 0.03 ** 8    # 0.27


@pytest.mark.parametrize('turn', [0, 1, 2])
def test_arguments_are_close_to_their_mean_within_a_hundredth_of_it(turn):
    """One that is larger than the others by d is 2 d/3 above the mean."""
    for d, apart in (0.02, True), (0.0145, False), (-0.02, True), (-0.0145, False):
        mean, found = _spread(*np.roll((7.0 + 7.0 * d, 7.0, 7.0), turn).tolist())
        assert mean == near(7.0 + 7.0 * d / 3.0, rel=EPSILON) and found == apart


def test_arguments_of_the_third_kind_of_which_one_is_off_the_others():
    """By 5 % of them, where the series alone would err by 1e-13; and some that it serves."""
    assert worst((carlson_rj(*one), mp.elliprj(*one)) for one in (
        *(np.ones((4, 4)) + 0.05 * np.eye(4)), (1.0, 1.002, 0.999, 1.004),
        (1.003, 1.0, 0.998, 0.999))) < 3.0 * EPSILON    # measured 0.5


def test_means_and_quarter_period():
    moduli = [*(10.0 ** np.random.default_rng(1).uniform(-20.0, 0.0, 50)), 1.0, 1e-300]
    # measured 2.3
    assert (worst((complete_k(kc), mp.pi / 2 / mp.agm(1, mp.mpf(kc))) for kc in moduli)
            < 4.0 * EPSILON)
    assert worst((agm(3.0, kc), mp.agm(3, mp.mpf(kc))) for kc in moduli) < 4.0 * EPSILON
    assert agm(1.0, 0.0) == 0.0
    for kc in moduli:
        low = kc * 1e-17
        high_part, low_part = agm_pair(1.0, 0.0, kc, low)
        # measured 6e-20
        assert worst([(mp.mpf(high_part) + low_part, mp.agm(1, mp.mpf(kc) + low))]) < 1e-19


def test_nome():
    with mp.workdps(90):
        for k in [mp.mpf(float(x))
                  for x in (*(10.0 ** np.random.default_rng(2).uniform(-30.0, -0.01, 40)), 0.98)]:
            kc = mp.sqrt(1 - k * k)
            exact = mp.exp(-mp.pi * mp.ellipk(kc * kc) / mp.ellipk(k * k))
            assert abs(nome(float(k), float(kc)) / exact - 1) < 4.0 * EPSILON       # measured 1.4
    assert nome(0.0, 1.0) == 0.0


def test_no_term_of_the_nome_is_missing():
    """Near the largest modulus the last term is 2e-16 of it, which rounding hides in one value."""
    with mp.workdps(30):
        errors = []
        for kc in map(mp.mpf, np.linspace(0.17, 0.1702, 400).tolist()):
            k = mp.sqrt(1 - kc * kc)
            exact = mp.exp(-mp.pi * mp.ellipk(kc * kc) / mp.ellipk(k * k))
            errors.append(float(nome(float(k), float(kc)) / exact - 1))
    # measured 8e-18, and 2e-16 without the last term; one value errs by 1.7e-16
    assert abs(np.mean(errors)) < 6e-17


def test_jacobi_functions():
    """Errors of sn, cn, dn are absolute; far out those of cn and dn are relative.

    There, on a long quarter period, they are small numbers.
    """
    rng = np.random.default_rng(3)
    for kc in (1.0, 0.9, 0.5, 0.171, 0.169, 0.02, 1e-5, 1e-10, 1e-16):
        with mp.workdps(60):
            m = 1 - mp.mpf(kc) ** 2
            k = float(mp.sqrt(m))
            far = (33.0, -47.0) if 0.01 < kc < 0.2 else ()    # several periods
            for u in (*rng.uniform(-5.0, 5.0, 12), *far):
                exact = [mp.ellipfun(name, u, m=m) for name in ('sn', 'cn', 'dn')]
                found = jacobi(u, k, kc)
                # measured 6: phase of 3 rad and more
                assert max(abs(a - b) for a, b in zip(found, exact, strict=True)
                           ) < 12.0 * max(1.0, abs(u) / 5.0) * EPSILON
                if kc < 1e-4:
                    assert worst(zip(found, exact, strict=True)) < 12.0 * EPSILON


def test_jacobi_functions_at_their_limits():
    for u in (-3.0, 0.0, 0.5, 20.0):
        assert jacobi(u, 1.0, 0.0) == pytest.approx(
            (np.tanh(u), 1.0 / np.cosh(u), 1.0 / np.cosh(u)), rel=4.0 * EPSILON, abs=0.0)
        assert jacobi(u, 0.0, 1.0) == pytest.approx(
            (np.sin(u), np.cos(u), 1.0), rel=0.0, abs=8.0 * EPSILON)
    # the quarter period is 692 (k' = 1e-300): half-way dn is 1e-150, at the end it is k'
    quarter = complete_k(1e-300)
    sn, cn, dn = jacobi(quarter, 1.0, 1e-300)
    assert sn == 1.0
    assert abs(cn) < 1e-311
    assert dn == near(1e-300, rel=1e-12)
