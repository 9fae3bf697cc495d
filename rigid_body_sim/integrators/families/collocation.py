"""Family of the collocation methods: gauss16. The kernels that depend on the number of unknowns, as source text for gauss_march.py.

Loops over the eight stages are the inner ones, on arrays in which the stages of an unknown lie side by side: the compiler makes them vector
code without being asked to reorder any sum.
"""

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.marching import gauss_march, unroll
from rigid_body_sim.integrators.marching.gauss_nodes import STAGES

TERMS = 2 * STAGES + 1


def equations(scene, wrench, books):
    """Return the equations of a scene that `march` is for."""
    return Equations(scene, wrench, books)


def march(method, bound, adapts):
    """Return the module that marches: gauss_march.py bound to equations."""
    n, size, groups = bound.kind.UNKNOWNS, bound.kind.UNKNOWNS + bound.extra, bound.kind.GROUPS
    relative = sum(not absolute for _, _, absolute in groups)
    kernels, matrix = bound.kernels.__name__, STAGES * (n + size)
    places = {'SIZE': size, 'UNKNOWNS': n, 'KEPT': gauss_march.VALUES + 2 * size + 2, 'RATES': STAGES * n, 'MATRIX': matrix,
              'PREDICTOR': matrix + STAGES * STAGES, 'FOR': matrix + 2 * STAGES * STAGES, 'CURVE': matrix + 2 * STAGES * STAGES + 5}
    return specialise(
        gauss_march, rate=f'{kernels}:rate', settled=f'{kernels}:settled', **{name: f'{name} = {place}\n' for name, place in places.items()},
        load=unroll.load_source('load', size), put=unroll.put_source('put', size),
        load_scales=unroll.load_source('load_scales', relative), put_scales=unroll.put_source('put_scales', relative),
        stage_rates=_stage_rates(n, size, bound.parameter_count), spread=_spread(n), combined=_combined(size, STAGES * n),
        advanced=_advanced(size), along=_along(size, places['CURVE']),
        end_of_curve=_end_of_curve(n, places['CURVE']), measure=_measure(groups), by_group=_by_group(groups), grown=_grown(groups),
        fastest=unroll.fastest_source(groups), first_scales=_first_scales(groups))


def begin(stepped, kernels):
    """Return (control, node) of a march, to be copied for each start."""
    control, node = np.zeros(gauss_march.WORK + kernels.CURVE + TERMS * kernels.SIZE), np.zeros(kernels.KEPT + STAGES * kernels.SIZE)
    control[kernels.TOLERANCE] = stepped.accuracy / stepped.horizon if stepped.accuracy is not None else 0.0
    control[kernels.FIXED] = stepped.step or 0.0
    return control, node


def _stage_rates(n, size, parameters):
    """Return the source of ``stage_rates(p, S)``: rates at the eight stages."""
    values = ''.join(f'p[{k}], ' for k in range(parameters))
    stages = ''.join(f'S[{STAGES * u} + i], ' for u in range(n))
    return '\n'.join(['@compiled', 'def stage_rates(p, S):',
                      f'    numbers = ({values})    # a tuple: an array might overlap S', f'    for i in range({STAGES}):',
                      f'        k = rate(numbers, ({stages}))', *(f'        S[{STAGES * (n + u)} + i] = k[{u}]' for u in range(size)), ''])


def _spread(n):
    """Return the source of ``spread(S, y, at)``: stages = y + the matrix at `at` times their rates, all unknowns in one loop."""
    lines = ['@compiled', 'def spread(S, y, at):']
    lines += [f'    f{u}_{j} = S[{STAGES * (n + u) + j}]' for u in range(n) for j in range(STAGES)]
    lines += [f'    for i in range({STAGES}):', *(f'        a{j} = S[at + {STAGES * j} + i]' for j in range(STAGES))]
    for u in range(n):
        products = [f'a{j} * f{u}_{j}' for j in range(STAGES)]
        lines.append(f'        S[{STAGES * u} + i] = y[{u}] + ({_tree(products)})')
    return '\n'.join([*lines, ''])


def _combined(size, rates):
    """Return the source of ``combined(S, row)``: the sum over the stages of row[j] times the rates, for each unknown."""
    sums = [_tree([f'row[{j}] * S[{rates + STAGES * u + j}]' for j in range(STAGES)]) for u in range(size)]
    return '\n'.join(['@compiled', 'def combined(S, row):', f'    return ({"".join(f"{total}, " for total in sums)})', ''])


