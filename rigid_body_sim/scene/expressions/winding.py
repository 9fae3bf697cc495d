# SPDX-License-Identifier: Apache-2.0
"""Which expressions jump where the angle of a hinge goes on from its other end, two turns away."""

import math

from rigid_body_sim.scene.expressions import tree

ARITHMETIC = {'+': lambda a, b: a + b, '-': lambda a, b: a - b, '*': lambda a, b: a * b,
              '/': lambda a, b: a / b if b else math.nan, 'negative': lambda a: -a}


def jumps(trees: tuple[tree.Term, ...], parameters: tuple[tuple[str, float], ...]) -> bool:
    """Return whether the values of trees change where the angle changes by two turns.

    ``sin(angle)`` and ``cos(angle/2 + t)`` do not, ``angle`` and ``angle*cos(angle)`` do. What is
    not sums, multiples, and functions of them counts as a jump.
    """
    known, growths = dict(parameters), {}
    for one in tree.parts(*trees):
        growths[one] = _growth(one, growths, known)
    return any(growths[one] != 0.0 for one in trees)


def _growth(one, growths, known):
    """Return the g of a term that is g angle and a part with the period of two turns, or NaN."""
    if one.op == 'number':
        return 0.0
    if one.op == 'name':
        return float(one.args[0] == 'angle' and 'angle' not in known)
    args = [growths[arg] for arg in one.args]
    if not any(args):
        return 0.0
    match one.op:
        case '+' | '-' | 'negative':
            return ARITHMETIC[one.op](*args)
        case '*' | '/':
            u, v = (_number(arg, known) for arg in one.args)
            if v is not None:
                return ARITHMETIC[one.op](args[0], v)
            if u is not None and one.op == '*':
                return u * args[1]
        case 'sin' | 'cos' | 'tan':
            return 0.0 if (2.0 * args[0]).is_integer() else math.nan
    return math.nan


def _number(one, known):
    """Return the value of a term of numbers and parameters; None of any other."""
    if one.op == 'number':
        return one.args[0]
    if one.op == 'name':
        return known.get(one.args[0])
    if one.op not in ARITHMETIC:
        return None
    args = [_number(arg, known) for arg in one.args]
    return None if None in args else ARITHMETIC[one.op](*args)
