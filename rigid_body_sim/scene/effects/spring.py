# SPDX-License-Identifier: Apache-2.0
"""Spring: between a point of the body and a point of the world, with damping along it."""

import functools
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import minus
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.expressed import of_pulls
from rigid_body_sim.scene.effects.protocol import (
    Acting,
    Cancelling,
    Effect,
    Potential,
    Pull,
    Twist,
)
from rigid_body_sim.scene.expressions import actions, formulas, tree, vectors
from rigid_body_sim.scene.expressions.cancelling import balancing
from rigid_body_sim.scene.expressions.source import PLACE, RATES, VELOCITY
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import NUMBER, VECTOR, described, mapping_of
from rigid_body_sim.scene.state import State

COEFFICIENT = {'type': 'number', 'minimum': 0}


@dataclass(frozen=True)
class Spring(Effect):
    """``spring: {at: [x, y, z], anchor: [x, y, z], stiffness: k, damping: c, length: l}``.

    It pulls the point `at` (body axes, m) toward `anchor` (world axes, m). With d from anchor to
    point,

        U = k (|d| - l)^2/2,    F = -c (d . v/|d|) d/|d|

    where v is the velocity of the point; U is booked as potential, what c takes as heat. Without
    a `length` U = k d^2/2, and c damps all of v. A scene may list several.

    ``spring: {stiffness: k, angle: phi, damping: c}`` on a hinge is a torsion spring, k in N m/rad
    and c in N m s: U = k (angle - phi)^2/2, and the torque -c rate about the axis.
    """

    energy: tree.Term
    pull: tuple[tree.Term, ...]
    damper: tuple[tree.Term, ...]
    at: tuple[float, float, float] | None    # None of a torsion spring
    held: tuple[tree.Term, ...] = ()         # pull and damper in body axes
    torsion: Twist | None = None             # of a torsion spring
    name: ClassVar[str] = 'spring'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['stiffness'],
        at=described(VECTOR, "m, from the body's origin, body axes"),
        anchor=described(VECTOR, 'm, world axes'),
        stiffness=described(COEFFICIENT, 'k in N/m; on a hinge N m/rad'),
        damping=described(COEFFICIENT, 'c in N s/m; on a hinge N m s', 0),
        length=described(COEFFICIENT, 'l in m; with 0 the damping acts on all of v', 0),
        angle=described(NUMBER, 'phi in rad, from initial.orientation about the axis', 0)),
        'U = k (|d| - l)^2/2 with d from anchor to point, F = -c (d.v/|d|) d/|d| as heat; '
        'on a hinge, without at and anchor, U = k (angle - phi)^2/2 and the torque -c '
        'rate')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)
    repeatable: ClassVar[bool] = True

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        k, c, l = (float(settings.get(key, 0.0)) for key in ('stiffness', 'damping', 'length'))
        if constraint.axis is not None and not {'at', 'anchor', 'length'} & set(settings):
            angle = float(settings.get('angle', 0.0))
            energy, damper = _torsion(k, c, angle, constraint.axis)
            return cls(energy, (), damper, None, torsion=Twist(k, angle, c))
        if 'angle' in settings:
            raise BadInput(f'{where}.angle', 'is given together with at, anchor or length'
                           if constraint.axis is not None
                           else f'has no meaning on constraint {constraint.kind!r}',
                           'a torsion spring on a hinge has stiffness, angle and damping')
        for key in ('at', 'anchor'):
            if key not in settings:
                raise BadInput(where, f'the key {key!r} is missing',
                               'needed: at, anchor, stiffness')
        x, y, z = map(float, settings['at'])
        law = functools.partial(_law, (x, y, z), settings['anchor'], k, c, l)
        energy, pull, damper = law('world')
        _, *held = law('body')
        return cls(energy, pull, damper, (x, y, z), vectors.total(*held) if c else held[0])

    def cancelling(self, frame: Frame, start: State, horizon: float) -> Cancelling:
        """Return the size of the terms of its pull at the start, and their moment."""
        if self.at is None:
            return of_pulls(actions.gradient(self.energy, frame), (), frame, start, horizon)
        size = balancing(self.pull, (), frame, start, horizon)
        return Cancelling(size * hypot3(*minus(self.at, frame.point)), size)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the pull and the damping."""
        if self.at is None:
            pulls = actions.pulls(self.energy, (), frame)
            if not self.damper:
                return pulls
            return *pulls, actions.torque(self.damper, 'body', (), frame, 'heat')
        # the moment of the force, not a derivative by the attitude, whose terms cancel
        pulls = actions.force(self.pull, 'world', (), self.at, frame, 'potential')
        if not self.damper:
            return pulls
        return *pulls, *actions.force(self.damper, 'world', (), self.at, frame, 'heat')

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the pull with the damping."""
        if self.at is None:
            found = formulas.pulls(self.energy, (), frame)
            damper = formulas.torque(self.damper or formulas.NONE, 'body', (), frame)
            return Pull(formulas=found.formulas + damper.formulas)
        # only the moment acts at a pivot: body axes spare turning the force
        if not frame.moves and frame.hinge is None:
            return formulas.force(self.held, 'body', (), self.at, frame)
        both = vectors.total(self.pull, self.damper or formulas.NONE)
        return formulas.force(both, 'world', (), self.at, frame)

    @property
    def twist(self) -> Twist | None:
        """The Twist of a torsion spring."""
        return self.torsion

    def potential(self, frame: Frame) -> Potential:
        """Return the energy."""
        return actions.potential(self.energy, (), frame)


def _law(at, anchor, k, c, l, axes):
    """Return U, the pull and the damper (none without c), components along the axes, as trees."""
    at, anchor = vectors.constant(at), vectors.constant(anchor)
    carried = vectors.cross(vectors.named(RATES), at)
    if axes == 'world':
        d = vectors.difference(vectors.total(vectors.named(PLACE), vectors.to_world(at)), anchor)
        v = vectors.total(vectors.named(VELOCITY), vectors.to_world(carried))
    else:
        to_origin = vectors.difference(vectors.named(PLACE), anchor)
        d = vectors.total(vectors.to_body(to_origin), at)
        v = vectors.total(vectors.to_body(vectors.named(VELOCITY)), carried)
    square, pull = vectors.dot(d, d), tree.number(-k)
    if l:
        pull = tree.times(pull, tree.minus(
            tree.number(1.0), tree.over(tree.number(l), tree.term('sqrt', square))))
        stretch = tree.minus(tree.term('sqrt', square), tree.number(l))
        square = tree.times(stretch, stretch)
        along = tree.over(vectors.dot(d, v), vectors.dot(d, d))
        v = vectors.scaled(along, d)
    return (tree.times(tree.number(0.5 * k), square), vectors.scaled(pull, d),
            vectors.scaled(tree.number(-c), v) if c else ())


def _torsion(k, c, angle, axis):
    """Return the energy of a torsion spring, and the torque of its damping."""
    turned = tree.minus(tree.term('name', 'angle'), tree.number(angle))
    energy = tree.times(tree.number(0.5 * k), tree.times(turned, turned))
    rate = tree.term('name', 'rate')
    return energy, tuple(tree.times(tree.number(-c * part), rate) for part in axis) if c else ()
