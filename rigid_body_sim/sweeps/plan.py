# SPDX-License-Identifier: Apache-2.0
"""The plan of a sweep: its runs in order, the values of each, and the variables of the result.

Runs are numbered over the dimensions like the elements of an array, the last one fastest. A plan
is made of the spec alone, so that every worker makes the same one.
"""

import functools
import importlib
import json
import math
import re
from dataclasses import dataclass, field

import numpy as np

from rigid_body_sim.choice.choice import HORIZON
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.motions import MOTIONS, absorbing_motion
from rigid_body_sim.motions.nearly import is_exact
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import AXES, PLACES, STATE_SIZE, UNITS
from rigid_body_sim.sweeps.quantities import QUANTITIES, unit_of_key

DONE, GAVE_UP, REFUSED, FUNCTION_FAILED, NOT_FINITE, NOT_RUN = 0, 1, 2, 3, 4, -1
STATUSES = {NOT_RUN: 'not_run', DONE: 'done', GAVE_UP: 'method_gave_up',
            REFUSED: 'scene_refused', FUNCTION_FAILED: 'function_failed',
            NOT_FINITE: 'not_finite'}
METHOD_NAMES = ('exact', *METHODS)
DOUBLE = np.dtype(float)
TRIES = 64
GOLDEN = 0.5 * (5.0 ** 0.5 - 1.0)    # multiples of this number spread evenly
RUN = 'run'
TEXT = 'status_text'
_PLACE = re.compile(r'initial\.(angular_velocity|position|velocity)(?:\.([0-2])|\[([0-2])\])?')
SPIN = 'initial.spin'
_WHOLE = {'initial.orientation': 'orientation', SPIN: 'angular_velocity'}


@dataclass(frozen=True)
class Variable:
    """One array of the result.

    Attributes
    ----------
    name : str
    dims : tuple of str
        Behind those of the runs.
    shape : tuple of int
        Along `dims`.
    dtype : numpy.dtype
    attrs : dict
        Among them ``long_name`` and ``units``.
    """

    name: str
    dims: tuple = ()
    shape: tuple = ()
    dtype: np.dtype = DOUBLE
    attrs: dict = field(default_factory=dict)

    @property
    def fill(self):
        """The value in a run that failed."""
        return math.nan if self.dtype.kind == 'f' else NOT_RUN

    @property
    def bytes(self):
        """Bytes of one run."""
        return self.dtype.itemsize * math.prod(self.shape)


