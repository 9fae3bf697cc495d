# SPDX-License-Identifier: Apache-2.0
"""Expressions are read by a whitelist: arithmetic is understood, all else gets one line."""

import keyword
import random
import time

import pytest
from soak import SOAK

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.expressions.reader import DEEPEST, LARGEST_POWER, LONGEST, read
from rigid_body_sim.scene.expressions.source import HEAD, Lines
from rigid_body_sim.scene.expressions.tree import derivatives, parts

NAMES = {'x', 'k', 't'}


@pytest.mark.parametrize(('text', 'shown'), [
    ('1 + 2*x', '(1.0 + (2.0 * x))'), ('-k*x^2', '(-(k) * (x ^ 2.0))'), ('x**2', '(x ^ 2.0)'),
    ('-x^2', '-((x ^ 2.0))'), ('2^-1*x', '((2.0 ^ -1.0) * x)'), ('(x)', 'x'), ('+x', 'x'),
    ('x - k - t', '((x - k) - t)'), ('x/k/t', '((x / k) / t)'), ('1e-3*x', '(0.001 * x)'),
    (' min(x, k) ', 'min(x, k)'), ('0*x', '0.0'), ('x^1', 'x'), (3, '3.0'), (0.5, '0.5')])
def test_arithmetic_is_read_in_the_order_of_the_text(text, shown):
    assert str(read(text, NAMES, 'here')) == shown


@pytest.mark.parametrize(('text', 'problem'), [
    ('__import__("os")', '__import__ is not a function here'), ('x.real', "'x.real' is not part"),
    ('1/0', 'a division by zero'), ('x^1e9', 'the power 1e+09'), ('9' * 400, 'a number too large'),
    ('1e999', 'a number too large'), ('x if x else 1', 'is not part of the language'),
    ('[x]', 'is not part'), ('lambda: 1', 'is not part'), ('sin(x', "'(' was never closed"),
    ('sin(x, x)', 'sin with 2 arguments'), ('-' * 100 + 'x', 'too deep'),
    ('(' * 300 + 'x' + ')' * 300, ''), ('True', 'True is not a number'), ('x y', 'invalid syntax'),
    ('"a"', "'a' is not a number"), ('x == 1', 'is not part'), ('é', 'é is not known here'),
    ('sin', 'sin is not known here'), ('\x00', ''), ('', ''), ('x=1', ''), ('f"{x}"', ''),
    ('x' * (LONGEST + 1), f'an expression of {LONGEST + 1} characters'),
    ('sin(x=1)', "'sin(x=1)' is not part"), ('sin(*x)', 'is not part'),
    ('-k*x # - 3', '# is not part'),
    ('1j', '1j is not a number'), ('x@k', 'is not part'), ('x//k', 'is not part'), ('...', '')])
def test_what_is_no_expression_gets_one_line(text, problem):
    with pytest.raises(BadInput) as refusal:
        read(text, NAMES, 'scene: effects.torque.value.0')
    line = str(refusal.value)
    assert line.startswith('scene: effects.torque.value.0: ')
    assert problem in line
    assert line.isprintable()
    assert len(line) < 300


@pytest.mark.parametrize('name', [*keyword.kwlist, *keyword.softkwlist])
def test_a_name_may_be_a_keyword_of_python(name):
    """A wavelength is called lambda; a name with an underscore behind it is another one."""
    text = f'2*{name} - x*sin({name})+{name}_*{name}__'
    if name == '_':
        return
    names = NAMES | {name, f'{name}_', f'{name}__'}
    assert str(read(text, names, 'here')) == (
        f'(((2.0 * {name}) - (x * sin({name}))) + ({name}_ * {name}__))')
    for text in (f'{name}*k', f'{name}: 1', f'k {name} x', f'x.{name}'):
        with pytest.raises(BadInput):
            read(text, NAMES, 'here')
    for text in (f'k {name} x', f'{name}: 1', f'x.{name}', f'{name} {name}', f'"{name}"'):
        with pytest.raises(BadInput) as refusal:
            read(text, names, 'here')
        assert str(refusal.value).isprintable()


SEEDS = ['-k*x^2 + 0.1*sin(3*t)', 'exp(-x)/(1 + k^2)', 'min(x, max(k, abs(t)))',
         'sqrt(x*x + 1)', 'where(x < k, tanh(t), -sign(x))', 'log(x)^0.3 - tan(t)/x^-2']
PLACES = (0.0, -0.0, 1.0, -3.5, 1e-300, 1e300, -1e300)


def mutated(draw):
    """Return a seed with a few places overwritten."""
    text = list(draw.choice(SEEDS))
    for _ in range(draw.choice((1, 1, 2, 6))):
        place = draw.randrange(len(text))
        tokens = '0123456789.eE+-*/^()[]{}xkt,_"\'\\\n\x00@:=<> é∑' if draw.random() < 0.3 \
            else '0123456789+-*/^.xkt'
        text[place:place + draw.randint(0, 2)] = draw.choice(tokens)
    return ''.join(text)


