# SPDX-License-Identifier: Apache-2.0
"""The results of the runs of a sweep: what is kept of states and events, or why a run failed."""

import math
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.choice.rounding import of_bodies
from rigid_body_sim.mechanics.bounds import passed
from rigid_body_sim.mechanics.energy import POTENTIAL
from rigid_body_sim.mechanics.ledger import balance
from rigid_body_sim.mechanics.parameters import parameters
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import AXES, PLACES, STATE_SIZE, States
from rigid_body_sim.sweeps import plan as plans
from rigid_body_sim.sweeps.functions import Run, length_of, returned
from rigid_body_sim.sweeps.quantities import QUANTITIES, diagnosis


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
        Values of the keys; empty where nobody asked for them.
    texts : dict of int to str
        Number of a run that failed -> why.
    """

    first: int
    stop: int
    arrays: dict
    values: dict
    texts: dict

    @property
    def size(self):
        """The number of its runs."""
        return self.stop - self.first

    def places(self, where):
        """Return the places in the block that a slice or an array selects, an array."""
        return np.arange(self.size)[where]

    def value(self, key, place):
        """Return the value of a key in the run of a place, as overrides take it."""
        value = self.values[key][place]
        return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


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


class Results:
    """The arrays of one block as its runs fill them.

    Parameters
    ----------
    plan : Plan
    block : Block
    """

    def __init__(self, plan, block):
        self.plan, self.block = plan, block

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
        alone = self.plan.differs_in_starts_alone(scene)
        arrays['expected_error'][where] = _expected(choice, scene, starts, alone)
        # an overflow shows at the start or grows with time
        if not np.isfinite(states[:, ::max(1, states.shape[1] - 1)]).all():
            places = self.block.places(where)
            for k in np.flatnonzero(~np.isfinite(states).all(axis=(1, 2))).tolist():
                self.fail(slice(places[k], places[k] + 1), plans.NOT_FINITE,
                          f'run {self.block.first + places[k]}: the states are not finite')
        if 'function' in self.plan.wants:
            self.keep_functions(None if struck else choice, starts, states, where)

    def keep_events(self, one, events, where):
        """Store the times of an event in the arrays."""
        arrays, word = self.block.arrays, plans.word(one.what)
        for place, told in zip(self.block.places(where).tolist(), events, strict=True):
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
        for k, place in enumerate(self.block.places(where).tolist()):
            if arrays['status'][place] != plans.DONE:
                continue
            run = Run(self.block.first + place,
                      {key: self.block.value(key, place) for key in self.block.values},
                      States(states[k].copy()), self.plan, choice, starts[k].copy())
            for name, outputs in self.plan.outputs.items():
                try:
                    told = returned(name, self.plan.spec.functions[name](run))
                    if [(key, length_of(value)) for key, value in told.items()] != \
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
        for place in self.block.places(where).tolist():
            self.block.texts[self.block.first + place] = text


def _expected(choice, scene, starts, alone):
    """Return the error of the attitude to expect of each start, rad; NaN where none is known.

    `alone` says whether runs of the scene may differ in their starts alone.
    """
    if choice.settled is None:    # a method that was named: no trial is made for each run
        return math.nan
    if choice.method != 'exact' or not alone:
        return choice.expected_error
    return of_bodies(scene, choice.many, starts, choice.horizon)


def _residuals(scene, choice, starts, ends, time):
    """Return the ledger's balance of each run, from its start to its end (time, s)."""
    kernels, p = energies(scene), parameters(scene)
    before, after = (diagnosis(kernels, p, np.ascontiguousarray(states))
                     for states in (starts, ends))
    potentials = np.maximum(*(np.abs(rows[:, POTENTIAL]) for rows in (before, after))).tolist()
    return [balance(before[k], after[k], choice.solver(start, Wrench()).entries(time),
                    passed(scene, time, potentials[k])) for k, start in enumerate(starts)]
