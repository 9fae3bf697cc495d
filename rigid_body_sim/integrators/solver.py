"""Stepped: a scene followed step by step, as a solver.

    solver = Stepped(scene, method='dop8', accuracy=1e-12, wrench=Wrench(torque=(0.0, 0.0, 0.1))).start(vector)
    solver.state(time, out)        # out (14,)
    solver.states(times, out)      # out (n, 14), any order of times, none before the start
    solver.exchanged(time)         # array (5,), rigid_body_sim/mechanics/exchange.py: work, heat, angular impulse since the start

Give `accuracy` (step control) or `step` (fixed steps; it goes before). A state does not depend on which other times were asked. Strikes of
the scene are the business of rigid_body_sim/simulation/simulation.py, which starts a solver anew after each.
"""

import bisect
import contextlib
import math

import numpy as np

from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.compilation.threads import on_all_cores
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators import METHODS, runnable
from rigid_body_sim.integrators.events import Watcher, watches
from rigid_body_sim.integrators.families import power_series, scipy_methods
from rigid_body_sim.integrators.marching import batch, table, track
from rigid_body_sim.integrators.marching.adaptive import TIME as NODE_TIME
from rigid_body_sim.integrators.marching.adaptive import VALUES
from rigid_body_sim.integrators.methods import dop8
from rigid_body_sim.mechanics.bounds import drive, swing_rate
from rigid_body_sim.mechanics.exchange import EXCHANGE_SIZE
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, STATE_SIZE, TIME

FINEST = 1e-15          # accuracy below this is not in the doubles
ULP = float(np.finfo(float).eps)
LEAST = 1e-300          # keeps a quotient finite
FOR_EVER = (math.inf,)


