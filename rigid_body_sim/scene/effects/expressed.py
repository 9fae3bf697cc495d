# SPDX-License-Identifier: Apache-2.0
"""Torques and potentials that a scene writes as expressions of time and state."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Acting, Cancelling, Effect, Potential, Pull
from rigid_body_sim.scene.expressions import actions, formulas, tree
from rigid_body_sim.scene.expressions.cancelling import balancing, cancelling_or_balancing
from rigid_body_sim.scene.expressions.expression import EXPRESSION, Expression
from rigid_body_sim.scene.expressions.onsets import onsets
from rigid_body_sim.scene.expressions.source import ATTITUDE, HINGE, PLACE, STATE_NAMES
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import described, mapping_of
from rigid_body_sim.scene.state import State


def trees_of(value: list[Expression], where: str) -> tuple[tree.Term, ...]:
    """Return the trees of three expressions."""
    return tuple(one.tree(f'{where}.{place}') for place, one in enumerate(value))


def refuse_beside_hinge(trees: tuple[tree.Term, ...], constraint: Constraint,
                        where: str) -> None:
    """Refuse the angle of a hinge and its rate where there is no hinge."""
    known = tree.names(*trees) & {*HINGE}
    if constraint.mechanism is not Mechanism.AXIS and known:
        raise BadInput(where, f'depends on {", ".join(sorted(known))}',
                       f'on constraint {constraint.kind!r} there is no hinge: '
                       'write attitude and angular velocity')


def as_written(acting: Iterable[Acting]) -> tuple[Acting, ...]:
    """Return what acts by an expression; nobody knows the sign of the heat that it books."""
    return tuple(one._replace(both_ways=True) if one.books == 'heat' else one for one in acting)


@dataclass(frozen=True)
class ExpressedTorque(Effect):
    """``torque: {value: [e, e, e], frame: body, books: work}`` with expressions e, in N m.

    Attributes
    ----------
    trees : tuple of 3 Terms
    frame : str
        Axes of the components: ``body`` or ``world``.
    books : str
        Where the ledger writes its power: ``work`` or ``heat``.
    parameters : tuple of (str, float)
    """

    trees: tuple[tree.Term, ...]
    frame: str
    books: str
    parameters: tuple[tuple[str, float], ...]
    name: ClassVar[str] = 'torque'
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)
    repeatable: ClassVar[bool] = True

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        value = settings['value']
        trees = trees_of(value, f'{where}.value')
        refuse_beside_hinge(trees, constraint, f'{where}.value')
        return cls(trees, settings.get('frame', 'body'), settings.get('books', 'work'),
                   value[0].parameters)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """The times at which it begins to change after it was constant for long, s."""
        return onsets(self.trees, self.parameters)

    def cancelling(self, frame: Frame, start: State, horizon: float) -> Cancelling:
        """Return the size of its terms that may cancel."""
        return Cancelling(
            cancelling_or_balancing(self.trees, self.parameters, frame, start, horizon), 0.0)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the couple; one of zero does not act."""
        if all(one == tree.ZERO for one in self.trees):
            return ()
        return as_written([actions.torque(self.trees, self.frame, self.parameters, frame,
                                          self.books)])

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the couple."""
        return formulas.torque(self.trees, self.frame, self.parameters, frame)


def of_pulls(pulls: tuple[tuple[tree.Term, ...], ...], parameters: tuple[tuple[str, float], ...],
             frame: Frame, start: State, horizon: float) -> Cancelling:
    """Return the sizes of the terms of a force at the origin and the torque about it (`gradient`).

    More than four arguments: those of `balancing`.
    """
    force, torque = (balancing(trees, parameters, frame, start, horizon) for trees in pulls)
    return Cancelling(torque + force * hypot3(*frame.point), force)


@dataclass(frozen=True)
class PotentialEnergy(Effect):
    """``potential: {energy: "0.5*k*(z - 1)^2"}``: U in J, of place and attitude.

    Force and torque follow by differentiation: F = -dU/d(x, y, z) at the body's origin, and the
    torque -dU/d(turn about it). A scene may list several.
    """

    energy: tree.Term
    parameters: tuple[tuple[str, float], ...]
    name: ClassVar[str] = 'potential'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['energy'],
        energy=described(
            EXPRESSION,
            'U in J, an expression of x y z, qx qy qz qw, or the angle of a hinge')),
        "F = -dU/d(x, y, z) at the body's origin, and the torque -dU/d(turn about it); "
        'booked as potential')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)
    repeatable: ClassVar[bool] = True

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        where = f'{where}.energy'
        energy = settings['energy'].tree(where)
        known = sorted(tree.names(energy) & {*STATE_NAMES} - {*PLACE, *ATTITUDE, 'angle'})
        if known:
            raise BadInput(where, f'depends on {", ".join(known)}',
                           f'a potential is a function of {", ".join((*PLACE, *ATTITUDE))}, '
                           'angle: write what depends on time or velocity as a force or a torque')
        refuse_beside_hinge((energy,), constraint, where)
        return cls(energy, settings['energy'].parameters)

    def cancelling(self, frame: Frame, start: State, horizon: float) -> Cancelling:
        """Return the size of the terms of its force and torque at the start."""
        return of_pulls(actions.gradient(self.energy, frame), self.parameters, frame, start,
                        horizon)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return force and torque."""
        return actions.pulls(self.energy, self.parameters, frame)

    def series(self, frame: Frame, time: float) -> Pull:
        """Return force and torque."""
        return formulas.pulls(self.energy, self.parameters, frame)

    def potential(self, frame: Frame) -> Potential:
        """Return the energy."""
        return actions.potential(self.energy, self.parameters, frame)
