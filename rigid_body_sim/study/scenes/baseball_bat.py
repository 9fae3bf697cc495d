# SPDX-License-Identifier: Apache-2.0
"""Check of the sweet spot of a bat (notes, "Baseball bat sweet spot").

The share of a blow that the hand takes, at any distance, is read from the motion after the blow.
"""

import numpy as np
from scipy.optimize import brentq

from rigid_body_sim.study.scenes.instruments import axes
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import baseball_bat as theory

SHARES = (0.5, 1.0, 1.3)            # places of other blows, over l'


def check(run):
    """Yield the quantities of a bat at rest that is hit at the scene's distance and at others."""
    scene = run.scene
    n, arm = (np.array(scene.constraint.axis),
              np.subtract(scene.body.center_of_mass, scene.constraint.through))
    arm -= n * (n @ arm)
    length, M = float(np.linalg.norm(arm)), scene.body.mass
    a = float(np.sqrt(n @ scene.body.about_center.matrix @ n / M))
    J, conjugate = (float(np.linalg.norm(scene.effect('strike').impulse)),
                    theory.center_of_percussion(length, a))
    own = float(np.subtract(scene.effect('strike').point, scene.constraint.through) @ arm) / length

    def hit(d):
        return run.variant({'strike.distance': d})

    def reaction(d):
        return _reaction(hit(d), n, arm, J)

    for d in (own, *(share * conjugate for share in SHARES)):
        where = f'd = {d:.4g} m'
        yield Quantity(
            f"phi' after the blow, {where}", theory.angular_acceleration(J, d, M, length, a),
            hit(d).at(0.0).angular_velocity @ n * np.sign(_sense(scene, n, arm)), 1e-12, 'rad/s')
        yield Quantity(f'F_R/F, {where}', theory.reaction_ratio(d, length, a), reaction(d), 1e-12,
                       absolute=True, as_written=theory.reaction_ratio_as_written(d, length, a))
    found = brentq(reaction, 0.5 * conjugate, 1.5 * conjugate, xtol=1e-15, rtol=8.9e-16)
    yield Quantity('centre of percussion', conjugate, found, 1e-12, 'm',
                   as_written=theory.center_of_percussion_as_written(length, a))


def _sense(scene, n, arm):
    """Return the moment about the hinge of the blow at unit distance, N s.

    Its sign is the sense in which the bat turns.
    """
    return n @ np.cross(arm / np.linalg.norm(arm), scene.effect('strike').impulse)


def _reaction(run, n, arm, J):
    """Return F_R/F = 1 - M l phi'/J.

    It is the part of the blow that the momentum of the centre of mass lacks, along the blow.
    """
    scene = run.scene
    state = run.states([0.0])
    center = np.array(scene.body.center_of_mass)
    velocity = state.velocity[0] + axes(state)[0] @ np.cross(state.angular_velocity[0], center)
    blow = np.array(scene.effect('strike').impulse) / J
    return 1.0 - scene.body.mass * (velocity @ blow) / J
