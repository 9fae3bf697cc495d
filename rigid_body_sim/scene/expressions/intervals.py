# SPDX-License-Identifier: Apache-2.0
"""Intervals in which expressions lie within intervals of what they depend on.

Many intervals at once: a pair of arrays, the least and the largest values. Rounding is not counted
and an operand that stands twice is taken to vary twice, so the values are some more or an ulp less
than those of the function. Source: R. E. Moore, R. B. Kearfott, M. J. Cloud, Introduction to
Interval Analysis (2009), chapters 2 and 5.
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.functions import exp, sin
from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.functions import hyperbolic_tangent, logarithm, raised

Range = tuple[np.ndarray, np.ndarray]


EXP, TANH, LOG, SIN, POWER = range(5)    # of `of_each`


@compiled
def of_each(function, x, y, out):
    """Fill out with a function of each of many numbers x, or with their powers y.

    The bits are those of an expression.
    """
    for k in range(len(x)):
        if function == EXP:
            out[k] = exp(x[k])
        elif function == TANH:
            out[k] = hyperbolic_tangent(x[k])
        elif function == LOG:
            out[k] = logarithm(x[k])
        elif function == SIN:
            out[k] = sin(x[k])
        else:
            out[k] = raised(x[k], y)


def _each(function, x, y=0.0):
    x, out = np.ascontiguousarray(x), np.empty(len(x))
    of_each(function, x, y, out)
    return out


def ranges(trees: tuple[tree.Term, ...], given: dict[str, Range]) -> dict[tree.Term, Range]:
    """Return the intervals of trees and of all their parts.

    Parameters
    ----------
    trees : tuple of Terms
    given : dict of str to tuple of 2 arrays (n,)
        The intervals of names. Other names, and what has kinks, may be any number.
    """
    like = next(iter(given.values()))[0]
    found: dict[tree.Term, Range] = {}
    with np.errstate(all='ignore'):
        for part in tree.parts(*trees):
            if part.op == 'number':
                found[part] = fixed(part.args[0], like)
            elif part.op == 'name':
                found[part] = given.get(part.args[0]) or _any(like)
            else:
                low, high = _operation(part, [found[arg] for arg in part.args])
                # what is not a number may be anything
                found[part] = (np.where(np.isnan(low), -np.inf, low),
                               np.where(np.isnan(high), np.inf, high))
    return found


def fixed(value: float, like: np.ndarray) -> Range:
    """Return the intervals of a number, as many as an array has entries."""
    filled = np.zeros(len(like)) + value
    return filled, filled


def _any(like):
    return fixed(-math.inf, like)[0], fixed(math.inf, like)[0]


def _operation(part, operands):
    """Return the intervals of an operation on intervals; all numbers where no rule is known."""
    (a, b), (c, d) = (*operands, operands[0])[:2]
    match part.op:
        case '+':
            return a + c, b + d
        case '-':
            return a - d, b - c
        case 'negative':
            return -b, -a
        case '*':
            return _product(a, b, c, d)
        case '/':
            through = (c <= 0.0) & (d >= 0.0)
            low, high = _product(a, b, 1.0 / d, 1.0 / c)
            return np.where(through, -np.inf, low), np.where(through, np.inf, high)
        case '^':
            return _power(a, b, c, d)
        case 'exp':
            return _each(EXP, a), _each(EXP, b)
        case 'tanh':
            return _each(TANH, a), _each(TANH, b)
        case 'sqrt':
            return np.sqrt(np.maximum(a, 0.0)), np.sqrt(np.maximum(b, 0.0))
        case 'log':
            return _logarithm(a), _logarithm(b)
        case 'sin':
            return _sine(a, b)
        case 'cos':
            return _sine(a + 0.5 * math.pi, b + 0.5 * math.pi)
    return _any(a)


def _product(a, b, c, d):
    """Return the intervals of [a, b] [c, d]; nothing times anything is nothing."""
    ends = [np.where((u == 0.0) | (v == 0.0), 0.0, u * v) for u in (a, b) for v in (c, d)]
    return np.minimum.reduce(ends), np.maximum.reduce(ends)


def _power(a, b, c, d):
    """Return the intervals of [a, b] to a power that does not change; else all numbers."""
    power = float(c[0])
    if not (math.isfinite(power) and (c == power).all() and (d == power).all()):
        return _any(a)
    if power != math.floor(power):
        a, b = np.maximum(a, 0.0), np.maximum(b, 0.0)
    ends = _each(POWER, a, power), _each(POWER, b, power)
    low, high = np.minimum(*ends), np.maximum(*ends)
    through = (a < 0.0) & (b > 0.0)
    if power < 0.0:
        return np.where(through, -np.inf, low), np.where(through, np.inf, high)
    return np.where(through & (power % 2.0 == 0.0), 0.0, low), high


def _logarithm(x):
    """Return the logarithm of positive numbers, and of others that of zero."""
    return np.where(x > 0.0, _each(LOG, np.where(x > 0.0, x, 1.0)), -math.inf)


def _sine(a, b):
    """Return the intervals of the sine of [a, b]."""
    ends = _each(SIN, a), _each(SIN, b)
    low, high = np.minimum(*ends), np.maximum(*ends)
    whole = b - a >= 2.0 * math.pi

    def meets(place):
        """Return whether a place, give and take whole turns, lies within."""
        return whole | (np.floor((b - place) / (2.0 * math.pi))
                        >= np.ceil((a - place) / (2.0 * math.pi)))
    return (np.where(meets(-0.5 * math.pi), -1.0, low), np.where(meets(0.5 * math.pi), 1.0, high))
