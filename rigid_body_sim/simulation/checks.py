# SPDX-License-Identifier: Apache-2.0
"""Checks of what a Simulation is given: numbers, counts of ticks, and starts."""

import math
import numbers
import operator

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics.energy import DIAGNOSIS, NOT_FINITE, NOT_UNIT
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.state import ORIENTATION

load_diagnosis = DIAGNOSIS.load
TIMES = 'times in s: a number, or a sequence of numbers'
LAST_TICK = 2**53
"""Number of the last tick: up to there ticks are exact as doubles, in which times are computed."""


def refuse_no_number(name, value):
    """Refuse values that cannot be compared with a number."""
    if type(value) is float:
        return
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise BadInput(name, f'got {value!r}', 'a number')


def doubles(what, values, expected):
    """Return numbers as an array of doubles; BadInput where they are none.

    `what` names them, and `expected` says what would be right.
    """
    try:
        found = np.asarray(values)
        if found.dtype.kind in 'iuf' or not found.size:
            return np.ascontiguousarray(found, dtype=float)
        if found.dtype.kind == 'O' and all(isinstance(one, numbers.Real) for one in found.flat):
            return np.ascontiguousarray(found, dtype=float)
    except (TypeError, ValueError, OverflowError):
        pass
    raise BadInput(what, f'got {values!r:.80}', expected)


def number_of_ticks(what, ticks, now):
    """Return a number of ticks to go from the tick `now` on as an int; BadInput if it is none.

    `what` names the method that was given it.
    """
    try:
        count = -1 if isinstance(ticks, bool) else operator.index(ticks)
    except TypeError:
        count = -1
    if not 0 <= count <= LAST_TICK - now:
        raise BadInput(
            what,
            f'got {ticks!r}',
            f'a number of ticks: an integer from 0 to {LAST_TICK - now}',
        )
    return count


def refuse_start(name, fault, start, diagnosis):
    """Raise the BadInput of a start that a motion cannot begin at.

    Parameters
    ----------
    name : str
        The scene's.
    fault : int
        What energy.diagnose_start found; not GOOD.
    start : array (14,)
    diagnosis : array
        What energy.diagnose_start filled.
    """
    where = f'{name}: initial'
    if fault == NOT_FINITE:
        raise BadInput(where, 'got numbers that are not finite', 'a finite state')
    if fault == NOT_UNIT:
        q = start[ORIENTATION].tolist()
        raise BadInput(where, f'got the orientation {q}', 'a unit quaternion')
    raise BadInput(
        where,
        '{} is beyond what a double holds ({})'.format(*_beyond(load_diagnosis(diagnosis))),
        'a smaller angular velocity, velocity or height',
    )


def _beyond(found):
    """Return the first quantity of a Diagnosis that is not finite, and its value, in words."""
    for name, value in ('kinetic', found.kinetic), ('potential', found.potential):
        if not math.isfinite(value):
            return f'the {name} energy', f'{float(value)!r} J'
    size = hypot3(*found.momentum)
    if not math.isfinite(size):
        return 'the angular momentum', f'{float(size)!r} kg m^2/s'
    return 'the square of the angular momentum', f'of {float(size)!r} kg m^2/s'
