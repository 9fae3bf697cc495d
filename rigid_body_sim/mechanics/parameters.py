# SPDX-License-Identifier: Apache-2.0
"""The numbers of a scene that mechanics computes with, as one named view.

The point of reference is the centre of mass of a free body and of a sphere on a table, the fixed
point of a pivoted body, and the axis of a hinged one.
"""

from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.layout import Quaternion, Vector, layout
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus

FREE, PIVOT, HINGE, TABLE = range(4)
KINDS = {'free': FREE, 'pivot': PIVOT, 'hinge': HINGE, 'table': TABLE}


class SceneParameters(NamedTuple):
    """A body, its constraint and its weight.

    Attributes
    ----------
    kind : float
        FREE, PIVOT, HINGE or TABLE.
    mass : float
        kg.
    center : Vector
        Body origin -> centre of mass, body axes, m.
    moments : Vector
        Principal moments, kg m^2: about the fixed point of a pivoted body, else about the centre
        of mass.
    axes : Quaternion
        Turns components along the principal axes into body components.
    gravity : float
        Acceleration along -z of the world, m/s^2; 0 where there is none.
    hinge_axis, through : Vector
        Unit vector along the hinge, and a point of it (m): body axes.
    hinge_moment : float
        Moment of inertia about the hinge, kg m^2; 0 where there is none.
    """

    kind: float
    mass: float
    center: Vector
    moments: Vector
    axes: Quaternion
    gravity: float
    hinge_axis: Vector
    through: Vector
    hinge_moment: float


SCENE = layout(SceneParameters)
GRAVITY = SCENE.part('gravity').first


def scene_parameters(scene):
    """Return the SceneParameters of a scene."""
    body, constraint, gravity = scene.body, scene.constraint, scene.effect('gravity')
    inertia = body.about_origin if constraint.kind == 'pivot' else body.about_center
    hinged = constraint.kind == 'hinge'
    return SceneParameters(
        kind=KINDS[constraint.kind], mass=body.mass, center=body.center_of_mass,
        moments=inertia.moments, axes=inertia.axes, gravity=gravity.g if gravity else 0.0,
        hinge_axis=constraint.axis, through=constraint.through,
        hinge_moment=moment_about_hinge(body, constraint) if hinged else 0.0)


def parameters(scene):
    """Return the SceneParameters as the flat array that kernels take."""
    p = np.zeros(SCENE.size)
    SCENE.store(p, scene_parameters(scene))
    return p


def moment_about_hinge(body, constraint):
    """Return the moment of inertia about the hinge's axis, kg m^2.

    n . I n + M |n x (c - through)|^2, with I about the centre of mass c.
    """
    n = constraint.axis
    lever = cross(n, minus(body.center_of_mass, constraint.through))
    inertia = body.about_center.matrix.tolist()
    return dot(n, apply(inertia, n)) + body.mass * dot(lever, lever)
