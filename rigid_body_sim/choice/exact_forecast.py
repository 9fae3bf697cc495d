# SPDX-License-Identifier: Apache-2.0
"""The expected error of a motion in closed form."""

from rigid_body_sim.choice.comparison import FINER, apart
from rigid_body_sim.choice.forecast import forecast
from rigid_body_sim.choice.rounding import lost
from rigid_body_sim.choice.runs import looks, run
from rigid_body_sim.integrators.protocols import FINEST


class _Continued:
    """A closed form, and the method that goes on from states from which it does not hold."""

    def __init__(self, exact, general):
        self._exact, self._general = exact, general

    def start(self, vector):
        """Return a solver from a state vector."""
        return (self._exact if self._exact.takes(vector) else self._general).start(vector)


def of_exact(scene, prototype, own, accuracy, horizon, general):
    """Return the Forecast of a motion in closed form.

    Its error is magnified rounding, plus `own` (rad, at the horizon) if it is the closed form of a
    scene that is nearly this one, plus that of the general method after a strike that ends the
    closed form.

    Parameters
    ----------
    prototype : Exact
    own, accuracy : float
        rad.
    horizon : float
        s.
    general : function
        ``general(accuracy)`` returns the Stepped that goes on where the closed form does not hold.
    """
    times, start, errors = looks(horizon), scene.initial.vector, 0.0
    if prototype.motion.takes is not None and scene.strikes:
        finer = run(scene, _Continued(prototype, general(max(FINEST, FINER * accuracy))), start,
                    times)
        prototype = _Continued(prototype, general(accuracy))
        states = run(scene, prototype, start, times)
        errors = apart(states, finer)
    else:
        states = run(scene, prototype, start, times)
    errors = errors + lost(scene, prototype, times, states)
    return forecast(errors + own * (times / horizon), times, accuracy, horizon)
