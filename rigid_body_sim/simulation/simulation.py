# SPDX-License-Identifier: Apache-2.0
"""Simulation: a scene in motion, tick by tick or at any times, with commands.

::

    from rigid_body_sim import Simulation
    simulation = Simulation('tennis_racket')
    simulation.advance(1000)
    print(simulation.state.angular_velocity)
    print(simulation.states([10.0, 20.0, 5.0]).orientation)
"""

import copy
import dataclasses
import functools
import html
import math
import typing

import numpy as np

from rigid_body_sim.choice.choice import HORIZON
from rigid_body_sim.choice.choose import choose, methods_for
from rigid_body_sim.choice.forecast import missed
from rigid_body_sim.errors import BadInput, Ended, NotConverged
from rigid_body_sim.mechanics import energy, impulse, parameters
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.mechanics.bounds import passed
from rigid_body_sim.mechanics.ledger import balance, entries_size, most
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.scene import yaml_text
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import Overrides, Scene, changed_scene, load_scene
from rigid_body_sim.scene.state import STATE_SIZE, TIME, State, States
from rigid_body_sim.simulation.admission import (
    Given,
    admit,
    no_motion_follows,
    refusals,
    scene_refuses,
)
from rigid_body_sim.simulation.checks import (
    TIMES,
    doubles,
    number_of_ticks,
    refuse_no_number,
    refuse_start,
)
from rigid_body_sim.simulation.command_rows import (
    HOLD,
    IMPULSE,
    LET_GO,
    WIDTH,
    row_of,
    wrench_of,
)
from rigid_body_sim.simulation.spans import (
    Event,
    Span,
    events_between,
    states_at,
    wrenches_at,
)
from rigid_body_sim.simulation.strikes import Strikes

LOOKS = 1024  # parts of the time ahead in which at_event looks first
KEPT = (
    'tick', 'events', 'departed', '_vector', '_arrived', '_origin', '_origin_time', '_beginning',
    '_initial', '_commands', '_told_end',
)
"""Attributes that a copy or a pickle takes over unchanged."""
NOTHING_HELD = Wrench()
STARTS = 'a State, or 14 numbers'


