# SPDX-License-Identifier: Apache-2.0
"""Torque: a couple in body or world axes, constant or piecewise constant in time.

These are Euler's equations with a torque Gamma.
"""

import bisect
import dataclasses
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Self

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.numerics.vectors import scaled
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.expressed import ExpressedTorque
from rigid_body_sim.scene.effects.protocol import (
    Acting,
    Bounds,
    Effect,
    Pull,
    as_floats,
)
from rigid_body_sim.scene.effects.shares import share_of_least
from rigid_body_sim.scene.expressions.expression import EXPRESSIONS, is_constant
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import VECTOR, described, mapping_of


@dataclass(frozen=True)
class Torque(Effect):
    """``torque: {value: [x, y, z], frame: body}`` acts for ever.

    ``torque: {times: [t0, t1, ...], values: [[x, y, z], ...], frame: world}`` acts in pieces.
    Values are in N m; values[i] acts from times[i] to times[i + 1], the last one stays, and before
    the first there is none. `frame` (body, the default, or world) names the axes of the
    components. `books` says where the ledger writes its power. A `value` of expressions, or one
    that is booked as heat, is an :class:`ExpressedTorque`. A scene may list several.
    """

    times: tuple[float, ...]
    values: tuple[tuple[float, ...], ...]
    frame: str
    books: str = 'work'
    name: ClassVar[str] = 'torque'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        value=described(EXPRESSIONS, 'N m, numbers or expressions'),
        books=described({'enum': ['work', 'heat']}, 'where the ledger books its power', 'work'),
        values=described(
            {'type': 'array', 'items': VECTOR, 'minItems': 1},
            'N m, one vector for each of times'),
        times=described(
            {'type': 'array', 'items': {'type': 'number', 'minimum': 0}, 'minItems': 1},
            's, rising'),
        frame=described({'enum': ['body', 'world']}, 'axes of the components', 'body')),
        'the couple Gamma = value; with times and values, values[i] from times[i] to the next '
        'time, and none before the first')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)
    repeatable: ClassVar[bool] = True

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Effect:
        """Return the effect of its settings in a scene file."""
        frame = settings.get('frame', 'body')
        if (('value' in settings) == ('values' in settings)
                or ('values' in settings) != ('times' in settings)):
            raise BadInput(where, f'got the keys {", ".join(sorted(settings)) or "none"}',
                           'give value alone, or times with values')
        books = settings.get('books', 'work')
        if 'value' in settings and (books == 'heat' or not is_constant(settings['value'])):
            return ExpressedTorque.from_scene(settings, body, constraint, where)
        if 'value' in settings:
            return cls((0.0,), (as_floats(one.text for one in settings['value']),), frame)
        times = as_floats(settings['times'])
        values = tuple(as_floats(value) for value in settings['values'])
        if len(times) != len(values):
            raise BadInput(where, f'{len(times)} times and {len(values)} values',
                           'one time for each value: when it begins')
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise BadInput(f'{where}.times', f'got {list(times)}',
                           'times rise from one to the next')
        return cls(times, values, frame, books)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """The times at which the torque jumps, s."""
        return self.times

    @property
    def opposite(self) -> Self:
        """The contrary torque."""
        return dataclasses.replace(self, values=tuple(scaled(-1.0, one) for one in self.values))

    def value(self, time: float) -> tuple[float, ...]:
        """Return the components just after a time, N m."""
        place = bisect.bisect_right(self.times, time) - 1
        return self.values[place] if place >= 0 else (0.0, 0.0, 0.0)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the couple; nothing if it is zero at all times."""
        if not any(map(any, self.values)):
            return ()
        value = self.value(time)
        if self.frame == 'world':
            return Acting('rigid_body_sim.scene.effects.elementary:to_frame', value, 'torque',
                          self.books, polynomial=True),
        return Acting('rigid_body_sim.scene.effects.elementary:constant', frame.from_body(value),
                      'torque', self.books, polynomial=True),

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the couple."""
        x, y, z = self.value(time)
        return (Pull(couple=(x, y, z)) if self.frame == 'world'
                else Pull(constant=frame.from_body((x, y, z))))

    def bounds(self, body: Body, constraint: Constraint) -> Bounds:
        """Return the largest torque, and that of each piece."""
        sizes = [hypot3(*value) for value in self.values]
        share = 1.0
        if self.frame == 'body' and constraint.axis is None:
            inertia = constraint.inertia(body)
            share = max((share_of_least(rotate_back(*inertia.axes, *value), inertia.moments, size)
                         for value, size in zip(self.values, sizes, strict=True) if size > 0.0),
                        default=1.0)
        return Bounds(0.0, max(sizes), tuple(zip(self.times, sizes, strict=True)), share)
