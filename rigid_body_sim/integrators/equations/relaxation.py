# SPDX-License-Identifier: Apache-2.0
"""The linear drag of a scene in the coordinates in which it is diagonal.

    omega' = -I^-1 K omega + ...,    v' = -(c/M) v + ...

K is symmetric, so with I^(-1/2) K I^(-1/2) = Q diag(lambda) Q^T the coordinates Q^T I^(1/2) omega
relax independently at the rates lambda.
"""

import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.integrators.equations import hinged
from rigid_body_sim.integrators.equations.euler import DRIFT, OMEGA
from rigid_body_sim.mechanics.bounds import drive, swing_rate
from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.principal_axes import eigenvectors

STIFF = 20.0    # times the rates of the motion: drag that is faster is stiff


class Relaxation(NamedTuple):
    """Drag on unknowns that stand side by side.

    Attributes
    ----------
    first : int
        The first of the unknowns.
    into, back : array (n, n)
        To the coordinates that relax independently, and from them.
    rates : list of n floats
        lambda, 1/s.
    """

    first: int
    into: np.ndarray
    back: np.ndarray
    rates: list


def stiff_relaxations(scene, unknowns):
    """Return the Relaxations of a scene for equations of so many unknowns, where drag is stiff.

    There are none where no relaxation is much faster than the motion.
    """
    matrix, slowing = _drag(scene)
    if not (matrix or slowing):
        return []
    motion = (hypot3(*scene.initial.angular_velocity.tolist()) + swing_rate(scene)
              + math.sqrt(drive(scene, None)))
    if scene.constraint.axis is None:
        # no eigenvalue is larger than three times the largest entry; most drag is far from stiff
        rows = _scaled(matrix, scene.frame) if matrix else ()
        most = 3.0 * max((abs(entry) for row in rows for entry in row), default=0.0)
        if max(most, slowing / scene.frame.mass) <= STIFF * motion:
            return []
    found = relaxations(scene, unknowns)
    fastest = max((rate for one in found for rate in one.rates), default=0.0)
    return found if fastest > STIFF * motion else []


def _drag(scene):
    """Return the matrix -K of a scene (frame components), or None, and c of the drag -c v."""
    frame = scene.frame
    pulls = [effect.damping(frame) for effect in scene.effects if effect.damping is not None]
    matrices = [pull.drag for pull in pulls if pull.drag is not None]
    slowing = math.fsum(pull.slowing for pull in pulls)
    total = [[math.fsum(one[i][j] for one in matrices) for j in range(3)] for i in range(3)]
    return total if matrices else None, slowing


def _over_roots(frame):
    """Return I^(-1/2), a list; 0 for a moment of zero."""
    return [1.0 / math.sqrt(moment) if moment > 0.0 else 0.0 for moment in frame.moments]


def _scaled(matrix, frame):
    """Return I^(-1/2) K I^(-1/2)."""
    over = _over_roots(frame)
    return [[-matrix[i][j] * over[i] * over[j] for j in range(3)] for i in range(3)]


def relaxations(scene, unknowns):
    """Return the Relaxations of a scene for equations of so many unknowns."""
    frame, axis, found = scene.frame, scene.constraint.axis, []
    matrix, slowing = _drag(scene)
    if matrix and axis is not None:
        along = math.fsum(axis[i] * matrix[i][j] * axis[j] for i in range(3) for j in range(3))
        rate = -along / moment_about_hinge(scene.body, scene.constraint)
        found.append(Relaxation(hinged.SPEED, np.eye(1), np.eye(1), [rate]))
    elif matrix:
        roots = [math.sqrt(moment) for moment in frame.moments]
        rates, vectors, _ = eigenvectors(_scaled(matrix, frame))
        into, back = np.array(vectors) * roots, (np.array(vectors) * _over_roots(frame)).T
        found.append(Relaxation(OMEGA, into, back, [max(rate, 0.0) for rate in rates]))
    if slowing and unknowns > DRIFT:
        found.append(Relaxation(DRIFT, np.eye(3), np.eye(3), [slowing / frame.mass] * 3))
    return found
