"""Bounds of the rates of a scene: what its weight and its torques can do."""

from functools import reduce
from operator import add

import numpy as np

from rigid_body_sim.mechanics.parameters import moment_about_hinge


def swing_rate(scene):
    """Return what the weight can add to the rate of a pivoted or hinged body (rad/s): 2 sqrt(M g r/I) by the energy, r the arm."""
    body, constraint, gravity = scene.body, scene.constraint, scene.effect('gravity')
    if gravity is None or constraint.kind not in ('pivot', 'hinge'):
        return 0.0
    arm = np.subtract(body.center_of_mass, constraint.through if constraint.kind == 'hinge' else (0.0, 0.0, 0.0))
    # of the moments across the arm of a symmetric body, whatever the third one is
    across = moment_about_hinge(body, constraint) if constraint.kind == 'hinge' else sorted(body.about_origin.moments)[1]
    return 2.0 * float(np.sqrt(body.mass * gravity.g * np.linalg.norm(arm) / across))


def drive(scene, wrench):
    """Return a bound of the angular acceleration (rad/s^2) by torques and a held wrench: their sum over the least moment."""
    body, constraint = scene.body, scene.constraint
    torques = [effect.values for effect in scene.effects if effect.name == 'torque']
    torque = reduce(add, (max(float(np.linalg.norm(value)) for value in values) for values in torques), 0.0)
    if wrench:
        arm = np.subtract(body.center_of_mass, constraint.through if constraint.kind == 'hinge' else (0.0, 0.0, 0.0))
        lever = float(np.linalg.norm(arm)) if constraint.kind in ('pivot', 'hinge') else 0.0
        torque += float(np.linalg.norm(wrench.torque)) + lever * float(np.linalg.norm(wrench.force))
    if torque == 0.0:
        return 0.0
    moments = (body.about_origin if constraint.kind == 'pivot' else body.about_center).moments
    return torque / (moment_about_hinge(body, constraint) if constraint.kind == 'hinge' else min(moment for moment in moments if moment > 0.0))
