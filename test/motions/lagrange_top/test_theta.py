# SPDX-License-Identifier: Apache-2.0
"""The functions of a top beside theta functions of mpmath, in both forms."""

import math

import mpmath
import pytest
from mpmath import mp, mpc, mpf
from near import near

from rigid_body_sim.motions.lagrange_top import theta
from rigid_body_sim.motions.lagrange_top.theta import THETA_1, THETA_2

pytestmark = pytest.mark.without_numba
LARGEST = math.exp(-math.pi)    # nome of either form


def jtheta(n, w, q):
    """Return theta_n(w) with 25 digits."""
    with mp.workdps(25):
        return mpmath.jtheta(n, w, q)


def circular_function(v, q, X, kind, modulus):
    """Return S(v)/theta_4(v) for the orientation 1, of the modulus that is asked for.

    S is theta(v - i A) without the phase exp(i v) of its leading term.
    """
    def bare(v):
        return mpmath.expj(-v) * jtheta(1 if kind == THETA_1 else 2, v - 0.5j * -mp.log(X), q) / (
            jtheta(4, v, q))
    return modulus * bare(v) / bare(mp.pi / 2 if kind == THETA_1 else mpf(0))


@pytest.mark.parametrize(('q', 'X'), [
    (LARGEST, 1.0), (LARGEST, 0.3), (LARGEST, LARGEST), (0.01, 0.02)])
@pytest.mark.parametrize('orientation', [1.0, -1.0])
def test_the_circular_form_is_a_quotient_of_theta_functions(q, X, orientation):
    powers, moduli = theta.powers_of(q), (0.7, 1.3, 2.5)
    kinds, Xs = (THETA_1, THETA_2, THETA_2), (X, X, math.sqrt(X * q))
    terms, slopes = zip(*(theta.circular_terms(powers, one, kind, orientation, modulus)
                          for kind, one, modulus in zip(kinds, Xs, moduli)), strict=True)
    series = theta.CircularSeries(powers, *terms)
    for turns in (0.06, -0.31, 0.5):
        (cosine, sine), found = theta.circular(series, (turns, 1e-17))
        v = mp.pi * mpf(turns)
        assert abs(mpc(cosine, sine) - mpmath.expj(2 * v)) < 4e-16
        for (re, im), kind, one, modulus in zip(found, kinds, Xs, moduli):
            expected = circular_function(v, q, one, kind, modulus)
            expected = expected if orientation > 0.0 else mpmath.conj(expected)
            assert abs(mpc(re, im) - expected) < 2e-15 * modulus    # measured: 5e-16
    for kind, one, slope in zip(kinds, Xs, slopes):
        place = mp.pi / 2 if kind == THETA_1 else mpf(0)
        rate = mpmath.diff(lambda v, one=one, kind=kind: mpmath.arg(
            circular_function(v, q, one, kind, 1)), place) / 2
        assert abs(slope + orientation * rate) < 2e-15    # measured: 1e-16
    assert theta.theta_3(q) == near(float(jtheta(3, 0, q)), rel=1e-15)
    assert theta.theta_3(-q) == near(float(jtheta(4, 0, q)), rel=1e-15)


def test_without_a_nome_a_function_keeps_its_modulus():
    """A steady top: q = 0, and X = 0 where a function has no zero."""
    for kind in (THETA_1, THETA_2):
        terms, slope = theta.circular_terms(theta.powers_of(0.0), 0.0, kind, 1.0, 0.7)
        assert terms.re == (0.7, 0.0, 0.0, 0.0) and not any(terms.im) and slope == 0.0


@pytest.mark.parametrize('root', [math.sqrt(LARGEST), 1e-3, 1e-200])
@pytest.mark.parametrize('angle', [1e-9, 0.4, math.pi / 2])
@pytest.mark.parametrize('orientation', [1.0, -1.0])
def test_the_hyperbolic_form_is_a_quotient_of_theta_functions(root, angle, orientation):
    """About the lowest position those of a quarter period on: theta_1/theta_2, theta_4/theta_2."""
    powers, moduli = theta.powers_of(root * root), (0.7, 1.3, 2.5)
    angles, kinds = (angle, angle, 0.5 * (angle + 0.3)), (THETA_1, THETA_2, THETA_2)
    series = theta.HyperbolicSeries(powers, *(
        theta.hyperbolic_terms(powers, one, kind, orientation, modulus, root)
        for one, kind, modulus in zip(angles, kinds, moduli)))
    with mp.workdps(40):
        q = mpf(root) ** 2
        halfway = -0.5 * math.log(root)
    for share in (0.0, -0.3, 1.0):
        y = share * min(halfway, 30.0)
        for highest in (False, True):
            found = theta.hyperbolic(series, y, highest)
            for (re, im), one, kind, modulus in zip(found, angles, kinds, moduli):
                w, below = mpc(one, orientation * y), jtheta(3 if highest else 2, 1j * y, q)
                if kind == THETA_1:
                    size = jtheta(3, 0, q) / jtheta(4, one, q)
                    above = jtheta(4 if highest else 1, w, q)
                else:
                    size = jtheta(2, 0, q) / jtheta(4, one, q)
                    above = jtheta(1 if highest else 4, w, q)
                expected = modulus * size * above / below
                bound = 4e-15 * abs(expected) + 2e-16 * root * modulus    # measured: half of it
                assert abs(mpc(re, im) - expected) <= bound


@pytest.mark.parametrize('y', [0.5, -3.0, 400.0, -800.0])
@pytest.mark.parametrize('orientation', [1.0, -1.0])
def test_on_the_separatrix_functions_are_hyperbolic(y, orientation):
    """The nome is 0: theta_1 and theta_2 are sine and cosine, and theta_3 and theta_4 are 1.

    Beyond 373 exp(-2 |y|) is 0.
    """
    powers, angle = theta.powers_of(0.0), 0.4
    series = theta.HyperbolicSeries(powers, *(
        theta.hyperbolic_terms(powers, angle, kind, orientation, modulus, 0.0)
        for kind, modulus in ((THETA_1, 0.7), (THETA_2, 1.3), (THETA_2, 2.5))))
    a, b, omega = (mpc(*one) for one in theta.hyperbolic(series, y, False))
    below = mpmath.cosh(y)
    assert abs(a - 0.7 * mpmath.sin(mpc(angle, orientation * y)) / below) < 1e-15
    assert abs(b - 1.3 / below) <= 1e-15 / below + 1e-322    # it may underflow
    assert abs(omega - 2.5 / below) <= 2e-15 / below + 1e-322
    if abs(y) < 4.0:    # at the highest position the axis stands
        a, b, omega = theta.hyperbolic(series, y, True)
        assert a == (near(0.7, rel=4e-16), 0.0) and b == omega == (0.0, 0.0)
