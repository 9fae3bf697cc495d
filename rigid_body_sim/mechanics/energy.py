# SPDX-License-Identifier: Apache-2.0
"""Template: energy and angular momentum of a state.

potential.py binds it to the potentials of the effects that a scene lists, and to what parts
carry inside the body.

Symbols: M mass, c centre of mass from the body's origin (body axes), omega angular velocity (body
axes), I inertia tensor and L angular momentum about the point of reference (parameters.py), R
rotation from body to world, V velocity of the centre of mass (world axes).
"""

import math
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Vector, layout
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.mechanics.parameters import CARRIED, FREE, HINGE, SCENE, TABLE
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.numerics.vectors import cross, dot, minus, plus, product, scaled
from rigid_body_sim.scene.state import STATE


class Diagnosis(NamedTuple):
    """The result of `diagnose`.

    Attributes
    ----------
    kinetic, potential : float
        J.
    momentum_squared : float
        L^2, (kg m^2/s)^2.
    momentum : Vector
        L about the point of reference, world axes, kg m^2/s.
    """

    kinetic: float
    potential: float
    momentum_squared: float
    momentum: Vector


DIAGNOSIS = layout(Diagnosis)
DIAGNOSIS_SIZE = DIAGNOSIS.size
KINETIC, POTENTIAL, MOMENTUM_SQUARED, MOMENTUM = (
    DIAGNOSIS.part(name).first for name in Diagnosis._fields)
load_scene, load_state, store_diagnosis = SCENE.load, STATE.load, DIAGNOSIS.store

GOOD, NOT_FINITE, NOT_UNIT, BEYOND = range(4)
UNIT = 1e-9    # largest error of the square of a quaternion that is given as an orientation

potential = UNBOUND    # (p, scene, q, position) -> J
# (p, scene, time, momentum) -> momentum with that of parts inside, body axes
with_parts = UNBOUND


@compiled
def angular_momentum(scene, omega):
    """Return I omega in body axes, I about the point of reference."""
    if scene.kind == HINGE:
        along = scene.hinge_moment * dot(scene.hinge_axis, omega)
        return scaled(along, scene.hinge_axis)
    principal = product(scene.moments, rotate_back(*scene.axes, *omega))
    return rotate(*scene.axes, *principal)


@compiled
def carried_energy(scene, now):
    """Return what a moving pivot adds to the kinetic energy about it, M u . (V - u/2), J.

    u is the velocity of the pivot, V that of the centre of mass.
    """
    q, omega = now.orientation, now.angular_velocity
    of_pivot = plus(now.velocity, rotate(*q, *cross(omega, scene.through)))
    of_center = plus(now.velocity, rotate(*q, *cross(omega, scene.center)))
    return scene.mass * dot(of_pivot, minus(of_center, scaled(0.5, of_pivot)))


@compiled
def diagnose(p, state, out):
    """Fill `out` with the Diagnosis of a state.

        kinetic     omega . I omega/2, and M V^2/2 with V = v + R (omega x c) of a body that moves;
                    of one whose pivot has the velocity u, M u . (V - u/2) more
        potential   the sum of the potentials of the effects
        L           R (I omega + h), h what parts carry inside the body

    Parameters
    ----------
    p : array
        SceneParameters, the values of the potentials, those of the parts.
    state : array (14,)
        StateView.
    out : array (6,)
        Diagnosis.
    """
    scene, now = load_scene(p), load_state(state)
    q, omega = now.orientation, now.angular_velocity
    momentum = angular_momentum(scene, omega)
    kinetic = 0.5 * dot(momentum, omega)
    if scene.kind == FREE or scene.kind == TABLE:
        of_center = plus(now.velocity, rotate(*q, *cross(omega, scene.center)))
        kinetic += 0.5 * scene.mass * dot(of_center, of_center)
    elif scene.kind == CARRIED:
        kinetic += carried_energy(scene, now)
    momentum = with_parts(p, scene, now.time, momentum)
    # L^2 of the body components: the rotation to the world would only add its rounding
    store_diagnosis(out, Diagnosis(kinetic, potential(p, scene, q, now.position),
                                   dot(momentum, momentum), rotate(*q, *momentum)))


@compiled
def diagnose_start(p, state, out):
    """Fill `out` as `diagnose` does, and say whether a motion can begin at the state.

    Returns
    -------
    int
        GOOD, or what is wrong: NOT_FINITE, NOT_UNIT (the orientation), BEYOND (energy or momentum
        are more than a double holds).
    """
    for number in state:
        if not abs(number) < math.inf:
            return NOT_FINITE
    x, y, z, w = load_state(state).orientation
    if not abs(x * x + y * y + z * z + w * w - 1.0) <= UNIT:
        return NOT_UNIT
    diagnose(p, state, out)
    for number in out:
        if not abs(number) < math.inf:
            return BEYOND
    return GOOD


@compiled
def diagnose_many(p, states, out):
    """Fill `out`, shape (n, 6), for states of shape (n, 14)."""
    for k in range(len(states)):
        diagnose(p, states[k], out[k])
