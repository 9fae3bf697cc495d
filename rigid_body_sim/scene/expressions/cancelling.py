# SPDX-License-Identifier: Apache-2.0
"""How large terms of an expression are that may cancel each other.

What is left of ``1 + tanh((t - 5)/0.1)`` at first, and of ``-5*(angle - 1)`` in the end, is the
rounding of terms as large as 1 and 5. No step is short enough to follow it. The same is left of a
spring and the weight that it carries.
"""

import functools
import math

import numpy as np

from rigid_body_sim.numerics.functions import atan2, hypot3
from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.numerics.vectors import dot
from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.intervals import fixed, ranges
from rigid_body_sim.scene.expressions.source import ATTITUDE, PLACE, STATE_NAMES
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.state import State

PARTS = 256    # of the time
POSE = {*PLACE, *ATTITUDE, 'angle'}


def cancelling(trees: tuple[tree.Term, ...], parameters: tuple[tuple[str, float], ...],
               horizon: float) -> float:
    """Return the size of the terms that may cancel each other in the values of trees.

    The length of the vector of them. Terms of the state, which may be as small as the motion, do
    not count, nor does what cancels within a function: there an argument passes zero.

    Parameters
    ----------
    trees : tuple of 3 Terms
    parameters : tuple of (str, float)
    horizon : float
        The time goes on up to there, s.
    """
    return _sizes_in(trees, parameters, horizon)[0]


def balancing(trees: tuple[tree.Term, ...], parameters: tuple[tuple[str, float], ...],
              frame: Frame, start: State, horizon: float) -> float:
    """Return the size of the terms of a law, which others may balance where a body rests at first.

    Its values count there, and what may cancel in them. It is 0 of a body that moves, and of a law
    that does not depend on place, attitude or the angle of a hinge.

    Parameters
    ----------
    trees, parameters, horizon
        As above.
    frame : Frame
    start : State
    """
    if tree.names(*trees).isdisjoint(POSE) or any(start.angular_velocity) or any(start.velocity):
        return 0.0
    inner, values = _sizes_in(trees, (*parameters, *_numbers(frame, start)), horizon)
    return inner + values


def cancelling_or_balancing(trees: tuple[tree.Term, ...],
                            parameters: tuple[tuple[str, float], ...],
                            frame: Frame, start: State, horizon: float) -> float:
    """Return the larger size: of what may cancel in a law, or of what others may balance.

    Parameters
    ----------
    trees, parameters, frame, start, horizon
        As above.
    """
    return max(cancelling(trees, parameters, horizon),
               balancing(trees, parameters, frame, start, horizon))


def _numbers(frame, start):
    """Return the names of the state with their numbers where a body rests at first."""
    orientation = tuple(map(float, start.orientation))
    origin = map(float, start.position)
    found = dict.fromkeys(STATE_NAMES, 0.0) | dict(
        zip((*PLACE, *ATTITUDE), (*origin, *orientation), strict=True))
    del found['t']
    if frame.hinge is not None:
        x, y, z, w = frame.hinge.zero
        *axis, along = multiply(-x, -y, -z, w, *orientation)
        found['angle'] = 2.0 * atan2(dot(frame.hinge.axis, axis), along)
    return found.items()


@functools.lru_cache(maxsize=256)
def _sizes_in(trees, parameters, horizon):
    """Return the size of terms that may cancel in the values of trees, and of the values."""
    if not tree.names(*trees):
        return 0.0, 0.0
    parts = PARTS if 't' in tree.names(*trees) else 1
    edges = np.arange(parts + 1.0) * (horizon / parts)
    given = {'t': (edges[:-1], edges[1:])}
    given |= {name: fixed(value, edges[1:]) for name, value in parameters}
    found = ranges(trees, given)
    cancelled: dict[tree.Term, float] = {}
    for part in found:
        cancelled[part] = _cancelled(part, found, cancelled)
    sizes = (hypot3(*(cancelled[one] for one in trees)),
             hypot3(*(float(_sizes(*found[one]).min()) for one in trees)))
    inner, values = (size if size < math.inf else 0.0 for size in sizes)
    return inner, values


def _sizes(low, high):
    """Return the largest size within each interval; 0 where it is not known."""
    sizes = np.maximum(np.abs(low), np.abs(high))
    return np.where(np.isfinite(sizes), sizes, 0.0)


def _cancelled(part, found, cancelled):
    """Return the size of the terms that may cancel in a part; those of its operands are known.

    It is that of the time when they are smallest: what explodes later is no reason to follow less
    closely now.
    """
    args = part.args
    match part.op:
        case '+' | '-':
            inner = cancelled[args[0]] + cancelled[args[1]]
            (a, b), (c, d) = (found[arg] for arg in args)
            if part.op == '-':
                c, d = -d, -c
            may = ((a < 0.0) & (d > 0.0)) | ((b > 0.0) & (c < 0.0))
            sizes = (_sizes(a, b) + _sizes(c, d))[may]
            return inner + float(sizes.min(initial=math.inf)) if len(sizes) else inner
        case 'negative' | 'abs':
            return cancelled[args[0]]
        case '*':
            least = [float(_sizes(*found[arg]).min()) for arg in args]
            return cancelled[args[0]] * least[1] + cancelled[args[1]] * least[0]
        case '/':
            low, high = found[args[1]]
            if ((low > 0.0) | (high < 0.0)).all():
                return cancelled[args[0]] / float(np.maximum(np.abs(low), np.abs(high)).max())
        case 'where' | 'min' | 'max':
            return max(cancelled[arg] for arg in args)
    return 0.0