class Stepped:
    """Solve a scene by a one-step method.

    Parameters
    ----------
    scene : Scene
    method : str
        A name of ``rigid_body_sim.integrators.METHODS``.
    accuracy : float, optional
        Error of the attitude (rad), and of omega relative to its largest size, that may build up in `horizon`, where the motion itself
        does not magnify it. It says nothing where `step` is given.
    step : float, optional
        Fixed step, s.
    wrench : effects.wrench.Wrench, optional
        Held all the time.
    horizon : float
        s.

    Raises
    ------
    BadInput
        By name and value, before anything runs.
    """

    def __init__(self, scene, method, accuracy=None, step=None, wrench=None, horizon=100.0):
        if accuracy is None and step is None:
            raise BadInput('method', 'got neither accuracy nor step', 'give one of them')
        if step is not None and not (math.isfinite(step) and step > 0.0):
            raise BadInput('step', f'got {step!r}', 'seconds, a positive number')
        if accuracy is not None and not (math.isfinite(accuracy) and accuracy >= FINEST):
            raise BadInput('accuracy', f'got {accuracy!r}', f'at least {FINEST!r}, what doubles carry')
        self.scene, self.method, self.wrench = scene, METHODS[method], wrench
        if step is None and 'accuracy' not in self.method.TAKES:
            raise BadInput('step', f'{method} does not control its error, it needs a step', 'give a step, in seconds')
        if step is not None and 'step' not in self.method.TAKES:
            raise BadInput('step', f'got {step!r}, but {method} chooses its own steps', 'give an accuracy and no step')
        self.accuracy, self.step, self.horizon = accuracy, step, horizon
        # what a command does is always asked for: one march for both, and half to compile
        one_march = bool(wrench) and scene.constraint.kind != 'table' and self.method.FAMILY is not scipy_methods
        self._plain = self._bind(books=one_march)
        self._with_books = self._plain if one_march else None

    def _bind(self, books):
        if self.scene.constraint.kind == 'table':
            if self.method.NAME not in runnable(self.scene):
                raise BadInput('integrator', f'{self.method.NAME!r} cannot run a ball on the table under a wrench',
                               f'those that can: {", ".join(runnable(self.scene))}')
            return table.OnTable(self.scene, self.method, self.wrench, self.step)
        if self.method.FAMILY is scipy_methods:
            return scipy_methods.Bound(self, books)
        return _Bound(self, books)

    def start(self, vector):
        """Return a solver from a state vector (14 doubles, its time included)."""
        started = object.__new__(Stepped)
        started.__dict__.update(self.__dict__)
        started.vector = vector = np.array(vector, dtype=float)
        started._begin, _, _, _, _, wx, wy, wz, *_ = vector.tolist()
        started._latest = _latest(started._begin, hypot3(wx, wy, wz))
        started._course = self._plain.course(started)
        started._booked_course = started._course if self._with_books is self._plain else None
        started._watcher = None
        return started

    def state(self, time, out):
        """Fill out, shape (14,), with the state at a time (s); it raises what `states` does."""
        time = float(time)
        self._within(time, time)
        self._course.state(time, out)

    def states(self, times, out):
        """Fill out, shape (n, 14), with the states at n times (s).

        Raises
        ------
        BadInput
            A time before the start, or not finite.
        NotConverged
            With the time and the cause; also where the body turns so often that doubles no longer carry a part of a turn.
        """
        times = np.asarray(times, dtype=float)
        if len(times):
            self._within(float(times.min()), float(times.max()))
            self._course.states(times, out)

    def many(self, starts, times, out):
        """Fill out, shape (bodies, n, 14), with the states at n times (s) from many starts, shape (bodies, 14), on all cores.

        taylor has a mode of its own for it, batch.py, where there is no drag; else the bodies are taken one by one.

        Raises
        ------
        BadInput, NotConverged
            As `states`; what did not converge is told with the number of the body.
        """
        def one_by_one(part):
            for body in range(part.start, part.stop):
                with _naming(body):
                    self.start(starts[body]).states(times, out[body])

        def eight_by_eight(part):
            failed = together.run(starts[part], out[part])
            if failed:
                with _naming(part.start + failed[0]):
                    raise _lost(self.method, self.scene, failed[1])

        plain = self._plain.equations if self.method.FAMILY is power_series else None
        if not (plain and self.step is None and len(times) and not plain.dragged):
            on_all_cores(one_by_one, len(starts))
            return
        begins, squares = starts[:, TIME], starts[:, ANGULAR_VELOCITY] ** 2
        rates = np.sqrt(squares[:, 0] + squares[:, 1] + squares[:, 2])
        for body in np.flatnonzero((times.min() < begins) | (times.max() > _latest(begins, rates))):
            with _naming(body):
                self.start(starts[body])._within(float(times.min()), float(times.max()))
        together = batch.Batch(plain, self.accuracy / self.horizon, times)
        on_all_cores(eight_by_eight, len(starts), 4 * LANES)

    def _within(self, first, last):
        """Raise unless the times from the first to the last can be reached."""
        if self._begin <= first <= last <= self._latest:
            return
        if not (first >= self._begin and math.isfinite(last)):
            raise BadInput('time', f'asked from {first!r} to {last!r} s', f'finite times from the start, {self._begin!r} s, on')
        raise NotConverged(f'{self.method.NAME} on {self.scene.name}: at t = {self._begin!r} s the body turns with '
                           f'{hypot3(*self.vector[ANGULAR_VELOCITY].tolist())!r} rad/s; until {last!r} s that is more radians than '
                           'doubles can count')

    def events(self, after, until, tick=0.0):
        """Return the (time, name, values) of what happens after one time (s) and not later than another, in order; it only goes forward.

        `tick` (s) is for motions in closed form, whose events may crowd: a method that steps has a step or more for each.
        """
        if self.scene.constraint.kind == 'table':
            return self._course.events(after, until)
        if self._watcher is None:
            self._watcher = Watcher(self, watches(self.scene), float(self.vector[TIME]), swing_rate(self.scene),
                                    drive(self.scene, self.wrench))
        return [event for event in self._watcher.events(until) if event[0] > after]

    def exchanged(self, time):
        """Return what commands and effects exchanged with the body from the start to a time, shape (5,); it raises what `states` does."""
        if not self._plain.acts:
            return np.zeros(EXCHANGE_SIZE)
        if self._booked_course is None:
            if self._with_books is None:
                self._with_books = self._bind(books=True)
            self._booked_course = self._with_books.course(self)
        self._within(float(time), float(time))
        row = np.empty(STATE_SIZE + EXCHANGE_SIZE)
        self._booked_course.state(float(time), row)
        return row[STATE_SIZE:]


def _latest(begin, rate):
    """Return the time after which a body has turned by more radians than doubles can count."""
    return begin + 1.0 / (ULP * rate + LEAST)


def _lost(method, scene, time):
    """Return the error of a march that ends at a time (s)."""
    return NotConverged(f'{method.NAME} on {scene.name}: at t = {float(time)!r} s the state is no longer finite, or the step fell below what '
                        'the clock resolves')