def evaluated(text, draw):
    """Return an expression's value and slope at a random place, by the kernel made of it."""
    lines = Lines({})
    one = read(text, NAMES, 'here')
    found = lines.of(one, *derivatives(one, ['x']))
    values = ''.join(f'{name}, ' for name in lines.values)
    source = '\n'.join([HEAD, f'def kernel({values}the_x, the_k, the_t):', *lines.lines,
                        f'    return {found[0]}, {found[1]}', ''])
    space = {}
    exec(compile(source, 'kernel', 'exec'), space)
    space |= {name: getattr(value, 'py_func', value) for name, value in space.items()}
    return space['kernel'](*lines.values.values(), *(draw.choice(PLACES) for _ in range(3)))


def test_mutated_expressions_are_read_and_computed_or_refused_in_bounded_time():
    """In `make soak` 100,000: none ends in a traceback, wherever it is computed."""
    count = 100_000 if SOAK else 300
    draw, begin, taken = random.Random(5), time.process_time(), 0
    for _ in range(count):
        line = ''
        try:
            value, slope = evaluated(mutated(draw), draw)
            assert isinstance(value, float)
            assert isinstance(slope, float)
            taken += 1
        except BadInput as refusal:
            line = str(refusal)
        assert line.isprintable()
    assert taken > 0.05 * count
    assert time.process_time() - begin < 0.1 * count


@pytest.mark.parametrize('text', [
    '+'.join(['x'] * 10**6), 'sin(' * 10**5 + 'x' + ')' * 10**5, '[' * 10**5,
    '__import__("os").system("x")', '(' * 999 + 'x' + ')' * 999, 'x^' * 900 + 'x',
    '9' * 1999, '-' * 1999, '*'.join(['(x+k)'] * 300), 'exp(' * 50 + 'x' + ')' * 50])
def test_a_hostile_expression_is_taken_or_refused_at_once(text):
    begin = time.process_time()
    try:
        one = read(text, NAMES, 'here')
        line, size = '', len(parts(*derivatives(one, ['x', 'k'])))
    except BadInput as refusal:
        line, size = str(refusal), 0
    assert size < 10_000
    assert line.isprintable()
    assert len(line) < 300
    assert time.process_time() - begin < 5.0    # measured 0.02


def test_lengths_depths_and_powers_are_taken_up_to_their_bounds():
    assert str(read('x' + ' ' * (LONGEST - 1), NAMES, 'here')) == 'x'
    assert str(read(f'x^{LARGEST_POWER}', NAMES, 'here')) == f'(x ^ {LARGEST_POWER})'
    assert str(read(f'x^-{LARGEST_POWER}', NAMES, 'here')) == f'(x ^ -{LARGEST_POWER})'
    deepest = '+' * DEEPEST
    assert str(read(f'{deepest}x', NAMES, 'here')) == 'x'
    for opening, closing in (('-', ''), ('+', ''), ('sin(', ')'), ('1 + (x < ', ')'), ('t*(', ')'),
                             ('(', ')/t'), ('max(t, ', ')'), ('(', ' > t)')):
        with pytest.raises(BadInput, match='too deep'):
            read(f'{opening}{deepest}x{closing}', NAMES, 'here')
    # with as many fewer as stand around them, none is too deep
    for opening, closing, around in (
            ('-', '', 1), ('sin(', ')', 1), ('t*(', ')', 1), ('(', ')*t', 1), ('max(t, ', ')', 1),
            ('max(', ', t)', 1), ('where(t < ', ', 1, 0)', 2), ('where(', ' < t, 1, 0)', 2)):
        assert 'x' in str(read(f'{opening}{deepest[around:]}x{closing}', NAMES, 'here'))
    for power in (1.001 * LARGEST_POWER, -1.001 * LARGEST_POWER):
        with pytest.raises(BadInput, match='the power'):
            read(f'x^{power}', NAMES, 'here')


def test_orders_are_read_either_way_round_and_choose_by_the_comparison():
    for text, shown in (('where(x < k, t, 1)', 'where(less(x, k), t, 1.0)'),
                        ('where(x <= k, t, 1)', 'where(less(x, k), t, 1.0)'),
                        ('where(x > k, t, 1)', 'where(less(k, x), t, 1.0)'),
                        ('where(x >= k, t, 1)', 'where(less(k, x), t, 1.0)')):
        assert str(read(text, NAMES, 'here')) == shown
    for text in ('where(x, t, 1)', 'where(x < k < t, 1, 2)', 'where(x == k, 1, 2)'):
        with pytest.raises(BadInput):
            read(text, NAMES, 'here')
