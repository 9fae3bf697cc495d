# SPDX-License-Identifier: Apache-2.0
"""Heavy symmetric top whose weight has any direction: lagrange_top.py in a turned world.

It absorbs what a Lagrange top absorbs, under a field or a constant force at the centre of mass
that is not along -z (leaning.py). The event of a pivot, a turning point of the height, is looked
for on the states.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Quaternion, layout
from rigid_body_sim.motions.lagrange_top import lagrange_top
from rigid_body_sim.motions.lagrange_top.lagrange_top import (
    fill_anchor,
    is_symmetric,
    load_parameters,
    numbers_of,
    state_at,
    symmetry_axis,
)
from rigid_body_sim.motions.leaning import leant, straightened, upright
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import STATE

EVENTS = ()
entries = takes = next_event = fill_columns = None


class Parameters(NamedTuple):
    """Numbers of the scene."""

    top: lagrange_top.Parameters
    turn: Quaternion    # leaning.py


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    top: lagrange_top.Anchor
    turn: Quaternion


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_given_turn, load_turn = PARAMETERS.part('turn').load, ANCHOR.part('turn').load
store_turn, load_state, store_state = ANCHOR.part('turn').store, STATE.load, STATE.store


def absorbs(scene):
    """Return whether the scene is a symmetric body under a constant force, held at a point."""
    return (scene.constraint.mechanism is Mechanism.POINT and symmetry_axis(scene) is not None
            and upright(scene) is not None and is_symmetric(scene))


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
