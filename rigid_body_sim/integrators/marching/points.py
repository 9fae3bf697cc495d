"""Nodes of a march, for the templates that keep the step from the last one."""

from rigid_body_sim.compilation.jit import compiled


@compiled
def onward(node, following, target):
    """Move a node to the following one, unless the target time lies before that; return 1 if it moved, -1 if it stays, 0 if none is known.

    A node begins with its time; `following` is not known while its time is not later.
    """
    if not following[0] > node[0]:
        return 0
    if target < following[0]:
        return -1
    for k in range(len(node)):
        node[k] = following[k]
    return 1
