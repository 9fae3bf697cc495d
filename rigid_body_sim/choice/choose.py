# SPDX-License-Identifier: Apache-2.0
"""The choice of the method that runs a scene.

A motion that absorbs the scene solves it exactly. Otherwise `auto` takes the cheapest method that
was measured to meet the accuracy (measured.py), after trial runs on the scene itself
(settling.py).
"""

import functools
import logging
import math
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from rigid_body_sim.choice import measured, settling
from rigid_body_sim.choice.comparison import FINER
from rigid_body_sim.choice.exact_forecast import of_exact
from rigid_body_sim.choice.forecast import Forecast, missed
from rigid_body_sim.compilation import jit
from rigid_body_sim.errors import BadInput, nearest
from rigid_body_sim.integrators import GENERAL, METHODS, STEADY, runnable
from rigid_body_sim.integrators.protocols import FINEST, Solver
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.bounds import drive
from rigid_body_sim.motions import absorbing_motion
from rigid_body_sim.motions.nearly import is_exact, nearly_absorbing, only_rounding
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import apply
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.painleve import may_meet_paradox
from rigid_body_sim.scene.scene import Scene
from rigid_body_sim.scene.state import TIME, State

STIFF = 10.0    # multiple of the body's rate above which internal dissipation is stiff
ENDING = 1e-9   # largest accuracy for stiff dissipation; a coarser one keeps a residual wobble
KEPT = 64       # choices
HORIZON = 100.0
"""Time over which an accuracy holds where no duration is given, s."""


@functools.cache
def _say_what_is_slow():
    """Warn once, in one line on stderr, what a missing numba costs."""
    if jit.numba is None:
        logging.getLogger('rigid_body_sim').warning(
            'numba is not installed: the same bits, about a hundred times slower; '
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
        if not wrench and self._holds(start) and (not self.is_nearly or self._meets(start)):
            return self._prototype.start(start)
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

    @functools.cached_property
    def rests_on_start(self):
        """Whether it is a closed form that another start of the scene may not have."""
        return self._asks or self.is_nearly

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
        found = _closed_form(replace(self.scene, initial=State(begun)), self.horizon)
        return found is not None and found.error <= max(self.accuracy, found.floor, self._left_out)

    def _general(self, wrench):
        """Return the solver that stands in where the prototype cannot go on."""
        method = METHODS.get(self.method)
        if method is None or not method.FAMILY.TAKES_WRENCH:    # None: `exact`
            return _general(self.scene, self.tolerance, self.step, wrench, self.horizon,
                            self.accuracy)
        return Stepped(self.scene, method.NAME, self.tolerance, self.step, wrench, self.horizon,
                       wanted=self.accuracy)


def _general(scene, tolerance, step=None, wrench=None, horizon=HORIZON, wanted=math.inf):
    """Return the Stepped that goes on where a closed form does not hold."""
    method = STEADY if measured.is_stiff(scene) else GENERAL
    return Stepped(scene, method.NAME, tolerance, step, wrench, horizon, wanted=wanted)


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
    found = _closed_form(scene, horizon)
    if not found or not (named or found.error <= max(accuracy, found.floor)):
        return None
    prototype = Exact(scene, found.motion, found.scene)

    def find():
        # the forecast of a closed form decides nothing unless a strike may end it: made on demand
        return of_exact(scene, prototype, found.error, accuracy, horizon,
                        functools.partial(_general, scene, horizon=horizon))
    return Choice(scene, 'exact', accuracy, None, horizon, accuracy, prototype,
                  settled or settling.Settled('exact', accuracy, find=find), found.error)


class _Closed(NamedTuple):
    """A closed form for a scene: the scene it solves, and its error but for rounding.

    `floor` is the rounding beside which an error does not show; 0 where there is no error.
    """

    motion: Any
    scene: Scene
    error: float
    floor: float


def _closed_form(scene, horizon):
    """Return the _Closed of a scene, or None."""
    motion = absorbing_motion(scene)
    if motion and is_exact(motion, scene):
        return _Closed(motion, scene, 0.0, 0.0)
    nearly = nearly_absorbing(scene, horizon)
    if nearly is None:
        return _Closed(motion, scene, math.inf, 0.0) if motion else None
    # a torque adds to the angle that the body turns
    floor = (measured.floor(scene, horizon)
             + 0.5 * measured.HALF_ULP * drive(scene, None) * horizon * horizon)
    return _Closed(*nearly, floor)


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