class Simulation:
    """A scene that runs.

    Parameters
    ----------
    scene : Scene, str or path
        A scene, the name of one that ships, or the path of a .yaml file.
    integrator : str
        A method of ``rigid_body_sim.integrators.METHODS``, ``exact`` or ``auto``.
    accuracy : float
        Error of the attitude (rad) that is asked for; closed forms give the round-off floor
        whatever is asked.
    rate : float
        Ticks per second, for :meth:`advance`.
    step : float, optional
        Fixed step of the method, s, instead of step control.
    horizon : float
        Duration over which the accuracy is asked for, s; 100 by default.
    settled : choice.settling.Settled, optional
        What `auto` chose in an earlier run (choice.choose).
    overrides : mapping of str to value, or sequence of str
        Changes of the scene: ``{'body.mass': 2.0}``, or lines ``body.mass=2.0``.

    Attributes
    ----------
    tick : int
        Ticks so far; it never falls, not even by :meth:`reset`.
    events : list of Event
        The events so far.
    departed : float or None
        The time (s) from which on the motion is not the one that `choice` made its forecast for:
        that of the first command, or 0 after a restart from another start; None before.
    watching : bool
        Whether :meth:`advance` looks for events; True. Without it, a jump costs the same however
        much happens on the way.

    Raises
    ------
    BadInput
        By name and value, before anything runs.
    """

    def __init__(
        self,
        scene,
        integrator: str = 'auto',
        accuracy: float = 1e-12,
        rate: float = 1000.0,
        step: float | None = None,
        horizon: float = HORIZON,
        settled: tuple | None = None,
        overrides=(),
    ):
        if not isinstance(scene, Scene):
            scene = load_scene(scene, overrides)
        elif overrides:
            scene = changed_scene(scene, overrides)
        self.scene = scene
        for name, value in ('accuracy', accuracy), ('rate', rate), ('horizon', horizon):
            refuse_no_number(name, value)
        if step is not None:
            refuse_no_number('step', step)
        if not (math.isfinite(rate) and rate > 0.0):
            raise BadInput('rate', f'got {rate!r}', 'ticks per second, a positive number')
        self.rate = float(rate)
        self.integrator, self.accuracy = integrator, accuracy
        self._chosen = choose(self.scene, integrator, accuracy, step, horizon, settled)
        self.choice = self._chosen
        self.tick = 0
        self.events, self.watching = [], True
        self._vector = np.empty(STATE_SIZE)
        self._mechanics = parameters.parameters(self.scene)
        self._energies = energies(self.scene)
        self._diagnosis = np.empty(energy.DIAGNOSIS_SIZE)
        self._nothing_given = np.zeros(entries_size(self.scene))
        self._strikes = Strikes(self.scene, self._mechanics)
        self._begin(self.choice, self.scene.initial.vector, 0)
        if self.method != 'exact':    # a method that steps may find that it cannot begin
            self._arrive()

    @functools.cached_property
    def _dynamics(self):
        return Dynamics(self.scene)

    def restart(self, initial) -> 'Simulation':
        """Begin anew at tick 0 from another state, for loops over starts; return this simulation.

        Commands, held wrench and events are forgotten; the scene's strikes come again. In closed
        form what follows has the bits of a new Simulation of the scene with that start. Otherwise
        the chosen method and tolerance stay, without a new trial.

        Parameters
        ----------
        initial : State or array (14,)
            It is taken as it is, like the starts of :func:`ensemble`, so it has to satisfy the
            constraint. Its time is ignored.

        Raises
        ------
        BadInput
            Another shape, numbers that are not finite, an orientation that is not a unit
            quaternion, more energy than a double holds. The simulation stays as it was.
            Whether the motion can be followed from there shows with the first state asked for.
        """
        start = doubles('restart', getattr(initial, 'vector', initial), STARTS).copy()
        if start.shape != (STATE_SIZE,):
            raise BadInput('restart', f'got a shape of {start.shape}', STARTS)
        start[TIME] = 0.0
        choice = self._choice_from(start) if self._chosen.rests_on_start else self.choice
        self._begin(choice, start, 0)
        self.events = []
        return self

    def runner(self):
        """Return a function ``run(start, time, out)``, for loops over starts.

        It fills `out`, shape (14,), with the state at a time (s) that a simulation begun at
        `start`, an array (14,), would have: the bits of :meth:`restart` and then :meth:`states`,
        where the start is at time 0. It is the quickest way to one state: under a microsecond for
        short runs, half of one where the same two arrays come each time. This simulation stays as
        it is. Like the starts of :func:`ensemble`, a start is taken as it is, with its own time,
        and the strikes of the scene are left out. Calls may not overlap: each thread makes a
        runner of its own.
        """
        if not self._chosen.rests_on_start:
            return self._chosen.runner()

        def run(start, time, out):
            self._choice_from(start).solver(start, NOTHING_HELD).state(time, out)
        return run

    def _choice_from(self, start):
        """Return the Choice for the scene from a state (14 doubles) on."""
        first = self._chosen
        if not first.rests_on_start or start.tolist() == self.scene.initial.vector.tolist():
            return first
        scene = dataclasses.replace(self.scene, initial=State(start.copy()))
        return choose(scene, self.integrator, self.accuracy, first.step, first.horizon)

    def with_(self, changes: Overrides = (), /, **more) -> 'Simulation':
        """Return a simulation of this scene with other values, at tick 0, for loops over scenes.

        Settings stay. Where `auto` chose a method that can run the changed scene, and no closed
        form does, its choice stays too: no trial is made, and `choice.expected_error` is that of
        this scene.

        Parameters
        ----------
        changes : mapping of str to value, or sequence of str
            As the `overrides` of a Simulation: ``simulation.with_({'body.mass': 2.0})``.
        **more
            Keys without a dot: ``simulation.with_(constraint='free')``.

        Raises
        ------
        BadInput
            What a Simulation of the changed scene raises.
        """
        lines = (*yaml_text.assignments(changes), *yaml_text.assignments(more))
        scene, choice, settled = changed_scene(self.scene, lines), self._chosen, None
        if self.integrator == 'auto' and choice.method != 'exact':
            methods = methods_for(scene)
            if choice.method in methods and 'exact' not in methods:
                settled = choice.settled
        return Simulation(
            scene, self.integrator, self.accuracy, self.rate, choice.step, choice.horizon, settled
        )

    def follow(self, previous, keep_state):
        """Begin at the present tick of another simulation instead of at 0, before anything else.

        With `keep_state`, for another method, accuracy or rate on the same scene: state, time,
        held wrench and ledger go on from there. Without it, for another scene: only the tick
        counter goes on.
        """
        self.tick = previous.tick
        self._restart()
        if not keep_state:
            return
        if self.rate == previous.rate:
            self._origin, self._origin_time = previous._origin, previous._origin_time
        else:
            self._origin_time = previous.time
        self._initial = previous._initial
        span, now = previous._spans[-1], previous.time
        given = span.given + span.solver.entries(now)
        self._spans = [self._span(now, previous.vector.copy(), span.wrench, span.strikes, given,
                                  most(span.passed, given))]
        self._arrive()

    def _restart(self):
        self._begin(self.choice, self._beginning, self.tick)

    def _begin(self, choice, start, tick):
        """Begin at a tick and time 0 from a state (14 doubles), or raise and change nothing."""
        diagnosis = np.empty(energy.DIAGNOSIS_SIZE)
        fault = self._energies.diagnose_start(self._mechanics, start, diagnosis)
        if fault:
            refuse_start(self.scene.name, fault, start, diagnosis)
        solver = choice.solver(start, NOTHING_HELD)
        spans = [Span(0.0, solver, NOTHING_HELD, 0, self._nothing_given, start)]
        if self.scene.strikes:
            spans = self._strikes.follow(spans, 0.0, choice)
        self._arrived, self._diagnosed_tick = False, None
        self.choice, self.tick, self._beginning = choice, tick, start
        own = self.scene.initial.vector    # the choice of the scene holds for its own start only
        elsewhere = (choice is self._chosen and start is not own
                     and start.tobytes() != own.tobytes())
        self.departed = 0.0 if elsewhere else None
        self._origin, self._origin_time = tick, 0.0
        self._initial = diagnosis
        self._spans, self._commands, self._foreseen = spans, None, NOTHING_FORESEEN
        self._told_end = False

    def _span(self, time, start, wrench, strikes, given, passed):
        """Return a Span from a state (14 doubles) on."""
        return Span(time, self.choice.solver(start, wrench), wrench, strikes, given, start, passed)

    def copy(self) -> 'Simulation':
        """Return an independent simulation at the same tick, which goes on with the same bits.

        What a stepped method has computed is not copied: the copy steps it again when it is
        asked for.
        """
        return copy.deepcopy(self)

    __copy__ = copy

    def __reduce__(self):
        choice = self._chosen
        made = (
            self.scene,
            self.integrator,
            self.accuracy,
            self.rate,
            choice.step,
            choice.horizon,
            choice.settled,
        )
        spans = [
            (span.time, span.start, span.wrench, span.strikes, span.given, span.passed)
            for span in self._spans
        ]
        return _restored, (made, spans, {name: getattr(self, name) for name in KEPT})

    @property
    def time(self) -> float:
        """Simulated time since the start or the last reset, s: ticks over rate, never a sum."""
        return self.time_at(self.tick)

    def time_at(self, tick):
        """Return the simulated time of a tick since the start or the last reset, s."""
        return self._origin_time + (tick - self._origin) / self.rate

    @property
    def vector(self) -> np.ndarray:
        """The present state, shape (14,), whose parts `state` names.

        It changes with the next call, so copy what you keep (or take :attr:`state`).
        """
        if not self._arrived:
            self._arrive()
        return self._vector

    @property
    def state(self) -> State:
        """The present State."""
        return State(self.vector.copy())

    @property
    def method(self) -> str:
        """Name of the method that solves the present motion.

        It is the one of `choice`, unless a command or a strike has led to a motion or a held
        wrench that another method solves.
        """
        return self._spans[-1].solver.name

    @property
    def expected_error(self) -> float | None:
        """Largest error of the attitude that is expected within the horizon, rad.

        None where nothing is known: of fixed steps, where a strike or a jump of a torque comes
        later than trial runs go, and after a command, since no trial has seen what it does to the
        motion. `choice.expected_error` is that of the scene. Trial runs tell it when it is first
        asked for: of a method that was named, too.
        """
        if self.departed is not None:
            return None
        error, allowed = self.choice.expected_error, self._allowed
        return max(error or 0.0, allowed[0]) if allowed else error

    @property
    def _allowed(self):
        """The (error, since) that the first solver has allowed itself so far, or None.

        integrators/protocols.py: Solver.allowance.
        """
        ends = [span.time for span in self._spans[1:]]
        found = (span.solver.allowance(end)
                 for span, end in zip(self._spans, [*ends, self.time], strict=True))
        return next(filter(None, found), None)

    @property
    def missed(self) -> str | None:
        """One line that says that the accuracy asked is missed and until when it is met; or None.

        After a command it says what was missed before, or what the run itself tells.
        """
        line, allowed = self.choice.missed, self._allowed
        if line and (self.departed is None or self.choice.met_until < self.departed):
            return line
        return missed(self.choice.accuracy, self.choice.horizon, *allowed) if allowed else None

    def advance(self, ticks: int = 1) -> None:
        """Go on by a number of ticks; events on the way are appended to `events`.

        Parameters
        ----------
        ticks : int
            Zero or more. Time never goes back: :meth:`states` gives earlier states.

        Raises
        ------
        BadInput
            Any other value. The simulation stays where it was, as after any other error but this:
        NotConverged
            The motion cannot be followed that far. The simulation stands at the last tick that
            it can reach; `events` has those up to there, and `end` where the run ends so.
        """
        before, tick = self.time, self.tick
        self.tick = tick + number_of_ticks('advance', ticks, self.tick)
        commands, self._commands = self._commands, None
        foreseen = self._foreseen
        place = self.tick - foreseen.tick
        if foreseen.spans is self._spans and 0 <= place < len(foreseen.vectors):
            self._vector[:] = foreseen.vectors[place]
            self._arrived, self._diagnosed_tick = True, None
            return
        spans = self._spans
        try:
            self._arrive()
            if self.watching:
                self._note_events(self._spans, before, self.time)
        except BaseException as error:
            self.tick, self._spans, self._commands = tick, spans, commands
            self._arrive()
            if isinstance(error, NotConverged):
                raise self._go_to_last_tick(error) from None
            raise

    def advance_through(self, ticks: int) -> States:
        """Go on by a number of ticks and return the States at all of them.

        They have the bits of the states that :meth:`advance` meets one by one. There are `ticks`
        of them, or as many as come before the run ends.

        Raises
        ------
        BadInput
            As :meth:`advance`.
        NotConverged
            As :meth:`advance`, where not even the next tick can be reached.
        """
        ticks = number_of_ticks('advance_through', ticks, self.tick)
        first = self.tick + 1
        try:
            states = self.states(self.time_at(np.arange(first, first + ticks)))
        except NotConverged as error:
            found = self._go_to_last_tick(error)
            if self.tick < first:
                raise found from None
            return self.states(self.time_at(np.arange(first, self.tick + 1)))
        self.advance(ticks)
        return states

    def _go_to_last_tick(self, error):
        """Go to the last tick before a NotConverged, and note the events up to the end.

        Return the NotConverged of the tick after it, or the one given where nothing was asked of
        that tick.
        """
        before, reached, beyond = self.time, self.tick, self._tick_after(error.time)
        tick = beyond - 1    # the first guess: rounding, or a march that overshot, may miss it
        while reached + 1 < beyond:
            refused = self._go_if_reached(tick)
            if refused is None:
                reached = tick
            else:
                beyond, error = tick, refused
            tick = (reached + beyond) // 2
        self._arrive()
        if self.watching and not self._told_end:
            self._note_events(self._spans, before, self.time)
            if isinstance(error, Ended):
                self._note_events(self._spans_until(error.time), self.time, math.inf)
                self._told_end = True
        return error

    def _go_if_reached(self, tick):
        """Go to a later tick, or stay and return the NotConverged where it cannot be reached."""
        kept = self.tick, self._spans, self._commands
        self.tick, self._commands = tick, None
        try:
            self._arrive()
        except NotConverged as error:
            self.tick, self._spans, self._commands = kept
            return error
        return None

    def _tick_after(self, time):
        """Return the first tick after the present one that is after a time (s) or None."""
        if time is None or not self.time < time < math.inf:
            return self.tick + 1
        tick = self._origin + math.floor((time - self._origin_time) * self.rate)
        while self.time_at(tick) <= time:
            tick += 1
        return max(tick, self.tick + 1)

    def foresee(self, ticks: int) -> States:
        """Return the States at the next ticks without going there.

        They have the bits of the states that :meth:`advance` meets if no command comes.

        There are `ticks` of them, or as many as come before the tick of the next event. They are
        kept: to advance to one of them costs nothing more.
        """
        ticks = number_of_ticks('foresee', ticks, self.tick)
        times = self.time_at(np.arange(self.tick + 1, self.tick + ticks + 1))
        if not ticks:
            return self.states(times)
        spans = self._spans_until(times[-1])
        event = next(self._events_between(spans, self.time, times[-1], self.tick + ticks), None)
        states = self.states(
            times if event is None else times[: max(event.tick - self.tick - 1, 0)]
        )
        self._foreseen = _Foreseen(spans, self.tick + 1, states.vector.copy())
        return states

    def diagnose(self, states):
        """Return energies (J) and L^2 of States, two arrays of shape (n,)."""
        out = np.empty((len(states), energy.DIAGNOSIS_SIZE))
        self._energies.diagnose_many(self._mechanics, states.vector, out)
        return out[:, energy.KINETIC] + out[:, energy.POTENTIAL], out[
            :, energy.MOMENTUM_SQUARED
        ].copy()

    def states(self, times) -> States:
        """Return the States at any times (s, any order) from the last :meth:`forget_past` on.

        Those after the present are as if no command came.

        Raises
        ------
        BadInput
            What is no time or no row of times; a time before the first one kept, or not finite.
        """
        times = doubles('states', times, TIMES).reshape(-1)
        if not len(times):
            return States(np.empty((0, STATE_SIZE)))
        if len(times) == 1:    # reductions take longer than a short run
            first = last = times.item()
        else:
            first, last = times.min(), times.max()    # NaN if one is
        if not (first >= self._spans[0].time and last < math.inf):
            raise BadInput(
                'states',
                f'got times from {float(first)!r} to {float(last)!r} s',
                f'finite times from {self._spans[0].time!r} s on',
            )
        spans = self._spans_until(last)
        return States(states_at(spans, times))

    def at_event(self, name: str, within: float = HORIZON) -> State:
        """Return the State at the next event of a name, without going there.

        Parameters
        ----------
        name : str
            ``flip``, ``rolling began``, ...: the names that :attr:`events` shows. At ``end`` it is
            the last state there is.
        within : float
            How far to look ahead, s.

        Raises
        ------
        BadInput
            No such event comes within that time; those that come are named.
        """
        refuse_no_number('within', within)
        if not 0.0 < within < math.inf:
            raise BadInput('within', f'got {within!r}', 'a positive number of seconds')
        now, reach = self.time, within / LOOKS
        while True:
            try:
                spans = self._spans_until(now + reach)
            except Ended as error:    # on the way to a later strike
                spans = self._spans_until(error.time)
            found = list(self._events_between(spans, now, now + reach, math.inf))
            for event in found:
                if event.name == name:
                    return self._state_at(event, spans[-1])
            if reach >= within:
                names = ', '.join(sorted({event.name for event in found}))
                raise BadInput(
                    'at_event',
                    f'no {name!r} within {within:g} s',
                    f'in that time come: {names}'
                    if names
                    else 'no event comes in that time: a later one needs a larger `within`',
                )
            reach = min(2.0 * reach, within)

    def _state_at(self, event, last):
        """Return the State at an event; `last` is the span of an `end`."""
        try:
            return self.states([event.time])[0]
        except Ended as error:
            if error.time == last.time:    # what the strike leaves is the last state
                return State(last.start.copy())
            return self.states([error.time])[0]

    def impulse(self, force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0), frame='world'):
        """Strike the body at the present tick: an impulse of force and one of torque.

        The force (N s) acts at the centre of mass; the torque is in N m s.

        Impulses of one tick are added before they act, so opposite ones cancel to the last bit.

        Raises
        ------
        BadInput
            Non-finite numbers, an unknown frame, a scene that refuses commands, a torque about an
            axis of zero moment, a command after which no motion follows (the run would end at the
            present tick, as in Painleve's paradox).
        """
        self._command_one(row_of(IMPULSE, force, torque, frame))

    def hold(self, force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0), frame='world'):
        """Hold a force and a torque from the present tick on, until the next hold or release.

        The force (N) acts at the centre of mass; the torque is in N m.

        The hold is continuous and solved at the accuracy asked: the same commands lead to the same
        state at any rate. In the body's frame the axes turn with the body. The same errors as for
        :meth:`impulse`.
        """
        self._command_one(row_of(HOLD, force, torque, frame))

    def release(self) -> None:
        """Release the held wrench at the present tick; the same errors as for :meth:`impulse`."""
        self.command(LET_GO)

    def _command_one(self, row):
        for refusal in self.command(row):
            raise refusal.error

    def command(self, rows):
        """Apply commands at the present tick, in order.

        The bits are those of commands given one by one, but the state is computed once.

        Parameters
        ----------
        rows : array (n, 8)
            See command_rows.py.

        Returns
        -------
        list of admission.Refusal
            The commands that are not taken, for the same reasons as in :meth:`impulse`; they have
            no effect. If no motion follows all of them together, they are taken one by one.
        """
        rows = np.ascontiguousarray(rows, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != WIDTH:
            raise BadInput(
                'command',
                f'got an array of shape {rows.shape}',
                f'rows of {WIDTH} numbers (command_rows.py)',
            )
        if not self.scene.accepts_commands:
            return scene_refuses(self.scene.name, len(rows))
        if self._commands is None:
            self._commands = _Commands(len(self._spans), self.wrench, Given.at(self.vector))
        commands = self._commands
        given = commands.given.copy()
        verdicts, amounts = np.empty(len(rows), np.int64), np.empty(len(rows))
        last, refused = admit(self._mechanics, self.rate, rows, *given, verdicts, amounts)
        wrench = wrench_of(rows[last]) if last >= 0 else commands.wrench
        try:
            self._settle(commands._replace(wrench=wrench, given=given))
        except NotConverged as error:
            if len(rows) == 1:
                return [no_motion_follows(rows[0], error)]
            return [refusal._replace(place=place) for place, row in enumerate(rows)
                    for refusal in self.command(row[np.newaxis])]
        return refusals(verdicts, amounts, rows, given.start) if refused else []

    @property
    def wrench(self) -> Wrench:
        """The Wrench that is held now; all zero if none is."""
        return self._spans[-1].wrench

    def reset(self) -> None:
        """Reset the state to the one at the start, without commands; ticks go on."""
        self._restart()
        self.events.append(Event(self.tick, self.time, 'reset', {}))

    def forget_past(self) -> None:
        """Drop what is needed for :meth:`states` before the present.

        A simulation that takes commands for days calls it now and then.
        """
        if self._commands is None:
            self._spans = self._spans_until(self.time)[-1:]

    @property
    def acceleration(self):
        """The (linear, angular) acceleration at the present.

        The first is of the body's origin (world axes, m/s^2), the second is omega' (body axes,
        rad/s^2).

        Exact, by the balance of forces (rigid_body_sim/mechanics/balance.py), with the held
        wrench; an impulse has none.
        """
        balance = self._dynamics.balance(self.vector, self.wrench)
        return balance.acceleration, balance.angular_acceleration

    def reactions(self, times):
        """Return what the constraint exerts on the body at times (s), as balance.Reactions.

        Force (N) and torque (N m) in world axes; the torque about `point` (m, world): the fixed
        point (torque 0), the point `through` of a hinge, the point of contact with the table
        (torque 0).

        The reaction to a strike or an impulse is an impulse too, and is not among these.

        Raises
        ------
        BadInput
            A free body; times as in :meth:`states`.
        """
        if self.scene.constraint.mechanism is Mechanism.FREE:
            raise BadInput(
                'reactions',
                f'nothing holds the body of {self.scene.name}',
                'a scene with a pivot, a hinge or a table',
            )
        states = self.states(times)
        spans = self._spans_until(states.time.max()) if len(states) else []
        return self._dynamics.reactions(states.vector, wrenches_at(spans, states.time))

    @property
    def energy(self) -> float:
        """Kinetic plus potential energy of the present state, J."""
        return float(self._diagnose()[energy.KINETIC] + self._diagnosis[energy.POTENTIAL])

    @property
    def angular_momentum_squared(self) -> float:
        """L . L about the point of reference (mechanics/parameters.py), (kg m^2/s)^2."""
        return float(self._diagnose()[energy.MOMENTUM_SQUARED])

    def ledger(self) -> dict[str, float]:
        """Return the balance of energy (J) and angular momentum, a dict of floats.

        It runs from the start or the last reset on; see ledger.balance.
        """
        span = self._spans[-1]
        given, now = span.given + span.solver.entries(self.time), self._diagnose()
        potential = max(abs(float(row[energy.POTENTIAL])) for row in (self._initial, now))
        on_the_way = map(max, span.passed, passed(self.scene, self.time, potential))
        return balance(self._initial, now, given, tuple(on_the_way))

    def _diagnose(self):
        if self._diagnosed_tick != (self.tick, len(self._spans)):
            self._energies.diagnose(self._mechanics, self.vector, self._diagnosis)
            self._diagnosed_tick = (self.tick, len(self._spans))
        return self._diagnosis

    def _arrive(self):
        """Evaluate the present state."""
        time = self.time
        self._spans = self._spans_until(time)
        self._spans[-1].solver.state(time, self._vector)
        self._arrived, self._diagnosed_tick = True, None

    def _note_events(self, spans, before, now):
        """Append the events after `before` up to `now` (s), at most of the present tick."""
        self.events += list(self._events_between(spans, before, now, self.tick))

    def _events_between(self, spans, before, now, last_tick):
        """Yield the events after `before` up to `now` (s), in their order, up to a last tick."""
        for time, name, values in events_between(spans, before, now, 1.0 / self.rate):
            tick = self._origin + math.ceil((time - self._origin_time) * self.rate)
            yield Event(min(tick, last_tick), time, name, values)

    def _spans_until(self, time):
        """Return the spans up to a time, with the scene's strikes on the way."""
        return self._strikes.follow(self._spans, time, self.choice)

    def _settle(self, commands):
        """Begin a new span at the present tick, or none where the commands of the tick cancel.

        Where no motion follows the commands it raises NotConverged, and all stays as it was.
        """
        time, before, given = self.time, self._spans, commands.given
        kept = before[: commands.base]
        last = kept[-1]
        acts = given.any_impulse or commands.wrench != last.wrench
        if acts:
            entries = last.given + last.solver.entries(time)
            if given.any_impulse:
                impulse.add_entries(given.response, entries)
            kept = [
                *kept,
                self._span(time, given.after.copy(), commands.wrench, last.strikes, entries,
                           most(last.passed, entries)),
            ]
        self._spans = kept
        try:
            self._arrive()
        except NotConverged:
            self._spans = before
            self._arrive()
            raise
        self._commands = commands
        if self._told_end:    # an end that was told may not come any more
            self._told_end = False
            self.events[:] = [event for event in self.events if event.time <= time]
        if self.departed == time:
            self.departed = None    # the commands of the tick may cancel
        if acts and self.departed is None:
            self.departed = time

    def __repr__(self):
        return (
            f'<Simulation of {self.scene.name} by {self.method}: tick {self.tick}, '
            f't = {self.time!r} s>'
        )

    def _repr_html_(self):
        ledger = self.ledger()
        rows = {
            'scene': self.scene.name,
            'about': self.scene.about,
            'method': self.method,
            'tick': f'{self.tick}, t = {self.time!r} s',
            'energy': f'{self.energy!r} J',
            'energy residual': f'{ledger["energy_residual"]:.2e}',
            'momentum residual': f'{ledger["momentum_residual"]:.2e}',
        }
        body = ''.join(
            f'<tr><th>{name}</th><td>{html.escape(text)}</td></tr>' for name, text in rows.items()
        )
        return f'<table><tbody>{body}</tbody></table>{self.state._repr_html_()}'


def _restored(made, spans, kept):
    """Return the Simulation that :meth:`Simulation.__reduce__` took apart."""
    simulation = Simulation(*made)
    vars(simulation).update(kept)
    simulation.choice = simulation._choice_from(simulation._beginning)
    simulation._spans = [simulation._span(time, start, *rest) for time, start, *rest in spans]
    return simulation


class _Commands(typing.NamedTuple):
    """The commands of the present tick.

    These are the number of spans before them, the wrench that they leave, and their Given.
    """

    base: int
    wrench: Wrench
    given: Given


class _Foreseen(typing.NamedTuple):
    """States that were computed ahead: their spans, the tick of the first one, their vectors.

    No event falls among them.
    """

    spans: list
    tick: int
    vectors: object


NOTHING_FORESEEN = _Foreseen(None, 0, ())
