"""Which method runs a scene: the exact one if a motion absorbs the scene, else the cheapest that meets the accuracy."""

import difflib
from dataclasses import dataclass

from rigid_body_sim.effects.wrench import Wrench
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import METHODS, runnable
from rigid_body_sim.integrators.stepped import Stepped
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.exact import Exact

FINEST_ACCURACY = 1e-15


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
        What the method was asked for.
    horizon : float
        Over which the accuracy holds, s.
    """

    scene: object
    method: str
    accuracy: float | None
    step: float | None
    horizon: float
    _prototype: object

    def solver(self, start, wrench):
        """Return a solver from a state on, under a held wrench."""
        if wrench == Wrench():
            return self._prototype.start(start)
        method = 'dop8' if self.method == 'exact' else self.method
        return Stepped(self.scene, method, self.accuracy, self.step, wrench, self.horizon).start(start)


def choose(scene, integrator='auto', accuracy=1e-12, step=None, horizon=100.0):
    """Return the Choice for a scene.

    Raises
    ------
    BadInput
        An unknown integrator, one that cannot run the scene (those that can are named), an accuracy below what doubles carry, a step that
        is not positive.
    """
    if not FINEST_ACCURACY <= accuracy <= 1.0:
        raise BadInput('accuracy', f'got {accuracy!r}', f'from {FINEST_ACCURACY} (doubles carry no more) to 1')
    if step is not None and not 0.0 < step < float('inf'):
        raise BadInput('step', f'got {step!r}', 'a positive number of seconds')
    if integrator not in ('auto', 'exact') and integrator not in METHODS:
        near = difflib.get_close_matches(integrator, ['auto', 'exact', *METHODS], 1)
        raise BadInput('integrator', f'got {integrator!r}',
                       f'did you mean {near[0]!r}?' if near else f'one of auto, exact, {", ".join(METHODS)}')
    motion = absorbing_motion(scene)
    if integrator in ('auto', 'exact') and motion and step is None:
        return Choice(scene, 'exact', accuracy, None, horizon, Exact(scene, motion))
    able = runnable(scene)
    method = 'dop8' if integrator == 'auto' else integrator
    if method not in able:
        possible = ', '.join(methods_for(scene)) or 'none'
        raise BadInput('integrator', f'{method!r} cannot run the scene {scene.name}', f'those that can: {possible}')
    return Choice(scene, method, accuracy, step, horizon, Stepped(scene, method, accuracy if step is None else None, step, horizon=horizon))
