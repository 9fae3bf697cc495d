# SPDX-License-Identifier: Apache-2.0
"""Stepped: a scene followed step by step, as a solver (protocols.py).

    solver = Stepped(scene, method='dop8', accuracy=1e-12, wrench=Wrench(torque=(0, 0, 0.1)))
    solver = solver.start(vector)
    solver.state(time, out)        # out (14,)
    solver.states(times, out)      # out (n, 14), any order of times, none before the start
    solver.entries(time)           # array (5,): the ledger's entries since the start

Give `accuracy` (step control) or `step` (fixed steps); `step` takes precedence. A state does not
depend on which other times were asked. Stepped does not apply the strikes of a scene:
simulation/simulation.py starts a new solver after each strike.
"""

import bisect
import contextlib
import functools
import math

import numpy as np

from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.compilation.repeated import repeated
from rigid_body_sim.compilation.threads import on_all_cores
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators import GENERAL, METHODS, runnable
from rigid_body_sim.integrators.departure import Arriving, Departing, applies, departure
from rigid_body_sim.integrators.growing import UNSEEN, Growing, slowest, unstable
from rigid_body_sim.integrators.marching.course import lost
from rigid_body_sim.integrators.marching.points import REACHED
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.mechanics.bounds import drive, swing_rate, unbounded
from rigid_body_sim.mechanics.energy import DIAGNOSIS_SIZE
from rigid_body_sim.mechanics.events import Watcher, watches
from rigid_body_sim.mechanics.ledger import ANGULAR_IMPULSE, ENTRIES_SIZE
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.mechanics.quadrature import Actors, Quadrature
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, TIME
from rigid_body_sim.scene.winding import may_reach_ends

ULP = float(np.finfo(float).eps)
LEAST = 1e-300          # keeps a quotient finite
MODEST = 1e50           # numbers of a state: up to there its energies are doubles
SLACK = 1e-2            # share of the tolerance: jumps between steps that the ledger ignores


class _Ledger:
    """What only the ledger needs: made on its first use, once for all starts."""

    def __init__(self, scene, wrench, horizon):
        self._scene, self._wrench, self._horizon = scene, wrench, horizon

    @functools.cached_property
    def actors(self):
        """The Actors of the scene."""
        return Actors(self._scene, self._wrench, self._horizon)


