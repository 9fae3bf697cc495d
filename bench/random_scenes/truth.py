# SPDX-License-Identifier: Apache-2.0
"""The truth of a scene: Newton's and Euler's equations in body axes, with 64-bit mantissas.

They use the full tensor and are integrated by extrapolation. The floor is what half an ulp on each
number of the start does, by finite differences.
"""

import math

import numpy as np

from random_scenes.laws import Laws
from random_scenes.wide import WIDE, angle, back, cross, inverse, rotated, times

HALF_ULP, MOVED = 2.0 ** -53, 2.0 ** 22
LINEAR = 0.1             # rad: what is moved farther apart is no longer in proportion
LEVELS = 7               # levels of the extrapolation: nine magnify rounding ten times as much
TOLERANCE = 1e-18        # of a step, relative
WAITS = 8                # steps after one that was too long before a longer one is tried


class TooMuchWork(Exception):
    """The truth needs more steps than it may take."""


class Steps:
    """The steps that a truth may still take; all copies of a start share them."""

    def __init__(self, most=math.inf):
        self.left = most

    def take(self):
        """Take one, or raise TooMuchWork."""
        self.left -= 1
        if self.left < 0:
            raise TooMuchWork


class Truth:
    """Copies of a scene's body, moved on by extrapolation of the modified midpoint rule.

    Unknowns: q (4), omega (3, body), velocity and place of the centre of mass (3 and 3, world).
    The start is moved by `moved` half ulps, for the floor.
    `jumped` (J) is the energy that torsion springs got without work, from one end of the angle of
    a hinge to the other; `turned` (rad) is the angle turned so far.
    """

    jumped, turned = WIDE(0), 0.0

    def __init__(self, scene, settings, parameters, motion=None, most=math.inf, moved=MOVED):
        body, kind = scene.body, scene.constraint.kind
        self.steps, self.moved = Steps(most), moved
        self.kind, self.effects = kind, settings
        self.mass = WIDE(body.mass)
        tensor = np.array(body.about_center.matrix, dtype=float).astype(WIDE)
        self.about_center = tensor[None]
        vector = scene.initial.vector
        self.axis, self.winds = None, getattr(scene.constraint, 'winds', False)
        start = np.concatenate((vector[1:8], vector[11:14], vector[8:11])).astype(WIDE)
        copies = [start]
        for place in range(13 if kind == 'free' else 7):
            size = 1.0 if place < 4 else abs(float(start[place]))
            if not size > 0.0:
                continue
            if kind == 'hinge' and place > 4:
                continue
            other = start.copy()
            by = WIDE(HALF_ULP * moved)
            if kind == 'hinge' and place == 4:
                other[4:7] *= 1 + by
            else:
                other[place] += by * size
            copies.append(other)
        self.y, tensors = np.array(copies), tensor[None]
        self.y[:, :4] /= np.sqrt((self.y[:, :4] ** 2).sum(1))[:, None]
        self.arm = np.zeros(3, dtype=WIDE)
        if kind != 'free':
            point = scene.constraint.point(body)
            self.arm = r = _wide(body.center_of_mass) - _wide(point)
            tensors = tensors + self.mass * ((r @ r) * np.eye(3, dtype=WIDE) - np.outer(r, r))
        self.I, self.inverse = tensors, inverse(tensors)
        if kind == 'hinge':
            n = _wide(scene.constraint.axis)
            self.axis = n / np.sqrt(n @ n)
            self.about = times(tensors, self.axis[None]) @ self.axis
            # rounded components across the axis would go on for ever
            self.y[:, 4:7] = (self.y[:, 4:7] @ self.axis)[:, None] * self.axis
        # the velocity of the centre of mass
        q, w = self.y[:, :4], self.y[:, 4:7]
        center = _wide(body.center_of_mass)
        self.y[:, 7:10] += rotated(q, cross(w, center[None]))
        self.y[:, 10:] += rotated(q, center[None] + 0 * w)
        self.center, self.t, self.struck = center, WIDE(0), set()
        self.origin = self.y[0, 10:] - rotated(q, center[None] + 0 * w)[0]
        self.motion = motion    # texts of place, velocity and acceleration
        self.laws = Laws(settings, parameters, self)

    def rates(self, y, t):
        """Return y' for rows of unknowns at a time (s)."""
        q, w, v = y[:, :4], y[:, 4:7], y[:, 7:10]
        moves = self.kind == 'free'
        force, torque, turning = self.laws.acting(y, t, self.t)
        if not moves:
            torque = torque + cross(self.arm[None], back(q, force))
        out = np.empty_like(y)
        if self.axis is not None:
            out[:, 4:7] = ((torque @ self.axis) / self.about)[:, None] * self.axis
        else:
            out[:, 4:7] = times(self.inverse, torque + self._gyroscopic(w)
                                + cross(times(self.I, w), turning + 0 * w))
        rate = w + turning
        x, s = q[:, :3], q[:, 3:]
        out[:, :3] = (s * rate + cross(x, rate)) / 2
        out[:, 3] = -(x * rate).sum(1) / 2
        out[:, 7:10] = force / self.mass if moves else 0
        out[:, 10:] = v if moves else 0
        return out

    def _gyroscopic(self, w):
        """Return m x omega of the principal axes by differences of moments, else as it stands.

        In slim bodies m x omega is a small difference of large numbers.
        """
        moments = np.diagonal(self.I, axis1=1, axis2=2)
        if np.count_nonzero(self.I) > np.count_nonzero(moments):
            return cross(times(self.I, w), w)
        I1, I2, I3 = moments.T
        x, y, z = w.T
        return np.stack(((I2 - I3) * y * z, (I3 - I1) * z * x, (I1 - I2) * x * y), axis=1)

    def to(self, time):
        """Go on to a time, with the jumps on the way."""
        jumps = sorted({x for name, one in self.effects if name == 'torque'
                        for x in one.get('times', ())}
                       | {one.get('time', 0.0) for name, one in self.effects if name == 'strike'})
        for jump in [*[x for x in jumps if self.t < x <= time], time]:
            self._march(jump)
            for name, one in self.effects:
                if name == 'strike' and one.get('time', 0.0) == jump and jump not in self.struck:
                    self._strike(one)
            self.struck.add(jump)

    def _march(self, end):
        h, since = end - self.t, WAITS
        while self.t < end:
            y, k = self.y, self.rates(self.y, self.t)
            rate, growth = (float(np.sqrt((one[0, 4:7] ** 2).sum())) for one in (y, k))
            fastest = rate + math.sqrt(growth)
            since += 1
            h = min(2 * h if since > WAITS else h, WIDE(1 / max(fastest, 1e-3)), end - self.t)
            while True:
                after, error = self._extrapolated(y, k, h)
                if error < TOLERANCE or h < 1e-9:
                    break
                h, since = h * 0.5, 0
            self._go(after, h, end)

    def _go(self, after, h, end):
        """Stand at the unknowns after a step h, which may be the last one up to an end (s)."""
        after[:, :4] /= np.sqrt((after[:, :4] ** 2).sum(1))[:, None]
        before, self.y = self.rate, after
        self.turned += float(h) * 0.5 * (before + self.rate)
        self.t = WIDE(end) if h == end - self.t else self.t + h

    @property
    def rate(self):
        """The angular speed, rad/s."""
        return float(np.sqrt((self.y[0, 4:7] ** 2).sum()))

    def _extrapolated(self, y, k, h):
        """Return y after h, and an estimate of its relative error.

        All levels of the extrapolation go side by side, the one with most steps first. They follow
        the changes of y: extrapolation magnifies the rounding of what it is given a hundred times.
        """
        self.steps.take()
        size, count = len(y), 2 * np.arange(LEVELS, 0, -1)
        s = np.repeat(h / count.astype(WIDE), size)[:, None]
        start, before = np.tile(y, (LEVELS, 1)), np.zeros((LEVELS * size, y.shape[1]), dtype=WIDE)
        now, rows = s * np.tile(k, (LEVELS, 1)), []
        for j in range(1, 2 * LEVELS + 1):
            rate = self.rates(start[:len(now)] + now, self.t + j * s[:len(now), 0])
            if j % 2 == 0:    # the last level that is left has arrived
                rows.append([(now[-size:] + before[-size:] + s[len(now) - size:len(now)]
                              * rate[-size:]) / 2])
                now, before, rate = now[:-size], before[:-size], rate[:-size]
            before, now = now, before + 2 * s[:len(now)] * rate
        for level in range(2, LEVELS + 1):
            row = rows[level - 1]
            for j in range(1, level):
                ratio = WIDE(level) ** 2 / WIDE(level - j) ** 2
                row.append(row[-1] + (row[-1] - rows[level - 2][j - 1]) / (ratio - 1))
        best, other = y + rows[-1][-1], y + rows[-1][-2]
        apart, sizes = np.abs(best - other)[0], 1 + np.abs(best[0])
        error = max(apart[:4].max(), *(apart[part].max() / sizes[part].max()
                                       for part in (slice(4, 7), slice(7, 10), slice(10, None))))
        return best, float(error)

    def _strike(self, one):
        q = self.y[:, :4]
        J = np.array(one['impulse'], dtype=float).astype(WIDE)[None] + 0 * q[:, :3]
        if one.get('frame') == 'body':
            J = rotated(q, J)
        if 'point' in one:
            lever = np.array(one['point'], dtype=float).astype(WIDE) - self.center
        else:
            lever = np.zeros(3, dtype=WIDE)
        G = cross((lever + self.arm)[None], back(q, J))
        if self.axis is not None:
            self.y[:, 4:7] += ((G @ self.axis) / self.about)[:, None] * self.axis
        else:
            self.y[:, 4:7] += times(self.inverse, G)
        if self.kind == 'free':
            self.y[:, 7:10] += J / self.mass

    def floor(self):
        """Return what half an ulp on the numbers of the start does, rad."""
        best = self.y[0, :4]
        apart = [angle(best, other[:4]) for other in self.y[1:]]
        if max(apart) > LINEAR:
            return math.inf
        return math.sqrt(math.fsum(x * x for x in apart)) / self.moved


def _wide(vector):
    """Return a vector of doubles in 80-bit numbers."""
    return np.array(vector, dtype=float).astype(WIDE)