def _advanced(size):
    """Return the source of ``advanced(y, mean, c, h) -> (y, c)``: the step made, and what the sums lose (Kahan)."""
    return '\n'.join(['@compiled', 'def advanced(y, mean, c, h):',
                      *(line for u in range(size) for line in (f'    d{u} = h * mean[{u}] + c[{u}]', f'    s{u} = y[{u}] + d{u}')),
                      f'    return {unroll.sums(size)}, {unroll.losses(size)}', ''])


def _along(size, curve):
    """Return the source of ``along(S, y, x)``: y plus the curve at x, by the recurrence of Legendre's polynomials."""
    lines = ['@compiled', 'def along(S, y, x):', '    p0, p1 = 1.0, x']
    lines += [f'    p{k + 1} = {(2 * k + 1) / (k + 1)!r} * (x * p{k}) - {k / (k + 1)!r} * p{k - 1}' for k in range(1, TERMS - 1)]
    sums = [' + '.join(f'S[{curve + TERMS * u + k}] * p{k}' for k in range(TERMS)) for u in range(size)]
    return '\n'.join([*lines, f'    return ({"".join(f"y[{u}] + ({total}), " for u, total in enumerate(sums))})', ''])


def _end_of_curve(n, curve):
    """Return the source of ``end_of_curve(S)``: the last coefficient of the curve, for each unknown."""
    last = ''.join(f'S[{curve + TERMS * u + TERMS - 1}], ' for u in range(n))
    return '\n'.join(['@compiled', 'def end_of_curve(S):', f'    return ({last})', ''])


def _measure(groups):
    """Return the source of ``measure(a, b, share, scales)``: the squared norm of a - share b, group by group over the squared scales."""
    lines, place = ['@compiled', 'def measure(a, b, share, scales):', '    total = 0.0'], 0
    for first, last, absolute in groups:
        lines += [f'    d{u} = a[{u}] - share * b[{u}]' for u in range(first, last)]
        square = ' + '.join(f'd{u} * d{u}' for u in range(first, last))
        share = f'({square}) / scales[{place}] if scales[{place}] > {unroll.NOTHING**2!r} else 0.0'
        lines.append(f'    total += {square if absolute else share}')
        place += not absolute
    return '\n'.join([*lines, '    return total', ''])


def _by_group(groups):
    """Return the source of ``by_group(a, scales)``: the squared norm of each group of unknowns over its squared scale."""
    entries, place = [], 0
    for first, last, absolute in groups:
        square = ' + '.join(f'a[{u}] * a[{u}]' for u in range(first, last))
        entries.append(f'{square}, ' if absolute else f'({square}) / scales[{place}] if scales[{place}] > {unroll.NOTHING**2!r} else 0.0, ')
        place += not absolute
    return '\n'.join(['@compiled', 'def by_group(a, scales):', f'    return ({"".join(entries)})', ''])


def _grown(groups):
    """Return the source of ``grown(scales, y)``: the squared scales with the unknowns y met."""
    squares = [' + '.join(f'y[{u}] * y[{u}]' for u in range(first, last)) for first, last, absolute in groups if not absolute]
    entries = ''.join(f'max(scales[{place}], {square}), ' for place, square in enumerate(squares))
    return '\n'.join(['@compiled', 'def grown(scales, y):', f'    return ({entries})', ''])


def _first_scales(groups):
    """Return the source of ``first_scales(y, k, h)``: the squared scales at y, where a first step h with rates k moves."""
    entries = []
    for first, last, absolute in groups:
        if not absolute:
            square, change = (' + '.join(f'{name}[{u}] * {name}[{u}]' for u in range(first, last)) for name in 'yk')
            entries.append(f'max({square}, h * h * ({change})), ')
    return '\n'.join(['@compiled', 'def first_scales(y, k, h):', f'    return ({"".join(entries)})', ''])


def _tree(terms):
    """Return the sum of terms, added in pairs: a shorter chain than one after the other."""
    while len(terms) > 1:
        terms = [f'({left} + {right})' for left, right in zip(terms[::2], terms[1::2], strict=True)]
    return terms[0]
