# SPDX-License-Identifier: Apache-2.0
"""From the text of an expression to a tree; nothing is ever evaluated as Python.

Python's own parser reads the text, and only what is listed here is accepted.
"""

import ast
import keyword
import math
import re
import warnings

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.expressions import tree

LONGEST = 2000
"""Most characters of an expression."""
DEEPEST = 60
"""Most parentheses and operations within each other."""
LARGEST_POWER = 64.0
"""Largest number in an exponent: a larger one is more likely a mistake than physics."""

_ORDERS = {ast.Lt: True, ast.LtE: True, ast.Gt: False, ast.GtE: False}
_OPERATORS = {ast.Add: tree.plus, ast.Sub: tree.minus, ast.Mult: tree.times, ast.Div: tree.over,
              ast.Pow: tree.power}


def read(text, names, where):
    """Return the tree of an expression.

    Parameters
    ----------
    text : str, int or float
        ``+ - * / ^``, parentheses, numbers, names, and the functions of tree.FUNCTIONS.
    names : collection of str
        The names that it may use.
    where : str
        File and key path, for error lines.

    Raises
    ------
    BadInput
        One line: what is wrong and what would be right.
    """
    if not isinstance(text, str):
        return tree.number(text)
    if len(text) > LONGEST:
        raise BadInput(where, f'an expression of {len(text)} characters', f'at most {LONGEST}')
    if '#' in text:    # a comment of Python: what comes after it would not count
        raise BadInput(where, f'got {_brief(text)}: # is not part of the language',
                       'a comment of the scene file, outside the quotes')
    spelled, meant = _without_keywords(text, names)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore', SyntaxWarning)
            parsed = ast.parse(spelled.replace('^', '**').strip(), mode='eval').body
    except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
        problem = getattr(error, 'msg', None) or 'too deep'
        raise BadInput(where, f'got {_brief(text)}: {problem}',
                       'an expression like -k*wx + 0.1*sin(w0*t)') from None
    return _Reader(names, where, text, meant).tree(parsed, 0)


def _without_keywords(text, names):
    """Return a text in which no name is a keyword of Python, and what the new names stand for.

    A parameter may be called lambda, as a wavelength is.
    """
    meant = {}
    for name in filter(keyword.iskeyword, names):
        other = f'{name}_'
        while other in text:
            other += '_'
        meant[other] = name
        text = re.sub(rf'(?<![\w.]){name}(?!\w)', other, text)
    return text, meant


def _brief(text):
    shown = repr(text)
    return shown if len(shown) <= 60 else f'{shown[:57]}...'


class _Reader:
    """Walks a parsed text; `where` and the text are for error lines, `meant` for its names."""

    def __init__(self, names, where, text, meant):
        self._names, self._where, self._text, self._meant = names, where, text, meant

    def _refuse(self, problem, remedy):
        raise BadInput(self._where, f'got {_brief(self._text)}: {problem}', remedy)

    def tree(self, parsed, depth):
        """Return the tree of a parsed part."""
        if depth > DEEPEST:
            self._refuse('too deep', f'at most {DEEPEST} operations within each other')
        match parsed:
            case ast.Constant(value=bool() | complex() | str() | bytes() | None):
                self._refuse(f'{parsed.value!r} is not a number', 'numbers like 2 or 1e-3')
            case ast.Constant(value=int() | float() as value):
                return self._number(value)
            case ast.Name(id=written):
                name = self._meant.get(written, written)
                if name not in self._names:
                    self._refuse(f'{name} is not known here',
                                 f'the names are {", ".join(sorted(self._names))}')
                return tree.term('name', name)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return tree.negative(self.tree(operand, depth + 1))
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.tree(operand, depth + 1)
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
                a, b = self.tree(left, depth + 1), self.tree(right, depth + 1)
                return self._checked(type(op), a, b)
            case ast.Call(func=ast.Name(id=name), args=args, keywords=[]) \
                    if name in tree.FUNCTIONS:
                if len(args) != tree.FUNCTIONS[name]:
                    self._refuse(f'{name} with {len(args)} arguments',
                                 f'{name} takes {tree.FUNCTIONS[name]}')
                found = [self.tree(one, depth + 1) for one in args]
                if name == 'where' and found[0].op != 'less':
                    self._refuse('where without a comparison', 'where(x < y, this, that)')
                return tree.term(name, *found)
            case ast.Compare(left=left, ops=[op], comparators=[right]) if type(op) in _ORDERS:
                a, b = self.tree(left, depth + 1), self.tree(right, depth + 1)
                return tree.term('less', *((a, b) if _ORDERS[type(op)] else (b, a)))
            case ast.Call(func=ast.Name(id=name)) if name not in tree.FUNCTIONS:
                self._refuse(f'{name} is not a function here',
                             f'the functions are {", ".join(tree.FUNCTIONS)}')
        self._refuse(f'{ast.unparse(parsed)[:40]!r} is not part of the language',
                     'numbers, names, + - * / ^, < >, parentheses and functions')
        return None

    def _number(self, value):
        try:
            value = float(value)
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            self._refuse('a number too large', 'numbers that a double can hold')
        return tree.number(value)

    def _checked(self, op, a, b):
        if op is ast.Div and b is tree.ZERO:
            self._refuse('a division by zero', 'a divisor that is not 0')
        if op is ast.Pow and b.op == 'number' and abs(b.args[0]) > LARGEST_POWER:
            self._refuse(f'the power {b.args[0]:g}', f'at most {LARGEST_POWER:g}')
        return _OPERATORS[op](a, b)
