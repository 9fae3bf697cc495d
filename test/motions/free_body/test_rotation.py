# SPDX-License-Identifier: Apache-2.0
"""Both forms of a free body's rotation beside elliptic and theta functions of mpmath."""

import math

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpc, mpf
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.motions.free_body import rotation

pytestmark = pytest.mark.without_numba
AMPLITUDES = 0.7, -1.3, 2.5
SHARED = 0.97    # k^2 at which either form serves


def expected_at(v, k2, zero, s):
    """Return A cn, sn, dn at 2 K v/pi, and theta_4(v + i s a) of nome q^2 for a = `zero`."""
    u = 2 * mpmath.ellipk(k2) * v / mp.pi
    q = mpmath.qfrom(m=k2)
    return [A * mpmath.ellipfun(name, u, m=k2) for A, name in zip(
        AMPLITUDES, ('cn', 'sn', 'dn'))], mpmath.jtheta(4, v + 1j * s * zero, q * q)


@pytest.mark.parametrize('k2', [1e-6, 0.3, SHARED, 0.9999])
@pytest.mark.parametrize('share', [0.4, 1.0])
@pytest.mark.parametrize('s', [1.0, -1.0])
def test_both_forms_are_quotients_of_theta_functions(k2, share, s):
    """The zero of the half angle's function is at the height a = share K' pi/(2 K).

    A form may leave out a positive factor of that function, and the hyperbolic one gives a part of
    its argument in turns.
    """
    with mp.workdps(25):
        K, Kc = mpmath.ellipk(mpf(k2)), mpmath.ellipk(1 - mpf(k2))
        zero, kc = share * Kc * mp.pi / (2 * K), float(mp.sqrt(1 - mpf(k2)))
        circular, hyperbolic = (np.zeros(rotation.ROTATION.size) for _ in range(2))
        rest = float((1 - mpf(share)) * Kc)
        of_circular, slope = rotation.fill_circular(
            circular, AMPLITUDES, s, k2, kc, float(K), rest)
        rate = mpmath.diff(lambda v: mpmath.arg(expected_at(v, k2, zero, s)[1]), 0)
        forms = []
        if k2 <= SHARED:
            assert slope == pytest.approx(float(rate), abs=2e-14)
            forms.append(lambda v: (*rotation.circular_series(
                of_circular, rotation.load_circular(circular), v), 0.0))
        if k2 >= SHARED:
            of_hyperbolic, slope_y, drift = rotation.fill_hyperbolic(
                hyperbolic, AMPLITUDES, s, math.sqrt(k2), kc, float(mp.pi * K / Kc), rest)
            forms.append(lambda v: rotation.hyperbolic_series(
                of_hyperbolic, rotation.load_hyperbolic(hyperbolic), v))
            # y = v K/K', less what is in the drift (turns of the half angle)
            assert float(slope_y * K / Kc - drift) == pytest.approx(float(rate), abs=2e-14)
        for turns in (0.0, 0.24, 0.37, 0.5, -0.26):
            omega, half = expected_at(2 * mp.pi * mpf(turns), k2, zero, s)
            for form in forms:
                found, re, im, along = form((turns, 0.0))
                assert found == pytest.approx([float(x) for x in omega], abs=3e-15)
                assert re > 0.0
                direction = mpc(re, im) * mpmath.expjpi(2 * along)
                assert abs(direction / abs(direction) - half / abs(half)) < 2e-15


def test_a_phase_goes_on_from_the_start_and_low_parts_count():
    """They are added where they are not lost: of a phase near 0."""
    course = rotation.Course(rotation.CIRCULAR, 0.0, (0.25, 1e-18), (0.0, 0.0), -0.25,
                             AMPLITUDES, AMPLITUDES)
    high, low = rotation.phase_of(course, (1.0, 2e-17))
    assert high + low == near(1e-18 + 0.25 * 2e-17, rel=1e-14)


@pytest.mark.parametrize('angle', [0.0, 0.3, -2.5])
@pytest.mark.parametrize('omega', [(0.0, 0.0, 3.0), (0.5, -1.0, 2.0), (2.0, 1.0, 0.0)])
def test_the_momentum_is_turned_to_the_third_axis_and_about_it_by_an_angle(angle, omega):
    """Z S takes m to axis 3; half of the angle is given as turns and as a number's argument."""
    moments = np.array([1.0, 2.0, 1.5])
    m = moments * omega
    L = np.linalg.norm(m)
    course = rotation.Course(rotation.STEADY, 0.0, (0.0, 0.0), (0.0, 0.0), 0.0,
                             tuple(moments / L), omega)
    x, y, z, w = rotation._joined(course, omega, math.cos(0.2), math.sin(0.2),
                                  (0.5 * (angle - 0.4) / (2.0 * math.pi), 0.0))
    found = Rotation.from_quat([x, y, z, w])
    assert found.apply(m) == pytest.approx([0.0, 0.0, L], abs=1e-14 * L)
    axis = np.cross(m / L, [0.0, 0.0, 1.0])    # of the shortest way
    size = np.linalg.norm(axis)
    shortest = Rotation.from_rotvec(axis * (math.atan2(size, m[2] / L) / size if size else 1.0))
    expected = Rotation.from_rotvec([0.0, 0.0, angle]) * shortest
    assert (found * expected.inv()).magnitude() < 1e-15    # measured: 4e-16
