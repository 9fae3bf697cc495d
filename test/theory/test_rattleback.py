# SPDX-License-Identifier: Apache-2.0
"""The modes of a rattleback: by another form of the equations, and by hand without spin."""

import numpy as np
import pytest
import rolling
import scipy.linalg
from near import near

from rigid_body_sim.theory.rattleback import modes

MASS, CENTER, SEMI_AXES, G = 1.5, np.array([0.0, 0.0, -0.01]), np.array([0.2, 0.03, 0.02]), 9.81
TENSOR = np.array([[4e-4, -3e-4, 0.0], [-3e-4, 5e-3, 0.0], [0.0, 0.0, 5.2e-3]])
OBLIQUE = np.array([[4e-4, -3e-4, 2e-4], [-3e-4, 5e-3, -1e-3], [2e-4, -1e-3, 5.2e-3]])


# measured: at most 7e-8, by the differences of second order here
@pytest.mark.parametrize(('spin', 'tensor', 'center'), [
    *((spin, TENSOR, CENTER) for spin in (0.0, 5.0, -5.0, 20.0)),
    (0.0, OBLIQUE, CENTER), (5.0, OBLIQUE, np.array([2e-4, -3e-4, -0.01]))])
def test_modes_are_those_of_the_laws_of_newton_and_euler(spin, tensor, center):
    x0, step = np.array([0.0, 0.0, 1.0, 0.0, 0.0, spin]), 1e-5

    def rates(x):
        return rolling.rates(x, MASS, tensor, center, SEMI_AXES, G)
    matrix = np.array([(rates(x0 + step * unit) - rates(x0 - step * unit)) / (2.0 * step)
                       for unit in np.eye(6)]).T
    expected = [value for value in np.linalg.eigvals(matrix) if value.imag > 1.0]
    found = modes((MASS, tensor, center), SEMI_AXES, G, spin)
    assert len(found) == 2
    assert found == near(sorted(expected, key=lambda value: value.imag), rel=1e-6)


def test_the_spin_damps_one_mode_and_raises_the_other_and_the_way_decides_which():
    (slow, fast), (slow_back, fast_back) = (
        modes((MASS, TENSOR, CENTER), SEMI_AXES, G, spin) for spin in (5.0, -5.0))
    assert slow.real * fast.real < 0.0
    assert slow_back == near(complex(-slow.real, slow.imag), rel=1e-9)
    assert fast_back == near(complex(-fast.real, fast.imag), rel=1e-9)


# measured: 3e-14
def test_without_spin_it_rocks_about_both_horizontal_axes():
    """The stiffness about an axis is m g (radius of curvature less the height)."""
    height = SEMI_AXES[2] + CENTER[2]
    stiffness = MASS * G * (np.square(SEMI_AXES[[1, 0]]) / SEMI_AXES[2] - height)
    moments = TENSOR[:2, :2] + MASS * height**2 * np.eye(2)
    expected = 1j * np.sqrt(scipy.linalg.eigh(np.diag(stiffness), moments, eigvals_only=True))
    found = modes((MASS, TENSOR, CENTER), SEMI_AXES, G, 0.0)
    assert found == near(expected, rel=1e-9)
