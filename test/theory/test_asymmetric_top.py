# SPDX-License-Identifier: Apache-2.0
"""Small deviations from rotation about one axis: linear equations, frequency, growth, erratum.

The equations are linearised numerically from Euler's equations.
"""

import itertools

import mpmath
import numpy as np
import pytest
from near import near
from scipy.integrate import solve_ivp

from rigid_body_sim.theory import asymmetric_top as theory
from rigid_body_sim.theory import euler_equations, largest_axis

OMEGA0 = 3.0


def matrix(I1, I2, I3, rates=theory.linear_rates):
    """Return A in eta' = A eta."""
    return np.array([rates(unit, OMEGA0, I1, I2, I3) for unit in np.eye(3)]).T


def jacobian(I1, I2, I3):
    """Return the derivative of Euler's right-hand side at (0, 0, omega0).

    It is exact, since the side is quadratic.
    """
    columns = []
    for unit in np.eye(3):
        there, back = (euler_equations.angular_acceleration(
                           (I1, I2, I3), np.array([0.0, 0.0, OMEGA0]) + step)
                       for step in (unit, -unit))
        columns.append(0.5 * (there - back))
    return np.array(columns).T


@pytest.mark.parametrize('moments', list(itertools.permutations([1.0, 2.0, 2.7])))
def test_linear_equations_and_their_frequency(moments):
    A = matrix(*moments)
    assert pytest.approx(A, abs=1e-14) == jacobian(*moments)
    squared = theory.frequency_squared(OMEGA0, *moments)
    assert (A @ A)[:2, :2] == pytest.approx(-squared * np.eye(2), abs=1e-13)
    stable = moments[2] != 2.0
    assert (squared > 0.0) == stable
    if stable:
        assert np.max(np.abs(np.linalg.eigvals(A).imag)) == near(
            theory.frequency(OMEGA0, *moments), 1e-14)
    else:
        assert np.max(np.linalg.eigvals(A).real) == near(
            theory.growth_rate(OMEGA0, *moments), 1e-14)
        ratio = theory.growing_ratio(*moments)
        assert (A @ [1.0, ratio, 0.0]
                == near(theory.growth_rate(OMEGA0, *moments) * np.array([1.0, ratio, 0.0]), 1e-14))


def test_tennis_racket_by_hand():
    """Moments 1, 3 across and 2 along omega0 = 3 give Omega^2 = 9 (1)(-1)/3 = -3."""
    assert theory.growth_rate(OMEGA0, 1.0, 3.0, 2.0) == near(3.0**0.5, 1e-15)


def test_erratum():
    """I1 = 3, I2 = 9: as written the frequency is too large by sqrt(3).

    The second equation is not Euler's.
    """
    written = matrix(3.0, 9.0, 5.0, theory.linear_rates_as_written)
    assert written == near(np.diag([1.0, 3.0, 1.0]) @ jacobian(3.0, 9.0, 5.0), 1e-14)
    assert np.abs(written - jacobian(3.0, 9.0, 5.0)).max() > 1.0
    squared = theory.frequency_squared_as_written(OMEGA0, 3.0, 9.0, 5.0)
    assert (written @ written)[0, 0] == near(-squared, 1e-14)
    assert squared / theory.frequency_squared(OMEGA0, 3.0, 9.0, 5.0) == near(3.0, 1e-14)


MOMENTS = 2.0, 4.0, 4.5
SEPARATRIX = 0.75, 1.0, 1.0
# on either side of the separatrix, far from it and near to it
TUMBLING = [(0.5, 2.0, 0.4), (2.0, 0.5, -0.2), (-0.3, 0.1, 1.5), (1e-3, 3.0, 2e-3),
            (2e-3, 3.0, 1e-3), (0.75 + 2.0**-20, 1.0, 1.0), (0.75, 1.0, 1.0 + 2.0**-20)]


