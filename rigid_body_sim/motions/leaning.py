# SPDX-License-Identifier: Apache-2.0
"""Held bodies under a constant force of any direction: the vertical of their motion leans.

The world is turned until the force is along -z. There the body moves as under its weight, and what
it does is turned back.
"""

from fractions import Fraction

from rigid_body_sim.compilation.jit import compiled_inline
from rigid_body_sim.mechanics.pulls import load_of
from rigid_body_sim.motions.axle import root_of
from rigid_body_sim.numerics.rotations import multiply, rotate, rotate_back, turn_to
from rigid_body_sim.numerics.vectors import dot
from rigid_body_sim.scene.scene import kept
from rigid_body_sim.scene.state import StateView


@kept
def upright(scene):
    """Return how the vertical of the motion lies in the world, and g along it.

    Returns
    -------
    turn : quaternion
        It turns the z axis against the force on the centre of mass.
    g : Fraction
        The force over the mass, m/s^2.
    None where anything else acts on the body, and where no force does.
    """
    load = load_of(scene)
    if load is None or not any(load):
        return None
    size = Fraction(*root_of(*dot(load, load).as_integer_ratio()))
    return turn_to(*(float(-one / size) for one in load)), size / Fraction(scene.body.mass)


@compiled_inline
def leant(turn, state):
    """Return a StateView of the turned world in the world of the scene."""
    return StateView(state.time, multiply(*turn, *state.orientation), state.angular_velocity,
                     rotate(*turn, *state.position), rotate(*turn, *state.velocity))


@compiled_inline
def straightened(turn, state):
    """Return a StateView of the world of the scene in the turned world."""
    x, y, z, w = turn
    return StateView(state.time, multiply(-x, -y, -z, w, *state.orientation),
                     state.angular_velocity, rotate_back(*turn, *state.position),
                     rotate_back(*turn, *state.velocity))
