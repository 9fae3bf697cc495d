"""Which method runs a scene: the exact one if a motion absorbs the scene, else the cheapest that was measured to meet the accuracy.

The measurements are those of rigid_body_sim/choice/measured.py, and are tried on the scene (rigid_body_sim/choice/trial.py).
"""

import difflib
import functools
import logging
from dataclasses import dataclass

from rigid_body_sim.choice import measured, trial
from rigid_body_sim.compilation import jit
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import METHODS, runnable
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import apply

FINEST_ACCURACY = 1e-15
STIFF = 10.0    # rates of dissipation beyond so many times that of the rotation
ENDING = 1e-9   # of a stiff one the tolerance, at most: a coarser one keeps a wobble above its end, and the steps at 1/rate for ever
HORIZON = 100.0
"""Over which an accuracy holds where no duration is given, s."""


@functools.cache
def _say_what_is_slow():
    """Say once, in one line on stderr, what a missing numba costs."""
    if jit.numba is None:
        logging.getLogger('rigid_body_sim').warning(
            'numba is not installed: the same bits, about a hundred times slower; '
            'pip install numba')


def methods_for(scene):
    """Return the names of the methods that can run a scene, the exact one first."""
    return (['exact'] if absorbing_motion(scene) else []) + runnable(scene)


@dataclass(frozen=True)
class Choice:
    """A method made ready for a scene.

    Attributes
    ----------
    method : str
        ``exact`` or a name of METHODS.
    accuracy, step : float or None
        What was asked for.
    horizon : float
        Over which the accuracy holds, s.
    tolerance : float or None
        The accuracy that the method itself is told: what `auto` found to be enough, else `accuracy`.
    expected_error : float or None
        Of the attitude at the end of the horizon (rad), where `auto` chose.
    """

    scene: object
    method: str
    accuracy: float | None
    step: float | None
    horizon: float
    tolerance: float | None
    expected_error: float | None
    _prototype: object

    def solver(self, start, wrench):
        """Return a solver from a state on, under a held wrench."""
        if not wrench:
            return self._prototype.start(start)
        method = 'dop8' if self.method in ('exact', 'taylor') else self.method
        return Stepped(self.scene, method, self.tolerance, self.step, wrench, self.horizon).start(start)

    def many(self, starts, times, out):
        """Fill out, shape (bodies, n, 14), with the states at n times (s) from many starts, shape (bodies, 14), on all cores."""
        self._prototype.many(starts, times, out)


def _stiff(scene):
    """Return whether internal dissipation is: its rate c L^2/I is c L times that of the rotation, L/I."""
    inner = scene.effect('internal_dissipation')
    if inner is None:
        return False
    momentum = apply(scene.body.about_center.matrix.tolist(), scene.initial.angular_velocity.tolist())
    return inner.coefficient * hypot3(*momentum) > STIFF


def choose(scene, integrator='auto', accuracy=1e-12, step=None, horizon=HORIZON, settled=None):
    """Return the Choice for a scene.

    Parameters
    ----------
    scene : Scene
    integrator : str
    accuracy : float
        rad.
    step : float, optional
        s.
    horizon : float
        s.
    settled : tuple, optional
        (method, tolerance, expected error) that `auto` once chose: then they are taken, whatever the table says now.

    Raises
    ------
    BadInput
        An unknown integrator, one that cannot run the scene (those that can are named), an accuracy below what doubles carry, a step that
        is not positive.
    """
    _say_what_is_slow()
    if not FINEST_ACCURACY <= accuracy <= 1.0:
        raise BadInput('accuracy', f'got {accuracy!r}', f'from {FINEST_ACCURACY} (doubles carry no more) to 1')
    if step is not None and not 0.0 < step < float('inf'):
        raise BadInput('step', f'got {step!r}', 'a positive number of seconds')
    if integrator not in ('auto', 'exact') and integrator not in METHODS:
        near = difflib.get_close_matches(integrator, ['auto', 'exact', *METHODS], 1)
        raise BadInput('integrator', f'got {integrator!r}',
                       f'did you mean {near[0]!r}?' if near else f'one of auto, exact, {", ".join(METHODS)}')
    if not 0.0 < horizon < float('inf'):
        raise BadInput('horizon', f'got {horizon!r}', 'a positive number of seconds')
    motion = absorbing_motion(scene)
    if integrator in ('auto', 'exact') and motion and step is None:
        return Choice(scene, 'exact', accuracy, None, horizon, accuracy, measured.floor(scene, horizon), Exact(scene, motion))
    able = runnable(scene)
    stiff = _stiff(scene)
    # the iteration of gauss16 does not converge where dissipation is stiff; dop8 steps to its end
    fit = [name for name in able if name != 'gauss16'] if stiff else able
    method, tolerance, expected = integrator, accuracy, None
    if integrator == 'auto':
        # a trial of a stiff scene could take coarse tolerances, which never come to an end
        method, tolerance, expected = settled or (measured.pick if stiff else trial.settle)(scene, fit, accuracy, horizon)
    if method not in able:
        possible = ', '.join(methods_for(scene)) or 'none'
        raise BadInput('integrator', f'{method!r} cannot run the scene {scene.name}', f'those that can: {possible}')
    if stiff:
        tolerance = min(tolerance, ENDING)
    return Choice(scene, method, accuracy, step, horizon, tolerance, expected, Stepped(scene, method, tolerance, step, horizon=horizon))
