# SPDX-License-Identifier: Apache-2.0
"""Family of the methods by power series: taylor.

Its equations (equations/series.py) are not those of a scene but of a few kinds: what acts is in
their numbers. They take no held wrench.
"""

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import euler, series
from rigid_body_sim.integrators.families.one_step import bind  # noqa: F401
from rigid_body_sim.integrators.marching import batch as batches
from rigid_body_sim.integrators.marching import taylor_march, taylor_series

TAKES_WRENCH = False
LANES = True
KINKS = False
SAFETY = 0.25    # steps planned a point earlier err by up to four times the allowed


def equations_of(scene, wrench):
    """Return the equations of a scene that `march` is for.

    Raises
    ------
    BadInput
        An effect or a constraint that they cannot have.
    """
    return series.Series(scene)


def batch(bound, stepped, times):
    """Return the Batch for a scene at n times (s), None for fixed steps."""
    if stepped.step is not None:
        return None
    return batches.Batch(bound.equations, stepped.accuracy / stepped.horizon, times)


def march(method, equations, adapts):
    """Return the module that marches: taylor_march.py bound to what acts."""
    return specialise(
        taylor_march,
        expand=_expand(
            equations.pushed, equations.coupled, equations.dragged, equations.hinged
        ),
    )


def begin(stepped, march):
    """Return (control, point) of a march, to be copied for each start."""
    control = np.zeros(march.WORK + march.PLACES * (taylor_series.ORDER + 1))
    control[march.TOLERANCE] = (
        SAFETY * stepped.accuracy / stepped.horizon if stepped.accuracy is not None else 0.0
    )
    control[march.FIXED] = stepped.step or 0.0
    return control, np.zeros(march.VALUES + 2 * march.SIZE)


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
