# SPDX-License-Identifier: Apache-2.0
"""Magnetic: a moment fixed in the body, in a field of the world."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.expressed import of_pulls, refuse_beside_hinge, trees_of
from rigid_body_sim.scene.effects.protocol import (
    NOTHING_CANCELS,
    Acting,
    Bounds,
    Cancelling,
    Effect,
    Potential,
    Pull,
)
from rigid_body_sim.scene.expressions import actions, formulas, tree, vectors
from rigid_body_sim.scene.expressions.expression import EXPRESSIONS, is_constant
from rigid_body_sim.scene.expressions.onsets import onsets
from rigid_body_sim.scene.expressions.source import PLACE, STATE_NAMES, TIME
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import VECTOR, described, mapping_of
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Magnetic(Effect):
    """``magnetic: {moment: [x, y, z], field: [e, e, e]}``: A m^2 in body axes, T in world axes.

    U = -m . B, from which the torque m x B and, in a field that depends on place, the force on the
    body's origin follow. The components of the field are numbers or expressions of x, y, z and t.
    The ledger books the power as potential, or as work if the field depends on time.
    """

    energy: tree.Term
    turn: tuple[tree.Term, ...]
    most: float
    parameters: tuple[tuple[str, float], ...]
    name: ClassVar[str] = 'magnetic'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['moment', 'field'],
        moment=described(VECTOR, 'm in A m^2, body axes'),
        field=described(EXPRESSIONS, 'B in T, world axes: numbers or expressions of x y z t')),
        'U = -m . B: the torque m x B, and the force of a field that is not uniform; '
        'booked as potential, or as work if the field depends on time')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)
    repeatable: ClassVar[bool] = True

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        where, field = f'{where}.field', settings['field']
        trees = trees_of(field, where)
        known = sorted(tree.names(*trees) & {*STATE_NAMES} - {*PLACE, *TIME})
        if known:
            raise BadInput(where, f'depends on {", ".join(known)}',
                           'a field of the place x, y, z and the time t')
        refuse_beside_hinge(trees, constraint, where)
        fixed = vectors.constant(settings['moment'])
        moment = vectors.to_world(fixed)
        most = 0.0
        if is_constant(field):
            most = _size(settings['moment']) * _size([one.text for one in field])
        return cls(tree.negative(vectors.dot(moment, trees)),
                   vectors.cross(fixed, vectors.to_body(trees)), most, field[0].parameters)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """The times at which it begins to change after it was constant for long, s."""
        return onsets((self.energy,), self.parameters)

    def cancelling(self, frame: Frame, start: State, horizon: float) -> Cancelling:
        """Return the size of the terms of a field that changes; one that does not has bounds."""
        if self.most > 0.0:
            return NOTHING_CANCELS
        return of_pulls(actions.gradient(self.energy, frame, self.turn), self.parameters, frame,
                        start, horizon)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return torque and force."""
        return actions.pulls(self.energy, self.parameters, frame, self.turn,
                             'work' if self._timed else 'potential')

    def series(self, frame: Frame, time: float) -> Pull:
        """Return torque and force."""
        return formulas.pulls(self.energy, self.parameters, frame, self.turn)

    @property
    def _timed(self) -> bool:
        return bool(tree.names(self.energy) & {*TIME})

    @property
    def potential(self):
        """The energy; None in a field that depends on the time."""
        return None if self._timed else self._potential

    def _potential(self, frame: Frame) -> Potential:
        return actions.potential(self.energy, self.parameters, frame)

    def bounds(self, body: Body, constraint: Constraint) -> Bounds:
        """Return |m| |B| of a uniform field."""
        return Bounds(self.most, 0.0)


def _size(vector):
    x, y, z = map(float, vector)
    return math.sqrt(x * x + y * y + z * z)