class Plan:
    """The runs of a Spec.

    Parameters
    ----------
    spec : Spec
    outputs : dict, optional
        What :func:`outputs_of` found of each function in `keep`; without it there are no
        variables of functions.

    Attributes
    ----------
    dims : dict of str to int
        The number of values of each dimension.
    template : Scene
        A run of the sweep that is valid; it has all its keys.
    template_run : int
    choice : Choice
        Choice of a method for the template.
    direct : dict of str to slice
        Keys that set places of the start and change nothing else of a scene that
        `starts_alone_differ`.
    horizon : float
        Duration over which the accuracy is asked for: to the last time, s.
    variables : list of Variable

    Raises
    ------
    BadInput
        All of TRIES runs, spread over the sweep, are refused, an event does not exist, or the
        integrator cannot run the scene.
    """

    def __init__(self, spec, outputs=None):
        self.spec = spec
        self._drawn = None
        self.dims = {key: len(values) for key, values in spec.vary.items()}
        if spec.runs:
            self.dims[RUN] = spec.runs
        self.horizon = float(spec.times[-1]) or HORIZON
        self.template, self.template_run = self._template()
        self.choice = choose(self.template, spec.integrator, spec.accuracy, horizon=self.horizon)
        self.direct = _direct_places([*spec.vary, *spec.sample])
        self.slow = [key for key in (*spec.vary, *spec.sample) if key not in self.direct]
        self.wants = {one.kind for one in spec.keep}
        _check_events(spec.keep)
        self.outputs = outputs or {}
        self.variables = _variables(self)

    @functools.cached_property
    def starts_alone_differ(self):
        """Whether runs of the template differ in their starts alone, see starts_alone_differ."""
        return starts_alone_differ(self.template, self.spec.integrator)

    def differs_in_starts_alone(self, scene):
        """Return whether runs of a scene of the plan differ in their starts alone."""
        return (self.starts_alone_differ if scene is self.template else
                starts_alone_differ(scene, self.spec.integrator))

    @property
    def is_quick(self):
        """Whether all runs are states of one scene in closed form, and nothing else is kept."""
        return (self.choice.method == 'exact' and not self.slow and self.starts_alone_differ
                and self.wants <= {'final', 'states', 'minimum', 'maximum'})

    @property
    def bytes(self):
        """Bytes of the result of one run."""
        return sum(one.bytes for one in self.variables)

    @property
    def working_bytes(self):
        """Bytes that computing one run takes: its states at all times, and its result."""
        return len(self.spec.times) * STATE_SIZE * 8 + self.bytes

    def places(self, first, stop):
        """Return the place along each dimension of the runs from `first` up to `stop`."""
        return dict(zip(self.dims, _places(tuple(self.dims.values()), first, stop), strict=True))

    def values(self, first, stop):
        """Return the values of each key at the runs from `first` up to `stop`.

        Returns
        -------
        dict of str to array (n, ...) or list of n values
        """
        places = self.places(first, stop) if self.spec.vary else {}
        found = {}
        for key, values in self.spec.vary.items():
            if isinstance(values, np.ndarray):
                found[key] = values[places[key]]
            else:
                found[key] = [values[place] for place in places[key].tolist()]
        for key, sampled in self.spec.sample.items():
            found[key] = self._samples(key, sampled, first, stop)
        return found

    def drawn(self):
        """Return all samples of each key, array (samples, ...).

        They are drawn once and kept: runs that this process computes take theirs from here.
        """
        if self._drawn is None:
            self._drawn = {key: sampled.of_runs(0, self.spec.runs)
                           for key, sampled in self.spec.sample.items()}
        return self._drawn

    def _samples(self, key, sampled, first, stop):
        runs = self.spec.runs
        if self._drawn is None:
            of_runs = sampled.of_runs
        else:
            def of_runs(begin, end):
                return self._drawn[key][begin:end]
        if stop - first >= runs:
            return of_runs(0, runs)[np.arange(first, stop) % runs]
        begin, end = first % runs, (stop - 1) % runs + 1
        if begin < end:
            return of_runs(begin, end)
        return np.concatenate([of_runs(begin, runs), of_runs(0, end)])

    def overrides(self, run):
        """Return the value of each key at one run, as ``--set`` takes them."""
        return {key: _plain(values[0]) for key, values in self.values(run, run + 1).items()}

    def scene_of(self, run):
        """Return the scene of one run; raises BadInput where it is refused."""
        return parse_scene(self.spec.scene, self.overrides(run), f'run {run}')

    def _template(self):
        size, problem = self.spec.size, None
        for run in dict.fromkeys(int(size * (k * GOLDEN % 1.0)) for k in range(TRIES)):
            try:
                return self.scene_of(run), run
            except BadInput as error:
                problem = problem or error
        raise problem


def _places(shape, first, stop):
    """Return the places along each dimension of the elements from `first` up to `stop`.

    It is numpy.unravel_index of a range, without a division for each element.
    """
    *outer, width = shape
    row, end = first // width, -(-stop // width)
    part = slice(first - row * width, stop - row * width)
    inner = np.tile(np.arange(width), end - row)[part]
    above = _places(outer, row, end) if outer else ()
    return (*(np.repeat(places, width)[part] for places in above), inner)


def starts_alone_differ(scene, integrator):
    """Return whether runs of a scene that differ in direct keys differ in their starts alone.

    This is not so where the constraint computes the start from other numbers, an axis without
    moment refuses a spin, or the choice of a method looks at the start.
    """
    constraint = scene.constraint
    if not constraint.starts_as_given or \
            min(constraint.inertia(scene.body).moments) <= 0.0:
        return False
    if integrator in ('auto', 'exact'):
        motion = absorbing_motion(scene)
        return motion is not None and motion.takes is None and is_exact(motion, scene)
    # whether internal dissipation is stiff depends on the start
    return scene.inner_dissipation == 0.0


def _plain(value):
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


def _direct_places(keys):
    """Return the places of the start that keys set, where each sets its own and no more."""
    found = {}
    for key in keys:
        match = _PLACE.fullmatch(key)
        if match:
            part, digit = PLACES[match[1]], match[2] or match[3]
            found[key] = part if digit is None else \
                slice(part.start + int(digit), part.start + int(digit) + 1)
        elif key in _WHOLE:
            found[key] = PLACES[_WHOLE[key]]
    taken = [place for part in found.values() for place in range(part.start, part.stop)]
    others = [key for key in keys if key.startswith('initial') and key not in found]
    # two keys with one meaning replace each other: such scenes are read one by one
    return found if len(set(taken)) == len(taken) and not others else {}


def _check_events(keep):
    asked = [one for one in keep if one.kind in ('first', 'all')]
    # scenes without a closed form have events of the same names
    known = {name for motion in MOTIONS if asked
             for name in importlib.import_module(motion).EVENTS}
    for one in asked:
        if one.what not in known:
            raise BadInput(f'keep: {one.kind}', f'got {one.what!r}',
                           f'an event: {", ".join(sorted(known))}')


