# SPDX-License-Identifier: Apache-2.0
"""Heavy top: formulas derived once more from the Lagrangian, and limits by their convergence.

The Lagrangian is differentiated in 40 digits.
"""

import mpmath
import numpy as np
import pytest
from near import near

from rigid_body_sim.theory import euler_angles, fast_top, sleeping_top
from rigid_body_sim.theory import heavy_top as theory

I1, I3, MGL = 0.03, 0.01, 0.981
BETA, RATES = 0.8, (2.5, -1.5, 40.0)    # alpha', beta', gamma'
# beta, P_alpha, P_gamma
STATES = [(0.8, 0.35, 0.6), (2.4, -0.2, 0.5), (1.1, 0.7, 0.3), (0.3, -0.6, -0.45)]


@pytest.fixture(autouse=True)
def digits():
    with mpmath.workdps(40):
        yield


def lagrangian(beta, alpha_rate, beta_rate, gamma_rate):
    """Return T - V of the notes for I1 = I2, from the body rates at gamma = 0."""
    omega1, omega2, omega3 = (
        -alpha_rate * mpmath.sin(beta), beta_rate, alpha_rate * mpmath.cos(beta) + gamma_rate)
    return (mpmath.mpf(I1) * (omega1**2 + omega2**2) / 2 + mpmath.mpf(I3) * omega3**2 / 2
            - mpmath.mpf(MGL) * mpmath.cos(beta))


def momenta(beta=BETA, rates=RATES):
    """Return (p_alpha, p_gamma) = dL/dalpha', dL/dgamma'."""
    return (mpmath.diff(lambda rate: lagrangian(beta, rate, rates[1], rates[2]), rates[0]),
            mpmath.diff(lambda rate: lagrangian(beta, rates[0], rates[1], rate), rates[2]))


def potential(beta, P_alpha, P_gamma):
    """Return V_eff as the energy at beta' = 0.

    alpha' and gamma' are solved from the momenta by linear algebra.
    """
    c, s = mpmath.cos(beta), mpmath.sin(beta)
    A = mpmath.matrix([[I1 * s**2 + I3 * c**2, I3 * c], [I3 * c, mpmath.mpf(I3)]])
    rates = mpmath.lu_solve(A, mpmath.matrix([P_alpha, P_gamma]))
    return ((mpmath.mpf(P_alpha) * rates[0] + mpmath.mpf(P_gamma) * rates[1]) / 2
            + mpmath.mpf(MGL) * c)


def test_momenta_and_rates():
    P_alpha, P_gamma = (float(value) for value in momenta())
    assert theory.p_gamma(RATES[0], RATES[2], BETA, I3) == near(P_gamma, 1e-14)
    assert theory.p_alpha(RATES[0], BETA, P_gamma, I1) == near(P_alpha, 1e-14)
    assert theory.alpha_rate(BETA, P_alpha, P_gamma, I1) == near(RATES[0], 1e-13)
    assert theory.gamma_rate(BETA, P_alpha, P_gamma, I1, I3) == near(RATES[2], 1e-13)
    omega = euler_angles.body_rates(*RATES, BETA, 0.3)
    assert euler_angles.p_alpha(omega, BETA, 0.3, I1, I1, I3) == near(P_alpha, 1e-13)


def test_beta_acceleration_from_the_lagrangian():
    """The acceleration is I1 beta'' = dL/dbeta at fixed rates."""
    P_alpha, P_gamma = (float(value) for value in momenta())
    expected = float(mpmath.diff(lambda beta: lagrangian(beta, *RATES), BETA)) / I1
    assert theory.beta_acceleration(BETA, P_alpha, P_gamma, I1, MGL) == near(expected, 1e-13)


@pytest.mark.parametrize(('beta', 'P_alpha', 'P_gamma'), STATES)
def test_effective_potential_and_its_derivatives(beta, P_alpha, P_gamma):
    assert theory.effective_potential(beta, P_alpha, P_gamma, I1, I3, MGL) == near(
        float(potential(beta, P_alpha, P_gamma)), 1e-13)
    slope, curvature = (float(mpmath.diff(lambda x: potential(x, P_alpha, P_gamma), beta, n))
                        for n in (1, 2))
    assert theory.slope(beta, P_alpha, P_gamma, I1, MGL) == near(slope, 1e-12)
    assert theory.curvature(beta, P_alpha, P_gamma, I1, MGL) == near(curvature, 1e-12)
    total = 4.5 * I1 + float(potential(beta, P_alpha, P_gamma))
    assert theory.energy(beta, 3.0, P_alpha, P_gamma, I1, I3, MGL) == near(total, 1e-13)


