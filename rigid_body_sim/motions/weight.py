"""Angular impulse of the weight of a pivoted or hinged body: a quadrature over its motion in closed form, for the ledger.

The torque about the constraint is r x (0, 0, -M g) = M g (-r_y, r_x, 0), r the world vector from there to the centre of mass. It is integrated
with 16 Gauss-Legendre nodes on panels of at most 8 rad of the fastest turning; the next term is below 1e-24 of the integral then.
"""

import math

import numpy as np

from rigid_body_sim.mechanics.bounds import swing_rate
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.gauss import rule
from rigid_body_sim.numerics.rotations import matrix, rotate
from rigid_body_sim.numerics.vectors import dot, scaled
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, STATE_SIZE

NODES, WEIGHTS = (np.array(numbers) for numbers in rule(16))
RADIANS_A_PANEL = 8.0
PANELS_AT_ONCE = 1024
MOST_PANELS = 2 ** 14
"""Of one stretch. Beyond a million radians the weight hardly changes the momentum, and panels spread over the stretch give its mean."""


class WeightImpulse:
    """The integral from a start on, kept up to the last time asked.

    Parameters
    ----------
    scene : Scene
        With constraint pivot or hinge, and gravity.
    states : callable
        (times, out) -> None, as a solver has it.
    start : array (14,)
        The state at the start.
    """

    def __init__(self, scene, states, start):
        body, constraint = scene.body, scene.constraint
        self._states, self._from, self._time = states, start[0], start[0]
        self._arm = constraint.arm(body)
        self._weight = body.mass * scene.effect('gravity').g
        self._axis = None
        if constraint.axis is not None:
            self._axis = rotate(*start[ORIENTATION].tolist(), *constraint.axis)
        self._impulse = np.zeros(3)
        self._fastest = hypot3(*start[ANGULAR_VELOCITY].tolist()) + swing_rate(scene)

    def until(self, time):
        """Return the angular impulse (N m s, world axes; for a hinge its part along the axis) from the start to a time (s)."""
        if time < self._time:
            self._time, self._impulse = self._from, np.zeros(3)
        panels = max(1, math.ceil(min(MOST_PANELS, (time - self._time) * self._fastest / RADIANS_A_PANEL)))
        edges = self._time + (time - self._time) * (np.arange(panels + 1) / panels)
        for first in range(0, panels, PANELS_AT_ONCE):
            part = edges[first:first + PANELS_AT_ONCE + 1]
            length = np.diff(part)[:, None]
            times = (part[:-1, None] + length * NODES).ravel()
            out = np.empty((len(times), STATE_SIZE))
            self._states(times, out)
            along_x, along_y, _ = matrix(*out[:, ORIENTATION].T)
            rx, ry = dot(along_x, self._arm), dot(along_y, self._arm)
            weights = (length * WEIGHTS).ravel() * self._weight
            # exact sums: the order in which numpy adds is its own affair
            self._impulse += [-math.fsum((weights * ry).tolist()), math.fsum((weights * rx).tolist()), 0.0]
        self._time = time
        return self._impulse if self._axis is None else np.array(scaled(dot(self._axis, self._impulse), self._axis))
