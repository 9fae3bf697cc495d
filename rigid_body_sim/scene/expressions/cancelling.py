# SPDX-License-Identifier: Apache-2.0
"""How large terms of an expression are that may cancel each other.

What is left of ``1 + tanh((t - 5)/0.1)`` at first, and of ``-5*(angle - 1)`` in the end, is the
rounding of terms as large as 1 and 5. No step is short enough to follow it.
"""

import functools
import math

import numpy as np

from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.intervals import fixed, ranges
from rigid_body_sim.scene.expressions.source import ATTITUDE

PARTS = 256    # of the time


@functools.lru_cache(maxsize=256)
def cancelling(trees: tuple[tree.Term, ...], parameters: tuple[tuple[str, float], ...],
               horizon: float) -> float:
    """Return the size of the terms that may cancel each other in the values of trees.

    The length of the vector of them. Terms whose bounds are not known, as those of rates, do not
    count, nor does what cancels within a function: that cancels where its argument passes zero.

    Parameters
    ----------
    trees : tuple of 3 Terms
    parameters : tuple of (str, float)
    horizon : float
        The time goes on up to there, s.
    """
    if not tree.names(*trees):
        return 0.0
    edges = np.arange(PARTS + 1.0) * (horizon / PARTS)
    unit, turn = np.ones(PARTS), 2.0 * math.pi * np.ones(PARTS)
    given = {'t': (edges[:-1], edges[1:]), 'angle': (-turn, turn)}
    given |= dict.fromkeys(ATTITUDE, (-unit, unit))
    given |= {name: fixed(value, unit) for name, value in parameters}
    found = ranges(trees, given)
    sizes = {part: _size(*found[part]) for part in found}
    cancelled: dict[tree.Term, float] = {}
    for part in found:
        cancelled[part] = _cancelled(part, found, sizes, cancelled)
    return hypot3(*(cancelled[one] for one in trees))


def _size(low, high):
    """Return the largest size within intervals; 0 where it is not known."""
    size = float(np.maximum(np.abs(low), np.abs(high)).max())
    return size if size < math.inf else 0.0


def _cancelled(part, found, sizes, cancelled):
    """Return the size of the terms that may cancel in a part; those of its operands are known."""
    args = part.args
    match part.op:
        case '+' | '-':
            inner = cancelled[args[0]] + cancelled[args[1]]
            (a, b), (c, d) = (found[arg] for arg in args)
            if part.op == '-':
                c, d = -d, -c
            may = (((a < 0.0) & (d > 0.0)) | ((b > 0.0) & (c < 0.0))).any()
            return inner + (sizes[args[0]] + sizes[args[1]] if may else 0.0)
        case 'negative' | 'abs':
            return cancelled[args[0]]
        case '*':
            return (cancelled[args[0]] * sizes[args[1]] + cancelled[args[1]] * sizes[args[0]])
        case '/':
            low, high = found[args[1]]
            if ((low > 0.0) | (high < 0.0)).all():
                return cancelled[args[0]] / float(np.minimum(np.abs(low), np.abs(high)).min())
        case 'where' | 'min' | 'max':
            return max(cancelled[arg] for arg in args)
    return 0.0
