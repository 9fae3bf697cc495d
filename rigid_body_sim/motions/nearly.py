# SPDX-License-Identifier: Apache-2.0
"""Bodies whose moments are equal but for so little that it does not show: taken as symmetric.

A closed form that needs two or three equal moments is offered the scene with moments made equal
that lie within NEARLY of each other. What that does to the attitude is measured: the same closed
form with the smaller and with the larger of these moments brackets the body. The largest angle
between the two, at LOOKS times up to the horizon, counts as the error; it knows how the motion
magnifies a small change, which no bound by the rates does.
"""

import dataclasses
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import Scene
from rigid_body_sim.scene.state import ORIENTATION, STATE_SIZE

NEARLY = 1e-9     # of the larger moment
LOOKS = 64


class Nearly(NamedTuple):
    """A closed form that solves a scene but for an error.

    Attributes
    ----------
    motion : module
    scene : Scene
        The one that it solves.
    error : float
        Of the attitude, from the start to the horizon, rad.
    """

    motion: Any
    scene: Scene
    error: float


def nearly_absorbing(scene, horizon):
    """Return the Nearly of a scene that no motion absorbs, or None.

    Parameters
    ----------
    scene : Scene
    horizon : float
        s.
    """
    moments = scene.constraint.inertia(scene.body).moments
    groups = _groups(moments)
    if all(len(set(group)) == 1 for group in groups):
        return None
    means = _with_moments(scene, moments, groups, lambda group: 0.5 * (group[0] + group[-1]))
    motion = absorbing_motion(means)
    if motion is None:
        return None
    times, ends = np.arange(1, LOOKS + 1) * (horizon / LOOKS), []
    for k in (0, -1):
        bound = _with_moments(scene, moments, groups, lambda group, k=k: group[k])
        out = np.empty((LOOKS, STATE_SIZE))
        Exact(bound, motion).start(scene.initial.vector).states(times, out)
        ends.append(out[:, ORIENTATION].tolist())
    error = max(angle_between(*p, *q) for p, q in zip(*ends, strict=True))
    return Nearly(motion, means, error)


def _groups(moments):
    """Return the moments in groups that lie within NEARLY of each other, each in order."""
    ordered = sorted(moments)
    groups = [[ordered[0]]]
    for before, moment in pairwise(ordered):
        if moment - before <= NEARLY * moment:
            groups[-1].append(moment)
        else:
            groups.append([moment])
    return groups


def _with_moments(scene, moments, groups, pick):
    """Return the scene with each moment replaced by what `pick` makes of its group."""
    picked = {moment: pick(group) for group in groups for moment in group}
    inertia = scene.constraint.inertia(scene.body)
    equal = dataclasses.replace(inertia, moments=tuple(picked[moment] for moment in moments))
    body = scene.body
    changes = {name: equal for name in ('about_center', 'about_origin')
               if getattr(body, name) is inertia or getattr(body, name) == inertia}
    return dataclasses.replace(scene, body=dataclasses.replace(body, **changes))
