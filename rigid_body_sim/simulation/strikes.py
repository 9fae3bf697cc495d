# SPDX-License-Identifier: Apache-2.0
"""Strikes of a scene: what acts at one instant ends a span and begins another."""

import numpy as np

from rigid_body_sim.errors import BadInput, Ended
from rigid_body_sim.mechanics import impulse
from rigid_body_sim.mechanics.ledger import most
from rigid_body_sim.scene.state import STATE_SIZE
from rigid_body_sim.simulation.admission import LARGEST_WORK
from rigid_body_sim.simulation.spans import Span


class Strikes:
    """The effects of a scene that act at one instant, in the order of their times.

    Parameters
    ----------
    scene : Scene
    mechanics : array
        See mechanics/parameters.py.
    """

    def __init__(self, scene, mechanics):
        self._scene, self._mechanics = scene, mechanics

    def follow(self, spans, time, choice):
        """Return spans and those that the strikes up to a time (s) begin.

        Parameters
        ----------
        spans : list of Span
        choice : choice.choice.Choice
            Makes the solvers.

        Raises
        ------
        BadInput
            A strike at the start, at time 0, that the body cannot take. With a later one the
            motion has its event `end`.
        """
        last, strikes = spans[-1], self._scene.strikes
        while last.strikes < len(strikes) and strikes[last.strikes].time <= time:
            strike = strikes[last.strikes]
            at = max(strike.time, last.time)
            before, given = np.empty(STATE_SIZE), last.given + last.solver.entries(at)
            last.solver.state(at, before)
            struck = before.copy()
            taken, work = impulse.push(
                self._mechanics, struck, *strike.as_impulse(self._scene.body, struck), given)
            fault = self._fault(at, taken, work)
            if fault and at <= 0.0:
                raise fault
            if fault:
                struck = before
                solver = NoMotion(last.solver.name, at, str(fault))
            else:
                solver = choice.solver(struck, last.wrench)
            last = Span(at, solver, last.wrench, last.strikes + 1, given, struck,
                        most(last.passed, given))
            spans = [*spans, last]
        return spans

    def _fault(self, at, taken, work):
        """Return a BadInput for too much work, or an axis that takes no momentum; else None."""
        where = f'{self._scene.name}: strike'
        if not abs(work) <= LARGEST_WORK:
            return BadInput(where, f'at {at:g} s it would do a work of {float(work)!r} J',
                            f'at most {LARGEST_WORK:g} J: energies are doubles')
        if not taken:
            return BadInput(where, f'at {at:g} s it has a torque about an axis of zero moment',
                            'a point and an impulse without: such an axis takes no angular '
                            'momentum')
        return None


class NoMotion:
    """The part of a solver after a strike that the body cannot take: no state, the event `end`.

    Parameters
    ----------
    name : str
        The method's.
    time : float
        Of the strike, s.
    why : str
    """

    def __init__(self, name, time, why):
        self.name, self._time, self._why = name, time, why

    def state(self, time, out):
        """Raise Ended."""
        raise Ended(self._why, self._time)

    def states(self, times, out):
        """Raise Ended if there are times."""
        if len(times):
            raise Ended(self._why, self._time)

    def entries(self, time):
        """Raise Ended."""
        raise Ended(self._why, self._time)

    def allowance(self, until):
        """Return None: nothing is solved."""
        return

    def events(self, after, until, tick=0.0):
        """Return the `end`, at the time of the strike."""
        return [(self._time, 'end', {})]
