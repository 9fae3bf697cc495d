# SPDX-License-Identifier: Apache-2.0
"""Force: at a point of the body, constant or an expression of time and state."""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.numerics.functions import hypot, hypot3
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.numerics.vectors import cross, minus
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.expressed import as_written, refuse_beside_hinge, trees_of
from rigid_body_sim.scene.effects.protocol import (
    Acting,
    Bounds,
    Cancelling,
    Effect,
    Pull,
    Vector,
)
from rigid_body_sim.scene.effects.shares import share_of_least
from rigid_body_sim.scene.expressions import actions, formulas, tree
from rigid_body_sim.scene.expressions.cancelling import cancelling_or_balancing
from rigid_body_sim.scene.expressions.expression import EXPRESSIONS
from rigid_body_sim.scene.expressions.onsets import onsets
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import VECTOR, described, mapping_of
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Force(Effect):
    """``force: {value: [e, e, e], at: [x, y, z], frame: body, books: work}``.

    The components are numbers or expressions, in N; `frame` (body, the default, or world) names
    their axes. `at` is the point of the body on which it acts (body axes, m); by default the
    centre of mass. The ledger books its power as `work`, or as `heat` if the scene says so. A
    scene may list several.
    """

    trees: tuple[tree.Term, ...]
    at: tuple[float, float, float]
    frame: str
    books: str
    parameters: tuple[tuple[str, float], ...]
    name: ClassVar[str] = 'force'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['value'],
        value=described(EXPRESSIONS, 'N, numbers or expressions'),
        at=described(
            VECTOR,
            "m, from the body's origin, body axes; the centre of mass if left out"),
        frame=described({'enum': ['body', 'world']}, 'axes of the components', 'body'),
        books=described({'enum': ['work', 'heat']}, 'where the ledger books its power', 'work')),
        'F = value at a point of the body')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)
    repeatable: ClassVar[bool] = True

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        value = settings['value']
        trees = trees_of(value, f'{where}.value')
        refuse_beside_hinge(trees, constraint, f'{where}.value')
        x, y, z = map(float, settings.get('at', body.center_of_mass))
        return cls(trees, (x, y, z), settings.get('frame', 'body'),
                   settings.get('books', 'work'), value[0].parameters)

    @property
    def opposite(self) -> Self | None:
        """The contrary force, if it is given in numbers."""
        if any(one.op != 'number' for one in self.trees):
            return None
        return dataclasses.replace(self, trees=tuple(
            tree.number(-float(one.args[0])) for one in self.trees))

    @property
    def bounds(self) -> Callable[[Body, Constraint], Bounds] | None:
        """Bounds of a force that is given in numbers."""
        return None if self.opposite is None else self._bounds

    def _bounds(self, body: Body, constraint: Constraint) -> Bounds:
        """Return the range of the energy of a force fixed in the world, or the torque of another.

        A force fixed in the world turns a free body by its torque only.
        """
        value = [float(one.args[0]) for one in self.trees]
        lever, size = self._lever(body, constraint), hypot3(*value)
        torque = size * hypot3(*lever)
        if constraint.holds_a_point and self.frame == 'world':
            return Bounds(torque, 0.0)
        if constraint.axis is not None:
            return Bounds(0.0, torque)
        inertia = constraint.inertia(body)
        x, y, z = rotate_back(*inertia.axes, *lever)
        # about each axis the part of the lever across it counts, whatever way the force has
        torques = size * hypot(y, z), size * hypot(z, x), size * hypot(x, y)
        if self.frame == 'body':
            torques = rotate_back(*inertia.axes, *cross(lever, value))
        return Bounds(0.0, torque, share=share_of_least(torques, inertia.moments, torque))

    def _lever(self, body: Body, constraint: Constraint) -> Vector:
        """Return where the force acts, from what is held or from the centre of mass, m."""
        held = constraint.holds_a_point
        return minus(self.at, constraint.point(body) if held else body.center_of_mass)

    def cancelling(self, frame: Frame, start: State, horizon: float) -> Cancelling:
        """Return the size of its terms that may cancel, and their moment."""
        size = cancelling_or_balancing(self.trees, self.parameters, frame, start, horizon)
        return Cancelling(size * hypot3(*minus(self.at, frame.point)), size)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """The times at which it begins to change after it was constant for long, s."""
        return onsets(self.trees, self.parameters)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the force and its moment."""
        return as_written(actions.force(self.trees, self.frame, self.parameters, self.at, frame,
                                        self.books))

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the force and its moment."""
        return formulas.force(self.trees, self.frame, self.parameters, self.at, frame)
