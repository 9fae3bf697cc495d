# SPDX-License-Identifier: Apache-2.0
"""The work of one worker: some runs of a plan, computed on one core.

Each run has the bits that ``ensemble`` gives it alone, whichever runs stand beside it. A run that
fails is NaN, with its status and a line that says why; the others go on.
"""

import functools
import math
import re
import threading
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.choice.measured import HALF_ULP
from rigid_body_sim.compilation.threads import one_core
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.mechanics.bounds import drive, swing_momentum, swing_rate
from rigid_body_sim.mechanics.ledger import balance
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import (
    ANGULAR_VELOCITY,
    AXES,
    ORIENTATION,
    PLACES,
    STATE_SIZE,
    States,
)
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.sweeps import plan as plans
from rigid_body_sim.sweeps.quantities import QUANTITIES, diagnosis

RATE = 1000.0
"""Ticks per second of runs that need a Simulation, those of scenes with strikes."""
PIECE_BYTES = 2**23
"""Size of the states that are computed before results are taken from them."""
ALONE = 4
"""If a method gives up, runs are halved down to this number, then taken one by one."""
TOLERATED = 2.0 * np.finfo(float).eps
"""Deviation from 1 of the square of a quaternion's norm that unit_quaternion leaves as it is."""


class Run:
    """One run as a function of the user's own sees it.

    Attributes
    ----------
    number : int
    values : dict
        Key of the scene -> its value in this run.
    states : States
        At the times of the sweep.
    """

    def __init__(self, number, values, states, plan, choice, start):
        self.number, self.values, self.states = number, values, states
        self._plan, self._choice, self._start = plan, choice, start

    def at(self, times) -> States:
        """Return the States at any times, s, which the sweep need not list."""
        if self._choice is None:
            return self.simulation.states(times)
        times = np.ascontiguousarray(times, dtype=float).reshape(-1)
        out = np.empty((1, len(times), STATE_SIZE))
        self._choice.many(self._start[np.newaxis], times, out)
        return States(out[0])

    @functools.cached_property
    def simulation(self) -> Simulation:
        """A Simulation of this run, at its start."""
        return _simulation(self._plan, self.number)


@dataclass
class Block:
    """The results of some runs.

    Attributes
    ----------
    first, stop : int
        The runs: from `first` up to `stop`.
    arrays : dict of str to array (n, ...)
        By the names of the plan's variables.
    values : dict of str to array (n, ...) or list
        Of the keys; empty where nobody asked for them.
    texts : dict of int to str
        Number of a run that failed -> why.
    """

    first: int
    stop: int
    arrays: dict
    values: dict
    texts: dict


def room(plan, count):
    """Return (arrays, states): memory for the results of this many runs.

    Where all of the states is kept, the arrays of its parts are views of `states`, shape
    (runs, times, 14), and nothing is copied; else `states` is None.
    """
    states, parts = None, {}
    whole = tuple(AXES)
    for one in plan.spec.keep:
        at = {'states': slice(None), 'final': 0}.get(one.kind)
        if at is None or one.what != whole or (one.kind == 'final' and len(plan.spec.times) > 1):
            continue
        if states is None:
            states = np.empty((count, len(plan.spec.times), STATE_SIZE))
        prefix = '' if one.kind == 'states' else 'final_'
        parts.update({prefix + part: states[:, at, PLACES[part]] for part in whole})
    arrays = {one.name: parts[one.name] if one.name in parts else
              np.empty((count, *one.shape), one.dtype) for one in plan.variables}
    return arrays, states


