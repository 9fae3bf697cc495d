# SPDX-License-Identifier: Apache-2.0
"""The start of a problem; it refuses effects that change on the way."""

from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, VELOCITY
from rigid_body_sim.study.precision.runner import RefusedError, begun


def of(scene):
    """Return the attitude, omega (body axes) and velocity (world) from which a peer starts.

    They are those of the scene, after the strikes at time 0.

    Raises
    ------
    RefusedError
        If something jumps later: a user of the peer would stop there and start again, which does
        not fit a sweep of settings.
    """
    if any(effect.name == 'strike' and effect.time > 0.0 for effect in scene.effects):
        raise RefusedError('a strike on the way: the harness gives peers smooth motions only')
    if any(effect.name == 'torque' and (len(effect.times) > 1 or effect.times[0] > 0.0)
           for effect in scene.effects):
        raise RefusedError('a torque that jumps: the harness gives peers smooth motions only')
    vector = begun(scene)
    return tuple(vector[ORIENTATION]), tuple(vector[ANGULAR_VELOCITY]), tuple(vector[VELOCITY])
