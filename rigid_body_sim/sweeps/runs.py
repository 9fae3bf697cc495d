# SPDX-License-Identifier: Apache-2.0
"""The runs of a plan: one worker computes some of them, on one core.

Each run has the bits that ``ensemble`` gives it alone, whichever runs stand beside it. A run that
fails is NaN, with its status and a line that says why; the others go on.
"""

import math
import re
import threading

import numpy as np

from rigid_body_sim.compilation.threads import one_core
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.schema import LARGEST
from rigid_body_sim.scene.state import ORIENTATION, STATE_SIZE
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.sweeps import plan as plans
from rigid_body_sim.sweeps.functions import simulation_of
from rigid_body_sim.sweeps.results import Block, Results, room

PIECE_BYTES = 2**23
"""Size of the states that are computed before results are taken from them."""
ALONE = 4
"""If a method gives up, runs are halved down to this number, then taken one by one."""
TOLERATED = 2.0 * np.finfo(float).eps
"""Deviation from 1 of the square of a quaternion's norm that unit_quaternion leaves as it is."""


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
    """Return an array that later calls in this thread use again: fresh memory is slow."""
    size = math.prod(shape)
    kept = vars(_OWN).get(name)
    if kept is None or len(kept) < size:
        vars(_OWN)[name] = kept = np.empty(size)
    return kept[:size].reshape(shape)


class _Work:
    """The computation of one block."""

    def __init__(self, plan, block, states):
        self.plan, self.block, self.states = plan, block, states
        self.values, self.results = block.values, Results(plan, block)

    def run(self):
        """Compute the runs in groups: those of one scene, whose starts alone differ."""
        count = self.block.size
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

    def scene(self, place, keys):
        """Return the scene of the run of a place with the values of some keys.

        The other keys have the values of the template.
        """
        overrides = {key: self.block.value(key, place) for key in keys}
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
        if not self.plan.differs_in_starts_alone(scene):
            self.one_by_one(where)
            return
        starts = _scratch('starts', (count, STATE_SIZE))
        starts[:] = scene.initial.vector
        good = True
        for key, part in self.plan.direct.items():
            values = self.values[key]
            if isinstance(values, np.ndarray):
                values = values[where].reshape(count, -1)
            else:
                width = 1 if key == plans.SPIN else part.stop - part.start
                values, rows = _rows([values[k] for k in self.block.places(where)], width)
                good = good & rows
            good = good & (np.abs(values) <= LARGEST).all(axis=1)    # a scene takes no others
            if key == plans.SPIN:
                values = np.concatenate([np.zeros((count, 2)), values], axis=1)
            elif part == ORIENTATION:
                values, unit = _units(values)
                good = good & unit
            starts[:, part] = values
        if not np.all(good):
            places = self.block.places(where)
            self.one_by_one(places[~good])
            where, starts = places[good], starts[good]
        if len(starts):
            self.many(scene, starts, where)

    def one_by_one(self, where):
        """Compute runs each of which is a scene of its own."""
        for place in self.block.places(where).tolist():
            alone = slice(place, place + 1)
            try:
                scene = self.scene(place, self.values)
            except BadInput as error:
                self.results.fail(alone, plans.REFUSED, error)
                continue
            self.many(scene, scene.initial.vector[np.newaxis].copy(), alone)

    def many(self, scene, starts, where):
        """Compute runs of one scene from some starts."""
        spec = self.plan.spec
        if scene.strikes:
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
                self.results.fail(where, _status_of(error), re.sub(r'^body 0: ', '', str(error)))
                return
            places = self.block.places(where)
            step = 1 if len(starts) <= ALONE else -(-len(starts) // 2)
            for begin in range(0, len(starts), step):
                part = places[begin:begin + step]
                self.many(scene, starts[begin:begin + step], _slice_of(part))
            return
        (choice, _), = found.choices
        self.results.keep(scene, choice, starts, out, found.events, where)

    def struck(self, where):
        """Compute runs whose scene has strikes, each by a Simulation."""
        times = self.plan.spec.times
        for place in self.block.places(where).tolist():
            alone = slice(place, place + 1)
            try:
                simulation = simulation_of(self.plan, self.block.first + place)
                states = simulation.states(times).vector[np.newaxis]
                if {'first', 'all', 'residuals'} & self.plan.wants:
                    simulation.advance(round(float(times[-1]) * simulation.rate))
                events = [simulation.events]
            except (NotConverged, BadInput) as error:
                self.results.fail(alone, _status_of(error), error)
                continue
            scene = simulation.scene
            self.results.keep(scene, simulation.choice, scene.initial.vector[np.newaxis], states,
                              events, alone, simulation)


def _status_of(error):
    return plans.REFUSED if isinstance(error, BadInput) else plans.GAVE_UP


def _slice_of(places):
    """Return places as a slice where they follow each other: that copies nothing."""
    first, last = int(places[0]), int(places[-1])
    return slice(first, last + 1) if last - first + 1 == len(places) else places


def _rows(values, width):
    """Return a list of values as an array (n, width), and which of them are so many numbers.

    The others are zero there: what a scene says of them is left to it.
    """
    rows, good = np.zeros((len(values), width)), np.zeros(len(values), bool)
    for k, value in enumerate(values):
        value = value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value
        row = value if isinstance(value, list) and width > 1 else [value]
        # a whole number may be beyond the largest double
        good[k] = len(row) == width and all(
            type(one) in (int, float) and -LARGEST <= one <= LARGEST for one in row)
        if good[k]:
            rows[k] = row
    return rows, good


def _units(values):
    """Return quaternions as scene.initial.unit_quaternion does, and which of them have a norm."""
    x, y, z, w = values.T
    with np.errstate(over='ignore', invalid='ignore', divide='ignore'):
        square = x * x + y * y + z * z + w * w
        unit = np.abs(square - 1.0) <= TOLERATED
        if unit.all():
            return values, True
        size = np.abs(values).max(axis=1)
        good = size > 1e-100    # the others are scaled first: one by one
        divisor = np.where(unit, 1.0, np.sqrt(square))
        return values / divisor[:, np.newaxis], good