def test_potential_energy_and_its_first_minimum():
    assert theory.potential_energy(BETA, MGL) == near(MGL * np.cos(BETA), 1e-15)
    tilt = theory.tilt_of_least_centrifugal_potential(0.2, 0.5)
    assert theory.alpha_rate(tilt, 0.2, 0.5, I1) == pytest.approx(0.0, abs=1e-14)
    assert theory.effective_potential(tilt, 0.2, 0.5, I1, I3, 0.0) == near(
        0.25 / (2.0 * I3), 1e-15)


@pytest.mark.parametrize(
    ('P_alpha', 'P_gamma'),
    [(0.35, 0.6), (-0.2, 0.5), (0.7, 0.3), (-0.6, -0.45), (0.0, 0.5), (0.4, 0.0), (0.02, 0.4)])
def test_equilibrium(P_alpha, P_gamma):
    """At beta_0, V_eff' = 0, the quartic vanishes and V_eff is least.

    The notes' V_eff'' agrees with the general one there.
    """
    beta_0 = theory.equilibrium_tilt(P_alpha, P_gamma, I1, MGL)
    expected = float(mpmath.findroot(
        lambda x: mpmath.diff(lambda y: potential(y, P_alpha, P_gamma), x), beta_0))
    assert beta_0 == near(expected, 1e-13)
    scale = P_alpha**2 + P_gamma**2 + I1 * MGL
    assert theory.equilibrium_residual(beta_0, P_alpha, P_gamma, I1, MGL) == pytest.approx(
        0.0, abs=1e-14 * scale)
    quartic = theory.equilibrium_quartic(P_alpha, P_gamma, I1, MGL)
    assert np.polyval(quartic, np.cos(beta_0)) == pytest.approx(0.0, abs=1e-14 * scale)
    assert np.polyval(quartic, np.cos(1.0)) == pytest.approx(
        theory.equilibrium_residual(1.0, P_alpha, P_gamma, I1, MGL), abs=1e-15 * scale)
    assert (np.abs(np.roots(quartic)[np.isreal(np.roots(quartic))]) < 1.0).sum() == 1
    general = theory.curvature(beta_0, P_alpha, P_gamma, I1, MGL)
    assert theory.curvature_at_equilibrium(beta_0, P_alpha, P_gamma, I1, MGL) == near(
        general, 1e-10)
    assert theory.nutation_frequency_squared_of_notes(beta_0, P_alpha, P_gamma, I1, MGL) == near(
        theory.nutation_frequency(beta_0, P_alpha, P_gamma, I1, MGL) ** 2, 1e-10)
    tilts = np.linspace(0.01, np.pi - 0.01, 2001)
    assert (theory.effective_potential(tilts, P_alpha, P_gamma, I1, I3, MGL).min()
            >= theory.effective_potential(beta_0, P_alpha, P_gamma, I1, I3, MGL) * (1.0 - 1e-15))


def test_the_notes_curvature_fails_off_equilibrium_and_at_90_degrees():
    """Off equilibrium the two curvatures differ widely.

    With P_alpha P_gamma = I1 M g l, beta_0 is 90 degrees, where only the general one is defined.
    """
    assert abs(theory.curvature_at_equilibrium(0.8, 0.35, 0.6, I1, MGL) / theory.curvature(
        0.8, 0.35, 0.6, I1, MGL) - 1.0) > 0.3
    P_gamma = 0.5
    P_alpha = I1 * MGL / P_gamma
    assert theory.equilibrium_tilt(P_alpha, P_gamma, I1, MGL) == near(np.pi / 2.0, 1e-15)
    expected = float(mpmath.diff(lambda x: potential(x, P_alpha, P_gamma), mpmath.pi / 2, 2))
    assert theory.curvature(np.pi / 2.0, P_alpha, P_gamma, I1, MGL) == near(expected, 1e-13)


