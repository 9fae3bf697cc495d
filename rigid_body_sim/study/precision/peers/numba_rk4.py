# SPDX-License-Identifier: Apache-2.0
"""Classical Runge-Kutta compiled by numba, as a careful user writes it in thirty lines."""

import numba
import numpy as np

from rigid_body_sim.study.precision.peers import ball, body, given, pendulum
from rigid_body_sim.study.precision.runner import Run, Runner, steps_for

NAME = 'numba RK4'


def version():
    """Return the version that is installed."""
    return numba.__version__


@numba.njit(cache=True)
def march(p, values, h, steps):
    """Return the unknowns after a number of steps."""
    rates = body.rates
    x, y, z, w, w1, w2, w3 = values
    for _ in range(steps):
        a = rates(p, x, y, z, w, w1, w2, w3)
        g = 0.5 * h
        b = rates(p, x + g * a[0], y + g * a[1], z + g * a[2], w + g * a[3], w1 + g * a[4],
                  w2 + g * a[5], w3 + g * a[6])
        c = rates(p, x + g * b[0], y + g * b[1], z + g * b[2], w + g * b[3], w1 + g * b[4],
                  w2 + g * b[5], w3 + g * b[6])
        d = rates(p, x + h * c[0], y + h * c[1], z + h * c[2], w + h * c[3], w1 + h * c[4],
                  w2 + h * c[5], w3 + h * c[6])
        s = h / 6.0
        x += s * (a[0] + 2.0 * (b[0] + c[0]) + d[0])
        y += s * (a[1] + 2.0 * (b[1] + c[1]) + d[1])
        z += s * (a[2] + 2.0 * (b[2] + c[2]) + d[2])
        w += s * (a[3] + 2.0 * (b[3] + c[3]) + d[3])
        w1 += s * (a[4] + 2.0 * (b[4] + c[4]) + d[4])
        w2 += s * (a[5] + 2.0 * (b[5] + c[5]) + d[5])
        w3 += s * (a[6] + 2.0 * (b[6] + c[6]) + d[6])
    return x, y, z, w, w1, w2, w3


@numba.njit(cache=True)
def swing(p, values, h, steps):
    """Return angle and rate of a pendulum after a number of steps."""
    rates = pendulum.rates
    phi, rate = values
    for _ in range(steps):
        a = rates(p, phi, rate)
        b = rates(p, phi + 0.5 * h * a[0], rate + 0.5 * h * a[1])
        c = rates(p, phi + 0.5 * h * b[0], rate + 0.5 * h * b[1])
        d = rates(p, phi + h * c[0], rate + h * c[1])
        phi += h / 6.0 * (a[0] + 2.0 * (b[0] + c[0]) + d[0])
        rate += h / 6.0 * (a[1] + 2.0 * (b[1] + c[1]) + d[1])
    return phi, rate


@numba.njit(cache=True)
def roll(push, slip, values, sliding, h, steps):
    """Advance the unknowns of a ball by some steps; return whether it slides at the end.

    The step in which it begins to roll is cut there.
    """
    slopes, p, trial = np.empty((4, 9)), push * sliding, np.empty(9)
    for _ in range(steps):
        left = h
        while left > 0.0:
            u, fall = slip @ values, slip @ p
            part = left
            if sliding and u + left * fall <= 0.0:
                part = -u / fall
            ball.rates(p, values, slopes[0])
            trial[:] = values + 0.5 * part * slopes[0]
            ball.rates(p, trial, slopes[1])
            trial[:] = values + 0.5 * part * slopes[1]
            ball.rates(p, trial, slopes[2])
            trial[:] = values + part * slopes[2]
            ball.rates(p, trial, slopes[3])
            values += part / 6.0 * (slopes[0] + 2.0 * (slopes[1] + slopes[2]) + slopes[3])
            if part < left or (sliding and slip @ values <= 0.0):
                sliding, p = False, 0.0 * push
            left -= part
    return sliding


def runners(problem, reference):
    """Yield the method."""
    numbers = given.of(problem)
    made = {body.Body: _turning, pendulum.Pendulum: _swinging, ball.Ball: _rolling}[type(numbers)]
    yield Runner(
        NAME, 'step', steps_for(problem, reference), lambda step: made(numbers, step), True)


def _turning(numbers, step):
    return _marching(numbers, numbers.numbers(), march, step)


def _swinging(numbers, step):
    return _marching(numbers, numbers.numbers.astype(float), swing, step)


def _marching(numbers, p, method, step):
    begun = tuple(numbers.start.tolist())
    now = (begun, 0)

    def begin():
        nonlocal now
        now = begun, 0

    def to(time):
        nonlocal now
        steps = body.whole_steps(time, step)
        now = method(p, now[0], step, steps - now[1]), steps
    return Run(begin, to, lambda: numbers.state(now[0]))


def _rolling(numbers, step):
    values, sliding, done = numbers.start.copy(), numbers.slides, 0

    def begin():
        nonlocal sliding, done
        values[:], sliding, done = numbers.start, numbers.slides, 0

    def to(time):
        nonlocal sliding, done
        steps = body.whole_steps(time, step)
        sliding, done = (
            roll(numbers.push, numbers.slip, values, sliding, step, steps - done), steps)
    return Run(begin, to, lambda: numbers.state(values))
