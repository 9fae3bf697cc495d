# SPDX-License-Identifier: Apache-2.0
"""Flips of a free body about its middle axis, counted in the recorded angular velocity.

They are independent of the recorded events.
"""

import itertools

import numpy as np

from rigid_body_sim.scene.constraints.protocol import Mechanism

SHARE = 0.5


class Flips:
    """Counts the changes of sign of the middle component m2 of L, each after |m2| >= |L|/2.

    Parameters
    ----------
    scene : Scene
        A free body with three different moments, see :func:`can_flip`.
    """

    def __init__(self, scene):
        inertia = scene.body.about_center
        self._inertia = inertia.matrix
        moments, vectors = np.linalg.eigh(self._inertia)
        self._middle = vectors[:, np.argsort(moments)[1]]
        self._positive, self._strong = None, False
        self.count = 0

    def add(self, angular_velocity):
        """Take ticks: angular velocity (n, 3) in body axes."""
        m = angular_velocity @ self._inertia
        along = m @ self._middle
        strong = np.abs(along) >= SHARE * np.sqrt((m * m).sum(axis=1))
        positive = along > 0.0
        changed = np.diff(
            positive, prepend=positive[0] if self._positive is None else self._positive
        )
        begins = np.flatnonzero(changed)
        # whether m2 was large in the stretch before each change
        before = [
            self._strong,
            *(strong[begin:end].any() for begin, end in itertools.pairwise(begins)),
        ]
        if len(begins):
            before[0] = before[0] or bool(strong[:begins[0]].any())
            self.count += sum(map(bool, before))
            self._strong = bool(strong[begins[-1]:].any())
        else:
            self._strong = self._strong or bool(strong.any())
        self._positive = positive[-1]


def can_flip(scene):
    """Return whether flips mean something: a free body with three different moments."""
    return (
        scene is not None
        and scene.constraint.mechanism is Mechanism.FREE
        and len(set(scene.body.about_center.moments)) == 3
    )
