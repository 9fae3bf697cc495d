# SPDX-License-Identifier: Apache-2.0
"""Family of the methods by power series: taylor.

Where what acts is in numbers, the equations (equations/series.py) are of a few kinds; where an
effect gives formulas, they are the scene's own (equations/expanded.py), and on a plane those of
the phases (equations/contact_series.py). They take no held wrench.
"""

import functools

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import euler, series
from rigid_body_sim.integrators.equations.expanded import Expanded
from rigid_body_sim.integrators.families import one_step
from rigid_body_sim.integrators.marching import batch as batches
from rigid_body_sim.integrators.marching import (
    expanded_march,
    recurrences,
    taylor_march,
    taylor_series,
    unroll,
)
from rigid_body_sim.integrators.marching.points import CONTROL, Control
from rigid_body_sim.integrators.protocols import FINEST  # noqa: F401
from rigid_body_sim.scene.constraints.protocol import Mechanism

ASKS = {'accuracy': (), 'step': ()}
TABLE = False
TAKES_WRENCH = False
LANES = True
KINKS = False
ROOTS = True
LEAST = unroll.NOTHING * unroll.NOTHING    # squared scale of what does not move yet
SAFETY = 0.25    # steps planned a point earlier err by up to four times the allowed


def bind(method, stepped):
    """Return the method's kernels on the equations of a scene."""
    if stepped.scene.constraint.mechanism is Mechanism.PLANE:
        # only now: a dozen modules of contact, which no other scene needs
        from rigid_body_sim.integrators.marching import contact_series
        return contact_series.OnPlaneBySeries(stepped.scene, method, stepped.step)
    return one_step.bind(method, stepped)


def equations_of(scene, wrench):
    """Return the equations of a scene that `march` is for.

    Raises
    ------
    BadInput
        For an effect or a constraint that they cannot express.
    """
    return Expanded(scene) if series.has_formulas(scene) else series.Series(scene)


def batch(bound, stepped, times):
    """Return the Batch for a scene at n times (s), None for fixed steps."""
    if (stepped.step is not None or stepped.scene.constraint.mechanism is Mechanism.PLANE
            or isinstance(bound.equations, Expanded)):
        return None
    return batches.Batch(bound.equations, stepped.accuracy / stepped.horizon, times)


def march(method, equations, adapts):
    """Return the module that marches: taylor_march.py bound to what acts, or expanded_march.py."""
    if isinstance(equations, Expanded):
        return _expanded_march(equations)
    return specialise(
        taylor_march,
        expand=_expand(
            equations.pushed, equations.coupled, equations.dragged, equations.hinged
        ),
    )


def _expanded_march(equations):
    """Return expanded_march.py bound to equations."""
    size, groups, based = equations.kind.UNKNOWNS, equations.groups, equations.based
    places = recurrences.places(size + based)
    relative = [group for group in groups if not group[2]]
    return specialise(
        expanded_march, prepare=equations.prepare, expand=equations.expand,
        along=f'from {recurrences.__name__} import along as along_of\n'
              f'along = along_of({size}, {places})\n',
        settled=f'{equations.kernels.__name__}:settled',
        load=unroll.load_source('load', size), put=unroll.put_source('put', size),
        load_scales=unroll.load_source('load_scales', len(relative)),
        put_scales=unroll.put_source('put_scales', len(relative)),
        grown=_grown(relative), measured=_measured(groups), added=_added(size),
        SIZE=f'SIZE = {size}\n', BASED=f'BASED = {based}\n', PLACES=f'PLACES = {places}\n',
        ROOM=f'ROOM = {equations.room}\n')


def _squares(text, first, last):
    """Return the text of a sum of squares."""
    return ' + '.join(f'{text.format(k)} * {text.format(k)}' for k in range(first, last))


def _grown(groups):
    """Return the source of ``grown(scales, y, rates, h)``: the squared scales with what is met."""
    entries = [f'max(scales[{place}], {_squares("y[{}]", first, last)}, '
               f'h * h * ({_squares("rates[{}]", first, last)}))'
               for place, (first, last, _) in enumerate(groups)]
    return '\n'.join(['@compiled', 'def grown(scales, y, rates, h):',
                      f'    return ({"".join(f"{entry}, " for entry in entries)})', ''])


def _measured(groups):
    """Return the source of ``measured(S, order, scales)``: the squared norm of coefficients.

    Those of each group of unknowns count over the group's squared scale.
    """
    lines = ['@compiled', 'def measured(S, order, scales):', '    a, found = PLACES * order, 0.0']
    place = 0
    for first, last, absolute in groups:
        square = _squares('S[a + {}]', first, last)
        if absolute:
            lines.append(f'    found += {square}')
        else:
            scale = f'scales[{place}]'
            lines.append(f'    found += ({square}) / {scale} if {scale} > {LEAST!r} else 0.0')
            place += 1
    return '\n'.join([*lines, '    return found', ''])


def _added(size):
    """Return the source of ``added(y, c, d)``: y + c + d, what the sums lose, and a squared norm.

    The norm is not finite where an unknown is not.
    """
    return '\n'.join([
        '@compiled', 'def added(y, c, d):',
        *(f'    d{k} = d[{k}] + c[{k}]\n    s{k} = y[{k}] + d{k}' for k in range(size)),
        f'    return {unroll.sums(size)}, {unroll.losses(size)}, {_squares("s{}", 0, size)}', ''])


def begin(stepped, march):
    """Return (control, point) of a march, to be copied for each start."""
    control = np.zeros(march.WORK + march.ROOM)
    tolerance = (
        SAFETY * stepped.accuracy / stepped.horizon if stepped.accuracy is not None else 0.0
    )
    CONTROL.store(control, Control(tolerance, stepped.step or 0.0, 0.0))
    return control, np.zeros(march.VALUES + 2 * march.SIZE)


@functools.cache
def _expand(pushed, coupled, dragged, hinged):
    """Return the source of ``expand(p, S, y)``: the series of y."""
    def numbers(first, count):
        return f'({"".join(f"p[{first + k}], " for k in range(count))})'

    def along_frame(first):
        return f'*rotate_back(y[0], y[1], y[2], y[3], p[{first}], p[{first + 1}], p[{first + 2}])'
    push = f'({along_frame(series.FORCE)}, *{numbers(series.PULL, 6)})' if pushed else '()'
    couple = f'({along_frame(series.COUPLE)}, *{numbers(euler.INVERSE, 3)})' if coupled else '()'
    drag = numbers(series.DRAG, 9) if dragged else '()'
    return '\n'.join(
        [
            f'from {taylor_series.__name__} import expansion as kernel_for',
            '',
            f'expansion = kernel_for({pushed}, {coupled}, {dragged}, {hinged})',
            '',
            '',
            '@compiled',
            'def expand(p, S, y):',
            f'    expansion(S, (y, {numbers(euler.EULER, 3)}, {numbers(series.CONSTANT, 3)}, '
            f'{push}, {couple}, {drag}))',
            '',
        ]
    )
