# SPDX-License-Identifier: Apache-2.0
"""Bodies that are symmetric but for what is too little to matter: they are taken as symmetric.

A closed form that needs two or three equal moments is offered the scene with moments made equal
that lie within NEARLY of each other: all of them become one moment, I + e -> I. Their differences
have what rounding lost in the parallel-axis theorem, so that an e need not be 0 where moments are
the same double. What is left out of Euler's equations, for axes i, j, k in cyclic order, is

    omega_i' by ((e_j - e_k) omega_j omega_k - e_i omega_i') / I_i.

The centre of mass of a held body may lie off the axis by NEARLY of its distance: its part d across
the axis is left out, and with it the torque d x R^T F of the force on the body.

What is left out is summed up along the closed form, stretch by stretch, and given to the body as a
kick at the start of each stretch. The closed form itself says what a kick does until the horizon,
so it includes how the motion magnifies kicks or averages them out. The changes of attitude by all
kicks are added as vectors, because they are small; TWICE their largest sum counts as the error.
The sum follows the motion as it starts, so nothing is known of it where a strike changes it.
"""

import dataclasses
import math
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from rigid_body_sim.mechanics.bounds import drive, swing_rate
from rigid_body_sim.mechanics.pulls import total_pull
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import matrix, rotate
from rigid_body_sim.numerics.vectors import apply, cross, minus, transposed
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import Scene
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, STATE_SIZE

NEARLY = 1e-9    # difference of two moments over the larger one; d over the distance
STRETCHES = 32                          # kicks about each axis, and looks at what they do
LOOKS_A_RADIAN, MOST_LOOKS = 8.0, 2 ** 17
SHOWN = 1e-7                            # size of the tried kicks over the rates of the body
TWICE = 2.0
FEW_ULPS = 2.0 ** -51    # relative: what rounds the moments of a body


class Nearly(NamedTuple):
    """A closed form that solves a scene but for an error.

    Attributes
    ----------
    motion : module
    scene : Scene
        The one that it solves.
    error : float
        Of the attitude, from the start to the horizon, rad; infinite where a strike comes before.
    """

    motion: Any
    scene: Scene
    error: float


def differ(scene, equal):
    """Return whether moments that turn the body differ where `equal` has one double for them."""
    if scene.constraint.axis is not None:
        return False
    (a, b, c), (bc, ca, ab) = equal, scene.constraint.inertia(scene.body).differences
    return (b == c and bc != 0.0) or (c == a and ca != 0.0) or (a == b and ab != 0.0)


def takes_any_moments(motion, scene):
    """Return whether a motion absorbs a scene also if no two of its moments are equal."""
    moments = scene.constraint.inertia(scene.body).moments
    apart = tuple(moment * (1.0 + k * NEARLY) for k, moment in enumerate(moments))
    return _has_inertia(scene) and motion.absorbs(_with_inertia(scene, apart))


def is_exact(motion, scene):
    """Return whether a motion that absorbs a scene leaves nothing out.

    It does where it takes two moments as equal that differ by what one double does not hold.
    """
    moments = scene.constraint.inertia(scene.body).moments
    return not differ(scene, moments) or takes_any_moments(motion, scene)


def only_rounding(scene, solved):
    """Return whether a scene differs from the one solved for it by rounding of its moments alone.

    From no start does that do more than half an ulp on the moments does, which are given rounded.
    """
    inertia, body = scene.constraint.inertia(scene.body), scene.body
    equal = solved.constraint.inertia(solved.body).moments
    least = min((moment for moment in equal if moment > 0.0), default=0.0)
    return (body.center_of_mass == solved.body.center_of_mass
            and all(abs(e) <= FEW_ULPS * least for e in _left_out(inertia, equal)))


def nearly_absorbing(scene, horizon):
    """Return the Nearly of a scene that is nearly symmetric, or None.

    None also where the body turns too often in the horizon for the error to be summed up, and
    where neither the centre of mass nor the body's origin is held.

    Parameters
    ----------
    scene : Scene
    horizon : float
        s.
    """
    equal = _made_equal(scene.constraint.inertia(scene.body).moments)
    off = _off_axis(scene, equal)
    if not (_has_inertia(scene) and (differ(scene, equal) or any(off))):
        return None
    symmetric = _symmetric(scene, equal, off)
    motion = absorbing_motion(symmetric)
    if motion is None:
        return None
    pace = hypot3(*scene.initial.angular_velocity.tolist()) + swing_rate(scene)
    looks = LOOKS_A_RADIAN * (pace + drive(scene, None) * horizon) * horizon
    if not looks <= MOST_LOOKS:
        return None
    each = int(looks / STRETCHES) + 2
    if any(strike.time < horizon for strike in scene.strikes):
        return Nearly(motion, symmetric, math.inf)
    error = _error(Exact(symmetric, motion), scene, equal, off, horizon, each)
    return Nearly(motion, symmetric, error)


def _off_axis(scene, equal):
    """Return the part d of the centre of mass across the axis, principal axes, m; 0 if it shows.

    It is that of a body held at a point whose moments are made equal.
    """
    arm = scene.frame.arm
    if scene.constraint.mechanism is Mechanism.POINT and len(set(equal)) == 2:
        k = next(k for k in range(3) if equal[(k + 1) % 3] == equal[(k + 2) % 3])
        off = [0.0 if place == k else part for place, part in enumerate(arm)]
        if hypot3(*off) <= NEARLY * abs(arm[k]):
            return off
    return [0.0, 0.0, 0.0]