def test_precession_variation():
    def rate(beta):
        return ((mpmath.mpf('0.35') - mpmath.mpf('0.6') * mpmath.cos(beta))
                / (mpmath.mpf(I1) * mpmath.sin(beta) ** 2))

    assert theory.precession_variation(BETA, 0.35, 0.6, I1) == near(
        float(mpmath.diff(rate, BETA)), 1e-13)


@pytest.mark.parametrize('beta_0', [0.5, 2.0])
def test_steady_precession(beta_0):
    """With either rate beta'' = 0; at 120 degrees one of them turns backwards."""
    for rate in theory.steady_precession_rates(beta_0, 60.0, I1, I3, MGL):
        P_gamma = I3 * 60.0
        P_alpha = theory.p_alpha(rate, beta_0, P_gamma, I1)
        assert theory.beta_acceleration(beta_0, P_alpha, P_gamma, I1, MGL) == pytest.approx(
            0.0, abs=1e-12)
        assert theory.equilibrium_tilt(P_alpha, P_gamma, I1, MGL) == near(beta_0, 1e-13)


def test_turning_points():
    """Released at rest in beta at 0.5 rad, the top has that V_eff at the other turning point."""
    P_gamma = 0.6
    P_alpha = theory.p_alpha(0.0, 0.5, P_gamma, I1)
    E = theory.energy(0.5, 0.0, P_alpha, P_gamma, I1, I3, MGL)
    least, greatest = theory.turning_points(E, P_alpha, P_gamma, I1, I3, MGL)
    assert least == near(0.5, 1e-13)
    assert theory.effective_potential(greatest, P_alpha, P_gamma, I1, I3, MGL) == near(E, 1e-13)
    middle = 0.5 * (least + greatest)
    assert (theory.effective_potential(middle, P_alpha, P_gamma, I1, I3, MGL) < E
            < theory.effective_potential(greatest + 0.01, P_alpha, P_gamma, I1, I3, MGL))


@pytest.mark.parametrize(('beta', 'P_alpha', 'P_gamma'), STATES)
def test_period_and_mean_precession_of_a_nutation(beta, P_alpha, P_gamma):
    """Period and precession agree with integrals of dt = dbeta/beta' and of alpha' dt over beta.

    beta' follows from the energy; the motion starts at rest in beta.
    """
    rate = theory.alpha_rate(beta, P_alpha, P_gamma, I1)
    omega, up = (-rate * np.sin(beta), 0.0, P_gamma / I3), (-np.sin(beta), 0.0, np.cos(beta))
    E = potential(beta, P_alpha, P_gamma)
    low, high = map(mpmath.mpf, theory.turning_points(float(E), P_alpha, P_gamma, I1, I3, MGL))

    def over(quantity):
        """Return the integral over half a period.

        beta = middle - reach cos(theta) removes the roots at the ends.
        """
        def integrand(theta):
            at = (low + high) / 2 - (high - low) / 2 * mpmath.cos(theta)
            speed = mpmath.sqrt(abs(2 * (E - potential(at, P_alpha, P_gamma)) / I1))
            return quantity(at) * (high - low) / 2 * mpmath.sin(theta) / speed
        with mpmath.workdps(20):
            return mpmath.quad(
                integrand, [mpmath.mpf('1e-6'), mpmath.pi / 2, mpmath.pi - mpmath.mpf('1e-6')])

    half = over(lambda at: 1)
    turned = over(lambda at: (P_alpha - P_gamma * mpmath.cos(at)) / (I1 * mpmath.sin(at) ** 2))
    top = (omega, up, I1, I3, MGL)
    # the ends of the integrals are left out: 1e-6 of pi
    assert theory.time_between_turning_points(*top) == near(float(half), 2e-6)
    assert theory.mean_precession(*top) == near(float(turned / half), 5e-6)


