# SPDX-License-Identifier: Apache-2.0
"""The growth of linear equations, beside the eigenvalues that a library finds."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.numerics.growth import fastest_growth


def test_the_rate_is_the_largest_real_part_of_an_eigenvalue():
    draw = np.random.default_rng(5)
    for size in (1, 2, 3, 6, 12):
        for _ in range(20):
            matrix = draw.normal(size=(size, size)) * 10.0 ** draw.uniform(-9.0, 9.0)
            expected = np.linalg.eigvals(matrix).real.max()
            # measured: within 2e-7 of the norm, of pairs that turn
            assert fastest_growth(matrix) == pytest.approx(
                expected, rel=0.0, abs=1e-6 * np.abs(matrix).sum(axis=1).max())


@pytest.mark.parametrize('scale', [1e-200, 1e-3, 1.0, 1e9, 1e200])
def test_a_rate_beside_much_faster_decay_is_found(scale):
    """One unknown grows as e^(3 t), one falls as e^(-1e6 t), and two turn by 1e3 rad/s."""
    matrix = np.zeros((4, 4))
    matrix[0, 0], matrix[1, 1], matrix[2, 3], matrix[3, 2] = 3.0, -1e6, 1e3, -1e3
    assert fastest_growth(scale * matrix) == near(3.0 * scale, rel=1e-9)


def test_what_grows_like_a_power_of_time_or_not_at_all_has_no_rate():
    drift = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    assert abs(fastest_growth(drift)) < 1e-7
    assert fastest_growth(np.zeros((3, 3))) == 0.0
    turn = np.array([[0.0, 5.0], [-5.0, 0.0]])
    assert abs(fastest_growth(turn)) < 1e-7
    assert fastest_growth(np.array([[-2.0]])) == near(-2.0, rel=1e-12)