class Stepped:
    """Solve a scene by a method of the table (integrators/__init__.py).

    Parameters
    ----------
    scene : Scene
    method : str
        A name of ``rigid_body_sim.integrators.METHODS``.
    accuracy : float, optional
        Error of the attitude (rad), and of omega relative to its largest size, that may build up
        in `horizon`, where the motion itself does not magnify it. An error of omega turns the body
        on, so the attitude of a fast body may err by some times more (a top that spins at 20 rad/s
        for 20 s: 2 times by gauss16, 5 by dop8). It has no effect where `step` is given.
    step : float, optional
        Fixed step, s.
    wrench : effects.wrench.Wrench, optional
        Held all the time.
    horizon : float
        s.
    most : int, optional
        Steps between two times asked for, after which a march gives up (marching/work.py).
    wanted : float, optional
        Relative error that the ledger may have, where `accuracy` is a coarser tolerance that was
        found to be fine enough for it; by default the accuracy alone bounds it.

    Raises
    ------
    BadInput
        By name and value, before anything runs.
    """

    rests_on_start = False

    def __init__(self, scene, method, accuracy=None, step=None, wrench=None, horizon=100.0,
                 most=None, wanted=math.inf):
        if wrench:
            scene = scene.wound
        self.scene, self.method, self.wrench = scene, METHODS[method], wrench
        _check_control(self.method, accuracy, step)
        self.accuracy, self.step, self.horizon, self.most = accuracy, step, horizon, most
        self.wanted = wanted
        on_table = scene.constraint.mechanism in (Mechanism.TABLE, Mechanism.PLANE)
        if on_table and method not in (able := runnable(scene)):
            raise BadInput('integrator', f'{method!r} cannot run a body on the table',
                           f'those that can: {", ".join(able)}')
        self._bound = self.method.FAMILY.bind(self.method, self)
        self._ledger = _Ledger(scene, wrench, horizon)
        self._departs = step is None and applies(scene, wrench)
        self._may_grow = step is None and not self._departs and not on_table
        self._may_wind = scene.wound.constraint != scene.constraint
        self._carried = scene.frame.path is not None
        self._may_leave_doubles = self._carried or step is not None
        self._mechanics = parameters(scene) if step is not None else None
        self.stop = math.inf    # where a step is to end, s
        # of a solver that was started
        self.vector, self.begin, self._latest, self._course = None, None, None, None
        self._quadrature, self._watcher = None, None

    def at(self, accuracy, most=None, wanted=math.inf):
        """Return a Stepped that differs in its accuracy, its `most` steps and what is `wanted`.

        It costs less than a new one: kernels and equations are shared.
        """
        _check_control(self.method, accuracy, self.step)
        other = object.__new__(Stepped)
        other.__dict__ = self.__dict__ | {'accuracy': accuracy, 'most': most, 'wanted': wanted}
        other._bound = self._bound.at(other)
        other.__dict__.pop('_wound', None)    # it has another accuracy
        return other

    @property
    def name(self):
        """The name of the method."""
        return self.method.NAME

    def start(self, vector):
        """Return a solver from a state vector (14 doubles, its time included).

        From a state with more energy than the scene's start, where what acts jumps at an end of
        a hinge's angle, the general method goes on if this one does not stop at kinks.
        """
        if self._may_wind and may_reach_ends(self.scene, vector):
            return self._wound.start(vector)
        started = object.__new__(Stepped)
        started.__dict__ = self.__dict__.copy()
        started.vector = vector = np.array(vector, dtype=float)
        started.begin, _, _, _, _, wx, wy, wz, *_ = vector.tolist()
        speed = hypot3(wx, wy, wz)
        started._latest = _latest(started.begin, speed)
        before = self._departs or speed < self._slow
        started._course = (before and started._before_march()) or started._marching()
        return started

    @functools.cached_property
    def _wound(self):
        """The Stepped of the scene with a kink at the ends of a hinge's angle."""
        method = self.method if self.method.FAMILY.KINKS else GENERAL
        return Stepped(self.scene.wound, method.NAME, self.accuracy, self.step, self.wrench,
                       self.horizon, self.most, self.wanted)

    def runner(self):
        """Return ``run(start, time, out)``, which fills out with the state at a time from a start.

        It has the bits of ``self.start(start).state(time, out)``, in a third of the time where the
        run is short. Calls may not overlap: each thread makes a runner of its own.
        """
        slow = self._slow
        alone = self._departs or self._may_wind or self._carried or slow == math.inf
        found = None if alone else self._bound.runner(self, slow)
        if found is None:
            return self._run
        run = repeated(*found, REACHED, self._run)
        if self.step is None:
            return run

        def run_in_fixed_steps(start, time, out):
            run(start, time, out)
            if not np.abs(out).max() < MODEST:
                self._run(start, time, out)
        return run_in_fixed_steps

    def _run(self, start, time, out):
        self.start(start).state(time, out)

    def _march_from(self, vector, stop=math.inf):
        """Return the course that goes on from a state, with a step that ends at a time (s)."""
        later = object.__new__(Stepped)
        later.__dict__.update(self.__dict__)
        later.vector, later.begin, later.stop = vector, float(vector[TIME]), stop
        return later._marching()

    def _marching(self):
        """Return the course that marches from the start."""
        course = self._bound.course(self)
        return Arriving(self.scene, course, self.vector) if self._departs else course

    def _before_march(self):
        """Return the course of what goes before a march, or None."""
        if self._departs:
            near = departure(self.scene, self.vector)
            return Departing(near, self._march_from) if near else None
        rate = self._growth(self.vector)
        return Growing(unstable(self.scene), self.wrench or Wrench(), self.vector, rate,
                       self._bound.equations.breakpoints, self._march_from) if rate else None

    def _growth(self, vector):
        """Return the rate (1/s) at which what cannot be seen yet grows from a start, or 0."""
        if not self._may_grow:
            return 0.0
        grows, wrench = unstable(self.scene), self.wrench or Wrench()
        if not grows.may_grow(hypot3(*vector[ANGULAR_VELOCITY].tolist())):
            return 0.0
        with np.errstate(all='ignore'):    # numbers that are beyond doubles grow nowhere
            unseen = grows.shown(vector, wrench) < UNSEEN
            return grows.rate(vector, wrench) if unseen else 0.0

    def _unclear(self, starts, rates):
        """Return the bodies that it takes `_growth` for, of starts whose |omega| is `rates`."""
        if not (rates < self._slow).any():
            return []
        grows = unstable(self.scene)
        found = np.flatnonzero(grows.may_grow(rates))
        times = starts[found, TIME]
        if not len(found) or times.min() < times.max():    # other things may act on them
            return found
        actors = self._ledger.actors
        x, y, z = actors.rates(actors.held(float(times[0])), starts[found])[:, ANGULAR_IMPULSE].T
        return found[grows.unclear(rates[found], np.sqrt(x * x + y * y + z * z))]

    @functools.cached_property
    def _slow(self):
        """The rate (rad/s) of a start from which something faster may grow, at most."""
        return slowest(self.scene) if self._may_grow else 0.0

    def state(self, time, out):
        """Fill out, shape (14,), with the state at a time (s); raises what `states` raises."""
        time = float(time)
        self._within(time, time)
        self._course.state(time, out)
        self._check(out[np.newaxis])

    def states(self, times, out):
        """Fill out, shape (n, 14), with the states at n times (s).

        Raises
        ------
        BadInput
            A time before the start, or not finite.
        NotConverged
            With the time and the cause; also where the body turns so often that doubles no longer
            carry a part of a turn.
        """
        times = np.asarray(times, dtype=float)
        if len(times):
            self._within(float(times.min()), float(times.max()))
            self._course.states(times, out)
            self._check(out)

    def many(self, starts, times, out):
        """Fill out, shape (bodies, n, 14), with the states of many bodies at n times (s).

        The bodies start from `starts`, shape (bodies, 14); all cores take part. Where the family
        of the method has a batch mode (LANES), bodies are solved side by side in the vector unit,
        else one by one.

        Raises
        ------
        BadInput, NotConverged
            As `states`; the message begins with the number of the body.
        """
        def one_by_one(part):
            for body in range(part.start, part.stop):
                with _naming(body):
                    self.start(starts[body]).states(times, out[body])

        def side_by_side(part):
            failed = batch.run(starts[part], out[part])
            if failed:
                with _naming(part.start + failed[0]):
                    raise lost(self.method, self.scene, failed[1])
            for body in range(part.start, part.stop) if self._carried else ():
                with _naming(body):
                    self._check(out[body])

        batch = None
        if self.method.FAMILY.LANES and len(times) and not self._may_wind:
            batch = self.method.FAMILY.batch(self._bound, self, times)
        if batch is None:
            on_all_cores(one_by_one, len(starts))
            return
        begins = starts[:, TIME]
        with np.errstate(over='ignore'):    # from such a rate no later time is reached
            x2, y2, z2 = np.square(starts[:, ANGULAR_VELOCITY].T)
            rates = np.sqrt(x2 + y2 + z2)
        first, last = float(times.min()), float(times.max())
        for body in np.flatnonzero((first < begins) | (last > _latest(begins, rates))):
            with _naming(body):
                self.start(starts[body])._within(first, last)
        on_all_cores(side_by_side, len(starts), 16 * LANES)
        for body in self._unclear(starts, rates):
            if self._growth(starts[body]):    # side by side bodies go in no stretches
                one_by_one(slice(body, body + 1))

    def _check(self, rows):
        """Raise if a state is beyond what doubles hold.

        So may be a pivot that moves, for which nothing is solved, and a body that is followed in
        steps of one size, which no error makes smaller: its energy counts, too.
        """
        if not self._may_leave_doubles or np.abs(rows).max() < MODEST:
            return
        finite = np.isfinite(rows).all(axis=1)
        if self.step is not None:
            diagnoses = np.empty((len(rows), DIAGNOSIS_SIZE))
            energies(self.scene).diagnose_many(self._mechanics, rows, diagnoses)
            finite &= np.isfinite(diagnoses).all(axis=1)
        if not finite.all():
            raise lost(self.method, self.scene, rows[~finite, TIME].min())

    def _within(self, first, last):
        """Raise unless the times from the first to the last can be reached."""
        if self.begin <= first <= last <= self._latest:
            return
        if not (first >= self.begin and math.isfinite(last)):
            raise BadInput('time', f'asked from {first!r} to {last!r} s',
                           f'finite times from the start, {self.begin!r} s, on')
        rate = hypot3(*self.vector[ANGULAR_VELOCITY].tolist())
        raise NotConverged(
            f'{self.method.NAME} on {self.scene.name}: at t = {self.begin!r} s the '
            f'body turns with {rate!r} rad/s; until {last!r} s that is more radians '
            'than doubles can count', self._latest
        )

    def events(self, after, until, tick=0.0):
        """Return the (time, name, values) of what happens after one time (s) and up to another.

        They are in order of time. A solver only goes forward: later calls ask for later times.
        Where events crowd within a `tick` (s), the rest of it may be passed over (events.py).
        """
        if self._course.TELLS_EVENTS:
            return self._course.events(after, until)
        if self._watcher is None:
            self._watcher = Watcher(self, watches(self.scene), float(self.vector[TIME]),
                                    swing_rate(self.scene), drive(self.scene, self.wrench),
                                    self._course.step_at if unbounded(self.scene) else None)
        return [event for event in self._watcher.events(until, tick) if event[0] > after]

    def allowance(self, until):
        """Return (error, since) as Solver.allowance does (protocols.py): on a plane only."""
        on_plane = self.scene.constraint.mechanism is Mechanism.PLANE
        return self._course.allowance(until) if on_plane else None

    def step_ends(self, until, most):
        """Return the times (s) after the start and before another at which steps or kinks end.

        None stands for more than `most` of them. Of a course that tells events there are none.
        """
        course = self._course
        if course.TELLS_EVENTS:
            return []
        kinks, found, time = [*course.kinks(until), math.inf], [], self.begin
        while len(found) <= most:
            time = min(course.step_at(time)[1], kinks[bisect.bisect_right(kinks, time)])
            if not time < until:
                return found
            found.append(time)
        return None

    def entries(self, time):
        """Return the ledger's entries from the start to a time, shape (5,), longer on a plane.

        mechanics/ledger.py has their layout. Raises what `states` raises.
        """
        time = float(time)
        self._within(time, time)
        if self._bound.KEEPS_ENTRIES:
            return self._course.entries(time)
        actors = self._ledger.actors
        if not actors.acts:
            return np.zeros(ENTRIES_SIZE)
        if self._quadrature is None:
            slack = min(SLACK * self.accuracy, self.wanted) if self.step is None else 0.0
            self._quadrature = Quadrature(actors, self._course.states, self.vector, slack,
                                          self._course.kinks)
        return self._quadrature.until(self._course.entries_until(time) if self._departs else time)


