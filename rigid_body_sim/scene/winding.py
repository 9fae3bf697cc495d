# SPDX-License-Identifier: Apache-2.0
"""Whether a body on a hinge may turn to the end of its angle, where some laws jump.

The angle of a hinge is from -2 pi to 2 pi, and goes on from the other end. Where what acts has a
potential, or takes energy only, a body with less energy than the potential has at both ends does
not get there.
"""

import math

from rigid_body_sim.compilation.jit import in_python
from rigid_body_sim.numerics import rotations
from rigid_body_sim.numerics.functions import cos, sin
from rigid_body_sim.numerics.vectors import apply, cross, dot, plus, scaled
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import State

SLACK = 2.0 ** -30    # of the energies: far above their rounding
END = math.pi * (1.0 - 2.0 ** -40)    # half the angle just before its end, rad


def energy_at_ends(scene):
    """Return the lower potential at the two ends of the angle, J.

    It is infinite where nothing that acts jumps there, and minus infinity where what acts may add
    energy without end.
    """
    if scene.constraint.mechanism is not Mechanism.AXIS:
        return math.inf
    acting = [one for effect in scene.effects if effect.acting is not None
              for one in effect.acting(scene.frame, -math.inf)]
    if not any(one.winding for one in acting):
        return math.inf
    if scene.strikes or any(effect.breakpoints for effect in scene.effects) or any(
            one.timed or one.both_ways or one.books == 'work' for one in acting):
        return -math.inf
    hinge = scene.frame.hinge
    ends = []
    for half in (END, -END):
        rotation = (*scaled(sin(half), hinge.axis), cos(half))
        vector = State.of(orientation=rotations.multiply(*hinge.zero, *rotation),
                          position=scene.initial.position).vector
        ends.append(potential_energy(scene, vector))
    first, last = ends
    # not min(): of a potential that is no number nothing is known
    return first if first <= last else last if last <= first else -math.inf


def may_reach_ends(scene, vector):
    """Return whether a body may get from a state (14 doubles) to an end where what acts jumps."""
    barrier = scene.energy_at_ends
    if barrier in (-math.inf, math.inf):
        return barrier < 0.0
    state = State(vector)
    axis, frame = scene.constraint.axis, scene.frame
    lever = cross(axis, frame.arm)
    inertia = scene.body.about_center.matrix.tolist()
    moment = dot(axis, apply(inertia, axis)) + frame.mass * dot(lever, lever)
    rate = dot(axis, state.angular_velocity.tolist())
    kinetic, potential = 0.5 * moment * rate * rate, potential_energy(scene, vector)
    slack = SLACK * (kinetic + abs(potential) + abs(barrier))
    # not <: a NaN counts as a body that gets there
    return not kinetic + potential + slack < barrier


def potential_energy(scene, vector):
    """Return the potential energy of a body on a hinge at a state (14 doubles), J."""
    state, frame = State(vector), scene.frame
    q = state.orientation.tolist()
    center = plus(state.position.tolist(),
                  rotations.rotate(*q, *plus(frame.point, frame.arm)))
    total = 0.0
    for effect in scene.effects:
        if effect.potential is not None:
            found = effect.potential(frame)
            total += in_python(found.kernel)(*found.values, *q, *center)
    return total
