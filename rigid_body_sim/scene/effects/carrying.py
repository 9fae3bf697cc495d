# SPDX-License-Identifier: Apache-2.0
"""Carrying: the effect of a moving pivot's acceleration on a body, seen from the pivot.

In axes that move with the pivot, whose acceleration is a, the force -M a acts at the centre of
mass. A scene does not list this effect: a pivot with a `motion` implies it.
"""

from dataclasses import dataclass
from typing import ClassVar, Self

from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.protocol import Acting, Cancelling, Effect, Pull
from rigid_body_sim.scene.expressions import actions, formulas, path, tree
from rigid_body_sim.scene.expressions.cancelling import cancelling
from rigid_body_sim.scene.expressions.onsets import onsets
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.state import State


@dataclass(frozen=True)
class Carrying(Effect):
    """The torque of -M a about a pivot with the acceleration a.

    Attributes
    ----------
    trees : tuple of 3 Terms
        -M a, world axes, N.
    parameters : tuple of (str, float)
    center : tuple of 3 floats
        The centre of mass, body axes, m.
    """

    trees: tuple[tree.Term, ...]
    parameters: tuple[tuple[str, float], ...]
    center: tuple[float, float, float]
    name: ClassVar[str] = 'carrying'
    SCHEMA: ClassVar[dict] = {}
    mechanisms: ClassVar = (Mechanism.POINT,)

    @classmethod
    def of(cls, moving: path.Path, body: Body) -> Self:
        """Return the effect of a path along which the held point of a body moves."""
        mass = tree.number(-body.mass)
        forces = tuple(tree.times(mass, one) for one in path.accelerations(moving.trees))
        return cls(forces, moving.parameters, body.center_of_mass)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """The times at which it begins to change after it was constant for long, s."""
        return onsets(self.trees, self.parameters)

    def cancelling(self, frame: Frame, start: State, horizon: float) -> Cancelling:
        """Return the moment of its terms that may cancel."""
        size = cancelling(self.trees, self.parameters, horizon)
        return Cancelling(size * hypot3(*frame.arm), 0.0)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the torque; there is none about the centre of mass, and none in a fixed frame."""
        if frame.path is None:
            return ()
        found = tuple(one for one in actions.force(self.trees, 'world', self.parameters,
                                                   self.center, frame, 'work')
                      if one.gives == 'torque')
        # a motion in closed form sees that something acts, even if it turns nothing
        return found or (Acting('rigid_body_sim.scene.effects.elementary:constant',
                                (0.0, 0.0, 0.0), 'torque', 'work',
                                polynomial=True),)

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the torque."""
        if frame.path is None:
            return Pull()
        return formulas.force(self.trees, 'world', self.parameters, self.center, frame)
