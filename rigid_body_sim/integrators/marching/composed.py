# SPDX-License-Identifier: Apache-2.0
"""Template: one step of a composition, kick, drift, kick, ..., drift, kick.

A kick of length 0 is left out.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND

drift = UNBOUND
kick = UNBOUND
DRIFTS = UNBOUND
KICKS = UNBOUND


@compiled
def step(p, y, c, k0, h):
    """Return (y, c) after a step of size h; k0 is not needed."""
    for k in range(len(DRIFTS)):
        if KICKS[k] != 0.0:
            y, c = kick(p, y, c, KICKS[k] * h)
        y, c = drift(p, y, c, DRIFTS[k] * h)
    if KICKS[-1] != 0.0:
        y, c = kick(p, y, c, KICKS[-1] * h)
    return y, c
