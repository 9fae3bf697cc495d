# SPDX-License-Identifier: Apache-2.0
"""Template: the substitution of gauss_march.py for unknowns that stiff drag relaxes.

In coordinates that relax independently (equations/relaxation.py) the rates k of the eight stages
are to meet k = N - lambda (y + h A k). Plain substitution converges for h lambda of a few units;
here the linear part is solved, so that it converges as if there were none:

    k <- k + (1 + h lambda A)^-1 (f - k),    f the rates of the equations at y + h A k

The same factor keeps the rounding of f, which a large lambda magnifies, out of k.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.marching.gauss_nodes import SLOPES, STAGES, A

BLOCKS = UNBOUND    # for each Relaxation: first unknown, number of them, place in S
RATES = UNBOUND

MOST = 3    # unknowns of a Relaxation
# places in the part of S of a Relaxation
INTO = 0
BACK = INTO + MOST * MOST
DECAY = BACK + MOST * MOST
FOR_STEP = DECAY + MOST
INVERSE = FOR_STEP + 1
KEPT = INVERSE + MOST * STAGES * STAGES
LEFT = KEPT + MOST * STAGES
SYSTEM = LEFT + MOST * STAGES
PART = SYSTEM + 2 * STAGES * STAGES


@compiled
def relax(S, y, h, fresh):
    """Replace the rates at the stages in S, f, by the next k.

    Parameters
    ----------
    S : array
        The workspace of gauss_march.py.
    y : tuple of floats
        The unknowns at the beginning of the step.
    h : float
        Size of the step, s.
    fresh : bool
        Whether the stages are predicted ones: then k follows from them, else it is the last one.
    """
    for first, size, part in BLOCKS:
        _relax(S[STAGES * first:], S[RATES + STAGES * first:], S[part:], y, first, size, h, fresh)


@compiled
def _relax(stages, rates, W, y, first, size, h, fresh):
    """Do so for the unknowns of one Relaxation; W is its part of S."""
    if W[FOR_STEP] != h:
        for k in range(size):
            _invert(W[SYSTEM:], h * W[DECAY + k], W[INVERSE + STAGES * STAGES * k:])
        W[FOR_STEP] = h
    if fresh:
        for u in range(size):
            for i in range(STAGES):
                total = 0.0
                for j in range(STAGES):
                    total += SLOPES[i, j] * (stages[STAGES * u + j] - y[first + u])
                W[KEPT + STAGES * u + i] = total / h
    for k in range(size):
        for i in range(STAGES):
            total = 0.0
            for u in range(size):
                place = STAGES * u + i
                total += W[INTO + size * k + u] * (rates[place] - W[KEPT + place])
            W[SYSTEM + STAGES * k + i] = total
    for k in range(size):
        for i in range(STAGES):
            total = 0.0
            for j in range(STAGES):
                total += (W[INVERSE + STAGES * (STAGES * k + i) + j]
                          * W[SYSTEM + STAGES * k + j])
            W[LEFT + STAGES * k + i] = total
    for u in range(size):
        for i in range(STAGES):
            total = 0.0
            for k in range(size):
                total += W[BACK + size * u + k] * W[LEFT + STAGES * k + i]
            W[KEPT + STAGES * u + i] += total
            rates[STAGES * u + i] = W[KEPT + STAGES * u + i]


@compiled
def _invert(system, z, inverse):
    """Fill `inverse` with (1 + z A)^-1 for z >= 0, by Gauss and Jordan's elimination."""
    width = 2 * STAGES
    for i in range(STAGES):
        for j in range(STAGES):
            system[width * i + j] = z * A[i, j] + (1.0 if i == j else 0.0)
            system[width * i + STAGES + j] = 1.0 if i == j else 0.0
    for column in range(STAGES):
        pivot = column
        for i in range(column + 1, STAGES):
            if abs(system[width * i + column]) > abs(system[width * pivot + column]):
                pivot = i
        scale = 1.0 / system[width * pivot + column]
        for j in range(width):
            row = system[width * pivot + j] * scale
            system[width * pivot + j] = system[width * column + j]
            system[width * column + j] = row
        for i in range(STAGES):
            if i != column:
                factor = system[width * i + column]
                for j in range(width):
                    system[width * i + j] -= factor * system[width * column + j]
    for i in range(STAGES):
        for j in range(STAGES):
            inverse[STAGES * i + j] = system[width * i + STAGES + j]
