# SPDX-License-Identifier: Apache-2.0
"""What the choice is: a method prepared for a scene, and what it is expected to err by."""

import functools
import math
from dataclasses import dataclass, field, replace

import numpy as np

from rigid_body_sim.choice import measured, settling
from rigid_body_sim.choice.closed_form import closed_form
from rigid_body_sim.choice.comparison import FINER
from rigid_body_sim.choice.forecast import Forecast, missed
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import GENERAL, METHODS, STEADY
from rigid_body_sim.integrators.protocols import FINEST, Solver
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.motions.nearly import only_rounding
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import TIME, State

HORIZON = 100.0
"""Time over which an accuracy holds where no duration is given, s."""


@dataclass(frozen=True)
class Choice:
    """A method prepared for a scene.

    Attributes
    ----------
    method : str
        ``exact`` or a name of METHODS.
    accuracy, step : float or None
        The settings that the caller asked for, rad and s.
    horizon : float
        Time over which the accuracy holds, s.
    tolerance : float or None
        The accuracy that the method is given: what `auto` found sufficient, else `accuracy`.
    settled : settling.Settled or None
        What `auto` chose, as `choose` takes it again; None of a method that was named.
    """

    scene: object = field(repr=False)
    method: str
    accuracy: float | None
    step: float | None
    horizon: float
    tolerance: float | None
    _prototype: Solver = field(repr=False)
    settled: settling.Settled | None = field(repr=False)
    _left_out: float = field(default=0.0, repr=False)    # error of a scene nearly this one, rad

    @functools.cached_property
    def _forecast(self):
        if self.settled:
            return self.settled.forecast
        if self.step is not None:
            return Forecast(None, None)
        return settling.of_named(self.scene, self._prototype, self.accuracy, self.horizon)

    @property
    def expected_error(self):
        """Largest error of the attitude within the horizon (rad); None where nothing tells.

        In a fast nutation a method that was named may err more in the angular velocity: then that
        error is told, as a share of the largest angular velocity. Trial runs tell it, when it is
        first asked for. Fixed steps are not tried.
        """
        return self._forecast.error

    @property
    def met_until(self):
        """Time until which the accuracy is met (s), at most the horizon; None where unknown."""
        return self._forecast.met_until

    @property
    def missed(self):
        """One line that says that the accuracy is missed and until when it is met; else None.

        A method that was named is tried only where it was never measured on such scenes: fast
        nutations are not in the table.
        """
        if (self.settled is None and measured.on_such(self.scene, self.method)
                and not settling.nutation(self.scene)):
            return None
        return missed(self.accuracy, self.horizon, self.expected_error, self.met_until)

    def solver(self, start, wrench):
        """Return a Solver from a state on, shape (14,), under a held wrench.

        The general method solves a held wrench where the choice is a motion, or a method whose
        family does not account for one. It also goes on where a command has brought the body to a
        state from which the motion does not hold, or errs by more than the accuracy.
        """
        prototype = self._prototype
        if not wrench and (not prototype.rests_on_start or self._goes_on(start)):
            return prototype.start(start)
        return self._general(wrench).start(start)

    def runner(self):
        """Return ``run(start, time, out)``, which fills out with the state at a time from a start.

        It has the bits of a solver from that start. Calls may not overlap: each thread makes a
        runner of its own.
        """
        return self._run if self._asks else self._prototype.runner()

    def _run(self, start, time, out):
        self.solver(start, Wrench()).state(time, out)

    def many(self, starts, times, out):
        """Fill out, shape (bodies, n, 14), with the states of many bodies at n times (s).

        The bodies start from `starts`, shape (bodies, 14); all cores take part.
        """
        held = np.array([self._holds(start) for start in starts]) if self._asks else None
        if held is None or held.all():
            self._prototype.many(starts, times, out)
            return
        for chosen, solver in ((held, self._prototype), (~held, self._general(Wrench()))):
            part = np.empty((int(chosen.sum()), *out.shape[1:]))
            solver.many(starts[chosen], times, part)
            out[chosen] = part

    @property
    def _asks(self):
        return self.method == 'exact' and self._prototype.motion.takes is not None

    @property
    def ends(self):
        """Whether it is a closed form that a strike of the scene may end."""
        return self._asks and bool(self.scene.strikes)

    @property
    def rests_on_start(self):
        """Whether it is a closed form that another start of the scene may not have."""
        return self._prototype.rests_on_start

    @property
    def is_nearly(self):
        """Whether it is the closed form of a scene nearly this one: its error is of the start."""
        return self.method == 'exact' and self._prototype.is_nearly

    def finer(self, share=FINER):
        """Return a Choice of the method with a finer tolerance, beside which its errors show.

        The tolerance is a share of this one; of a share of 0 it is the finest that there is. It is
        None for a closed form that holds from every start, which has no tolerance.

        Raises
        ------
        BadInput
            Fixed steps have no tolerance; the tolerance is the finest already.
        """
        if self.method == 'exact' and not self._asks:
            return None
        if self.step is not None:
            raise BadInput('step', f'got {self.step!r}', 'an accuracy: fixed steps are not tried')
        finer = max(FINEST, share * self.tolerance)
        if finer == self.tolerance:
            raise BadInput('accuracy', f'takes a tolerance of {self.tolerance!r}',
                           'a coarser one: no finer run tells its error')
        return self._at(finer)

    def suited(self, tolerance, error):
        """Return the Choice that `auto` makes where bodies need another tolerance than the scene.

        Parameters
        ----------
        tolerance : float
        error : float
            The one to expect, rad.
        """
        tolerance = max(FINEST, tolerance)
        met_until = self.horizon if error <= self.accuracy else None
        return replace(self._at(tolerance), settled=settling.Settled(
            self.method, tolerance, error, met_until))

    def _at(self, tolerance):
        """Return a Choice of the method with another tolerance."""
        # in closed form the tolerance is that of the method that goes on where the form ends
        stepped = {} if self.method == 'exact' else {'_prototype': self._prototype.at(tolerance)}
        return replace(self, tolerance=tolerance, **stepped)

    def _holds(self, start):
        """Return whether the prototype goes on from a state."""
        return not self._asks or self._prototype.takes(start)

    def _goes_on(self, start):
        """Return whether the prototype goes on from a state, and errs there by what is allowed."""
        return self._holds(start) and (not self.is_nearly or self._meets(start))

    @functools.cached_property
    def _leaves_out_rounding(self):
        return only_rounding(self.scene, self._prototype.solved)

    def _meets(self, start):
        """Return whether the closed form of a scene nearly this one is good enough from a state.

        Its error grows with the rates of the body, and a body at rest shows none.
        """
        if self._leaves_out_rounding:
            return True
        begun = self.scene.initial.vector.copy()
        begun[TIME] = start[TIME]
        if start.tobytes() == begun.tobytes():
            return True
        begun[:], begun[TIME] = start, 0.0
        found = closed_form(replace(self.scene, initial=State(begun)), self.horizon)
        return found is not None and found.error <= max(self.accuracy, found.floor, self._left_out)

    def _general(self, wrench):
        """Return the solver that stands in where the prototype cannot go on."""
        method = METHODS.get(self.method)
        if method is None or not method.FAMILY.TAKES_WRENCH:    # None: `exact`
            return general(self.scene, self.tolerance, self.step, wrench, self.horizon,
                           self.accuracy)
        return Stepped(self.scene, method.NAME, self.tolerance, self.step, wrench, self.horizon,
                       wanted=self.accuracy)


def general(scene, tolerance, step=None, wrench=None, horizon=HORIZON, wanted=math.inf):
    """Return the Stepped that goes on where a closed form does not hold."""
    method = STEADY if measured.is_stiff(scene) else GENERAL
    return Stepped(scene, method.NAME, tolerance, step, wrench, horizon, wanted=wanted)
