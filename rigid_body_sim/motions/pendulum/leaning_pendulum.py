# SPDX-License-Identifier: Apache-2.0
"""Pendulum whose weight has any direction: pendulum.py in a turned world.

It absorbs a body on a hinge under a field or a constant force at the centre of mass that is not
along -z (leaning.py). Its events are those of the pendulum.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Quaternion, layout
from rigid_body_sim.motions.leaning import leant, straightened, upright
from rigid_body_sim.motions.pendulum import anchor as numbers
from rigid_body_sim.motions.pendulum import pendulum
from rigid_body_sim.motions.pendulum.anchor import fill_anchor, load_parameters, numbers_of
from rigid_body_sim.motions.pendulum.pendulum import state_at
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import STATE

EVENTS, next_event = pendulum.EVENTS, pendulum.next_event
entries = takes = fill_columns = None


class Parameters(NamedTuple):
    """Numbers of the scene."""

    swing: numbers.Parameters
    turn: Quaternion    # leaning.py


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    swing: numbers.Anchor
    turn: Quaternion


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_given_turn, load_turn = PARAMETERS.part('turn').load, ANCHOR.part('turn').load
store_turn, load_state, store_state = ANCHOR.part('turn').store, STATE.load, STATE.store


def absorbs(scene):
    """Return whether the scene is a body on a hinge under a constant force."""
    return scene.constraint.mechanism is Mechanism.AXIS and upright(scene) is not None


def parameters(scene):
    """Return the numbers of the scene that the kernels take: :class:`Parameters` as an array."""
    turn, g = upright(scene)
    return PARAMETERS.array(Parameters(numbers_of(scene, g), turn))


@compiled
def anchor(parameters, start, out):
    """Fill the anchor from the state `start`."""
    turn = load_given_turn(parameters)
    fill_anchor(load_parameters(parameters), straightened(turn, load_state(start)), out)
    store_turn(out, turn)


@compiled
def state(anchor, time, out):
    """Fill out with the state at a time before or after the anchor."""
    store_state(out, leant(load_turn(anchor), state_at(anchor, time)))
