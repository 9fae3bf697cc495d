# SPDX-License-Identifier: Apache-2.0
"""SciPy: solve_ivp with DOP853 on a right-hand side compiled by numba.

rtol = atol = tolerance. The onset of rolling of a ball is an event.
"""

import numba
import numpy as np
import scipy

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.study.precision.peers import ball, body, given, pendulum
from rigid_body_sim.study.precision.runner import TOLERANCES, Run, Runner

NAME = 'SciPy DOP853'


def version():
    """Return the version that is installed."""
    return scipy.__version__


@numba.njit(cache=True)
def turning(_, values, p):
    """Return the rates of the unknowns of a turning body."""
    return np.array(body.rates(
        p, values[0], values[1], values[2], values[3], values[4], values[5], values[6]))


@numba.njit(cache=True)
def swinging(_, values, p):
    """Return the rates of angle and rate of a pendulum."""
    return np.array(pendulum.rates(p, values[0], values[1]))


@numba.njit(cache=True)
def rolling(_, values, p):
    """Return the rates of the unknowns of a ball."""
    out = np.empty(9)
    ball.rates(p, values, out)
    return out


def runners(problem, reference):
    """Yield the method."""
    numbers = given.of(problem)
    yield Runner(NAME, 'tolerance', tuple(t for t in TOLERANCES if t > 2.3e-14),
                 lambda tolerance: _run(numbers, tolerance), True)


def _run(numbers, tolerance):
    still = np.zeros(9)
    if isinstance(numbers, ball.Ball):
        side, p = rolling, numbers.push
    elif isinstance(numbers, pendulum.Pendulum):
        side, p = swinging, numbers.numbers.astype(float)
    else:
        side, p = turning, numbers.numbers()
    slides = isinstance(numbers, ball.Ball) and numbers.slides
    now = (0.0, numbers.start, slides)

    def onset(_, values, __):
        return numbers.slip @ values
    onset.terminal, onset.direction = True, -1

    def begin():
        nonlocal now
        now = 0.0, numbers.start, slides

    def to(time):
        nonlocal now
        began, values, sliding = now
        if sliding:
            found = _solved(side, began, time, values, p, tolerance, onset)
            if not found.t_events[0].size:
                now = time, found.y[:, -1], True
                return
            began, values, sliding = found.t_events[0][0], found.y_events[0][0], False
        found = _solved(side, began, time, values, still if slides else p, tolerance, None)
        now = time, found.y[:, -1], sliding
    return Run(begin, to, lambda: numbers.state(now[1]))


def _solved(side, began, time, values, p, tolerance, event):
    from scipy.integrate import solve_ivp
    found = solve_ivp(side, (began, time), values, 'DOP853', t_eval=(time,), args=(p,),
                      rtol=tolerance, atol=tolerance, events=event)
    if not found.success:
        raise NotConverged(f'{NAME}: {found.message}')
    return found
