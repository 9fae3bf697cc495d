"""Torque: a couple in body or world axes, constant or constant by pieces in time (Euler's equations with Gamma)."""

import bisect
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.views import Acting, Pull, as_floats

VECTOR = {'type': 'array', 'items': {'type': 'number'}, 'minItems': 3, 'maxItems': 3}


@dataclass(frozen=True)
class Torque:
    """``torque: {value: [x, y, z], frame: body}`` for ever, or ``torque: {times: [t0, t1, ...], values: [[x, y, z], ...], frame: world}``.

    N m; values[i] acts from times[i] to times[i + 1], the last one stays, before the first there is none. `frame` (body, the default, or
    world) names the axes of the components. A scene may list several.
    """

    times: tuple
    values: tuple
    frame: str
    name: ClassVar = 'torque'
    SCHEMA: ClassVar = {
        'type': 'object', 'additionalProperties': False, 'properties': {
            'value': VECTOR, 'values': {'type': 'array', 'items': VECTOR, 'minItems': 1},
            'times': {'type': 'array', 'items': {'type': 'number', 'minimum': 0}, 'minItems': 1}, 'frame': {'enum': ['body', 'world']}}}
    constraints: ClassVar = ('free', 'pivot', 'hinge')
    repeatable: ClassVar = True

    @classmethod
    def from_scene(cls, mapping, body, constraint, where):
        """Make it of its mapping in a scene file."""
        frame = mapping.get('frame', 'body')
        if ('value' in mapping) == ('values' in mapping) or ('values' in mapping) != ('times' in mapping):
            raise BadInput(where, f'got the keys {", ".join(sorted(mapping)) or "none"}', 'give value alone, or times with values')
        if 'value' in mapping:
            return cls((0.0,), (as_floats(mapping['value']),), frame)
        times, values = as_floats(mapping['times']), tuple(as_floats(value) for value in mapping['values'])
        if len(times) != len(values):
            raise BadInput(where, f'{len(times)} times and {len(values)} values', 'one time for each value: when it begins')
        if any(later <= earlier for earlier, later in pairwise(times)):
            raise BadInput(f'{where}.times', f'got {list(times)}', 'times rise from one to the next')
        return cls(times, values, frame)

    @property
    def breakpoints(self):
        """The times at which the torque jumps, s."""
        return self.times

    def value(self, time):
        """Return the components just after a time, N m."""
        place = bisect.bisect_right(self.times, time) - 1
        return self.values[place] if place >= 0 else (0.0, 0.0, 0.0)

    def acting(self, frame, time):
        """View `rate`: the couple."""
        value = self.value(time)
        if self.frame == 'world':
            return Acting('rigid_body_sim.scene.effects.elementary:to_frame', value, 'torque', 'work'),
        return Acting('rigid_body_sim.scene.effects.elementary:constant', frame.from_body(value), 'torque', 'work'),

    def series(self, frame, time):
        """View `series`: the couple."""
        value = self.value(time)
        return Pull(couple=value) if self.frame == 'world' else Pull(constant=frame.from_body(value))
