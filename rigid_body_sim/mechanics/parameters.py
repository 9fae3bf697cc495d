# SPDX-License-Identifier: Apache-2.0
"""The numbers of a scene that mechanics computes with, as one named view.

The point of reference is the centre of mass of a free body and of a sphere on a table, the fixed
point of a pivoted body, and the axis of a hinged one.
"""

import functools
import operator
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.layout import Matrix, Quaternion, Vector, layout
from rigid_body_sim.numerics.pairs import in_integers, pair_of
from rigid_body_sim.numerics.vectors import apply, cross, dot
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import kept

FREE, PIVOT, HINGE, TABLE = (int(Mechanism[name]) for name in ('FREE', 'POINT', 'AXIS', 'TABLE'))
CARRIED = len(Mechanism)    # a pivot that moves
KINDS = {Mechanism.PLANE: FREE}    # between impacts a body above a plane is free
NO_AXIS = NOT_HELD = (0.0, 0.0, 0.0)


class SceneParameters(NamedTuple):
    """A body and its constraint; values of potentials and parts follow it (potential.py).

    Attributes
    ----------
    kind : float
        FREE, PIVOT, HINGE or TABLE, the constraint's mechanism, or CARRIED.
    mass : float
        kg.
    center : Vector
        Body origin -> centre of mass, body axes, m.
    moments : Vector
        Principal moments, kg m^2: about the fixed point of a pivoted body, else about the centre
        of mass.
    axes : Quaternion
        Turns components along the principal axes into body components.
    frame_axes : Quaternion
        Turns components in the frame of the equations into body components.
    hinge_axis : Vector
        Unit vector along the hinge, body axes; 0 where there is none.
    through : Vector
        The point that is held, body axes, m; 0 where there is none.
    hinge_moment : float
        Moment of inertia about the hinge, kg m^2; 0 where there is none.
    grip : float
        Largest torque that dry friction at the hinge balances, N m.
    skew : float
        1.0 for a body whose principal axes are not its own: its SkewAxes stand at the end of the
        array that `parameters` returns; else 0.0.
    """

    kind: float
    mass: float
    center: Vector
    moments: Vector
    axes: Quaternion
    frame_axes: Quaternion
    hinge_axis: Vector
    through: Vector
    hinge_moment: float
    grip: float
    skew: float


class SkewAxes(NamedTuple):
    """Principal axes that are not the body's, in rows of body components, with 32 digits."""

    rows: Matrix    # rounded
    lost: Matrix    # what rounding took


SCENE, SKEW = layout(SceneParameters), layout(SkewAxes)


@kept
def scene_parameters(scene):
    """Return the SceneParameters of a scene."""
    body, constraint = scene.body, scene.constraint
    inertia, axis = constraint.inertia(body), constraint.axis
    kind = KINDS.get(constraint.mechanism, constraint.mechanism)
    return SceneParameters(
        kind=kind if constraint.path is None else CARRIED, mass=body.mass,
        center=body.center_of_mass,
        moments=inertia.moments, axes=inertia.axes, frame_axes=scene.frame.axes,
        hinge_axis=NO_AXIS if axis is None else axis,
        through=constraint.point(body) if constraint.holds_a_point else NOT_HELD,
        hinge_moment=0.0 if axis is None else moment_about_hinge(body, constraint),
        grip=functools.reduce(operator.add, [effect.grip for effect in scene.effects], 0.0),
        skew=1.0 if inertia.rows else 0.0)


def parameters(scene):
    """Return the flat array that kernels take.

    SceneParameters, the values of potentials and parts, and the SkewAxes if there are any.
    """
    known = scene_parameters(scene)
    numbers = SCENE.numbers(known)
    for one in (*potentials(scene), *momenta(scene)):
        numbers += one.values
    if known.skew:
        numbers += SKEW.numbers(_skew_axes(scene.constraint.inertia(scene.body).rows))
    return np.fromiter(numbers, float, len(numbers))


def _skew_axes(rows):
    """Return the SkewAxes of rows of Fractions."""
    pairs = [[pair_of(entry) for entry in row] for row in rows]
    return SkewAxes(*(tuple(tuple(pair[k] for pair in row) for row in pairs) for k in range(2)))


@kept
def potentials(scene):
    """Return the Potential of each effect of a scene that has one."""
    frame = scene.frame
    return [effect.potential(frame) for effect in scene.effects if effect.potential is not None]


@kept
def momenta(scene):
    """Return the Momentum of each effect of a scene that carries one inside the body."""
    frame = scene.frame
    found = [effect.momentum(frame) for effect in scene.effects if effect.momentum is not None]
    return [one for one in found if one is not None]


def moment_about_hinge(body, constraint):
    """Return the moment of inertia about the hinge's axis, kg m^2.

    n . I n + M |n x (c - through)|^2, with I about the centre of mass c, rounded once.
    """
    inertia = body.about_center
    center = body.exact_center if any(body.center_lost) else body.center_of_mass
    (nx, ny, nz, x, y, z, a, b, c, I1, I2, I3, d1, d2, d3, mass), one = in_integers(
        (*constraint.axis, *center, *constraint.point(body), *inertia.moments, *inertia.lost,
         body.mass))
    n, arm = (nx, ny, nz), (x - a, y - b, z - c)
    if inertia.axes == IDENTITY and not inertia.entries:    # integers cost a tenth of fractions
        turned = nx * nx * (I1 + d1) + ny * ny * (I2 + d2) + nz * nz * (I3 + d3)
    else:
        turned = dot(n, apply(inertia.exact, n)) * one
    lever, square = cross(n, arm), one * one
    return float((turned * square + mass * dot(lever, lever)) / (square * square * one))
