# SPDX-License-Identifier: Apache-2.0
"""Template: the rates of the ledger's entries at the states of a body.

quadrature.py binds it to what acts in a scene.
"""

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.mechanics.energy import angular_momentum
from rigid_body_sim.mechanics.ledger import ENTRIES, ENTRIES_SIZE, Entries
from rigid_body_sim.mechanics.parameters import FREE, HINGE, SCENE
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import multiply, rotate, rotate_back
from rigid_body_sim.numerics.vectors import cross, dot, plus, scaled
from rigid_body_sim.scene.state import STATE

load_scene, load_state, store_entries = SCENE.load, STATE.load, ENTRIES.store

# (p, q, omega, v, m, time, place) -> power of work (W), heat (W), torque (frame, N m)
acting = UNBOUND


@compiled
def rates(p, states, out):
    """Fill the rows of `out` with the rates of the Entries, and |omega| after them.

    Parameters
    ----------
    p : array
        SceneParameters, and the values of what acts.
    states : array (n, 14)
    out : array (n, 6)
        W, W, N m (world axes), rad/s.
    """
    scene = load_scene(p)
    for k in range(len(states)):
        now = load_state(states[k])
        q, axes, omega = now.orientation, scene.frame_axes, now.angular_velocity
        reference = scene.center if scene.kind == FREE else scene.through
        of_point = plus(now.velocity, rotate(*q, *cross(omega, reference)))
        place = plus(now.position, rotate(*q, *reference))
        work, heat, torque = acting(p, multiply(*q, *axes), rotate_back(*axes, *omega), of_point,
                                    rotate_back(*axes, *angular_momentum(scene, omega)), now.time,
                                    place)
        taken = rotate(*q, *_taken(scene, omega, rotate(*axes, *torque)))
        row = out[k]
        store_entries(row, Entries(work, heat, taken))
        row[ENTRIES_SIZE] = hypot3(*omega)


@compiled
def _taken(scene, omega, torque):
    """Return the part of a torque that turns the body, body axes.

    On a hinge it is the part along the axis; at rest dry friction balances some of it. There is
    none about an axis of zero moment.
    """
    if scene.kind == HINGE:
        along = dot(scene.hinge_axis, torque)
        if scene.grip > 0.0 and dot(scene.hinge_axis, omega) == 0.0:
            along -= max(-scene.grip, min(along, scene.grip))
        return scaled(along, scene.hinge_axis)
    x, y, z = rotate_back(*scene.axes, *torque)
    I1, I2, I3 = scene.moments
    x, y, z = x if I1 > 0.0 else 0.0, y if I2 > 0.0 else 0.0, z if I3 > 0.0 else 0.0
    return rotate(*scene.axes, x, y, z)
