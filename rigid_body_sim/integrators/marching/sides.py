# SPDX-License-Identifier: Apache-2.0
"""Template: the switches of what acts at a state; their signs tell the side of each kink."""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.euler import load_axes, load_state, read_state
from rigid_body_sim.numerics.rotations import rotate_back

switching = UNBOUND
COUNT = UNBOUND


@compiled
def sides(p, vector, out):
    """Fill `out`, shape (COUNT,), with the switches at a state vector; a start in p is changed."""
    q, _, place, drift = read_state(p, vector)
    state = load_state(vector)
    omega = rotate_back(*load_axes(p), *state.angular_velocity)
    found = switching(p, *q, *omega, *drift, state.time, *place)
    for k in range(COUNT):
        out[k] = found[k]
