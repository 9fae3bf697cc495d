# SPDX-License-Identifier: Apache-2.0
"""Runge-Kutta steps written out: a table of coefficients becomes kernels without loops.

Unrolled, all stages live in registers and a zero coefficient costs nothing. A step holds its
coefficients as literals; a trial reads them from an array, where each costs one instruction less.
compilation/templates.py binds the text into the templates of this folder. An unknown count of ``n
+ extra`` means n unknowns that the rates depend on, then `extra` quadratures, for which no stage
values are formed.
"""

import functools
import itertools

from rigid_body_sim.integrators.equations.euler import CLOCK, DRIFT, PLACE

ROUNDING = 2.0 ** -49    # share of an increment: rounding of the sums of error estimates
# rad/s: below this angular speed relative rates are meaningless, since the body is still starting
# from rest
NOTHING = 1e-100
LET_GO = 2.0 ** -10     # share of the terms of a force: what is accelerated more is not balanced


@functools.cache
def step_source(method, n, extra):
    """Return the source of ``step(p, y, c, k0, h) -> (y, c)``.

    One step of size h from y, where k0 is rate(p, y). c is what the sums have lost so far (Kahan):
    it is added to the increment, and what the new sum loses is returned.
    """
    *stages, increment = _written([*method.A, method.B], repr)
    return '\n'.join(
        [
            '@compiled',
            'def step(p, y, c, k0, h):',
            *_stages(stages, n),
            *_increment(increment, n + extra),
            f'    return {sums(n + extra)}, {losses(n + extra)}',
            '',
        ]
    )


def weights(method):
    """Return the coefficients of a method as its ``trial`` takes them."""
    return [number for row in _rows(method) for number in row.values()]


@functools.cache
def trial_source(method, n, extra, groups):
    """Return the source of ``trial(p, w, y, c, k0, h, scales) -> (y, c, scales, error)``.

    w is an array of the :func:`weights` of the method.

    Like ``step``, with the error estimate of DOP853: err5^2/sqrt(err5^2 + 0.01 err3^2), each a sum
    over groups of unknowns of the squared error over the squared scale of the group. Where err5 is
    only the rounding of its own terms, the error is 0: it says nothing, and the error of order 8
    is far below it. More than forty lines: its lines follow the text that it writes.

    Parameters
    ----------
    groups : sequence of (first, last, absolute)
        Slices of the unknowns. The scale of an absolute group is 1; of the others the largest norm
        met so far, `scales` holds their squares.
    """
    places = itertools.count()
    *stages, increment, e5, e3 = _written(_rows(method), lambda number: f'w[{next(places)}]')
    lines = [
        '@compiled',
        'def trial(p, w, y, c, k0, h, scales):',
        *_stages(stages, n),
        *_increment(increment, n + extra),
        '    fifth = third = moved = 0.0',
    ]
    squares = []
    for first, last, absolute in groups:
        members = range(first, last)
        if absolute:
            weight = ''
        else:
            place = len(squares)
            before, after = (
                ' + '.join(f'{name} * {name}' for name in (form.format(u) for u in members))
                for form in ('y[{}]', 's{}')
            )
            lines.append(f'    square{place} = max(scales[{place}], {before}, {after})')
            lines.append(
                f'    weight{place} = 1.0 / square{place} '
                f'if square{place} > {NOTHING * NOTHING!r} else 0.0'
            )
            squares.append(f'square{place}')
            weight = f'weight{place} * '
        for name, row in (('fifth', e5), ('third', e3)):
            lines += [f'    e{u} = {_sum(row, u)}' for u in members]
            lines.append(f'    {name} += {weight}({" + ".join(f"e{u} * e{u}" for u in members)})')
        lines.append(f'    moved += {weight}({" + ".join(f"d{u} * d{u}" for u in members)})')
    return '\n'.join(
        [
            *lines,
            '    fifth, third = h * h * fifth, h * h * third',
            '    below = fifth + 0.01 * third',
            '    error = fifth / math.sqrt(below) '
            f'if not fifth <= {ROUNDING * ROUNDING!r} * moved < math.inf else 0.0',
            f'    return {sums(n + extra)}, {losses(n + extra)}, '
            f'({"".join(f"{square}, " for square in squares)}), error',
            '',
        ]
    )


