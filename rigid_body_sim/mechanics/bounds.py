"""Bounds of the rates of a scene: what its weight and its torques can do."""

import math
from functools import reduce
from operator import add

from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import minus


def swing_rate(scene):
    """Return what the weight can add to the rate of a pivoted or hinged body (rad/s): 2 sqrt(M g r/I) by the energy, r the arm."""
    body, constraint, gravity = scene.body, scene.constraint, scene.effect('gravity')
    if gravity is None or constraint.kind not in ('pivot', 'hinge'):
        return 0.0
    arm = minus(body.center_of_mass, constraint.through if constraint.kind == 'hinge' else (0.0, 0.0, 0.0))
    # of the moments across the arm of a symmetric body, whatever the third one is
    across = moment_about_hinge(body, constraint) if constraint.kind == 'hinge' else sorted(body.about_origin.moments)[1]
    return 2.0 * math.sqrt(body.mass * gravity.g * hypot3(*arm) / across)


def drive(scene, wrench):
    """Return a bound of the angular acceleration (rad/s^2) by torques and a held wrench: their sum over the least moment."""
    body, constraint = scene.body, scene.constraint
    torques = [effect.values for effect in scene.effects if effect.name == 'torque']
    torque = reduce(add, (max(hypot3(*value) for value in values) for values in torques), 0.0)
    if wrench:
        arm = minus(body.center_of_mass, constraint.through if constraint.kind == 'hinge' else (0.0, 0.0, 0.0))
        lever = hypot3(*arm) if constraint.kind in ('pivot', 'hinge') else 0.0
        torque += hypot3(*wrench.torque) + lever * hypot3(*wrench.force)
    if torque == 0.0:
        return 0.0
    moments = (body.about_origin if constraint.kind == 'pivot' else body.about_center).moments
    return torque / (moment_about_hinge(body, constraint) if constraint.kind == 'hinge' else min(moment for moment in moments if moment > 0.0))