@contextlib.contextmanager
def _naming(body):
    """Say in what did not converge which body it is."""
    try:
        yield
    except NotConverged as error:
        raise NotConverged(f'body {body}: {error}') from None


class _Bound:
    """The kernels of one method on the equations of one scene kind."""

    def __init__(self, stepped, books):
        # power series keep no books
        method = dop8 if books and stepped.method.FAMILY is power_series else stepped.method
        family = method.FAMILY
        self.equations = equations = family.equations(stepped.scene, stepped.wrench, books)
        self.acts = equations.acts
        self.march = family.march(method, equations, stepped.step is None)
        control, node = family.begin(stepped, self.march)
        self._beginning, self._prototypes = np.concatenate((control, node)), {}
        places = np.cumsum([equations.parameter_count, len(control), len(node), len(node)]).tolist()
        self.node, self.piece_size = places[1], places[-1] + track.STORE + track.CHECKPOINTS * len(node)
        shared = {name: f'{self.march.__name__}:{name}' for name in ('begin', 'march', 'between', 'SIZE', 'VALUES')}
        shared |= {'start': f'{equations.kernels.__name__}:start', 'write': equations.write}
        shared |= {name: f'{name} = {place}\n' for name, place in zip(('CONTROL', 'NODE', 'FOLLOWING', 'COUNTS'), places, strict=True)}
        self.track = specialise(track, **shared)

    def course(self, stepped):
        """Return the course of a started solver."""
        return _Course(stepped, self)

    def prototype(self, time):
        """Return the beginning of a piece that starts at a time: the parameters that hold there, control, node."""
        k = bisect.bisect_right(self.equations.breakpoints, time)
        if k not in self._prototypes:
            self._prototypes[k] = np.concatenate((self.equations.held(time), self._beginning))
        return self._prototypes[k]


class _Course:
    """One march from a start: a piece for each stretch between breakpoints, made when it is reached."""

    def __init__(self, stepped, bound):
        # the solver itself is not kept: two that hold each other stay in memory until the garbage is collected
        self._method, self._scene, self._begin, self._vector = stepped.method, stepped.scene, stepped._begin, stepped.vector
        self._bound, self._pieces, self._ends = bound, [], FOR_EVER
        if bound.equations.breakpoints:
            self._ends = [time for time in bound.equations.breakpoints if time > self._begin] + [math.inf]

    def _first_piece(self):
        """Return the piece at the start, not filled yet."""
        self._pieces.append(np.empty(self._bound.piece_size))
        return self._bound.prototype(self._begin), self._vector, self._pieces[0]

    def _next_piece(self, begin):
        """Return the piece that begins where the last one ends."""
        bound, before, piece = self._bound, self._pieces[-1], np.empty(self._bound.piece_size)
        prototype = bound.prototype(begin)
        fixed, values = bound.equations.fixed_count, bound.node + VALUES
        piece[:len(prototype)] = prototype
        piece[:fixed], piece[bound.node + NODE_TIME] = before[:fixed], begin
        piece[values:values + bound.march.SIZE] = before[values:values + bound.march.SIZE]
        bound.track.opened(piece)
        return piece

    def state(self, time, out):
        """Fill out with the state at a time not before the start."""
        if not time < self._ends[0]:
            self.states(np.array([time]), out[np.newaxis])
        elif self._pieces:
            self._check(self._bound.track.state(self._pieces[0], time, self._ends[0], out), self._pieces[0])
        else:
            self._check(self._bound.track.first_state(*self._first_piece(), time, self._ends[0], out), self._pieces[0])

    def states(self, times, out):
        """Fill out with the states at times not before the start."""
        order = np.argsort(times, kind='stable')
        bound, last, done, k = self._bound, times[order[-1]], 0, 0
        if not self._pieces:
            bound.track.first_piece(*self._first_piece())
        while done < len(order):
            end = self._ends[k]
            until = len(order) if last < end else int(np.searchsorted(times[order], end, side='left'))
            piece = self._pieces[k]
            filled = done + bound.track.states(piece, times, order[done:until], end, out)
            self._check(filled == until, piece)
            done, k = until, k + 1
            if done < len(order) and k == len(self._pieces):
                self._check(bound.track.follow(piece, end, end), piece)
                self._pieces.append(self._next_piece(end))

    def _check(self, good, piece):
        if not good:
            raise _lost(self._method, self._scene, piece[self._bound.node + NODE_TIME])