@functools.cache
def fastest_source(groups):
    """Return the source of ``fastest(y, k)``.

    The largest rate of change (1/s) of a group of unknowns, relative to its scale at y.

    It is 0 where nothing moves yet.
    """
    lines = ['@compiled', 'def fastest(y, k):', '    found = 0.0']
    for first, last, absolute in groups:
        change, square = (
            ' + '.join(f'{name}[{u}] * {name}[{u}]' for u in range(first, last)) for name in 'ky'
        )
        if absolute:
            lines.append(f'    found = max(found, math.sqrt({change}))')
        else:
            lines += [
                f'    square = {square}',
                f'    found = max(found, math.sqrt(({change}) / square)) '
                f'if square > {NOTHING * NOTHING!r} else found',
            ]
    return '\n'.join([*lines, f'    return found if found > {NOTHING!r} else 0.0', ''])


@functools.cache
def load_source(name, size):
    """Return the source of ``name(array, at)``: a tuple of `size` entries."""
    return '\n'.join(
        [
            '@compiled',
            f'def {name}(array, at):',
            f'    return ({"".join(f"array[at + {u}], " for u in range(size))})',
            '',
        ]
    )


@functools.cache
def put_source(name, size):
    """Return the source of ``name(values, array, at)``: it writes a tuple into an array."""
    return '\n'.join(
        [
            '@compiled',
            f'def {name}(values, array, at):',
            *(f'    array[at + {u}] = values[{u}]' for u in range(size)),
            '',
        ]
    )


def flight(groups):
    """Return where among the relative groups those of place and velocity are; none: ()."""
    firsts = [first for first, _, absolute in groups if not absolute]
    return (firsts.index(PLACE), firsts.index(DRIFT)) if PLACE in firsts else ()


def balanced_source(groups):
    """Return the source of ``balanced(moving, scales, k)``: both, or 0 for those of the flight.

    Terms of a size `moving` (m/s^2) balance where they hardly accelerate the body. Where they do,
    it soon has a velocity that is a scale.
    """
    lines = ['@compiled', 'def balanced(moving, scales, k):']
    if not flight(groups):
        return '\n'.join([*lines, '    return 0.0, scales', ''])
    square = ' + '.join(f'k[{u}] * k[{u}]' for u in range(DRIFT, CLOCK))
    kept = [place for place, (first, _, _) in enumerate(
        group for group in groups if not group[2]) if first < PLACE]
    return '\n'.join([
        *lines, f'    if {square} > {LET_GO * LET_GO!r} * moving * moving:',
        f'        return 0.0, ({"".join(f"scales[{place}], " for place in kept)}0.0, 0.0)',
        '    return moving, scales', ''])


def _rows(method):
    """Return the rows of coefficients of a method that estimates its error."""
    return [*method.A, method.B, method.E5, method.E3]


def _written(rows, text):
    """Return rows with the texts of their coefficients, written in order."""
    return [{j: text(number) for j, number in row.items()} for row in rows]


def _stages(rows, n):
    """Return the lines of all stages.

    The newest stage is added last, because the others are known earlier.
    """
    lines = [f'    a{i}_{j} = h * {a}' for i, row in enumerate(rows) for j, a in row.items()]
    for i, row in enumerate(rows):
        if i == 0:
            continue
        *early, last = row
        values = []
        for u in range(n):
            before = (
                f'(y[{u}] + ({" + ".join(f"a{i}_{j} * k{j}[{u}]" for j in early)}))'
                if early
                else f'y[{u}]'
            )
            values.append(f'{before} + a{i}_{last} * k{last}[{u}]')
        lines.append(f'    k{i} = rate(p, ({", ".join(values)}))')
    return lines


def _increment(row, size):
    lines = [f'    b{j} = h * {b}' for j, b in row.items()]
    for u in range(size):
        lines.append(f'    d{u} = {" + ".join(f"b{j} * k{j}[{u}]" for j in row)} + c[{u}]')
        lines.append(f'    s{u} = y[{u}] + d{u}')
    return lines


def _sum(row, u):
    return ' + '.join(f'{e} * k{j}[{u}]' for j, e in row.items())


def sums(size):
    """Return the text of the tuple of new unknowns, s0, s1, ..."""
    return f'({"".join(f"s{u}, " for u in range(size))})'


def losses(size):
    """Return the text of the tuple of what s = y + d has lost of the increments d."""
    return f'({"".join(f"d{u} - (s{u} - y[{u}]), " for u in range(size))})'