def word(name):
    """Return a name as part of the name of a variable: other characters become ``_``."""
    return re.sub(r'\W+', '_', name)


def _kept(plan, one):
    """Return the Variables of one entry of `keep`."""
    if one.kind == 'final':
        return [Variable(f'final_{part}', (_axis(part),), (len(AXES[part]),), attrs={
            'long_name': f'{part.replace("_", " ")} at the last time', 'units': UNITS[part]})
            for part in one.what]
    if one.kind == 'states':
        return [Variable(part, ('time', _axis(part)), (len(plan.spec.times), len(AXES[part])),
                         attrs={'long_name': part.replace('_', ' '), 'units': UNITS[part]})
                for part in one.what]
    if one.kind == 'first':
        return [Variable(f'first_{word(one.what)}', attrs={
            'long_name': f'time of the first {one.what}, NaN if there is none', 'units': 's'})]
    if one.kind == 'all':
        event = word(one.what)
        return [Variable(f'all_{event}', (event,), (one.most,), attrs={
            'long_name': f'times of the first {one.most} {one.what} events', 'units': 's'}),
            Variable(f'{event}_count', dtype=np.dtype(np.int32), attrs={
                'long_name': f'number of {one.what} events', 'units': '1'})]
    if one.kind in ('minimum', 'maximum'):
        quantity = QUANTITIES[one.what]
        return [Variable(f'{one.kind}_{word(one.what)}', attrs={
            'long_name': f'{one.kind} over the times of: {quantity.long_name}',
            'units': quantity.unit})]
    if one.kind == 'residuals':
        return [Variable(f'{name}_residual', attrs={
            'long_name': f'{name} residual of the ledger at the last time, relative',
            'units': '1'}) for name in ('energy', 'momentum')]
    return [Variable(name, (f'{name}_place',) if size is not None else (),
                     () if size is None else (size,),
                     attrs={'long_name': f'by the function {one.what}'})
            for name, size in plan.outputs.get(one.what, ())]


def _variables(plan):
    """Return the Variables of a plan: what is kept, and how each run went."""
    found = [variable for one in plan.spec.keep for variable in _kept(plan, one)]
    names = [one.name for one in found]
    for place, name in enumerate(names):
        if name in names[:place] or name in plan.dims:
            raise BadInput('keep', f'two things have the name {name!r}', 'give one of them')
    meanings = [STATUSES[value] for value in sorted(STATUSES)]
    return [
        *found,
        Variable('status', dtype=np.dtype(np.int8), attrs={
            'long_name': 'how the run ended; status_text says why',
            'flag_values': sorted(STATUSES), 'flag_meanings': ' '.join(meanings)}),
        Variable('method', dtype=np.dtype(np.int8), attrs={
            'long_name': 'method', 'flag_values': list(range(len(METHOD_NAMES))),
            'flag_meanings': ' '.join(METHOD_NAMES)}),
        Variable('tolerance', attrs={'long_name': 'accuracy that the method was given',
                                     'units': 'rad'}),
        Variable('expected_error', dtype=np.dtype(np.float32), attrs={
            'long_name': 'error of the attitude to expect at the last time, NaN where the '
                         'method was named and not chosen', 'units': 'rad'}),
    ]


def _axis(part):
    return 'quaternion' if part == 'orientation' else 'axis'


def coordinates(plan):
    """Return name -> (dims, values, attrs) of all coordinates but those of the samples."""
    found = {}
    for key, values in plan.spec.vary.items():
        attrs = {'long_name': key, 'units': unit_of_key(key)}
        if not isinstance(values, np.ndarray):
            values = np.array([value if isinstance(value, str) else json.dumps(value)
                               for value in values], dtype=object)
        found[key] = (key,), values, attrs
    dims = {dim for one in plan.variables for dim in one.dims}
    if 'time' in dims:
        found['time'] = ('time',), plan.spec.times, {'long_name': 'time', 'units': 's'}
    for name, axes in (('quaternion', 'xyzw'), ('axis', 'xyz')):
        if name in dims or any(sampled.width == len(axes)
                               for sampled in plan.spec.sample.values()):
            found[name] = (name,), np.array(list(axes), dtype=object), {}
    return found


def sample_dims(sampled):
    """Return the dimensions of the coordinate of a sampled key."""
    return {1: (RUN,), 3: (RUN, 'axis'), 4: (RUN, 'quaternion')}[sampled.width]


def sample_attrs(key):
    """Return the attributes of the coordinate of a sampled key."""
    return {'long_name': key, 'units': unit_of_key(key)}
