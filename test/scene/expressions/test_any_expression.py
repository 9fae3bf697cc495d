# SPDX-License-Identifier: Apache-2.0
"""Whatever an expression says, its onsets are times in order and its terms have a finite size."""

import math
import random
import warnings

import pytest
from soak import SOAK

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.expressions import reader
from rigid_body_sim.scene.expressions.cancelling import cancelling
from rigid_body_sim.scene.expressions.onsets import onsets

LEAVES = ['t', 't', 't', 'wx', 'k', 'angle', 'qx', '0', '1', '50', '0.01', '-2.5', '1e-300']
POWERS = ['2', '3', '-2', '0.5', '9', '-1.5', '64', 'k', 'log(0)']
CALLS = {'sqrt': 1, 'sin': 1, 'cos': 1, 'tan': 1, 'exp': 1, 'log': 1, 'tanh': 1, 'abs': 1,
         'sign': 1, 'min': 2, 'max': 2}


def drawn(draw, depth):
    """Return the text of a random expression."""
    if depth == 0 or draw.random() < 0.15:
        return draw.choice(LEAVES)
    kind = draw.choice(['+', '-', '*', '/', '^', 'call', 'call', 'call', 'where'])
    if kind == 'call':
        name = draw.choice(list(CALLS))
        return f'{name}({", ".join(drawn(draw, depth - 1) for _ in range(CALLS[name]))})'
    if kind == 'where':
        a, b, c, d = (drawn(draw, depth - 1) for _ in range(4))
        return f'where({a} < {b}, {c}, {d})'
    right = draw.choice(POWERS) if kind == '^' else drawn(draw, depth - 1)
    return f'({drawn(draw, depth - 1)} {kind} {right})'


@pytest.mark.parametrize('seed', range(4))
def test_onsets_and_sizes_of_any_expression(seed):
    draw, made = random.Random(seed), 0
    while made < (5000 if SOAK else 60):
        text = drawn(draw, draw.randint(1, 5))
        try:
            trees = (reader.read(text, {'t', 'wx', 'k', 'angle', 'qx'}, 'x'),) * 3
        except BadInput:
            continue
        made += 1
        with warnings.catch_warnings():
            warnings.simplefilter('error')
            times = onsets(trees, (('k', 2.0),))
            size = cancelling(trees, (('k', 2.0),), 100.0)
        assert list(times) == sorted(set(times)) and all(map(math.isfinite, times)), text
        assert 0.0 <= size < math.inf, text
