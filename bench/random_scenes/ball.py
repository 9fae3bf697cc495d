# SPDX-License-Identifier: Apache-2.0
"""The truth of a ball that slides on a table and then rolls."""

import math

import numpy as np

from random_scenes.truth import HALF_ULP, MOVED, Truth
from random_scenes.wide import WIDE, cross, rotated


class BallTruth:
    """A ball that slides, then rolls: v and omega are linear in time, q by extrapolation."""

    jumped, turned, moved = 0.0, 0.0, MOVED    # as Truth has them

    def __init__(self, scene, settings, *_):
        one, self.radius = dict(settings)['sliding_friction'], WIDE(scene.body.radius)
        vector, base = scene.initial.vector, WIDE(HALF_ULP * MOVED)
        rows = [np.concatenate((vector[5:8], vector[11:13])).astype(WIDE)]
        rows += [rows[0] * (1 + base * np.eye(5, dtype=WIDE)[k]) for k in range(5)]
        self.q = np.tile(vector[1:5].astype(WIDE), (6, 1))
        rows = np.array(rows)
        self.w0 = rotated(self.q, rows[:, :3])
        u = rows[:, 3:] - self.radius * np.stack([self.w0[:, 1], -self.w0[:, 0]], axis=1)
        slip = np.sqrt((u ** 2).sum(1))
        k = WIDE(scene.body.about_center.moments[0]) / (self.radius ** 2 * WIDE(scene.body.mass))
        a = WIDE(one['mu']) * WIDE(one['g'])
        self.until = slip / (a * (1 + 1 / k))
        f = -a * u / slip[:, None]
        # I omega' = (-a z) x M f
        self.growth = np.stack([f[:, 1], -f[:, 0], 0 * slip], axis=1) / (k * self.radius)
        self.t = 0.0

    def to(self, time):
        """Go on to a time."""
        ends = sorted({float(x) for x in self.until if self.t < x < time} | {time})
        for end in ends:
            n = max(1, math.ceil((end - self.t) * float(np.abs(self.w0).max()) / 0.5))
            begin = WIDE(self.t)
            for step in range(n):
                before = self.rate
                self._step(begin + (WIDE(end) - begin) * step / n, (WIDE(end) - begin) / n)
                self.t = float(begin) + (end - float(begin)) * (step + 1) / n
                self.turned += 0.5 * (before + self.rate) * (end - float(begin)) / n
            self.t = end

    def _omega(self, t):
        return self.w0 + np.minimum(t, self.until)[:, None] * self.growth

    @property
    def rate(self):
        """The angular speed, rad/s."""
        return float(np.sqrt((self._omega(self.t)[0] ** 2).sum()))

    def _step(self, t, h):
        rows = []

        def rates(q, t):
            w = self._omega(t)
            out = np.empty_like(q)
            out[:, :3] = (q[:, 3:] * w + cross(w, q[:, :3])) / 2
            out[:, 3] = -(w * q[:, :3]).sum(1) / 2
            return out
        for level in range(1, 10):
            n = 2 * level
            s, before, now = h / n, self.q, self.q + h / n * rates(self.q, t)
            for j in range(1, n):
                before, now = now, before + 2 * s * rates(now, t + j * s)
            now = (now + before + s * rates(now, t + h)) / 2
            row = [now]
            for j in range(1, level):
                ratio = WIDE(level) ** 2 / WIDE(level - j) ** 2
                row.append(row[-1] + (row[-1] - rows[-1][j - 1]) / (ratio - 1))
            rows.append(row)
        self.q = rows[-1][-1]

    @property
    def y(self):
        """The attitudes, in the place where Truth has them."""
        return self.q

    floor = Truth.floor
