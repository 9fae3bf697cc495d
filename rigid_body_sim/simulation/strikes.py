# SPDX-License-Identifier: Apache-2.0
"""Strikes of a scene: what acts at one instant ends a span and begins another."""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.mechanics import impulse
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
        choice : choice.choose.Choice
            Makes the solvers.

        Raises
        ------
        BadInput
            A strike that the body cannot take.
        """
        last, strikes = spans[-1], self._scene.strikes
        while last.strikes < len(strikes) and strikes[last.strikes].time <= time:
            strike = strikes[last.strikes]
            at = max(strike.time, last.time)
            struck, given = np.empty(STATE_SIZE), last.given + last.solver.entries(at)
            last.solver.state(at, struck)
            taken, work = impulse.push(
                self._mechanics, struck, *strike.as_impulse(self._scene.body, struck), given)
            self._check(at, taken, work)
            solver = choice.solver(struck, last.wrench)
            last = Span(at, solver, last.wrench, last.strikes + 1, given, struck)
            spans = [*spans, last]
        return spans

    def _check(self, at, taken, work):
        """Refuse a strike of too much work, or about an axis that takes no momentum."""
        if not abs(work) <= LARGEST_WORK:
            raise BadInput(
                f'{self._scene.name}: strike',
                f'at {at:g} s it would do a work of {float(work)!r} J',
                f'at most {LARGEST_WORK:g} J: energies are doubles',
            )
        if not taken:
            raise BadInput(
                f'{self._scene.name}: strike',
                f'at {at:g} s it has a torque about an axis of zero moment',
                'a point and an impulse without: such an axis takes no angular momentum',
            )
