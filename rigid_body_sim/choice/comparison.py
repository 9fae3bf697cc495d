# SPDX-License-Identifier: Apache-2.0
"""How far two runs of a scene are apart."""

import math

import numpy as np

from rigid_body_sim.mechanics.energy import DIAGNOSIS
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.numerics.functions import hypot3_of_each
from rigid_body_sim.numerics.rotations import angles_between, multiply, normalised
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, VELOCITY

FINER = 2.0 ** -7    # share of a tolerance: that of the finer run, which tells the error
ROUNDINGS = 2.0 ** 10    # times half an ulp of the start: errors up to there may be rounding


def apart(states, others):
    """Return the angles between the attitudes of two runs (rad), shape (n,); infinite for NaN."""
    angles = np.empty(len(states))
    angles_between(states[:, ORIENTATION], others[:, ORIENTATION], angles)
    return np.where(np.isnan(angles), math.inf, angles)


def grown(states, others):
    """Return by how much the error of a run grows in its second half, rad; infinite for NaN.

    The error is the rotation, as seen from the world, that takes the attitude of the other run to
    that of this one. The largest angle counts between that at the end of the first half and a
    later one: an error that stays counts as none, and one that changes its direction counts.
    """
    of_error = np.array([
        multiply(*one, -x, -y, -z, w) for one, (x, y, z, w) in zip(
            states[:, ORIENTATION].tolist(), others[:, ORIENTATION].tolist(), strict=True)])
    later = of_error[max(len(of_error) // 2 - 1, 0):]
    angles = np.empty(len(later))
    angles_between(np.repeat(later[:1], len(later), axis=0), later, angles)
    found = float(angles.max())
    return math.inf if math.isnan(found) else found


def apart_from_mean(states, finer):
    """Return the angles between the attitudes of a run and the mean ones of finer runs, (n,).

    A finer run takes more steps and errs more by rounding. The rounding of several runs is
    independent, so that their mean errs less than each of them.

    Parameters
    ----------
    finer : list of array (n, 14)
        Those that are not finite are left out.
    """
    best, total = finer[0][:, ORIENTATION], np.zeros((len(states), 4))
    finite = [one for one in (other[:, ORIENTATION] for other in finer) if np.isfinite(one).all()]
    for one in finite:
        same = (best * one).sum(axis=1) >= 0.0    # q and -q are the same attitude
        total += np.where(same[:, None], one, -one)
    mean = finer[0].copy()
    if finite:
        mean[:, ORIENTATION] = [normalised(*row) for row in total.tolist()]
    return apart(states, mean)


def momenta(scene, states):
    """Return the angular momenta of a run, shape (n, 3), kg m^2/s."""
    out = np.empty((len(states), DIAGNOSIS.size))
    energies(scene).diagnose_many(parameters(scene), states, out)
    return out[:, DIAGNOSIS.part('momentum').places]


def velocities_apart(states, others, before):
    """Return the differences of the velocities of two runs, shape (n,); infinite for NaN.

    They are relative to the largest speed so far, `before` (m/s) at the start.
    """
    return shares(states[:, VELOCITY], others[:, VELOCITY], before)


def rates_apart(states, others):
    """Return the differences of the angular velocities of two runs, shape (n,), as above.

    They are relative to the largest rate at the looks so far.
    """
    return shares(states[:, ANGULAR_VELOCITY], others[:, ANGULAR_VELOCITY], 0.0)


def shares(one, other, before):
    """Return the lengths of differences as shares of the largest length so far, shape (n,).

    Parameters
    ----------
    one, other : array (n, 3)
        Vectors of two runs. Where one is not finite the share is infinite.
    before : float
        The length at the start: what has come to rest has only rounding left.
    """
    sizes, apart = np.maximum.accumulate([before, *lengths(one)])[1:], lengths(one - other)
    found = np.divide(apart, sizes, out=np.zeros(len(apart)), where=sizes > 0.0)
    return np.where(np.isfinite(apart) & np.isfinite(sizes), found, math.inf)


def lengths(vectors):
    """Return the lengths of vectors (n, 3), shape (n,)."""
    out = np.empty(len(vectors))
    hypot3_of_each(np.ascontiguousarray(vectors), out)
    return out
