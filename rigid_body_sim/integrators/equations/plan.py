# SPDX-License-Identifier: Apache-2.0
"""From trees to the steps that make their Taylor series.

Trees are first written with the operations that have recurrences, then listed step by step;
marching/recurrences.py has the recurrences.
"""

import functools
import math
import operator

from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.source import OR_ZERO

LARGEST = 64
"""Largest whole power that is multiplied out."""
UNKNOWN = '_y'
"""What names of unknowns begin with: no parameter of a scene begins so."""


def unknown(place):
    """Return the term of an unknown."""
    return tree.term('name', f'{UNKNOWN}{place}')


def rewritten(trees, definitions, parameters):
    """Return trees with names replaced by definitions, made of operations with recurrences.

    Whole powers are multiplied out; a tangent is a quotient, and a power of a changing exponent an
    exponential. What does not change stands before a product, and a sign before that: equal
    products of series, as those of the attitude in all that it turns, are one then, whatever
    multiplies them.
    """
    found = {}

    def of(one):
        if one in found:
            return found[one]
        if one.op == 'name' and one.args[0] in definitions:
            made = of(definitions[one.args[0]])
        elif one.op in ('number', 'name'):
            made = one
        else:
            args = [of(arg) for arg in one.args]
            if one.op == '^' and not _changes(args[1]):
                args[1] = _whole(args[1], parameters)
            made = _remade(one.op, args)
        found[one] = made
        return made
    return [of(one) for one in trees]


def _plus(a, b):
    """Return a + b; a sign, and a share of both, stand before the sum."""
    if b.op == 'negative':
        return _minus(a, *b.args)
    if a.op == 'negative':
        return _minus(b, *a.args)
    share, (one, other) = _common(a, b)
    return _scaled(share, tree.plus(one, other))


def _minus(a, b):
    """Return a - b, as `_plus`."""
    if b.op == 'negative':
        return _plus(a, *b.args)
    if a.op == 'negative':
        return tree.negative(_plus(*a.args, b))
    share, (one, other) = _common(a, b)
    return _scaled(share, tree.minus(one, other))


def _common(a, b):
    """Return the share that two terms have in common, and what it multiplies."""
    (share, one), (other_share, other) = _parted(a), _parted(b)
    if share is other_share and one is not None and other is not None:
        return share, (one, other)
    return tree.ONE, (a, b)


def _parted(one):
    """Return the share of a term, which does not change, and the rest: None if nothing does."""
    if not _changes(one):
        return one, None
    if one.op == '*' and not _changes(one.args[0]):
        return one.args
    return tree.ONE, one


def _scaled(share, one):
    """Return a term times what does not change; the sign stands first."""
    if one.op == 'negative':
        return tree.negative(_scaled(share, *one.args))
    if share.op == 'negative' or (share.op == 'number' and share.args[0] < 0.0):
        return tree.negative(_scaled(tree.negative(share), one))
    inner, rest = _parted(one)
    return _folded(share, one) if rest is None else tree.times(_folded(share, inner), rest)


def _folded(a, b):
    """Return the product of two terms that do not change; that of two numbers is a number."""
    if a.op == b.op == 'number':
        return tree.number(a.args[0] * b.args[0])
    return tree.times(a, b)


def _times(a, b):
    """Return a b: the shares, then the product of what changes."""
    if a.op == 'negative':
        return tree.negative(_times(*a.args, b))
    if b.op == 'negative':
        return tree.negative(_times(a, *b.args))
    (share, one), (other_share, other) = _parted(a), _parted(b)
    if one is None or other is None:
        return _scaled(share, b) if one is None else _scaled(other_share, a)
    return _scaled(_folded(share, other_share), tree.times(one, other))


def _over(a, b):
    """Return a/b."""
    if _changes(b) or not _changes(a):
        return tree.over(a, b)
    return _scaled(tree.over(tree.ONE, b), a)


RULES = {'+': _plus, '-': _minus, '*': _times, '/': _over, 'negative': tree.negative}


def _remade(op, args):
    """Return the term of an operation on trees that are rewritten already."""
    if op in RULES:
        return RULES[op](*args)
    if op == 'tan':
        return tree.over(tree.term('sin', *args), tree.term('cos', *args))
    if op != '^':
        return tree.term(op, *args)
    base, exponent = args
    if exponent is tree.ZERO:
        return tree.ONE
    if _changes(exponent):
        return tree.term('exp', tree.times(exponent, tree.term('log', base)))
    if exponent.op == 'number' and abs(exponent.args[0]) in range(1, LARGEST + 1):
        whole = _whole_power(base, int(abs(exponent.args[0])))
        return whole if exponent.args[0] > 0.0 else tree.over(tree.ONE, whole)
    if exponent.op == 'number' and exponent.args[0] == 0.5:
        return tree.term('sqrt', base)
    return tree.term('^', base, exponent)


