# SPDX-License-Identifier: Apache-2.0
"""Expressions are read by a whitelist: arithmetic is understood, all else gets one line."""

import random
import time

import pytest

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.expressions.reader import LONGEST, read

NAMES = {'x', 'k', 't'}


@pytest.mark.parametrize(('text', 'shown'), [
    ('1 + 2*x', '(1.0 + (2.0 * x))'), ('-k*x^2', '(-(k) * (x ^ 2.0))'), ('x**2', '(x ^ 2.0)'),
    ('-x^2', '-((x ^ 2.0))'), ('2^-1*x', '((2.0 ^ -1.0) * x)'), ('(x)', 'x'), ('+x', 'x'),
    ('x - k - t', '((x - k) - t)'), ('x/k/t', '((x / k) / t)'), ('1e-3*x', '(0.001 * x)'),
    (' min(x, k) ', 'min(x, k)'), ('0*x', '0.0'), ('x^1', 'x'), (3, '3.0'), (0.5, '0.5')])
def test_arithmetic_is_read_in_the_order_of_the_text(text, shown):
    assert str(read(text, NAMES, 'here')) == shown


@pytest.mark.parametrize(('text', 'problem'), [
    ('__import__("os")', '__import__ is no function here'), ('x.real', "'x.real' is not part"),
    ('1/0', 'a division by zero'), ('x^1e9', 'the power 1e+09'), ('9' * 400, 'a number too large'),
    ('1e999', 'a number too large'), ('x if x else 1', 'is not part of the language'),
    ('[x]', 'is not part'), ('lambda: 1', 'is not part'), ('sin(x', "'(' was never closed"),
    ('sin(x, x)', 'sin with 2 arguments'), ('-' * 100 + 'x', 'too deep'),
    ('(' * 300 + 'x' + ')' * 300, ''), ('True', 'True is no number'), ('x y', 'invalid syntax'),
    ('"a"', "'a' is no number"), ('x == 1', 'is not part'), ('é', 'é is not known here'),
    ('sin', 'sin is not known here'), ('\x00', ''), ('', ''), ('x=1', ''), ('f"{x}"', ''),
    ('x' * (LONGEST + 1), f'an expression of {LONGEST + 1} characters'), ('sin(x=1)', ''),
    ('1j', '1j is no number'), ('x@k', 'is not part'), ('x//k', 'is not part'), ('...', '')])
def test_what_is_no_expression_gets_one_line(text, problem):
    with pytest.raises(BadInput) as refusal:
        read(text, NAMES, 'scene: effects.torque.value.0')
    line = str(refusal.value)
    assert line.startswith('scene: effects.torque.value.0: ')
    assert problem in line
    assert line.isprintable()
    assert len(line) < 300


def test_mutated_expressions_are_read_or_refused_in_bounded_time():
    """A hundredth of the 100,000 that were tried: none ended in a traceback."""
    seeds = ['-k*x^2 + 0.1*sin(3*t)', 'exp(-x)/(1 + k^2)', 'min(x, max(k, abs(t)))',
             'sqrt(x*x + 1)']
    draw, begin = random.Random(5), time.process_time()
    for _ in range(1000):
        text = list(draw.choice(seeds))
        for _ in range(draw.randint(1, 6)):
            place = draw.randrange(len(text))
            text[place:place + draw.randint(0, 3)] = draw.choice(
                '0123456789.eE+-*/^()[]{}xkt,_"\'\\\n\x00@:=<> é∑')
        line = ''
        try:
            read(''.join(text), NAMES, 'here')
        except BadInput as refusal:
            line = str(refusal)
        assert line.isprintable()
    assert time.process_time() - begin < 30.0    # measured 0.1