def test_a_top_knows_no_axis_across_its_own():
    omega, up = np.array([0.4, -1.3, 20.0]), np.array([0.36, 0.48, 0.8])
    for angle in (0.7, 2.0):
        turn = np.array([[np.cos(angle), -np.sin(angle), 0.0],
                         [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
        for of in (theory.time_between_turning_points, theory.mean_precession):
            # measured: 1e-15
            assert of(turn @ omega, turn @ up, I1, I3, MGL) == near(
                of(omega, up, I1, I3, MGL), 1e-12)


@pytest.mark.parametrize(('omega', 'up'), [
    ((0.4, -1.3, 20.0), (0.36, 0.48, 0.8)), ((-2.0, 0.7, 35.0), (0.48, -0.36, -0.8))])
def test_a_top_below_its_pivot_is_one_above_it_seen_from_the_other_end(omega, up):
    """Half a turn about axis 1 of the body renames axis 3, and M g l changes its sign."""
    renamed = np.array([1.0, -1.0, -1.0])
    for of in (theory.time_between_turning_points, theory.mean_precession):
        # measured: at most 5e-13
        assert of(omega * renamed, up * renamed, I1, I3, -MGL) == near(
            of(omega, up, I1, I3, MGL), 1e-11)


@pytest.mark.parametrize(('beta', 'P_alpha', 'P_gamma'), STATES)
def test_turning_points_below_the_pivot_are_those_above_it_from_the_other_end(
        beta, P_alpha, P_gamma):
    E = theory.energy(beta, 1.5, P_alpha, P_gamma, I1, I3, MGL)
    least, greatest = theory.turning_points(E, P_alpha, P_gamma, I1, I3, MGL)
    assert least < beta < greatest
    assert theory.turning_points(E, P_alpha, -P_gamma, I1, I3, -MGL) == near(
        (np.pi - greatest, np.pi - least), 1e-11)    # measured: 2e-16


@pytest.mark.parametrize(('share', 'defined'), [(0.9e-4, False), (1.1e-4, True)])
def test_precession_is_not_defined_a_ten_thousandth_of_the_nutation_off_the_vertical(
        share, defined):
    """Released at rest at u = cos(beta), it falls to u - 1/2 if P_gamma^2/K = 2 (1 - (u - 1/2)^2).

    K = 2 I1 M g l.
    """
    u = 1.0 - 0.5 * share
    P_gamma = np.sqrt(4.0 * I1 * MGL * (1.0 - (u - 0.5) ** 2))
    omega = np.array([0.0, 0.0, P_gamma / I3])
    up = np.array([-np.sqrt(1.0 - u * u), 0.0, u])
    renamed = np.array([1.0, -1.0, -1.0])
    rates = (theory.mean_precession(omega, up, I1, I3, MGL),
             theory.mean_precession(omega * renamed, up * renamed, I1, I3, -MGL))
    assert [rate is not None for rate in rates] == [defined] * 2


def test_without_weight_or_through_the_vertical_no_precession_is_defined():
    for omega, up, Mgl in (((0.4, -1.3, 20.0), (0.36, 0.48, 0.8), 0.0),
                           ((0.4, 0.0, 20.0), (0.0, 0.0, 1.0), MGL)):
        assert theory.mean_precession(omega, up, I1, I3, Mgl) is None
    assert theory.time_between_turning_points(
        (0.4, -1.3, 20.0), (0.36, 0.48, 0.8), I1, I3, 0.0) is None


def test_sleeping_top_expansion():
    """V_eff about 0: stiffness by differentiation, and the quartic term at the threshold.

    The term is M g l/8, so equality is stable.
    """
    P_gamma = 0.3
    for beta in (0.2, 1.0):
        expected = float(potential(beta, P_gamma, P_gamma)) - P_gamma**2 / (2.0 * I3)
        assert sleeping_top.effective_potential(beta, P_gamma, I1, MGL) == near(expected, 1e-13)

    def upright(beta, P):
        return (P**2 / (2 * mpmath.mpf(I1)) * mpmath.tan(beta / 2) ** 2
                + mpmath.mpf(MGL) * mpmath.cos(beta))

    assert sleeping_top.stiffness(P_gamma, I1, MGL) == near(
        float(mpmath.diff(lambda x: upright(x, P_gamma), 0, 2)), 1e-12)
    threshold = sleeping_top.threshold(I1, MGL)
    assert threshold == near(2.0 * (I1 * MGL) ** 0.5, 1e-15)
    exact = 2 * mpmath.sqrt(mpmath.mpf(I1) * mpmath.mpf(MGL))
    assert float(mpmath.diff(lambda x: upright(x, exact), 0, 4)) / 24.0 == near(MGL / 8.0, 1e-12)
    assert sleeping_top.is_stable(1.0005 * threshold, I1, MGL)
    assert not sleeping_top.is_stable(0.9995 * threshold, I1, MGL)


def test_falling_top():
    """At P_gamma^2 = 0.999 of the threshold the top nods to 3.62 degrees.

    V_eff has its upright value there; a small tilt grows at sqrt(-stiffness/I1).
    """
    P_gamma = 0.999**0.5 * sleeping_top.threshold(I1, MGL)
    tilt = sleeping_top.nodding_tilt(P_gamma, I1, MGL)
    assert np.degrees(tilt) == pytest.approx(3.62, abs=0.005)
    assert np.cos(tilt) == near(P_gamma**2 / (2.0 * I1 * MGL) - 1.0, 1e-15)
    assert sleeping_top.effective_potential(tilt, P_gamma, I1, MGL) == near(MGL, 1e-14)
    assert sleeping_top.growth_rate(P_gamma, I1, MGL) == near(
        (-sleeping_top.stiffness(P_gamma, I1, MGL) / I1) ** 0.5, 1e-11)
    assert sleeping_top.nodding_tilt(1.1 * P_gamma, I1, MGL) == 0.0
    assert sleeping_top.nodding_tilt(0.0, I1, MGL) == near(np.pi, 1e-15)


def deviations(predicted, exact):
    """Return relative deviations at slowness 0.01, 0.005, 0.0025.

    P_alpha/P_gamma shrinks alike.
    """
    results = []
    for slowness in (0.01, 0.005, 0.0025):
        P_gamma = (I1 * MGL / slowness) ** 0.5
        P_alpha = 5.0 * slowness * P_gamma
        beta_0 = theory.equilibrium_tilt(P_alpha, P_gamma, I1, MGL)
        assert fast_top.slowness(P_gamma, I1, MGL) == near(slowness, 1e-14)
        results.append(abs(predicted(P_alpha, P_gamma) / exact(beta_0, P_alpha, P_gamma) - 1.0))
    return results


def test_fast_top_limits():
    """Relative deviations shrink by four when slowness and P_alpha/P_gamma are both halved."""
    precession = deviations(lambda _, P_gamma: fast_top.precession_rate(P_gamma, MGL),
                            lambda *at: theory.alpha_rate(*at, I1))
    nutation = deviations(lambda _, P_gamma: fast_top.nutation_frequency(P_gamma, I1),
                          lambda *at: theory.nutation_frequency(*at, I1, MGL))
    tilt = deviations(
        lambda *at: fast_top.cos_equilibrium_tilt(*at, I1, MGL), lambda beta_0, *_: np.cos(beta_0))
    for found in (precession, nutation, tilt):
        assert found[0] < 0.01
        assert found[0] / found[1] == near(4.0, 0.1)
        assert found[1] / found[2] == near(4.0, 0.1)


def test_fast_top_errata():
    """I1 = 0.03, P_gamma = 3: precession 0.33 rad/s, nutation 100 rad/s.

    As written they would be 0.0098 rad/s and the square of 100 rad/s.
    """
    P_alpha, P_gamma = 0.05, 3.0
    beta_0 = theory.equilibrium_tilt(P_alpha, P_gamma, I1, MGL)
    true_precession = theory.alpha_rate(beta_0, P_alpha, P_gamma, I1)
    true_nutation = theory.nutation_frequency(beta_0, P_alpha, P_gamma, I1, MGL)
    assert fast_top.precession_rate(P_gamma, MGL) == near(true_precession, 0.01)
    assert fast_top.precession_rate_as_written(P_gamma, I1, MGL) < 0.05 * true_precession
    assert fast_top.nutation_frequency(P_gamma, I1) == near(true_nutation, 0.01)
    assert fast_top.nutation_frequency_as_written(P_gamma, I1) > 50.0 * true_nutation
    assert fast_top.epsilon(P_gamma, I1, MGL) == near(np.cos(beta_0) - P_alpha / P_gamma, 0.01)


def test_the_notes_limit_is_not_the_criterion():
    """The criterion is slowness << 1: with P_gamma/P_alpha = 100 but a slow spin the limit fails.

    beta_0 is nowhere near P_alpha/P_gamma.
    """
    P_gamma = 0.1
    beta_0 = theory.equilibrium_tilt(P_gamma / 100.0, P_gamma, I1, MGL)
    assert fast_top.slowness(P_gamma, I1, MGL) > 1.0
    assert abs(np.cos(beta_0) - 0.01) > 0.5
