# SPDX-License-Identifier: Apache-2.0
"""The choice of the method that runs a scene.

A motion that absorbs the scene solves it exactly. Otherwise `auto` takes the cheapest method that
was measured to meet the accuracy (measured.py), after trial runs on the scene itself
(settling.py).
"""

import functools
import logging
import math

from rigid_body_sim.choice import measured, settling
from rigid_body_sim.choice.choice import HORIZON, Choice, general
from rigid_body_sim.choice.closed_form import closed_form
from rigid_body_sim.choice.exact_forecast import of_exact
from rigid_body_sim.compilation import jit
from rigid_body_sim.errors import BadInput, nearest
from rigid_body_sim.integrators import METHODS, runnable
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import apply
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.painleve import may_meet_paradox

STIFF = 10.0    # multiple of the body's rate above which internal dissipation is stiff
ENDING = 1e-9   # largest accuracy for stiff dissipation; a coarser one keeps a residual wobble
KEPT = 64       # choices


@functools.cache
def _say_what_is_slow():
    """Warn once, in one line on stderr, what a missing numba costs."""
    if jit.numba is None:
        logging.getLogger('rigid_body_sim').warning(
            'numba is not installed: the same bits, hundreds of times slower; '
            'pip install numba')


def methods_for(scene):
    """Return the names of the methods that can run a scene, the exact one first.

    Series do not run a body that may meet Painleve's paradox; they refuse it with the bound on mu.
    """
    able = runnable(scene)
    if (scene.constraint.mechanism is Mechanism.PLANE
            and any(METHODS[name].NEEDS == 'series' for name in able)
            and may_meet_paradox(scene.body, scene.contact.mu)):
        able = [name for name in able if METHODS[name].NEEDS != 'series']
    return (['exact'] if absorbing_motion(scene) else []) + able


def _stiff(scene):
    """Return what is stiff in a scene, a set of the names in Method.STIFF."""
    found = set()
    if max(_inner_rates(scene)) > STIFF:
        found.add('dissipation')
    if measured.is_stiff(scene):
        found.add('drag')
    return found


def _inner_rates(scene):
    """Return the rates of internal dissipation relative to the rotation that it ends in.

    The body ends up at L/I_max. The rate about an axis of the moment I is c L^2/I, so the
    quotients are c L about the axis of the largest moment, and c L I_max/I_min, which is large for
    a slim body.
    """
    if scene.inner_dissipation == 0.0:
        return 0.0, 0.0
    inertia = scene.constraint.inertia(scene.body)
    momentum = apply(inertia.matrix.tolist(), scene.initial.angular_velocity.tolist())
    least = min(moment for moment in inertia.moments if moment > 0.0)
    rate = scene.inner_dissipation * hypot3(*momentum)
    return rate, rate * (max(inertia.moments) / least)


def choose(scene, integrator='auto', accuracy=1e-12, step=None, horizon=HORIZON, settled=None,
           together=False):
    """Return the Choice for a scene.

    Parameters
    ----------
    scene : Scene
    integrator : str
        ``auto``, ``exact`` or a name of METHODS.
    accuracy : float
        rad.
    step : float, optional
        s.
    horizon : float
        s.
    settled : settling.Settled, optional
        An earlier choice by `auto`, which is taken again whatever the table says now.
    together : bool
        Whether many bodies are solved: `auto` takes a method that has them side by side if that
        meets the accuracy, which the table of single bodies does not know.

    Raises
    ------
    BadInput
        An unknown integrator, one that cannot run the scene (the message names those that can),
        an accuracy below what doubles carry, a step that is not positive.
    """
    _say_what_is_slow()
    _check(integrator, accuracy, step, horizon)
    same = _Same(scene, scene.initial.vector.tobytes())
    return _chosen(same, integrator, accuracy, step, horizon, settled, together)


class _Same:
    """A scene as the key of a cache: the same object, with the same start."""

    __slots__ = 'scene', 'start'

    def __init__(self, scene, start):
        self.scene, self.start = scene, start

    def __hash__(self):
        return id(self.scene)

    def __eq__(self, other):
        return self.scene is other.scene and self.start == other.start


