# SPDX-License-Identifier: Apache-2.0
"""From a scene to its states, sources use only arithmetic with the same bits on every machine.

The sources are read, not run. What they may take from `math` and `numpy` is listed: operations
that IEEE 754 rounds correctly, exact ones, and moves of data. Everything else needs a reason here.
"""

import ast
import pathlib
import re

import pytest

PACKAGE = pathlib.Path(__file__).resolve().parent.parent / 'rigid_body_sim'
ROOMS = ('compilation', 'numerics', 'scene', 'mechanics', 'motions', 'integrators', 'choice',
         'simulation', 'sweeps/draws.py', 'messages/tick_messages.py')
SCRIPTS = ('numerics/make_functions.py',)
"""Scripts that print constants; nothing imports them."""

CORRECT = {
    # fsum, comb, factorial and isqrt are exact; fma is rounded once
    'math': 'ceil comb copysign factorial floor fma frexp fsum inf isfinite isnan isqrt ldexp nan '
            'nextafter pi prod sqrt ulp',
    # cumsum and prod are for whole numbers here, and add one by one in any case
    'np': 'abs add append arange argmax argsort array array_equal asarray ascontiguousarray '
          'broadcast_arrays ceil concatenate count_nonzero cumsum diag diagonal diff divide empty '
          'empty_like errstate eye finfo flatnonzero float64 floor frexp frombuffer fromiter full '
          'inf int64 intp isfinite isnan maximum minimum nan ndarray newaxis nonzero ones '
          'ones_like outer prod random ravel repeat reshape roll searchsorted sort sqrt square '
          'stack tile uint8 uint32 uint64 union1d unique where zeros'}
CORRECT = {module: set(names.split()) for module, names in CORRECT.items()}
LIBRARIES = ('scipy', 'mpmath', 'cmath', 'statistics', 'sympy')
REDUCTIONS = ('dot', 'mean', 'std', 'var', 'trace')
EXCEPTED = {
    # lsoda and radau are SciPy's: simulation/arithmetic.py says that their bits are not promised
    ('integrators/families/scipy_methods.py', 'np.linalg'),
    ('integrators/families/scipy_methods.py', 'import of scipy'),
    # a first guess with two digits, which Newton's method makes 60 in Decimal
    ('numerics/gauss.py', 'math.cos'),
    # of Decimals and Fractions
    ('numerics/gauss.py', 'power value(slope, x) ** 2'),
    ('numerics/exponential.py', 'power Decimal(2) ** (Decimal(-j) / 32)'),
    ('numerics/functions.py', 'power step ** j'),
    ('numerics/functions.py', 'power (-u * u) ** n')}


SUMS = {
    # of Fractions, Decimals and whole numbers
    'compilation/layout.py: sum((1 for _ in _leaves(kind, self._name)))',
    'compilation/layout.py: sum((1 for _ in _leaves(kind, name)))',
    'integrators/equations/equations.py: sum((len(one.values) for one in acting))',
    'integrators/equations/plan.py: sum((weights.get(step[0], 0) for step in self._steps))',
    'integrators/families/collocation.py: sum((not absolute for _, _, absolute in groups))',
    'integrators/families/one_step.py: sum((not absolute for _, _, absolute in groups))',
    'integrators/marching/gauss_nodes.py: '
    'sum((coefficient * comb(k, m) for k, coefficient in enumerate(polynomial) if k >= m))',
    'mechanics/potential.py: sum((size for _, size in parts))',
    'numerics/functions.py: sum(((-u * u) ** n * u / (2 * n + 1) for n in range(12)))',
    'simulation/ensemble.py: sum(map(_width, names))'}


def _exact_power(base, exponent):
    """Return whether a power is one of whole numbers, Fractions or Decimals, or of 2."""
    if isinstance(exponent, ast.UnaryOp):
        exponent = exponent.operand
    whole = isinstance(exponent, ast.Constant) and isinstance(exponent.value, int)
    if isinstance(base, ast.UnaryOp):
        base = base.operand
    constant = isinstance(base, ast.Constant)
    return constant and (isinstance(base.value, int) or (base.value == 2.0 and whole))


def _docstrings(tree):
    for part in ast.walk(tree):
        body = getattr(part, 'body', ())
        for one in body if isinstance(body, list) else ():
            if isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant):
                yield one.value


