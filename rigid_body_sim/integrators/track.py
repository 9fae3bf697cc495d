"""Template: states at any times along a march, with checkpoints.

The nodes of a march depend on its start only. Every `stride`-th node is kept; when the store is full, every other one is dropped and the
stride doubles, so an earlier time costs a restart from the checkpoint before it. A state between two nodes is one step of the method from
the earlier one: it is as accurate as the nodes, continuous, and does not depend on which times were asked.
"""

from rigid_body_sim.compiled import compiled
from rigid_body_sim.specialise import UNBOUND

start = UNBOUND
begin = UNBOUND
march = UNBOUND
between = UNBOUND
write = UNBOUND
SIZE = UNBOUND
VALUES = UNBOUND

TIME = 0
STORED, STRIDE, COUNT = 0, 1, 2     # layout of `counts`
SPACING = 32                        # at first every which node is kept


@compiled
def _copy(source, target):
    for k in range(len(source)):    # an assignment of slices would compile numba's own error texts, for seconds
        target[k] = source[k]


@compiled
def first_piece(p, vector, control, node, following, store, counts):
    """Fill a piece at its start, a state vector; its constants are in p, control and node."""
    node[TIME] = vector[0]
    start(p, vector, node, VALUES)
    piece(p, control, node, following, store, counts)


@compiled
def piece(p, control, node, following, store, counts):
    """Fill a piece at its first node, whose time and unknowns are set."""
    begin(p, control, node)
    _copy(node, following)
    _copy(node, store[0])
    counts[STORED], counts[STRIDE], counts[COUNT] = 1, SPACING, 0


@compiled
def follow(p, control, node, following, store, counts, target, end):
    """Bring `node` to the last node not later than `target`; return whether it went well."""
    if target < node[TIME]:
        low, high = 0, counts[STORED] - 1
        while low < high:
            middle = (low + high + 1) // 2
            if store[middle, TIME] <= target:
                low = middle
            else:
                high = middle - 1
        _copy(store[low], node)
        following[TIME] = node[TIME]
        counts[COUNT] = low * counts[STRIDE]
    while True:
        until_checkpoint = counts[STRIDE] - counts[COUNT] % counts[STRIDE]
        moved, good = march(p, control, node, following, target, end, until_checkpoint)
        counts[COUNT] += moved
        if not good:
            return False
        if moved < until_checkpoint:
            return True
        if counts[COUNT] == counts[STORED] * counts[STRIDE]:
            if counts[STORED] == len(store):
                half = len(store) // 2
                for k in range(half):
                    _copy(store[2 * k], store[k])
                counts[STORED], counts[STRIDE] = half, 2 * counts[STRIDE]
            if counts[COUNT] == counts[STORED] * counts[STRIDE]:
                _copy(node, store[counts[STORED]])
                counts[STORED] += 1


@compiled
def states(p, control, node, following, store, counts, times, order, end, out):
    """Fill row order[i] of out with the state at times[order[i]], times rising in that order; return how many rows were filled."""
    for i in range(len(order)):
        k = order[i]
        if not follow(p, control, node, following, store, counts, times[k], end):
            return i
        y = between(p, control, node, following, times[k] - node[TIME])
        write(p, times[k], y, out[k])
        for book in range(14, out.shape[1]):
            out[k, book] = y[SIZE - out.shape[1] + book]
    return len(order)
