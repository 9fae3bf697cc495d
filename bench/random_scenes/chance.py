# SPDX-License-Identifier: Apache-2.0
"""Random numbers, vectors and rotations, of which random scenes are drawn."""

import math
import random

import numpy as np


class Chance(random.Random):
    """Random numbers and vectors."""

    def between(self, low, high):
        """Return a number whose logarithm is uniform."""
        return math.exp(self.uniform(math.log(low), math.log(high)))

    def vector(self, size):
        """Return a vector of that length in any direction, a list."""
        v = np.array([self.gauss(0.0, 1.0) for _ in range(3)])
        return [float(x) for x in v / np.linalg.norm(v) * size]

    def turn(self):
        """Return a rotation matrix."""
        q = np.array([self.gauss(0.0, 1.0) for _ in range(4)])
        x, y, z, s = q / np.linalg.norm(q)
        return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - s * z), 2 * (x * z + s * y)],
                         [2 * (x * y + s * z), 1 - 2 * (x * x + z * z), 2 * (y * z - s * x)],
                         [2 * (x * z - s * y), 2 * (y * z + s * x), 1 - 2 * (x * x + y * y)]])
