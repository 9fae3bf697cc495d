# SPDX-License-Identifier: Apache-2.0
"""The surroundings of a drawn body: point of reference, ground, and what holds it."""

import math
from typing import NamedTuple

import numpy as np
import yaml
from scipy.spatial.transform import Rotation

from rigid_body_sim.drawing import surfaces
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.constraints.protocol import Mechanism


def middle_of(scene):
    """Return the point of reference in body axes, m: the point held, else the centre of mass."""
    return np.zeros(3) if scene is None else np.array(scene.constraint.point(scene.body))


def reach_of(scene, drawing):
    """Return the largest distance (m) of the drawn surface from the point of reference."""
    return float(np.linalg.norm(drawing.vertices - middle_of(scene), axis=1).max())


def follows(scene):
    """Return whether the body can travel, so that a picture should move with it."""
    return scene is not None and not scene.constraint.holds_a_point


def start_of(scene):
    """Return the initial place of the point of reference, world, m."""
    if scene is None:
        return np.zeros(3)
    turn = Rotation.from_quat(scene.initial.orientation)
    return scene.initial.position + turn.apply(middle_of(scene))


class Ground(NamedTuple):
    """The ground: its height above the world's origin (m), and the quaternion of its axes.

    Its z axis is its normal.
    """

    height: float
    axes: tuple = IDENTITY


def ground_of(scene, reach):
    """Return the Ground: the table or plane, or else a level plane just below the moving body."""
    start = float(start_of(scene)[2])
    mechanism = scene.constraint.mechanism if scene else None
    if mechanism is Mechanism.PLANE:
        return Ground(0.0, scene.constraint.axes)
    if mechanism is Mechanism.TABLE:
        return Ground(start - scene.body.radius)
    return Ground(start - 1.1 * reach)


def holder_of(scene, reach):
    """Return the surfaces of what holds the body, a column or an axle, in the world at the start.

    They move with the point that they hold.
    """
    mechanism = scene.constraint.mechanism if scene else Mechanism.FREE
    start = start_of(scene)
    if mechanism is Mechanism.POINT:
        height = float(start[2]) - ground_of(scene, reach).height
        column = surfaces.cone(0.12 * reach, height)
        return [column.placed(start - (0.0, 0.0, 0.75 * height))]
    if mechanism is Mechanism.AXIS:
        to_axis = Rotation.align_vectors([scene.constraint.axis], [[0.0, 0.0, 1.0]])[0]
        turn = Rotation.from_quat(scene.initial.orientation) * to_axis
        return [surfaces.cylinder(0.025 * reach, reach).placed(start, turn.as_quat())]
    return []


class Spring(NamedTuple):
    """A spring: its point of the body (body axes, m) and its fixed end (world, m)."""

    at: np.ndarray
    anchor: np.ndarray


def springs_of(scene):
    """Return the Springs that pull the body; a torsion spring has no place of its own."""
    listed = yaml.safe_load(scene.text).get('effects') or [] if scene else []
    found = [settings for one in listed if isinstance(one, dict) for settings in one.values()]
    return [Spring(np.array(one['at'], float), np.array(one['anchor'], float))
            for one in found if isinstance(one, dict) and {'at', 'anchor'} <= set(one)]


def cell_of(reach):
    """Return the spacing of the lines of the ground, m: 1, 2 or 5 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(reach))
    return next(power * factor for factor in (5.0, 2.0, 1.0) if power * factor <= reach)
