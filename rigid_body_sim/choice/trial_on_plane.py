# SPDX-License-Identifier: Apache-2.0
"""Trials on a plane, where no table says how many steps a radian takes.

An eighth of a tolerance costs a third more there. So where a trial would take many steps, none is
made: two coarse runs tell how the errors of the motion go with the tolerance, and an eighth of
what follows is taken. Work is counted in steps, so the choice depends neither on the clock nor on
numba.
"""

import math

from rigid_body_sim.choice.comparison import FINER
from rigid_body_sim.choice.forecast import Forecast
from rigid_body_sim.choice.trial import SATURATED, Trial
from rigid_body_sim.choice.trial_runs import COARSER, NEAR
from rigid_body_sim.integrators.marching.contact_succession import CANCELS
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.mechanics.contact.numbers import weight
from rigid_body_sim.numerics.functions import hypot3

DEAR = 12288        # steps of the finer run of a trial: where it has more, none is made
COARSE = 2.0 ** -10, 2.0 ** -14     # tolerances of the two runs that are made instead
WITHIN = 4 * DEAR   # steps of each of them; beyond, the finest tolerance is taken
CAREFUL = 8.0       # share of the tolerance that follows from them


class TrialOnPlane(Trial):
    """The trial runs of one method on a scene with a plane."""

    def take(self, tolerance):
        """Return the tolerance to take where the table has the one given."""
        return self._careful() if self._dear(tolerance) else super().take(tolerance)

    def _pace_seen(self):
        """Return 0: what a run takes is asked in steps, and the trial is of the whole time."""
        return 0.0

    def _likely(self, tolerance):
        """Return where the search begins: no table is behind the tolerance given."""
        return COARSER * tolerance

    def _untold(self):
        """Return the Forecast of nothing: on a plane nothing was measured that could promise."""
        return Forecast(None, None)

    def _dear(self, tolerance):
        """Return whether a trial at a tolerance on a plane would take more than DEAR steps.

        The finer run itself tells, and the trial goes on from it. A coarse one does not tell: an
        event counts as many steps at any tolerance.
        """
        finer = self._grid(FINER * self._likely(tolerance))
        try:
            self._runs[finer] = self._run(finer, DEAR)
        except TooMuchWork:
            return True
        return False

    def _careful(self):
        """Return a tolerance that meets the accuracy, from two coarse runs over the whole time.

        Errors are taken to go with the tolerance, or faster, as those of order eight do. Where the
        coarse runs part, or would be too long, nothing is known: the finest tolerance is taken
        that another run can be compared with.
        """
        finest, coarse = self._grid(max(self._finest / FINER, self._cancelling())), COARSE[0]
        try:
            for one in COARSE:
                self._runs[one] = self._run(one, WITHIN)
        except TooMuchWork:
            return finest
        error = self._error(coarse)
        if error > SATURATED:
            return finest
        return max(finest, self._grid(self._accuracy / (CAREFUL * max(1.0, error / coarse))))

    def _cancelling(self):
        """Return the finest tolerance (rad) whose finer run, NEAR of it, steps can still follow.

        The rounding of forces that cancel limits the tolerance per second
        (marching/contact_succession.py).
        """
        heaviness, size = max(weight(self._scene), 1e-3), max(self._scene.body.surface.size)
        start = self._scene.initial
        speed = (hypot3(*start.velocity) + hypot3(*start.angular_velocity) * size
                 + math.sqrt(heaviness * size))
        return CANCELS / NEAR * heaviness / speed * self._horizon
