"""Template: march with steps of one size.

A node is one point of the march: [time, steps so far, unused (3), unknowns, what their sums lost]. The k-th node stands at origin + k h,
formed anew each time; the last one stands at the end.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND

rate = UNBOUND
settled = UNBOUND
step = UNBOUND
load = UNBOUND
put = UNBOUND
SIZE = UNBOUND

TIME, COUNT, VALUES = 0, 1, 5
NEARLY = 1e-9    # of a step: an end that close to a node is that node


@compiled
def begin(p, control, node):
    """Take the time of a node as the origin of all times."""
    control[1] = node[TIME]


@compiled
def march(p, control, node, following, target, end, limit):
    """Move `node` on until the step from it holds the time `target`, at most `limit` steps; return (steps moved, whether it went well).

    Parameters
    ----------
    control : array
        [h, origin].
    node : array
        Changed; `following` is not needed.
    end : float
        The last node stands there exactly.
    """
    h, origin = control[0], control[1]
    t, count = node[TIME], node[COUNT]
    y, c = load(node, VALUES), load(node, VALUES + SIZE)
    moved = 0
    while t < end and moved < limit:
        t1, size = origin + (count + 1.0) * h, h
        if t1 + NEARLY * h >= end:
            t1, size = end, end - t
        if target < t1:
            break
        y, c = step(p, y, c, rate(p, y), size)
        y, c = settled(y, c)
        t, count = t1, count + 1.0
        moved += 1
    node[TIME], node[COUNT] = t, count
    put(y, node, VALUES)
    put(c, node, VALUES + SIZE)
    return moved, y[0] == y[0]


@compiled
def between(p, control, node, following, dt):
    """Return the unknowns a time dt after a node and within the step from it: one step of the method."""
    y = load(node, VALUES)
    if dt > 0.0:
        y, _ = step(p, y, load(node, VALUES + SIZE), rate(p, y), dt)
    return y