def _error(solver, scene, equal, off, horizon, each):
    """Return the error; the sums along a stretch have `each` terms."""
    solver = solver.start(scene.initial.vector)
    axes = matrix(*scene.constraint.inertia(scene.body).axes)
    edges = np.arange(STRETCHES + 1) * (horizon / STRETCHES)
    ends, looks = np.empty((STRETCHES + 1, STATE_SIZE)), np.empty((STRETCHES * each, STATE_SIZE))
    solver.states(edges, ends)
    step = horizon / (STRETCHES * each)
    solver.states((np.arange(STRETCHES * each) + 0.5) * step, looks)
    rises = np.diff(apply(transposed(axes), ends[:, ANGULAR_VELOCITY].T), axis=1)
    w = apply(transposed(axes), looks[:, ANGULAR_VELOCITY].T)
    sums = [(w[(k + 1) % 3] * w[(k + 2) % 3]).reshape(STRETCHES, each).cumsum(axis=1)[:, -1] * step
            for k in range(3)]
    kicks = _kicks(scene.constraint.inertia(scene.body), equal, rises, sums)
    if any(off):
        force = apply(transposed(matrix(*looks[:, ORIENTATION].T)), total_pull(scene).force)
        turns = cross(off, apply(transposed(axes), force))
        for kick, turn, moment in zip(kicks, turns, equal, strict=True):
            if moment > 0.0:
                kick += turn.reshape(STRETCHES, each).cumsum(axis=1)[:, -1] * (step / moment)
    size = np.abs(kicks).max()
    if not size > 0.0:
        return 0.0
    fastest = max(np.abs(looks[:, ANGULAR_VELOCITY]).max(), 1e-300)
    larger = SHOWN * fastest / size
    changes = np.zeros((STRETCHES + 1, 3))
    for m in range(STRETCHES):
        start, part = ends[m].copy(), np.empty((STRETCHES + 1 - m, STATE_SIZE))
        start[ANGULAR_VELOCITY] += larger * np.array(apply(axes, kicks[:, m]))
        solver.start(start).states(edges[m:], part)
        changes[m:] += _between(ends[m:, ORIENTATION], part[:, ORIENTATION])
    return float(TWICE * np.sqrt((changes * changes).sum(axis=1)).max() / larger)


def _kicks(inertia, equal, rises, sums):
    """Return the kicks about the principal axes, shape (3, STRETCHES), rad/s."""
    kicks, e = np.zeros((3, STRETCHES)), _left_out(inertia, equal)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        if equal[i] > 0.0:
            kicks[i] = ((e[j] - e[k]) * sums[i] - e[i] * rises[i]) / equal[i]
    return kicks


def _left_out(inertia, equal):
    """Return the e of each moment, kg m^2: what it has beyond the one that is taken for it.

    It is what the mean of the moments made equal has, and what this one has beyond their mean: the
    differences know of that also what rounding lost.
    """
    found = []
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        alike = [part for part in (i, j, k) if equal[part] == equal[i]]
        beyond = {j: inertia.differences[k], k: -inertia.differences[j]}    # I_i - I_j, I_i - I_k
        mean = math.fsum(inertia.moments[part] - equal[i] for part in alike) / len(alike)
        found.append(mean + math.fsum(beyond[part] for part in alike[1:]) / len(alike))
    return found


def _between(p, q):
    """Return the small rotation vectors (rad) from attitudes to others, shape (n, 3)."""
    px, py, pz, pw = p.T
    qx, qy, qz, qw = q.T
    sign = np.where(px * qx + py * qy + pz * qz + pw * qw < 0.0, -2.0, 2.0)
    # the vector part of q p^-1, world axes
    return (sign * np.array([qx * pw - qw * px - qy * pz + qz * py,
                             qy * pw - qw * py - qz * px + qx * pz,
                             qz * pw - qw * pz - qx * py + qy * px])).T


def _made_equal(moments):
    """Return the moments, with those that lie within NEARLY of each other made equal."""
    ordered = sorted(moments)
    groups = [[ordered[0]]]
    for before, moment in pairwise(ordered):
        if moment - before <= NEARLY * moment:
            groups[-1].append(moment)
        else:
            groups.append([moment])
    means = {moment: 0.5 * group[0] + 0.5 * group[-1] for group in groups for moment in group}
    return tuple(means[moment] for moment in moments)


def _symmetric(scene, equal, off):
    """Return the scene with other moments about the point that is held, and no `off`."""
    found = _with_inertia(scene, equal)
    if not any(off):
        return found
    axes, body = scene.constraint.inertia(scene.body).axes, found.body
    center = minus(body.center_of_mass, rotate(*axes, *off))
    return dataclasses.replace(found, body=dataclasses.replace(
        body, center_of_mass=center, center_lost=(0.0, 0.0, 0.0)))


def _has_inertia(scene):
    """Return whether a body has the tensor about the point that its constraint holds."""
    body = scene.body
    return scene.constraint.inertia(body) in (body.about_center, body.about_origin)


def _with_inertia(scene, moments):
    """Return the scene with other moments about the point that its constraint holds."""
    inertia, body = scene.constraint.inertia(scene.body), scene.body
    changed = dataclasses.replace(inertia, moments=moments, lost=(0.0, 0.0, 0.0), entries=())
    changes = {name: changed for name in ('about_center', 'about_origin')
               if getattr(body, name) == inertia}
    return dataclasses.replace(scene, body=dataclasses.replace(body, **changes))