# measured: at most 6e-11
@pytest.mark.parametrize('omega', TUMBLING)
def test_the_time_between_flips_is_that_of_euler_s_equations(omega):
    """omega2 changes its sign at equal times; SciPy integrates Euler's equations."""
    seconds = theory.time_between_flips(MOMENTS, omega)

    def crossing(_, omega):
        return omega[1]
    run = solve_ivp(lambda _, omega: euler_equations.angular_acceleration(MOMENTS, omega),
                    (0.0, 2.1 * seconds), omega, method='DOP853', rtol=1e-13, atol=1e-15,
                    events=crossing)
    first, second = run.t_events[0][:2]
    assert second - first == near(seconds, 1e-9)


# measured: at most 2e-16
@pytest.mark.parametrize('omega', [*TUMBLING, (1e-140, 1e-135, 1e-140)])
def test_the_time_between_flips_keeps_its_digits(omega):
    """2 K(m)/lambda in 60 digits, from the energy and the angular momentum."""
    with mpmath.workdps(60):
        I1, I2, I3 = map(mpmath.mpf, MOMENTS)
        w1, w2, w3 = (mpmath.mpf(w) ** 2 for w in omega)
        energy, square = (sum(moment**power * w for moment, w in zip((I1, I2, I3), (w1, w2, w3)))
                          for power in (1, 2))    # twice the energy
        rest, turn = (I3 - I2) * (square - energy * I1), (I2 - I1) * (energy * I3 - square)
        lead, side = max(rest, turn), min(rest, turn)
        exact = 2 * mpmath.ellipk(side / lead) * mpmath.sqrt(I1 * I2 * I3 / lead)
        expected = float(exact)
    assert theory.time_between_flips(MOMENTS, omega) == near(expected, 1e-14)


@pytest.mark.parametrize(('moments', 'omega'), [
    ((1.0, 1.0, 2.0), (0.3, 2.0, 0.4)), ((1.0, 2.0, 2.0), (0.3, 2.0, 0.4)),
    ((2.0, 1.0, 3.0), (0.3, 2.0, 0.4)), ((1.0, 3.0, 2.0), (0.3, 2.0, 0.4)),
    ((0.0, 1.0, 1.5), (0.3, 2.0, 0.4)),
    (MOMENTS, (0.0, 0.0, 0.0)), (MOMENTS, (3.0, 0.0, 0.0)), (MOMENTS, (0.0, 3.0, 0.0)),
    (MOMENTS, (0.0, 0.0, 3.0)), (MOMENTS, SEPARATRIX)])
def test_without_flips_there_is_no_time_between_them(moments, omega):
    assert theory.time_between_flips(moments, omega) is None


def test_least_energy_is_about_the_largest_axis():
    """Over directions of m at fixed L the energy lies between its least and greatest value.

    Both are reached; the excess is the difference from the least.
    """
    moments, L = np.array([1.0, 3.0, 2.0]), 5.0
    m = np.random.default_rng(1).normal(size=(20000, 3))
    m *= L / np.linalg.norm(m, axis=1)[:, None]
    T = largest_axis.energy(moments, m)
    least, greatest = (
        largest_axis.least_energy(moments, L), largest_axis.greatest_energy(moments, L))
    assert (least, greatest) == near((25.0 / 6.0, 12.5), 1e-15)
    assert least <= T.min() < 1.001 * least
    assert 0.999 * greatest < T.max() <= greatest
    assert largest_axis.energy(moments, [0.0, L, 0.0]) == near(least, 1e-15)
    assert largest_axis.excess_energy(moments, m) == pytest.approx(T - least, abs=1e-13)


def test_excess_energy_does_not_cancel():
    m = np.array([1e-9, 5.0, 2e-10])
    with mpmath.workdps(40):
        exact = (sum(mpmath.mpf(x) ** 2 * (1 / mpmath.mpf(moment) - 1 / mpmath.mpf(3))
                     for x, moment in zip(m, (1, 3, 2))) / 2)
    assert largest_axis.excess_energy(np.array([1.0, 3.0, 2.0]), m) == near(float(exact), 1e-15)
