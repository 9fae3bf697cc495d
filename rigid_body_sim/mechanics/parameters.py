"""The numbers of a scene that the kernels of this folder take.

The point of reference is the centre of mass of a free body and of a sphere on a table, the fixed
point of a pivoted body, and the axis of a hinged one. Symbols: M mass, c centre of mass from the
body's origin (body axes), omega angular velocity (body axes), L angular momentum about the point of
reference (world axes), g acceleration of gravity (along -z of the world).
"""

import numpy as np

from rigid_body_sim.numerics.vectors import apply, cross, dot, minus

FREE, PIVOT, HINGE, TABLE = range(4)
KINDS = {'free': FREE, 'pivot': PIVOT, 'hinge': HINGE, 'table': TABLE}

# layout of the parameters
KIND, MASS, CENTER, MOMENTS, AXES, GRAVITY, HINGE_AXIS, THROUGH, HINGE_MOMENT = 0, 1, 2, 5, 8, 12, 13, 16, 19
PARAMETER_SIZE = 20


def parameters(scene):
    """Return the numbers of a scene that the kernels below take, shape (20,)."""
    body, constraint = scene.body, scene.constraint
    inertia = body.about_origin if constraint.kind == 'pivot' else body.about_center
    gravity = scene.effect('gravity')
    p = np.zeros(PARAMETER_SIZE)
    p[KIND], p[MASS], p[CENTER:CENTER + 3] = KINDS[constraint.kind], body.mass, body.center_of_mass
    p[MOMENTS:MOMENTS + 3], p[AXES:AXES + 4] = inertia.moments, inertia.axes
    p[GRAVITY] = gravity.g if gravity else 0.0
    p[HINGE_AXIS:HINGE_AXIS + 3], p[THROUGH:THROUGH + 3] = constraint.axis, constraint.through
    p[HINGE_MOMENT] = moment_about_hinge(body, constraint) if constraint.kind == 'hinge' else 0.0
    return p


def moment_about_hinge(body, constraint):
    """Return the moment of inertia about the hinge's axis: n . I n + M |n x (c - through)|^2, kg m^2."""
    n = constraint.axis
    lever = cross(n, minus(body.center_of_mass, constraint.through))
    return dot(n, apply(body.about_center.matrix.tolist(), n)) + body.mass * dot(lever, lever)