def found(text):
    """Yield (line, what) for each operation that no list allows."""
    tree = ast.parse(text)
    quiet = set(map(id, _docstrings(tree)))
    for part in ast.walk(tree):
        if isinstance(part, ast.BinOp | ast.AugAssign):
            first, last = ((part.left, part.right) if isinstance(part, ast.BinOp)
                           else (part.target, part.value))
            if isinstance(part.op, ast.MatMult):
                yield part.lineno, '@'
            if isinstance(part.op, ast.Pow) and not _exact_power(first, last):
                yield part.lineno, f'power {ast.unparse(part)}'
        elif isinstance(part, ast.Attribute):
            module = part.value.id if isinstance(part.value, ast.Name) else ''
            if module in CORRECT and part.attr not in CORRECT[module]:
                yield part.lineno, f'{module}.{part.attr}'
        elif isinstance(part, ast.Import | ast.ImportFrom):
            names = ([part.module or ''] if isinstance(part, ast.ImportFrom)
                     else [alias.name for alias in part.names])
            for name in (name.partition('.')[0] for name in names):
                if name in LIBRARIES:
                    yield part.lineno, f'import of {name}'
            if isinstance(part, ast.ImportFrom) and part.module in ('math', 'numpy'):
                short = {'math': 'math', 'numpy': 'np'}[part.module]
                for alias in part.names:
                    if alias.name not in CORRECT[short]:
                        yield part.lineno, f'{short}.{alias.name}'
        elif isinstance(part, ast.Call) and isinstance(part.func, ast.Name):
            if part.func.id == 'pow':
                yield part.lineno, 'pow()'
        elif isinstance(part, ast.Call) and isinstance(part.func, ast.Attribute):
            module = part.func.value.id if isinstance(part.func.value, ast.Name) else ''
            if part.func.attr in REDUCTIONS and module not in ('vectors', 'tree'):
                yield part.lineno, f'.{part.func.attr}()'
        elif isinstance(part, ast.Constant) and isinstance(part.value, str) and (
                id(part) not in quiet):
            # sources that are made for a scene
            for module, name in re.findall(r'\b(math|np)\.(\w+)', part.value):
                if name not in CORRECT[module]:
                    yield part.lineno, f'{module}.{name}'


def sources():
    """Yield (name, path) of the sources from a scene to its states."""
    for room in ROOMS:
        place = PACKAGE / room
        for path in [place] if place.suffix else sorted(place.rglob('*.py')):
            name = path.relative_to(PACKAGE).as_posix()
            if name not in SCRIPTS:
                yield name, path


def test_from_scene_to_state_only_correctly_rounded_operations_are_written():
    wrong = [f'{name}:{line} {what}' for name, path in sources()
             for line, what in found(path.read_text()) if (name, what) not in EXCEPTED]
    assert wrong == []


def test_every_exception_is_still_needed():
    there = {(name, what) for name, path in sources() for _, what in found(path.read_text())}
    assert there >= EXCEPTED


def test_sums_of_floats_are_written_out():
    """The sum() of Python 3.12 and later compensates, that of 3.11 does not."""
    calls = {f'{name}: {ast.unparse(part)}' for name, path in sources()
             for part in ast.walk(ast.parse(path.read_text()))
             if isinstance(part, ast.Call) and isinstance(part.func, ast.Name)
             and part.func.id == 'sum'}
    assert calls == SUMS


@pytest.mark.parametrize('text', [
    'a @ b', 'a @= b', 'x ** 0.5', 'x ** 2', 'x ** y', '2.0 ** y', 'x **= 3', 'pow(x, 2)',
    'np.dot(a, b)', 'a.dot(b)', 'np.linalg.norm(a)', 'np.einsum("i,i", a, b)', 'np.inner(a, b)',
    'math.sin(x)', 'np.sin(x)', 'math.hypot(x, y)', 'np.cross(a, b)', 'np.exp(x)', 'math.exp(x)',
    'from math import sin', 'from numpy import longdouble', 'np.longdouble(1)', 'np.sum(a)',
    'from scipy.spatial.transform import Rotation', 'import scipy.linalg', 'import cmath',
    'source = f"return math.atan2({y}, {x})"', 'a.mean()'])
def test_what_is_forbidden_is_found(text):
    assert list(found(text))


def test_what_is_allowed_passes():
    assert list(found('"""math.sin is not called."""\nx = 2.0 ** -53 + math.sqrt(y) * 2 ** bits\n'
                      'source = f"math.sqrt({x})"\ntotal = a[0] * b[0] + a[1] * b[1]')) == []