def compute(plan, first, stop, into=None, values=False):
    """Return the Block of the runs from `first` up to `stop`.

    Parameters
    ----------
    plan : Plan
    first, stop : int
    into : tuple, optional
        Where the results go: what :func:`room` returns.
    values : bool
        Whether the Block is to have the values of the keys too.
    """
    arrays, states = into or room(plan, stop - first)
    texts, step = {}, max(1, PIECE_BYTES // plan.working_bytes)
    if states is not None:
        step = stop - first     # nothing is taken from them
    for begin in range(first, stop, step):
        end = min(begin + step, stop)
        at = slice(begin - first, end - first)
        block = Block(begin, end, {name: array[at] for name, array in arrays.items()},
                      plan.values(begin, end), texts)
        with one_core():
            _Work(plan, block, None if states is None else states[at]).run()
    return Block(first, stop, arrays, plan.values(first, stop) if values else {}, texts)


_OWN = threading.local()


def _scratch(name, shape):
    """Return an array that the next call in this thread takes again: fresh memory is slow."""
    size = math.prod(shape)
    kept = vars(_OWN).get(name)
    if kept is None or len(kept) < size:
        vars(_OWN)[name] = kept = np.empty(size)
    return kept[:size].reshape(shape)


class _Work:
    """The computation of one block."""

    def __init__(self, plan, block, states):
        self.plan, self.block, self.states = plan, block, states
        self.values = block.values

    def run(self):
        """Compute the runs in groups: those of one scene, whose starts alone differ."""
        count = self.block.stop - self.block.first
        if not self.plan.slow:
            self.group(slice(0, count), count)
            return
        if any(key in self.plan.spec.sample for key in self.plan.slow):
            groups = [np.array([place]) for place in range(count)]
        else:
            places = self.plan.places(self.block.first, self.block.stop)
            shape = tuple(self.plan.dims[key] for key in self.plan.slow)
            codes = np.ravel_multi_index([places[key] for key in self.plan.slow], shape)
            order = np.argsort(codes, kind='stable')
            groups = np.split(order, np.flatnonzero(np.diff(codes[order])) + 1)
        for group in groups:
            self.group(_slice_of(group), len(group))

    def value(self, key, place):
        """Return the value of a key in the run of a place, as overrides take it."""
        value = self.values[key][place]
        return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value

    def scene(self, place, keys):
        """Return the scene of the run of a place with the values of some keys.

        The other keys have the values of the template.
        """
        overrides = {key: self.value(key, place) for key in keys}
        if not overrides:
            return self.plan.template
        return parse_scene(self.plan.template.text, overrides, f'run {self.block.first + place}')

    def group(self, where, count):
        """Compute runs that differ from each other in direct keys alone."""
        place = where.start if isinstance(where, slice) else int(where[0])
        if count == 1 or not self.plan.direct:
            self.one_by_one(where)
            return
        try:
            scene = self.scene(place, self.plan.slow)
        except BadInput:
            # the template's start may not suit these parameters, so all keys of each run are read
            self.one_by_one(where)
            return
        if not self.starts_alone_differ(scene):
            self.one_by_one(where)
            return
        starts = _scratch('starts', (count, STATE_SIZE))
        starts[:] = scene.initial.vector
        good = True
        for key, part in self.plan.direct.items():
            values = self.values[key]
            values = values[where] if isinstance(values, np.ndarray) else \
                np.array([values[k] for k in np.arange(self.size)[where]], dtype=float)
            values = values.reshape(count, -1)
            if key == plans.SPIN:
                values = values * (0.0, 0.0, 1.0)
            elif part == ORIENTATION:
                values, unit = _units(values)
                good = good & unit
            finite = np.isfinite(values)
            if not finite.all():
                good = good & finite.all(axis=1)
            starts[:, part] = values
        if not np.all(good):
            places = np.arange(self.size)[where]
            self.one_by_one(places[~good])
            where, starts = places[good], starts[good]
        if len(starts):
            self.many(scene, starts, where)

    def starts_alone_differ(self, scene):
        """Return whether runs of a scene differ in their starts alone."""
        return (self.plan.starts_alone_differ if scene is self.plan.template else
                plans.starts_alone_differ(scene, self.plan.spec.integrator))

    @property
    def size(self):
        """The number of runs of the block."""
        return self.block.stop - self.block.first

    def one_by_one(self, where):
        """Compute runs each of which is a scene of its own."""
        for place in np.arange(self.size)[where].tolist():
            alone = slice(place, place + 1)
            try:
                scene = self.scene(place, self.values)
            except BadInput as error:
                self.fail(alone, plans.REFUSED, error)
                continue
            self.many(scene, scene.initial.vector[np.newaxis].copy(), alone)

    def many(self, scene, starts, where):
        """Compute runs of one scene from some starts."""
        spec = self.plan.spec
        if any(effect.as_impulse is not None for effect in scene.effects):
            self.struck(where)
            return
        in_place = self.states is not None and isinstance(where, slice)
        out = self.states[where] if in_place else \
            _scratch('states', (len(starts), len(spec.times), STATE_SIZE))
        try:
            method = self.plan.choice if scene is self.plan.template else spec.integrator
            found = ensemble(scene, starts, spec.times, method, spec.accuracy, out=out,
                             events=bool({'first', 'all'} & self.plan.wants),
                             horizon=self.plan.horizon)
        except (NotConverged, BadInput) as error:
            if len(starts) == 1:
                status = plans.REFUSED if isinstance(error, BadInput) else plans.GAVE_UP
                self.fail(where, status, re.sub(r'^body 0: ', '', str(error)))
                return
            places = np.arange(self.size)[where]
            step = 1 if len(starts) <= ALONE else -(-len(starts) // 2)
            for begin in range(0, len(starts), step):
                part = places[begin:begin + step]
                self.many(scene, starts[begin:begin + step], _slice_of(part))
            return
        (choice, _), = found.choices
        self.keep(scene, choice, starts, out, found.events, where)

    def struck(self, where):
        """Compute runs whose scene has strikes, each by a Simulation."""
        times = self.plan.spec.times
        for place in np.arange(self.size)[where].tolist():
            alone = slice(place, place + 1)
            try:
                simulation = _simulation(self.plan, self.block.first + place)
                states = simulation.states(times).vector[np.newaxis]
                if {'first', 'all', 'residuals'} & self.plan.wants:
                    simulation.advance(round(float(times[-1]) * simulation.rate))
                events = [simulation.events]
            except (NotConverged, BadInput) as error:
                self.fail(alone, plans.REFUSED if isinstance(error, BadInput) else plans.GAVE_UP,
                          error)
                continue
            self.keep(simulation.scene, simulation.choice,
                      simulation.scene.initial.vector[np.newaxis], states, events, alone,
                      simulation)

    def keep(self, scene, choice, starts, states, events, where, struck=None):
        """Store the kept results of some runs in the arrays.

        Parameters
        ----------
        scene : Scene
        choice : Choice
        starts : array (n, 14)
        states : array (n, times, 14)
        events : list of list of Event, or None
        where : slice or array of int
            The places of the runs in the block.
        struck : Simulation, optional
            Of the only run, whose scene has strikes; it is at the last time.
        """
        arrays, spec = self.block.arrays, self.plan.spec
        found = residuals = None
        if any(QUANTITIES[one.what].diagnosed for one in spec.keep
               if one.kind in ('minimum', 'maximum')):
            found = diagnosis(energies(scene), parameters(scene), states)
        if 'residuals' in self.plan.wants:
            residuals = [struck.ledger()] if struck else \
                _residuals(scene, choice, starts, states[:, -1], float(spec.times[-1]))
        for one in spec.keep:
            if one.kind in ('final', 'states'):
                at, prefix = (-1, 'final_') if one.kind == 'final' else (slice(None), '')
                for part in one.what:
                    array = arrays[prefix + part]
                    # the parts of states that were computed in place are there
                    if not np.may_share_memory(array, states):
                        array[where] = states[:, at, PLACES[part]]
            elif one.kind in ('first', 'all'):
                self.keep_events(one, events, where)
            elif one.kind in ('minimum', 'maximum'):
                values = QUANTITIES[one.what].of(states, found)
                name = f'{one.kind}_{plans.word(one.what)}'
                arrays[name][where] = (values.min if one.kind == 'minimum' else values.max)(axis=1)
            elif one.kind == 'residuals':
                for name in ('energy_residual', 'momentum_residual'):
                    arrays[name][where] = [balanced[name] for balanced in residuals]
        arrays['status'][where] = plans.DONE
        arrays['method'][where] = plans.METHOD_NAMES.index(choice.method)
        arrays['tolerance'][where] = math.nan if choice.tolerance is None else choice.tolerance
        alone = self.starts_alone_differ(scene)
        arrays['expected_error'][where] = _expected(choice, scene, starts, alone)
        # an overflow shows at the start or grows with time
        if not np.isfinite(states[:, ::max(1, states.shape[1] - 1)]).all():
            places = np.arange(self.size)[where]
            for k in np.flatnonzero(~np.isfinite(states).all(axis=(1, 2))).tolist():
                self.fail(slice(places[k], places[k] + 1), plans.NOT_FINITE,
                          f'run {self.block.first + places[k]}: the states are not finite')
        if 'function' in self.plan.wants:
            self.keep_functions(None if struck else choice, starts, states, where)

    def keep_events(self, one, events, where):
        """Store the times of an event in the arrays."""
        arrays, word = self.block.arrays, plans.word(one.what)
        for place, told in zip(np.arange(self.size)[where].tolist(), events, strict=True):
            times = [event.time for event in told if event.name == one.what]
            if one.kind == 'first':
                arrays[f'first_{word}'][place] = times[0] if times else math.nan
                continue
            row = arrays[f'all_{word}'][place]
            row[:] = math.nan
            row[:len(times)] = times[:one.most]
            arrays[f'{word}_count'][place] = len(times)

    def keep_functions(self, choice, starts, states, where):
        """Store the results of the user's functions in the arrays."""
        arrays = self.block.arrays
        for k, place in enumerate(np.arange(self.size)[where].tolist()):
            if arrays['status'][place] != plans.DONE:
                continue
            run = Run(self.block.first + place,
                      {key: self.value(key, place) for key in self.values},
                      States(states[k].copy()), self.plan, choice, starts[k].copy())
            for name, outputs in self.plan.outputs.items():
                try:
                    told = returned(name, self.plan.spec.functions[name](run))
                    if [(key, _size(value)) for key, value in told.items()] != \
                            [tuple(output) for output in outputs]:
                        raise ValueError(f'returned {told!r}, not as in the other runs')
                    for key, value in told.items():
                        arrays[key][place] = value
                except Exception as error:
                    # an error in a user's function affects this run alone
                    self.fail(slice(place, place + 1), plans.FUNCTION_FAILED,
                              f'{name}: {type(error).__name__}: {error}')

    def fail(self, where, status, problem):
        """Note that the runs of some places failed."""
        for one in self.plan.variables:
            self.block.arrays[one.name][where] = one.fill
        self.block.arrays['status'][where] = status
        text = ' '.join(str(problem).split())
        for place in np.arange(self.size)[where].tolist():
            self.block.texts[self.block.first + place] = text


def _slice_of(places):
    """Return places as a slice where they follow each other: that copies nothing."""
    first, last = int(places[0]), int(places[-1])
    return slice(first, last + 1) if last - first + 1 == len(places) else places


def _units(values):
    """Return quaternions as scene.initial.unit_quaternion does, and which of them have a norm."""
    x, y, z, w = values.T
    with np.errstate(over='ignore', invalid='ignore', divide='ignore'):
        square = x * x + y * y + z * z + w * w
        unit = np.abs(square - 1.0) <= TOLERATED
        if unit.all():
            return values, True
        size = np.abs(values).max(axis=1)
        good = (size > 1e-100) & (size < 1e100)    # the others are scaled first: one by one
        divisor = np.where(unit, 1.0, np.sqrt(square))
        return values / divisor[:, np.newaxis], good


def _expected(choice, scene, starts, alone):
    """Return the error of the attitude to expect of each start, rad; NaN where none is known.

    `alone` says whether runs of the scene may differ in their starts alone.
    """
    if choice.expected_error is None:
        return math.nan
    if choice.method != 'exact' or not alone:
        return choice.expected_error
    # as choose has it for one start: half an ulp of all the angle turned, to which torque adds
    x, y, z = starts[:, ANGULAR_VELOCITY].T
    horizon = choice.horizon
    turned = np.sqrt(x * x + y * y + z * z)
    turned += swing_rate(scene)
    turned *= horizon
    turned += 4.0 + 0.5 * drive(scene, None) * horizon * horizon
    turned *= HALF_ULP
    return turned


def _residuals(scene, choice, starts, ends, time):
    """Return the ledger's balance of each run, from its start to its end (time, s)."""
    kernels, p = energies(scene), parameters(scene)
    before, after = (diagnosis(kernels, p, np.ascontiguousarray(states))
                     for states in (starts, ends))
    swing = swing_momentum(scene)
    return [balance(before[k], after[k], choice.solver(start, Wrench()).exchanged(time), swing)
            for k, start in enumerate(starts)]


def _simulation(plan, run):
    """Return the Simulation of one run, of which the last time is a tick."""
    spec = plan.spec
    rate = math.ceil(plan.horizon * RATE) / plan.horizon
    return Simulation(plan.scene_of(run), spec.integrator, spec.accuracy, rate,
                      horizon=plan.horizon)


def returned(name, value):
    """Return what a function returned as name -> number or array, its own name for a bare one."""
    if isinstance(value, dict):
        return {plans.word(str(key)): np.asarray(one, dtype=float) for key, one in value.items()}
    short = plans.word(name.rpartition(':')[2].rpartition('.')[2])
    return {short: np.asarray(value, dtype=float)}


def _size(value):
    """Return the length of an array, None of a number."""
    if value.ndim > 1:
        raise ValueError(f'returned an array of shape {value.shape}; a number or a row is kept')
    return len(value) if value.ndim else None


def outputs_of(plan):
    """Return what each function of a plan gives: name -> [(variable, length or None)].

    Raises
    ------
    BadInput
        The function fails on the template's run.
    """
    found = {}
    for name, function in plan.spec.functions.items():
        simulation = _simulation(plan, plan.template_run)
        run = Run(plan.template_run, plan.overrides(plan.template_run),
                  simulation.states(plan.spec.times), plan, None,
                  simulation.scene.initial.vector)
        try:
            told = returned(name, function(run))
            found[name] = [(key, _size(value)) for key, value in told.items()]
        except Exception as error:
            raise BadInput(f'keep: function {name}', f'fails on run {plan.template_run} '
                           f'({type(error).__name__}: {error})',
                           'a function of one Run that returns a number, a row of numbers or a '
                           'dict of them') from error
    return found
