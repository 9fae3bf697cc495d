# SPDX-License-Identifier: Apache-2.0
"""Expressions of scene files as trees, and their derivatives.

A term is kept once, so that equal parts of an expression are the same object and are computed
once. The order of operations is that of the text: the bits of a scene do not depend on the version
of a computer algebra system and the order in which it adds.
"""

import functools
from dataclasses import dataclass

FUNCTIONS = {'sqrt': 1, 'sin': 1, 'cos': 1, 'tan': 1, 'exp': 1, 'log': 1, 'tanh': 1, 'abs': 1,
             'sign': 1, 'min': 2, 'max': 2, 'where': 3}
"""Function -> number of arguments."""


@dataclass(frozen=True, eq=False)
class Term:
    """A number, a name, or an operation on other terms.

    Attributes
    ----------
    op : str
        ``number``, ``name``, ``+ - * / ^``, ``negative``, ``less`` (1 where the first is below the
        second, else 0), or a key of FUNCTIONS; ``where`` takes a ``less`` and what holds where it
        is 1 and where it is 0.
    args : tuple
        A float, a text, or terms.
    """

    op: str
    args: tuple

    def __str__(self):
        if self.op in ('number', 'name'):
            return f'{self.args[0]}'
        if self.op in ('+', '-', '*', '/', '^'):
            return f'({self.args[0]} {self.op} {self.args[1]})'
        return f'{"-" if self.op == "negative" else self.op}({", ".join(map(str, self.args))})'


@functools.lru_cache(maxsize=100_000)
def term(op, *args):
    """Return the term of an operation: the same object for the same operation."""
    return Term(op, args)


def number(value):
    """Return the term of a number."""
    return term('number', float(value))


ZERO, ONE, TWO = number(0.0), number(1.0), number(2.0)


def _is(one, value):
    return one.op == 'number' and one.args[0] == value


def plus(a, b):
    """Return a + b; a zero adds nothing."""
    return b if _is(a, 0.0) else a if _is(b, 0.0) else term('+', a, b)


def minus(a, b):
    """Return a - b; a zero takes nothing away."""
    return a if _is(b, 0.0) else negative(b) if _is(a, 0.0) else term('-', a, b)


def times(a, b):
    """Return a b; zero and one are not multiplied out."""
    if _is(a, 0.0) or _is(b, 0.0):
        return ZERO
    return b if _is(a, 1.0) else a if _is(b, 1.0) else term('*', a, b)


def over(a, b):
    """Return a/b."""
    return ZERO if _is(a, 0.0) else a if _is(b, 1.0) else term('/', a, b)


def negative(a):
    """Return -a."""
    if a.op == 'number':
        return number(-a.args[0])
    return a.args[0] if a.op == 'negative' else term('negative', a)


def power(a, b):
    """Return a to the power b."""
    return ONE if _is(b, 0.0) else a if _is(b, 1.0) else term('^', a, b)


def names(*trees):
    """Return the names that stand in trees."""
    return {one.args[0] for one in parts(*trees) if one.op == 'name'}


def parts(*trees):
    """Return each term of trees once, in an order in which what it is made of comes before it."""
    found, stack = {}, [(one, False) for one in reversed(trees)]
    while stack:
        one, done = stack.pop()
        if one in found:
            continue
        if done or one.op in ('number', 'name'):
            found[one] = None
            continue
        stack.append((one, True))
        stack += [(arg, False) for arg in reversed(one.args)]
    return list(found)


def derivatives(tree, variables):
    """Return the partial derivatives of a tree by names (the rules of any calculus textbook).

    Parameters
    ----------
    tree : Term
    variables : sequence of str

    Returns
    -------
    list of Term
    """
    found = []
    for variable in variables:
        rates = {}
        for one in parts(tree):
            rates[one] = _derivative(one, variable, rates)
        found.append(rates[tree])
    return found


def _derivative(one, variable, rates):
    """Return d(one)/d(variable), the derivatives of its arguments being known.

    More than forty lines: a table of rules, one for each operation.
    """
    op, args = one.op, one.args
    if op == 'number':
        return ZERO
    if op == 'name':
        return ONE if args[0] == variable else ZERO
    if op == 'where':
        return choice(args[0], rates[args[1]], rates[args[2]])
    u, v = (*args, None)[:2]
    du, dv = rates[u], rates.get(v)
    if du is ZERO and (dv is None or dv is ZERO):
        return ZERO
    match op:
        case '+':
            return plus(du, dv)
        case '-':
            return minus(du, dv)
        case '*':
            return plus(times(du, v), times(u, dv))
        case '/':
            return over(minus(du, times(one, dv)), v)
        case 'negative':
            return negative(du)
        case '^':
            slope = times(times(v, power(u, minus_one(v))), du)
            return slope if dv is ZERO else plus(slope, times(times(one, term('log', u)), dv))
        case 'sqrt':
            return over(du, times(TWO, one))
        case 'sin':
            return times(term('cos', u), du)
        case 'cos':
            return negative(times(term('sin', u), du))
        case 'tan':
            return times(plus(ONE, times(one, one)), du)
        case 'exp':
            return times(one, du)
        case 'log':
            return over(du, u)
        case 'tanh':
            return times(minus(ONE, times(one, one)), du)
        case 'abs':
            return times(term('sign', u), du)
        case 'min' | 'max':
            return choice(term('less', *((u, v) if op == 'min' else (v, u))), du, dv)
        case 'less' | 'sign':    # steps: their jumps have no slope
            return ZERO
    raise AssertionError(op)


def choice(less, a, b):
    """Return a where a comparison holds, else b."""
    return a if a is b else term('where', less, a, b)


def minus_one(v):
    """Return v - 1."""
    return number(v.args[0] - 1.0) if v.op == 'number' else minus(v, ONE)
