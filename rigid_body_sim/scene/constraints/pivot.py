# SPDX-License-Identifier: Apache-2.0
"""Pivot: a point of the body stays where it is, and the body turns about it in all directions."""

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics import rotations
from rigid_body_sim.numerics.vectors import cross, minus, plus
from rigid_body_sim.scene import initial
from rigid_body_sim.scene.bodies import Body, Inertia, moved, refuse_beyond, square_of
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism, Vector
from rigid_body_sim.scene.expressions import path, tree
from rigid_body_sim.scene.expressions.expression import EXPRESSIONS
from rigid_body_sim.scene.expressions.source import TIME
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.schema import VECTOR, described, mapping_of
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Pivot(Constraint):
    """``constraint: pivot``. The reference point is the body's origin.

    With a point `at` that is not the origin it is a :class:`DisplacedPivot`, with a `motion` a
    :class:`MovingPivot`.
    """

    kind: ClassVar[str] = 'pivot'
    usage: ClassVar[str] = 'pivot'
    INITIAL: ClassVar[dict] = {**initial.ORIENTATION, **initial.TILT, **initial.TURNING,
                               **initial.PLACE}
    mechanism: ClassVar[Mechanism] = Mechanism.POINT
    starts_as_given: ClassVar[bool] = True

    @classmethod
    def variant(cls, body: Body, settings: Any) -> type[Constraint]:
        """Return DisplacedPivot or MovingPivot where settings are given."""
        if isinstance(settings, dict) and 'motion' in settings:
            return MovingPivot
        return DisplacedPivot if settings else cls

    @classmethod
    def variants(cls) -> tuple[type[Constraint], ...]:
        """Return the three classes of a pivot."""
        return cls, DisplacedPivot, MovingPivot

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state as it is given; the origin is at rest."""
        start.refuse_spin_without_moment(body.about_origin, where)
        return start.state()

    def point(self, body: Body) -> Vector:
        """Return the body's origin."""
        return 0.0, 0.0, 0.0

    def inertia(self, body: Body) -> Inertia:
        """Return the tensor about the body's origin."""
        return body.about_origin


@dataclass(frozen=True)
class DisplacedPivot(Constraint):
    """``constraint: {pivot: {at: [x, y, z]}}``: the point `at` (body axes, m) is held.

    `initial.position` is where it is in the world.
    """

    at: Vector = (0.0, 0.0, 0.0)
    kind: ClassVar[str] = 'displaced_pivot'
    usage: ClassVar[str] = 'pivot: {at: [x, y, z]}'
    SCHEMA: ClassVar[dict | None] = described(mapping_of(
        ['at'], at=described(VECTOR, "m, from the body's origin, body axes")),
        'the point `at` is held at initial.position')
    INITIAL: ClassVar[dict] = Pivot.INITIAL
    mechanism: ClassVar[Mechanism] = Mechanism.POINT

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Any:
        """Return the pivot at its point; a Pivot where that is the body's origin."""
        x, y, z = map(float, settings['at'])
        if not any((x, y, z)):
            return Pivot()
        refuse_beyond(body.mass * square_of((x, y, z)), where)
        return cls((x, y, z))

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state as it is given; the point is at rest."""
        start.refuse_spin_without_moment(self.inertia(body), where)
        arm = rotations.rotate(*start.orientation, *self.at)
        velocity = cross(arm, rotations.rotate(*start.orientation, *start.omega))
        return State.of(0.0, start.orientation, start.omega, minus(start.position, arm), velocity)

    def point(self, body: Body) -> Vector:
        """Return the point `at`."""
        return self.at

    def inertia(self, body: Body) -> Inertia:
        """Return the tensor about the point `at`."""
        return moved(body.about_center, body.mass, self.arm(body), 1.0, self.exact_arm(body))


@dataclass(frozen=True)
class MovingPivot(Constraint):
    """``constraint: {pivot: {motion: [e, e, e], at: [x, y, z]}}``: the pivot moves, whatever acts.

    The point `at` (body axes, m; default: the body's origin) is at `initial.position` +
    `motion(t)` in the world; the components of `motion` are expressions of the time t (s), in m,
    without kinks. The bearing exerts the force that this takes, and the ledger books its work.
    """

    trees: tuple[tree.Term, ...]
    parameters: tuple[tuple[str, float], ...]
    at: Vector = (0.0, 0.0, 0.0)
    kind: ClassVar[str] = 'moving_pivot'
    usage: ClassVar[str] = 'pivot: {motion: [0, 0, "0.01*cos(300*t)"]}'
    SCHEMA: ClassVar[dict | None] = described(mapping_of(
        ['motion'],
        motion=described(EXPRESSIONS, 'm, world axes: expressions of t'),
        at=described(VECTOR, "m, from the body's origin, body axes", [0, 0, 0])),
        'the point `at` is at initial.position + motion(t); the work of the drive is booked')
    INITIAL: ClassVar[dict] = Pivot.INITIAL
    mechanism: ClassVar[Mechanism] = Mechanism.POINT

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, where: str) -> Any:
        """Return the pivot on its path."""
        x, y, z = map(float, settings.get('at', (0.0, 0.0, 0.0)))
        refuse_beyond(body.mass * square_of((x, y, z)), where)
        where = f'{where}.motion'
        trees = tuple(one.tree(f'{where}.{place}', TIME)
                      for place, one in enumerate(settings['motion']))
        kinks = path.kinks(trees)
        if kinks:
            raise BadInput(where, f'has {", ".join(kinks)}',
                           'a path without kinks: where it has one the pivot would strike the '
                           'body')
        found = cls(trees, settings['motion'][0].parameters, (x, y, z))
        for what, vector in zip(('place', 'velocity', 'acceleration'),
                                path.along(found.path, 0.0), strict=True):
            if not all(map(math.isfinite, vector)):
                raise BadInput(where, f'the {what} at time 0 is {list(vector)}',
                               'a path that is finite')
        return found

    @property
    def path(self) -> path.Path:
        """The path of the pivot, without `initial.position`."""
        return path.path(self.trees, self.parameters)

    def initial(self, start: Start, body: Body, where: str) -> State:
        """Return the state as it is given, with the pivot on its path."""
        start.refuse_spin_without_moment(self.inertia(body), where)
        place, velocity, _ = path.along(self.path, 0.0)
        arm = rotations.rotate(*start.orientation, *self.at)
        carried = cross(arm, rotations.rotate(*start.orientation, *start.omega))
        return State.of(0.0, start.orientation, start.omega,
                        minus(plus(start.position, place), arm), plus(velocity, carried))

    def point(self, body: Body) -> Vector:
        """Return the point `at`."""
        return self.at

    def inertia(self, body: Body) -> Inertia:
        """Return the tensor about the point `at`."""
        if not any(self.at):
            return body.about_origin
        return moved(body.about_center, body.mass, self.arm(body), 1.0, self.exact_arm(body))

    def frame(self, body: Body) -> Frame:
        """Return the frame about the point, with its path."""
        return super().frame(body)._replace(path=self.path)
