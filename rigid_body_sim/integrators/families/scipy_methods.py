# SPDX-License-Identifier: Apache-2.0
"""Family of SciPy's solvers, on the scene's own compiled rates.

A method is a module with SOLVER, the name of a ``scipy.integrate.OdeSolver``.

They run forward as far as they were asked and keep the interpolant of each step (about 1 kB a
step); states come from these, so a state does not depend on which other times were asked.
`accuracy` is what SciPy is asked for at each step: rtol = accuracy, atol = accuracy times the size
of the unknown at the start, at least 1 of its unit. Errors of steps add up beyond it. Below 100
ulp (2.2e-14) it is 100 ulp, SciPy's own limit.
"""

import bisect
import math

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.marching.course import stops_after
from rigid_body_sim.integrators.marching.work import TooMuchWork, Work
from rigid_body_sim.scene.state import STATE_SIZE, TIME

ASKS = {'accuracy': ('SOLVER',)}
TABLE = False
TAKES_WRENCH = True
LANES = False
KINKS = False
ROOTS = True
FINEST = 100.0 * np.finfo(float).eps
UNMOVED = 1e-3    # s, the first step where nothing changes yet
DEAR = 10    # steps of a compiled march that a trial takes for one step here
COST = 200   # steps of a compiled march that cost as much as one step here


def bind(method, stepped):
    """Return the rates of a scene for one solver."""
    return Bound(method, stepped)


class Bound:
    """The rates of one scene for one solver."""

    KEEPS_ENTRIES = False

    def __init__(self, method, stepped):
        # to import it takes a quarter of what a node needs to start
        from scipy import integrate
        self.equations = Equations(stepped.scene, stepped.wrench)
        self.solver = getattr(integrate, method.SOLVER)

    def at(self, stepped):
        """Return the Bound of a solver that differs in its accuracy: this one."""
        return self

    def runner(self, stepped, slow):
        """Return None: runs are those of a course."""

    def course(self, stepped):
        """Return the course of a started solver."""
        return _Course(stepped, self.equations, self.solver)


class _Course:
    """One run from a start: interpolants of the steps so far.

    There is one solver for each stretch between breakpoints.
    """

    TELLS_EVENTS = False

    def __init__(self, stepped, equations, solver):
        self._equations, self._method, self._scene = equations, stepped.method, stepped.scene
        self._started = solver
        self._first, self._y = equations.start(stepped.vector)
        y = self._y
        self._begin = float(stepped.vector[TIME])
        self._most = stepped.most
        self._accuracy = max(stepped.accuracy, FINEST)
        self._scales = np.ones(len(y))
        for first, last, absolute in equations.groups:
            if not absolute:
                self._scales[first:last] = max(1.0, float(np.linalg.norm(y[first:last])))
        self._ends = stops_after(self._begin, equations.breakpoints, stepped.stop)
        self._reached, self._steps, self._parameters = [], [], []
        self._solver = None

    def kinks(self, until):
        """Return the times of kinks: none."""
        return []

    def step_at(self, time):
        """Return when the step that holds a time (s) begins and ends, s."""
        self.state(time, np.empty(STATE_SIZE))
        k = bisect.bisect_left(self._reached, time)
        return self._reached[k - 1] if k else self._begin, self._reached[k]

    def _enter(self, begin, y):
        """Start the solver of the stretch that begins at a time."""
        p = self._equations.continued(self._first, begin)
        rate = self._equations.kernels.rate
        self._p = p
        end = next(time for time in self._ends if time > begin)
        at_rest = not any(rate(p, tuple(y.tolist())))
        self._solver = self._started(
            lambda time, y: np.array(rate(p, tuple(y.tolist()))),
            begin,
            y,
            end,
            rtol=self._accuracy,
            atol=self._accuracy * self._scales,
            # of nothing that changes SciPy would make a step that never ends
            first_step=min(UNMOVED, end - begin) if at_rest else None,
        )

    def _advance(self):
        # the last good time, however often the solver has gone on from a state that is not finite
        reached = float(self._reached[-1]) if self._reached else self._begin
        where = f'{self._method.NAME} on {self._scene.name}: at t = {reached!r} s'
        try:
            message = self._solver.step()
        except ValueError:    # SciPy takes no Jacobian apart that is not finite
            raise NotConverged(f'{where} the rates are not finite', reached) from None
        if self._solver.status == 'failed' or not np.isfinite(self._solver.y).all():
            raise NotConverged(f'{where}: {message or "the state is no longer finite"}', reached)
        self._reached.append(self._solver.t)
        self._steps.append(self._solver.dense_output())
        self._parameters.append(self._p)
        if self._solver.status == 'finished':
            self._enter(self._solver.t, self._solver.y)

    def _reach(self, target):
        """Go on until a time (s) is passed."""
        name, before = f'{self._method.NAME} on {self._scene.name}', len(self._steps)

        def reached():
            return self._reached[-1] if self._reached else -math.inf

        def arrived(limit):
            for _ in range(limit):
                if reached() >= target:
                    return True
                self._advance()
                if self._most is not None and DEAR * (len(self._steps) - before) > self._most:
                    raise TooMuchWork(f'{name}: more than {self._most} steps to t = {target!r} s',
                                      float(reached()))
            return False

        Work(name, None, COST).go(arrived, lambda: max(self._begin, reached()), target)

    def state(self, time, out):
        """Fill out with the state at a time not before the start."""
        self.states(np.array([time]), out[np.newaxis])

    def states(self, times, out):
        """Fill out with the states at times not before the start."""
        with np.errstate(all='ignore'):    # what is not finite ends in one line, without warnings
            if self._solver is None:
                self._enter(self._begin, self._y)
            self._reach(float(times.max()))
        write = self._equations.kernels.write
        for time, row in zip(times, out, strict=True):
            k = bisect.bisect_left(self._reached, time)
            y = self._steps[k](time)
            write(self._parameters[k], time, tuple(y.tolist()), row)