@functools.lru_cache(maxsize=KEPT)
def _chosen(same, integrator, accuracy, step, horizon, settled, together):
    """Return the Choice for settings that have been checked.

    A Choice never changes: whoever runs the same scene again gets the same one.
    """
    scene = same.scene
    closed = None
    if (integrator in ('auto', 'exact') and step is None
            and (not settled or settled.method == 'exact')):
        closed = _by_motion(scene, integrator == 'exact' or settled is not None, accuracy, horizon,
                            settled)
    if closed and (integrator == 'exact' or settled or not closed.ends or closed.missed is None):
        return closed
    if integrator == 'exact' and step is not None and 'exact' in methods_for(scene):
        raise BadInput('step', f'got {step!r}, but a closed form takes no steps',
                       'leave it out, or name a method that does')
    able, wobbles = runnable(scene), _inner_rates(scene)[0] > STIFF
    method, tolerance, prototype = integrator, accuracy, None
    if integrator == 'auto':
        stiff = _stiff(scene)
        fit = [name for name in able if stiff <= set(METHODS[name].STIFF)]
        coarsest = ENDING if wobbles else math.inf

        def settle(able):
            return settling.settle(scene, able, min(accuracy, coarsest), horizon,
                                   coarsest=coarsest)
        settled = settled or settle(fit)
        if together:
            settled = settling.side_by_side(settled, settle, fit, accuracy)
        if closed and closed.expected_error <= (settled.expected_error or 0.0):    # None: untried
            return closed
        method, tolerance, prototype = settled.method, settled.tolerance, settled.prototype
    else:
        settled = None
    if method not in able:
        possible = ', '.join(methods_for(scene)) or 'none'
        raise BadInput('integrator', f'{method!r} cannot run the scene {scene.name}',
                       f'those that can: {possible}')
    if wobbles and tolerance is not None:
        tolerance = min(tolerance, ENDING)
    if prototype is not None and step is None:
        prototype = prototype.at(tolerance, wanted=accuracy)
    else:
        prototype = Stepped(scene, method, tolerance, step, horizon=horizon, wanted=accuracy)
    return Choice(scene, method, accuracy, step, horizon, tolerance, prototype, settled)


def _by_motion(scene, named, accuracy, horizon, settled):
    """Return the Choice of the closed form of a scene, or None.

    One that errs by more than the accuracy, since it is that of a scene nearly this one, is taken
    only if it is `named`.
    """
    found = closed_form(scene, horizon)
    if not found or not (named or found.error <= max(accuracy, found.floor)):
        return None
    prototype = Exact(scene, found.motion, found.scene)

    def find():
        # the forecast of a closed form decides nothing unless a strike may end it: made on demand
        return of_exact(scene, prototype, found.error, accuracy, horizon,
                        functools.partial(general, scene, horizon=horizon))
    return Choice(scene, 'exact', accuracy, None, horizon, accuracy, prototype,
                  settled or settling.Settled('exact', accuracy, find=find), found.error)


def _check(integrator, accuracy, step, horizon):
    """Raise BadInput unless each setting by itself is one that a scene could have."""
    if not FINEST <= accuracy <= 1.0:
        raise BadInput('accuracy', f'got {accuracy!r}',
                       f'from {FINEST} (doubles carry no more) to 1')
    if step is not None and not 0.0 < step < float('inf'):
        raise BadInput('step', f'got {step!r}', 'a positive number of seconds')
    if integrator not in ['auto', 'exact', *METHODS]:
        near = nearest(integrator, ['auto', 'exact', *METHODS])
        advice = f'did you mean {near!r}?' if near else (
            f'one of auto, exact, {", ".join(METHODS)}')
        raise BadInput('integrator', f'got {integrator!r}', advice)
    if not 0.0 < horizon < float('inf'):
        raise BadInput('horizon', f'got {horizon!r}', 'a positive number of seconds')
