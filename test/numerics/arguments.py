# SPDX-License-Identifier: Apache-2.0
"""Arguments of the tests of functions: the same numbers on every machine.

Run as a script from the source tree, it prints, as JSON, a digest of what each function gives for
them: ``PYTHONPATH=.:test python test/numerics/arguments.py``.
"""

import hashlib
import json
import math

import numpy as np

from rigid_body_sim.compilation import fused
from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics import double_double, exponential, functions, phase

COUNT = 1300       # arguments of each kind for the digests: about a hundred thousand in all
SPECIAL = [0.0, -0.0, 1.0, -1.0, 0.5, 2.0, math.inf, -math.inf, math.nan, 5e-324, -5e-324,
           2.0 ** -1022, 1.7976931348623157e308, 1e15, 1e22, math.pi / 2, math.pi / 4, 1e-8]


class Arguments:
    """Random arguments, made without library functions whose results may differ."""

    def __init__(self, seed, count):
        self._rng = np.random.default_rng(seed)
        self._count = count

    def uniform(self, first, last):
        return first + (last - first) * self._rng.random(self._count)

    def powers(self, first, last, signs=True):
        """Return numbers that are uniform in exponent, from 2^first to 2^last."""
        exponents = self._rng.integers(first, last, self._count)
        return np.ldexp(self.uniform(1.0, 2.0) * (self._signs() if signs else 1.0), exponents)

    def positive(self):
        """Return doubles with random bits, subnormal ones too."""
        return self._rng.integers(1, 0x7FF0000000000000, self._count).view(np.float64)

    def any(self):
        return self.positive() * self._signs()

    def near(self, value):
        """Return numbers around a value, at distances from an ulp to half of it."""
        return value * (1.0 + self.powers(-52, 0) * 0.5)

    def multiples(self, value, most):
        """Return the doubles next to whole multiples of a value."""
        return np.nextafter(value * self._rng.integers(-most, most, self._count),
                            self._signs() * np.inf)

    def whole(self, first, last):
        return self._rng.integers(first, last, self._count).astype(float)

    def _signs(self):
        return self._rng.choice([-1.0, 1.0], self._count)


def arguments(seed, count):
    """Return {name: list of tuples of arrays}: the arguments of each function, by kinds."""
    made = Arguments(seed, count)
    angles = [(x,) for x in (
        made.uniform(-10.0, 10.0), made.uniform(-0.8, 0.8), made.uniform(-1.7e6, 1.7e6),
        made.uniform(-1e15, 1e15), made.powers(-40, 1), made.any(),
        made.multiples(math.pi / 4, 20), made.multiples(math.pi / 2, 2 ** 40))]
    pairs = [(made.uniform(-1.0, 1.0), made.uniform(-1.0, 1.0)),
             (made.powers(-40, 40), made.powers(-40, 40)), (made.any(), made.any()),
             (made.near(1.0), made.whole(-1, 2)), (made.powers(-8, 0), made.uniform(-2.0, 2.0)),
             (made.powers(-1074, -1020), made.powers(-1074, -1020)),
             (made.powers(1020, 1023), made.powers(1020, 1023))]
    return {
        'sin': angles, 'cos': angles,
        'exp': [(x,) for x in (made.uniform(-746.0, 710.0), made.uniform(-1.0, 1.0),
                               made.uniform(-745.2, -708.0), made.powers(-60, 10))],
        'log': [(x,) for x in (made.positive(), made.near(1.0), made.uniform(0.5, 2.0),
                               made.powers(-1074, -1022, signs=False))],
        'asinh': [(x,) for x in (made.uniform(-10.0, 10.0), made.uniform(0.1, 0.2),
                                 made.powers(-30, 30), made.any())],
        'power': [(made.powers(-60, 60, False), made.uniform(-2.0, 2.0)),
                  (made.positive(), 1.0 / made.whole(2, 40)),
                  (made.powers(-100, 100, False), made.uniform(-10.0, 10.0)),
                  (made.near(1.0), made.powers(0, 40)), (made.positive(), made.uniform(-1.2, 1.2)),
                  (made.uniform(0.0, 5.0), made.whole(-5, 6))],
        'atan2': pairs, 'hypot': pairs,
        'hypot3': [(*pair, made.powers(-40, 40)) for pair in pairs[:3]] + [
            (*pair, made.any()) for pair in pairs[2:3]]}


@compiled
def _turned(x):
    return phase.sin_cos(x, 1e-18)


@compiled
def _decayed(x):
    return exponential.decay(x)


@compiled
def _paired(x, y):
    product, low = double_double.two_product(x, y)
    return (product, low, *double_double.divide(x, low, y, 0.0),
            *double_double.root(abs(x), abs(low)))


@compiled
def _fused(x, y, z):
    return fused.fma(x, y, z)


def digests():
    """Return {name: digest of the bits} of functions.py and of the functions below it."""
    made = Arguments(2, 4 * COUNT)
    given = {name: (getattr(functions, name), kinds)
             for name, kinds in arguments(1, COUNT).items()}
    given |= {
        'sin_cos': (functions.sin_cos, given['sin'][1]),
        'fma': (_fused, [(made.uniform(-1.0, 1.0), made.uniform(-1.0, 1.0), made.powers(-60, 0)),
                         (made.any(), made.any(), made.any()),
                         (made.powers(-600, -450), made.powers(-600, -450),
                          made.powers(-1074, -1000))]),
        'phase.sin_cos': (_turned, [(made.uniform(-2.0, 2.0),)]),
        'decay': (_decayed, [(made.uniform(0.0, 750.0),)]),
        'double_double': (_paired, [(made.powers(-400, 400), made.powers(-400, 400))])}
    found = {}
    for name, (function, kinds) in given.items():
        values = [function(*numbers) for kind in kinds
                  for numbers in zip(*(k.tolist() for k in kind), strict=True)]
        if '.' not in name and name not in ('decay', 'double_double'):
            many = len(kinds[0])
            values += [function(*SPECIAL[k:k + many], *SPECIAL[:k + many - len(SPECIAL)])
                       if k + many > len(SPECIAL) else function(*SPECIAL[k:k + many])
                       for k in range(len(SPECIAL))]
        # nan may have any sign and payload
        bits = np.array(values)
        found[name] = hashlib.sha256(np.where(np.isnan(bits), 0.5, bits).tobytes()).hexdigest()
    return found


if __name__ == '__main__':
    print(json.dumps(digests()))