def _whole(exponent, parameters):
    """Return an exponent that does not change, as a number where it is a whole one or a half."""
    by_number = {'+': operator.add, '-': operator.sub, '*': operator.mul}

    def value(one):
        if one.op in by_number:
            return by_number[one.op](*map(value, one.args))
        if one.op == 'negative':
            return -value(*one.args)
        known = one.args[0] if one.op in ('number', 'name') else math.nan
        return parameters.get(known, math.nan) if one.op == 'name' else known
    found = value(exponent)
    known = abs(found) == 0.5 or abs(found) in range(LARGEST + 1)
    return tree.number(found) if known else exponent


def _whole_power(base, exponent):
    """Return a power by squares."""
    if exponent == 1:
        return base
    half = _whole_power(base, exponent // 2)
    square = _times(half, half)
    return _times(square, base) if exponent % 2 else square


@functools.lru_cache(maxsize=100_000)
def _changes(one):
    """Return whether an unknown stands in a term."""
    return any(name.startswith(UNKNOWN) for name in tree.names(one))


class Plan:
    """The steps that make the series of trees.

    Attributes
    ----------
    steps : tuple
        (op, operands ...), as recurrences.py reads them.
    rates : tuple
        The operand of each tree; None of a tree that is 0.
    firsts, fixed : list of Terms
        The first coefficient of each step; what steps take beside series.
    bases : tuple
        The operands of roots and powers, whose series hold as long as these stay positive.
    products : int
        The Cauchy products of an order.
    """

    def __init__(self, trees):
        self._place, self._fixed, self.firsts, self._steps = {}, {}, [], []
        self._changing = set()
        for one in tree.parts(*trees):
            if one.op == 'name':
                changes = one.args[0].startswith(UNKNOWN)
            else:
                changes = any(arg in self._changing for arg in one.args)
            if changes:
                self._changing.add(one)
                if one not in self._place:
                    self._append(one)
        self.rates = tuple(None if one is tree.ZERO else self._operand(one) for one in trees)
        self.steps, self.fixed = tuple(self._steps), list(self._fixed)
        self.bases = tuple(dict.fromkeys(
            step[1] for step in self._steps if step[0] in ('sqrt', '^')))
        weights = {'*': 1, '/': 1, 'exp': 1, 'sin': 1, 'cos': 1, 'tanh': 2, 'log': 1, 'sqrt': 1,
                   '^': 2}
        self.products = sum(weights.get(step[0], 0) for step in self._steps)

    def _number(self, one):
        """Return the operand of what does not change, or changes from call to call only."""
        return -1 - self._fixed.setdefault(one, len(self._fixed))

    def _operand(self, one):
        return self._place[one] if one in self._changing else self._number(one)

    def _put(self, one, *step):
        self._place[one] = len(self._steps)
        self._steps.append(step)
        self.firsts.append(one)

    def _append(self, one):
        """Append the step of a term that changes."""
        op, operands = one.op, [self._operand(arg) for arg in one.args if one.op != 'name']
        inverse = tree.term('/', tree.ONE, one.args[-1]) if op == '/' else None
        match op:
            case 'name':
                self._put(one, 'unknown', int(one.args[0].removeprefix(UNKNOWN)))
            case '*' if (turned := tree.term('*', *reversed(one.args))) in self._place:
                self._place[one] = self._place[turned]
            case '*' if min(operands) < 0:
                self._put(one, 'scaled', max(operands), min(operands))
            case '/' if operands[1] < 0:
                self._put(one, 'scaled', operands[0], self._number(inverse))
            case '/':
                self._put(one, '/', *operands, self._number(inverse))
            case 'sin' | 'cos':
                for which in ('sin', 'cos'):
                    pair = tree.term(which, *one.args)
                    self._changing.add(pair)
                    self._put(pair, which, *operands)
            case 'log':
                self._put(one, op, *operands, self._number(tree.term('/', tree.ONE, *one.args)))
            case 'sqrt':
                self._put(one, op, *operands,
                          self._number(tree.term(OR_ZERO, tree.number(0.5), one)))
            case '^':
                self._put(one, op, *operands,
                          self._number(tree.term(OR_ZERO, tree.ONE, one.args[0])))
            case _:
                self._put(one, op, *operands)
