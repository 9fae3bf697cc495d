# SPDX-License-Identifier: Apache-2.0
"""Random samples that depend only on the seed, the key and the number of the run.

Philox is a counter-based generator: run i has the four 64-bit words of counter i + 1, whoever
draws them and in which order (Salmon, Moraes, Dror, Shaw, SC11 2011). The functions are the
package's own, so that the samples have the same bits on every machine.
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.functions import log, sin_cos

UNIFORM, NORMAL, DIRECTION, ROTATION = range(4)
KINDS = {'uniform': UNIFORM, 'normal': NORMAL, 'direction': DIRECTION, 'rotation': ROTATION}
WIDTHS = {UNIFORM: 1, NORMAL: 1, DIRECTION: 3, ROTATION: 4}
WORDS = 4                   # words of 64 bits for each run
UNIT = 2.0 ** -53
TWO_PI = 2.0 * math.pi


@compiled
def fill(kind, words, a, b, out):
    """Fill out, shape (n, width), with samples made of words, shape (n, 4) of uint64.

    With u1, u2, u3 uniform in [0, 1):

    - uniform: a + (b - a) u1
    - normal: a + b sqrt(-2 log(1 - u1)) cos(2 pi u2) (Box and Muller, 1958)
    - direction, of length a: z = 2 u1 - 1, longitude 2 pi u2 (Archimedes)
    - rotation: Shoemake, Graphics Gems III, 1992, page 129
    """
    for i in range(len(words)):
        u1 = (words[i, 0] >> np.uint64(11)) * UNIT
        u2 = (words[i, 1] >> np.uint64(11)) * UNIT
        if kind == UNIFORM:
            out[i, 0] = a + (b - a) * u1
        elif kind == NORMAL:
            _, c = sin_cos(TWO_PI * u2)
            out[i, 0] = a + b * (math.sqrt(-2.0 * log(1.0 - u1)) * c)
        elif kind == DIRECTION:
            z = 2.0 * u1 - 1.0
            around = math.sqrt((1.0 - z) * (1.0 + z))
            s, c = sin_cos(TWO_PI * u2)
            out[i, 0] = a * (around * c)
            out[i, 1] = a * (around * s)
            out[i, 2] = a * z
        else:
            u3 = (words[i, 2] >> np.uint64(11)) * UNIT
            s2, c2 = sin_cos(TWO_PI * u2)
            s3, c3 = sin_cos(TWO_PI * u3)
            near, far = math.sqrt(1.0 - u1), math.sqrt(u1)
            out[i, 0] = near * s2
            out[i, 1] = near * c2
            out[i, 2] = far * s3
            out[i, 3] = far * c3


class Sampled:
    """The samples of one key.

    Parameters
    ----------
    kind : str
        A name of KINDS.
    a, b : float
        Bounds of `uniform`; mean and standard deviation of `normal`; the length of a `direction`.
    seed : int
    key : str
        The key that is sampled: each key has its own random numbers.
    """

    def __init__(self, kind, a, b, seed, key):
        self.kind, self.a, self.b = KINDS[kind], a, b
        self.width = WIDTHS[self.kind]
        words = np.random.SeedSequence([seed, *key.encode()]).generate_state(2, np.uint64)
        self._key = words

    def of_runs(self, first, stop):
        """Return the samples of the runs from `first` up to `stop`.

        Returns
        -------
        array (n,) or (n, width)
        """
        words = np.random.Philox(key=self._key, counter=first).random_raw(WORDS * (stop - first))
        out = np.empty((stop - first, self.width))
        fill(self.kind, words.reshape(-1, WORDS), self.a, self.b, out)
        return out[:, 0] if self.width == 1 else out
