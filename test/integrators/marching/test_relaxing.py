# SPDX-License-Identifier: Apache-2.0
"""The substitution for what stiff drag relaxes: of linear equations it is the solution at once."""

import numpy as np
import pytest

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.marching import relaxing
from rigid_body_sim.integrators.marching.gauss_nodes import STAGES, A

pytestmark = pytest.mark.without_numba

UNKNOWNS, RATES = 6, 100
LEFT = 1e-10
PARTS = 200, 200 + relaxing.PART
# the unknowns 1 and 2, and 3 to 5; the first number belongs to none
BOUND = specialise(relaxing, RATES=f'RATES = {RATES}\n',
                   BLOCKS=f'BLOCKS = ((1, 2, {PARTS[0]}), (3, 3, {PARTS[1]}))\n')


@pytest.mark.parametrize('z', [0.0, 0.3, 20.0, 1e6])
def test_the_inverse_of_a_matrix_of_stages(z):
    system, inverse = np.zeros(2 * STAGES * STAGES), np.zeros(STAGES * STAGES)
    BOUND._invert(system, z, inverse)
    found = inverse.reshape(STAGES, STAGES) @ (np.eye(STAGES) + z * np.array(A))
    # measured: 0, 3e-16, 6e-16 and 4e-15
    assert found == pytest.approx(np.eye(STAGES), abs=2e-14)


def test_linear_equations_are_solved_by_one_substitution_whatever_the_step():
    """It is k = n - M (y + h A k) with M = back diag(decay) into.

    A second one changes rounding alone. Measured: 1e-11 and 1.4e-11 of 1200.
    """
    draw = np.random.default_rng(5)
    S, y, blocks = np.zeros(PARTS[1] + relaxing.PART), draw.normal(size=UNKNOWNS), []
    for part, first, size in ((PARTS[0], 1, 2), (PARTS[1], 3, 3)):
        into, decay, W = draw.normal(size=(size, size)), 10.0 ** np.arange(size), S[part:]
        back = np.linalg.inv(into)
        W[relaxing.INTO:][:size * size] = into.ravel()
        W[relaxing.BACK:][:size * size] = back.ravel()
        W[relaxing.DECAY:][:size] = decay
        blocks.append((slice(first, first + size), back @ np.diag(decay) @ into,
                       draw.normal(size=(size, 1))))
    S[RATES:RATES + STAGES] = 7.0

    def substituted(h, k, fresh):
        """Return the next k, and what it leaves of the equations, from the rates at k."""
        stages = y[:, np.newaxis] + h * k @ np.array(A).T
        S[:STAGES * UNKNOWNS] = stages.ravel()
        for rows, M, n in blocks:
            place = RATES + STAGES * rows.start
            f = n - M @ stages[rows]
            S[place:place + f.size] = f.ravel()
        BOUND.relax(S, y, h, fresh)
        new = S[RATES:RATES + STAGES * UNKNOWNS].reshape(UNKNOWNS, STAGES).copy()
        there = y[:, np.newaxis] + h * new @ np.array(A).T
        return new, max(np.abs(new[rows] - (n - M @ there[rows])).max() for rows, M, n in blocks)

    for h in (0.1, 0.7, 0.1):
        k, left = substituted(h, draw.normal(size=(UNKNOWNS, STAGES)), True)
        assert left < LEFT
        assert (k[0] == 7.0).all()
        again, left = substituted(h, k, False)
        assert left < LEFT
        assert again[1:] == pytest.approx(k[1:], abs=LEFT)
