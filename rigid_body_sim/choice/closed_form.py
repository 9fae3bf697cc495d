# SPDX-License-Identifier: Apache-2.0
"""The closed form of a scene, or that of a scene nearly this one, and by how much it errs."""

import math
from typing import Any, NamedTuple

from rigid_body_sim.choice import measured
from rigid_body_sim.mechanics.bounds import drive
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.nearly import is_exact, nearly_absorbing
from rigid_body_sim.scene.scene import Scene


class ClosedForm(NamedTuple):
    """A closed form for a scene: the scene it solves, and its error but for rounding.

    `floor` is the rounding beside which an error does not show; 0 where there is no error.
    """

    motion: Any
    scene: Scene
    error: float
    floor: float


def closed_form(scene, horizon):
    """Return the ClosedForm of a scene, or None."""
    motion = absorbing_motion(scene)
    if motion and is_exact(motion, scene):
        return ClosedForm(motion, scene, 0.0, 0.0)
    nearly = nearly_absorbing(scene, horizon)
    if nearly is None:
        return ClosedForm(motion, scene, math.inf, 0.0) if motion else None
    # a torque adds to the angle that the body turns
    floor = (measured.floor(scene, horizon)
             + 0.5 * measured.HALF_ULP * drive(scene, None) * horizon * horizon)
    return ClosedForm(*nearly, floor)
