"""Drag: resistance in proportion to velocity (creeping flow; Stokes's law)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.vectors import dot
from rigid_body_sim.scene.effects.views import Acting, Pull

COEFFICIENT = {'type': 'number', 'minimum': 0}


@dataclass(frozen=True)
class Drag:
    """``drag: {linear: c, angular: k}``; either may be left out (0).

    F = -c v at the centre of mass (c in N s/m = kg/s, v its velocity) and the couple -k omega (k in N m s). At a pivot or hinge F counts
    by its torque about the constraint. Not on the table, where rolling resistance would be another effect.
    """

    linear: float
    angular: float
    name: ClassVar = 'drag'
    SCHEMA: ClassVar = {'type': 'object', 'properties': {'linear': COEFFICIENT, 'angular': COEFFICIENT}, 'additionalProperties': False}
    constraints: ClassVar = ('free', 'pivot', 'hinge')
    repeatable: ClassVar = False
    breakpoints: ClassVar = ()

    @classmethod
    def from_scene(cls, mapping, body, constraint, where):
        """Make it of its mapping in a scene file."""
        if not mapping:
            raise BadInput(where, 'no coefficient', 'give linear (N s/m), angular (N m s), or both')
        return cls(float(mapping.get('linear', 0.0)), float(mapping.get('angular', 0.0)))

    def acting(self, frame, time):
        """View `rate`: force and couple; what is zero does not act."""
        acting = []
        if self.linear and frame.kind == 'free':
            acting.append(Acting(f'{__name__}:force', (self.linear,), 'force', 'heat'))
        elif self.linear and any(frame.arm):
            acting.append(Acting(f'{__name__}:moment', (self.linear, *frame.arm), 'torque', 'heat'))
        if self.angular:
            acting.append(Acting(f'{__name__}:couple', (self.angular,), 'torque', 'heat'))
        return tuple(acting)

    def series(self, frame, time):
        """View `series`: the couple and, at a pivot, the moment turn a body; the force slows down one that flies."""
        r = np.array(frame.arm)
        # of `couple` and `moment`
        matrix = -self.angular * np.eye(3) - self.linear * (dot(r, r) * np.eye(3) - np.outer(r, r))
        return Pull(drag=tuple(map(tuple, matrix.tolist())) if matrix.any() else None, slowing=self.linear if frame.kind == 'free' else 0.0)


@compiled
def force(c, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return -c v, N, world components."""
    return -c * vx, -c * vy, -c * vz


@compiled
def couple(k, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return -k omega, N m."""
    return -k * wx, -k * wy, -k * wz


@compiled
def moment(c, rx, ry, rz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return r x (-c omega x r) = -c (r^2 omega - (r . omega) r), N m."""
    square, along = rx * rx + ry * ry + rz * rz, rx * wx + ry * wy + rz * wz
    return -c * (square * wx - along * rx), -c * (square * wy - along * ry), -c * (square * wz - along * rz)
