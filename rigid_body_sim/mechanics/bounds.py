# SPDX-License-Identifier: Apache-2.0
"""Bounds of the rates of a scene: what its weight and its torques can do."""

import math
from functools import reduce
from operator import add

from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import minus


def swing_rate(scene):
    """Return what the weight can add to the rate of a pivoted or hinged body (rad/s).

    2 sqrt(M g r/I) by the energy, with r the arm from the constraint to the centre of mass.
    """
    body, constraint, gravity = scene.body, scene.constraint, scene.effect('gravity')
    if gravity is None or constraint.kind not in ('pivot', 'hinge'):
        return 0.0
    if constraint.kind == 'hinge':
        across = moment_about_hinge(body, constraint)
    else:    # of the moments across the arm of a symmetric body, whatever the third one is
        across = sorted(body.about_origin.moments)[1]
    return 2.0 * math.sqrt(body.mass * gravity.g * _arm(body, constraint) / across)


def drive(scene, wrench):
    """Return a bound of the angular acceleration by torques and a held wrench (rad/s^2).

    The sum of their sizes over the least moment.
    """
    body, constraint = scene.body, scene.constraint
    torques = [effect.values for effect in scene.effects if effect.name == 'torque']
    sizes = (max(hypot3(*value) for value in values) for values in torques)
    torque = reduce(add, sizes, 0.0)
    if wrench:
        lever = _arm(body, constraint) if constraint.kind in ('pivot', 'hinge') else 0.0
        torque += hypot3(*wrench.torque) + lever * hypot3(*wrench.force)
    if torque == 0.0:
        return 0.0
    if constraint.kind == 'hinge':
        return torque / moment_about_hinge(body, constraint)
    inertia = body.about_origin if constraint.kind == 'pivot' else body.about_center
    return torque / min(moment for moment in inertia.moments if moment > 0.0)


def _arm(body, constraint):
    """Return the distance (m) of the centre of mass from the fixed point, or the hinge's point."""
    hinged = constraint.kind == 'hinge'
    return hypot3(*minus(body.center_of_mass, constraint.through if hinged else (0.0, 0.0, 0.0)))
