"""Stepped: a scene followed step by step, as a solver.

    solver = Stepped(scene, method='dop8', accuracy=1e-12, wrench=Wrench(torque=(0.0, 0.0, 0.1))).start(vector)
    solver.state(time, out)        # out (14,)
    solver.states(times, out)      # out (n, 14), any order of times, none before the start
    solver.exchanged(time)         # array (5,), rigid_body_sim/exchange.py: work, heat, angular impulse since the start

Give `accuracy` (step control) or `step` (fixed steps; it goes before). A state does not depend on which other times were asked. Strikes of
the scene are the business of rigid_body_sim/simulation.py, which starts a solver anew after each.
"""

import math

import numpy as np

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.exchange import EXCHANGE_SIZE
from rigid_body_sim.integrators import METHODS, dop8, power_series, runnable, scipy_methods, table, track
from rigid_body_sim.integrators.adaptive import TIME as NODE_TIME
from rigid_body_sim.integrators.adaptive import VALUES
from rigid_body_sim.mechanics import drive, swing_rate
from rigid_body_sim.specialise import specialise
from rigid_body_sim.state import ANGULAR_VELOCITY, STATE_SIZE, TIME
from rigid_body_sim.watches import Watcher, watches

CHECKPOINTS = 128       # of a march: how many are kept
FINEST = 1e-15          # accuracy below this is not in the doubles
ULP = float(np.finfo(float).eps)
ONLY = np.zeros(1, dtype=np.intp)    # the order of a single time


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
        started.vector = np.array(vector, dtype=float)
        started._course = self._plain.course(started)
        started._booked_course = started._course if self._with_books is self._plain else None
        started._watcher = None
        return started

    def state(self, time, out):
        """Fill out, shape (14,), with the state at a time (s)."""
        self.states(np.array([time]), out[np.newaxis])

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
        if len(times) and math.isfinite(last := times.max()):
            begin, speed = float(self.vector[TIME]), math.hypot(*self.vector[ANGULAR_VELOCITY].tolist())
            if speed * (float(last) - begin) * ULP > 1.0:
                raise NotConverged(f'{self.method.NAME} on {self.scene.name}: at t = {begin!r} s the body turns with {speed!r} rad/s; '
                                   f'until {float(last)!r} s that is more radians than doubles can count')
        self._course.states(times, out)

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
        """Return what commands and effects exchanged with the body from the start to a time, shape (5,)."""
        if not self._plain.acts:
            return np.zeros(EXCHANGE_SIZE)
        if self._booked_course is None:
            if self._with_books is None:
                self._with_books = self._bind(books=True)
            self._booked_course = self._with_books.course(self)
        row = np.empty((1, STATE_SIZE + EXCHANGE_SIZE))
        self._booked_course.states(np.array([time]), row)
        return row[0, STATE_SIZE:]


class _Bound:
    """The kernels of one method on the equations of one scene kind."""

    def __init__(self, stepped, books):
        # power series keep no books
        method = dop8 if books and stepped.method.FAMILY is power_series else stepped.method
        family = method.FAMILY
        self.equations = equations = family.equations(stepped.scene, stepped.wrench, books)
        self.acts = equations.acts
        self.march = family.march(method, equations, stepped.step is None)
        self._prototype = family.begin(stepped, self.march)
        shared = {name: f'{self.march.__name__}:{name}' for name in ('begin', 'march', 'between', 'SIZE', 'VALUES')}
        shared |= {name: f'{equations.kernels.__name__}:{name}' for name in ('start', 'write')}
        self.track = specialise(track, **shared)

    def course(self, stepped):
        """Return the course of a started solver."""
        return _Course(stepped, self)

    def arrays(self, p):
        """Return the arrays of a piece with the parameters p: what track.py fills and follows."""
        control, node = self._prototype
        return p, control.copy(), node.copy(), np.empty(len(node)), np.empty((CHECKPOINTS, len(node))), np.empty(3, dtype=np.intp)


class _Course:
    """One march from a start: a piece for each stretch between breakpoints, made when it is reached."""

    def __init__(self, stepped, bound):
        self._stepped, self._bound = stepped, bound
        equations = bound.equations
        self._begin = float(stepped.vector[TIME])
        self._ends = [time for time in equations.breakpoints if time > self._begin] + [math.inf]
        p, *rest = first = bound.arrays(equations.held(self._begin))
        bound.track.first_piece(p, stepped.vector, *rest)
        self._pieces = [first]

    def _next_piece(self, begin):
        """Return the piece that begins where the last one ends."""
        p, _, reached, *_ = self._pieces[-1]
        piece = self._bound.arrays(self._bound.equations.continued(p, begin))
        values = slice(VALUES, VALUES + self._bound.march.SIZE)
        node = piece[2]
        node[NODE_TIME], node[values] = begin, reached[values]
        self._bound.track.piece(*piece)
        return piece

    def states(self, times, out):
        """Fill out with the states at times."""
        if len(times) == 0:
            return
        order = np.argsort(times, kind='stable') if len(times) > 1 else ONLY
        first, last = times[order[0]], times[order[-1]]
        if not (first >= self._begin and math.isfinite(last)):
            raise BadInput('time', f'asked from {first!r} to {last!r} s', f'finite times from the start, {self._begin!r} s, on')
        bound, done, k = self._bound, 0, 0
        while done < len(order):
            end = self._ends[k]
            until = len(order) if last < end else int(np.searchsorted(times[order], end, side='left'))
            piece = self._pieces[k]
            filled = done + bound.track.states(*piece, times, order[done:until], end, out)
            self._check(filled == until, piece)
            done, k = until, k + 1
            if done < len(order) and k == len(self._pieces):
                self._check(bound.track.follow(*piece, end, end), piece)
                self._pieces.append(self._next_piece(end))

    def _check(self, good, piece):
        if not good:
            method, scene = self._stepped.method.NAME, self._stepped.scene.name
            raise NotConverged(f'{method} on {scene}: at t = {float(piece[2][NODE_TIME])!r} s the state is no longer finite, '
                               'or the step fell below what the clock resolves')
