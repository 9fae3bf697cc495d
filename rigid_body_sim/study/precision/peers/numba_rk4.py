"""Classical Runge-Kutta compiled by numba: what a careful user writes in thirty lines."""

import numba

from rigid_body_sim.study.precision.peers import body
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
        b = rates(p, x + g * a[0], y + g * a[1], z + g * a[2], w + g * a[3], w1 + g * a[4], w2 + g * a[5], w3 + g * a[6])
        c = rates(p, x + g * b[0], y + g * b[1], z + g * b[2], w + g * b[3], w1 + g * b[4], w2 + g * b[5], w3 + g * b[6])
        d = rates(p, x + h * c[0], y + h * c[1], z + h * c[2], w + h * c[3], w1 + h * c[4], w2 + h * c[5], w3 + h * c[6])
        s = h / 6.0
        x += s * (a[0] + 2.0 * (b[0] + c[0]) + d[0])
        y += s * (a[1] + 2.0 * (b[1] + c[1]) + d[1])
        z += s * (a[2] + 2.0 * (b[2] + c[2]) + d[2])
        w += s * (a[3] + 2.0 * (b[3] + c[3]) + d[3])
        w1 += s * (a[4] + 2.0 * (b[4] + c[4]) + d[4])
        w2 += s * (a[5] + 2.0 * (b[5] + c[5]) + d[5])
        w3 += s * (a[6] + 2.0 * (b[6] + c[6]) + d[6])
    return x, y, z, w, w1, w2, w3


def runners(problem, reference):
    """Yield the method."""
    given = body.of(problem)
    yield Runner(NAME, 'step', steps_for(problem, reference), lambda step: _run(given, step), True)


def _run(given, step):
    p, start = given.numbers(), tuple(given.start.tolist())
    now = (start, 0)

    def begin():
        nonlocal now
        now = start, 0

    def to(time):
        nonlocal now
        steps = body.whole_steps(time, step)
        now = march(p, now[0], step, steps - now[1]), steps
    return Run(begin, to, lambda: given.state(now[0]))
