"""SciPy: solve_ivp with DOP853 on a right-hand side compiled by numba; rtol = atol = tolerance."""

import numba
import numpy as np
import scipy

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.study.precision.peers import body
from rigid_body_sim.study.precision.runner import TOLERANCES, Run, Runner

NAME = 'SciPy DOP853'


def version():
    """Return the version that is installed."""
    return scipy.__version__


@numba.njit(cache=True)
def right_side(_, values, p):
    """Return the rates of the unknowns."""
    return np.array(body.rates(p, values[0], values[1], values[2], values[3], values[4], values[5], values[6]))


def runners(problem, reference):
    """Yield the method."""
    given = body.of(problem)
    yield Runner(NAME, 'tolerance', tuple(t for t in TOLERANCES if t > 2.3e-14), lambda tolerance: _run(given, tolerance), True)


def _run(given, tolerance):
    from scipy.integrate import solve_ivp
    p = given.numbers()
    now = (0.0, given.start)

    def begin():
        nonlocal now
        now = 0.0, given.start

    def to(time):
        nonlocal now
        found = solve_ivp(right_side, (now[0], time), now[1], 'DOP853', t_eval=(time,), args=(p,), rtol=tolerance, atol=tolerance)
        if not found.success:
            raise NotConverged(f'{NAME}: {found.message}')
        now = time, found.y[:, -1]
    return Run(begin, to, lambda: given.state(now[1]))