def _check_control(method, accuracy, step):
    """Raise BadInput unless a method can take this accuracy and step."""
    if accuracy is None and step is None:
        raise BadInput('method', 'got neither accuracy nor step', 'give one of them')
    if step is not None and not (math.isfinite(step) and step > 0.0):
        raise BadInput('step', f'got {step!r}', 'seconds, a positive number')
    if accuracy is not None and not (math.isfinite(accuracy) and accuracy >= FINEST):
        raise BadInput('accuracy', f'got {accuracy!r}',
                       f'at least {FINEST!r}, what doubles carry')
    if step is None and 'accuracy' not in method.TAKES:
        raise BadInput('step', f'{method.NAME} does not control its error, it needs a step',
                       'give a step, in seconds')
    if step is not None and 'step' not in method.TAKES:
        raise BadInput('step', f'got {step!r}, but {method.NAME} chooses its own steps',
                       'give an accuracy and no step')


def _latest(begin, rate):
    """Return the time after which a body has turned by more radians than doubles can count."""
    return begin + 1.0 / (ULP * rate + LEAST)


@contextlib.contextmanager
def _naming(body):
    """Begin the message of a NotConverged with the number of the body."""
    try:
        yield
    except NotConverged as error:
        raise NotConverged(f'body {body}: {error}', error.time) from None
