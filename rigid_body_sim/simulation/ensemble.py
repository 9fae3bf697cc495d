# SPDX-License-Identifier: Apache-2.0
"""Ensembles: many bodies of one scene, from many starts or with other parameters, on all cores."""

import contextlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from tqdm import tqdm

from rigid_body_sim.choice.choice import HORIZON, Choice
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.choice.rounding import of_bodies
from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.compilation.threads import on_all_cores
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.numerics.rotations import angles_between
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import Scene, load_scene, parse_scene
from rigid_body_sim.scene.state import PLACES, STATE_SIZE, State, States
from rigid_body_sim.simulation.checks import TIMES, doubles
from rigid_body_sim.simulation.spans import Event

BLOCK_BYTES = 2**25
"""Bytes of the states that are computed between two reports of progress, or before columns are
taken from them."""
SHARE = 0.8
"""Part of the free memory that a result may take."""
UNLOOKED = 2**26
"""Bytes of a result up to which the free memory is not checked."""
DOUBLE = 8    # bytes
MANY = 1024
"""Bodies from which on `auto` takes a finer tolerance if a sample of them needs it."""
SAMPLED = 8
SPENT = 0.3
"""Share of the accuracy that the worst body of the sample may err by with a finer tolerance."""
LOOKS = 3
"""How often the tolerance is looked at."""


class Ensemble(Sequence):
    """The states of many bodies in one array.

    An integer gives the :class:`States` of one body (or, with columns left out, its rows of the
    array); a slice gives an Ensemble. The columns have names: ``ensemble.angular_velocity`` has
    the shape (bodies, n, 3).

    Attributes
    ----------
    vector : array (bodies, n, 14 or less)
        The columns of a State, or those that were asked for, in the order of ``columns``.
    columns : tuple of str
        Names of the parts that it holds.
    events : list of list of Event, or None
        The events of each body, if they were asked for; their ticks are None.
    choices : list of (Choice, array of int)
        Each method that was chosen, and the numbers of its bodies; empty for a part of an
        Ensemble. `auto` chooses for the start of the scene; for 1024 bodies and more it takes a
        finer tolerance if the quickest one or one of seven others needs it.
        :meth:`expected_errors` tells of each of them.
    """

    __slots__ = ('_asked', 'choices', 'columns', 'events', 'vector')

    def __init__(self, vector, columns=tuple(PLACES), events=None, choices=(), asked=None):
        self.vector, self.columns, self.events = vector, tuple(columns), events
        self.choices, self._asked = list(choices), asked    # starts and times

    def __len__(self):
        return len(self.vector)

    def __getitem__(self, body):
        if isinstance(body, slice):
            return Ensemble(self.vector[body], self.columns, self.events and self.events[body])
        whole = self.columns == tuple(PLACES)
        return States(self.vector[body]) if whole else self.vector[body]

    def __getattr__(self, name):
        if name not in PLACES or name not in self.columns:
            raise AttributeError(f'{name!r}: the columns are {", ".join(self.columns)}')
        place = 0
        for column in self.columns[:self.columns.index(name)]:
            place += _width(column)
        part = self.vector[..., place:place + _width(name)]
        return part[..., 0] if name == 'time' else part

    def __array__(self, dtype=None, copy=None):
        return (np.array if copy else np.asarray)(self.vector, dtype=dtype)

    def expected_errors(self):
        """Return the error of the attitude to expect of each body, rad, shape (bodies,).

        It is the largest at the times that were asked for. `auto` takes the tolerance that the
        scene's own start needs, or the worst of a few bodies: one whose motion magnifies errors
        more may err by more than the accuracy, and shows it here. Bodies run again with a finer
        tolerance, which takes a little longer than the ensemble did, and those that differ by
        less than that one with the finest; the error of a closed form is half an ulp of the angle
        turned, which takes a run only of bodies that heat may bring to rest. The starts and the
        states must still be what they were.

        Raises
        ------
        BadInput
            A part of an Ensemble; columns without the orientation; fixed steps, or the finest
            tolerance, beside which no run is finer.
        """
        if self._asked is None:
            raise BadInput('expected_errors', 'asked of a part of an Ensemble',
                           'that of the whole Ensemble, and its part')
        if 'orientation' not in self.columns:
            raise BadInput('expected_errors', f'the columns are {", ".join(self.columns)}',
                           'columns with the orientation')
        starts, times = self._asked
        errors = np.zeros(len(self))
        for choice, bodies in self.choices:
            errors[bodies] = of_bodies(choice.scene, choice.many, starts[bodies],
                                       times.max(initial=0.0))
            if choice.is_nearly:
                errors[bodies] += choice.expected_error
            finer = choice.finer()
            if finer is None:
                continue
            for part in _blocks(len(bodies), len(times)):
                here = bodies[part]
                apart = self._apart(finer, here)
                # what differs by less than the finer tolerance may have been taken in the same
                # steps, which a start or the growth of steps limits, not the tolerance
                alike = apart < finer.tolerance
                if alike.any() and finer.tolerance > FINEST:
                    apart[alike] = self._apart(choice.finer(0.0), here[alike])
                errors[here] = np.maximum(errors[here], apart)
        return errors

    def _apart(self, choice, bodies):
        """Return how far the attitudes of bodies are from those by another Choice, rad, each."""
        starts, times = self._asked
        attitudes = np.empty((len(bodies), len(times), _width('orientation')))
        _fill(choice, starts[bodies], times, ('orientation',), attitudes, _silent)
        apart = np.empty(attitudes[..., 0].size)
        angles_between(self.orientation[bodies].reshape(len(apart), -1),
                       attitudes.reshape(len(apart), -1), apart)
        return apart.reshape(len(bodies), -1).max(axis=1, initial=0.0)


def ensemble(scene, starts=None, times=(0.0,), integrator: str | Choice = 'auto',
             accuracy: float = 1e-12, *, overrides: Mapping | None = None,
             columns: Sequence[str] | None = None, out=None, events: bool = False,
             memory: float | None = None, progress: bool = False,
             horizon: float = HORIZON) -> Ensemble:
    """Return the states of many bodies at many times.

    More than eight arguments: one call is the whole interface; most are named and have a default.

    Parameters
    ----------
    scene : Scene, str or path
        Body, constraint and effects; its strikes are left out.
    starts : array (bodies, 14) or list of State, optional
        Each with its own time; by default the initial state of the scene, with the overrides of
        each body.
    times : array (n,)
        s, in any order.
    integrator, accuracy
        As for Simulation; or a Choice for this scene, which was made before. In closed form and by
        most methods each body gets the bits that it has alone; `taylor` takes eight bodies at
        once, with other steps to the same accuracy.
    overrides : mapping of str to a value for each body, optional
        ``{'body.mass': masses, 'gravity.g': [9.81, 1.62]}``: parameters that differ from body to
        body. Each combination is a scene of its own: it is checked, and a method is chosen for it
        (some milliseconds, more where `auto` tries methods).
    columns : sequence of str, optional
        Parts to keep, of ``time, orientation, angular_velocity, position, velocity``; default all.
    out : array (bodies, n, width), optional
        Array for the states, for example a ``numpy.memmap``; the width is 14, or that of
        `columns`.
    events : bool
        Whether to look for events too, up to the last time.
    memory : float, optional
        Most bytes that the result may take; by default four fifths of the free memory. With `out`
        nothing is allocated but a block.
    progress : bool
        Whether to show a bar on stderr.
    horizon : float
        Duration over which the accuracy is asked for, s; 100 by default.

    Returns
    -------
    Ensemble
        States by body, in the order of the starts or of the overrides.

    Raises
    ------
    BadInput
        Arguments of another shape, numbers that are not finite, a result that memory cannot hold
        (before anything is computed), a time before a start where there is no closed form.
    NotConverged
        With the number of the body and the time where a method gave up.
    """
    scene = scene if isinstance(scene, Scene) else load_scene(scene)
    times = doubles('times', times, TIMES).reshape(-1)
    scenes = _scenes(scene, overrides or {})
    starts = _starts(starts, scene, scenes)
    if not (np.isfinite(starts).all() and np.isfinite(times).all()):
        raise BadInput('ensemble', 'got numbers that are not finite', 'finite starts and times')
    names = _columns(columns)
    shape = (len(starts), len(times), sum(map(_width, names)))
    out = _result(shape, out, memory)
    groups = _groups(scenes, starts, times, integrator, accuracy, horizon)
    # even a hidden bar takes as long as the states of a hundred bodies
    bar = tqdm(total=len(starts), unit=' bodies', leave=False) if progress else None
    report = _silent if bar is None else bar.update
    with contextlib.nullcontext() if bar is None else bar:
        if len(groups) == 1:
            _fill(groups[0][0], starts, times, names, out, report)
        else:
            def fill(part):
                for choice, bodies in groups[part]:
                    block = np.empty((len(bodies), len(times), shape[2]))
                    try:
                        _fill(choice, starts[bodies], times, names, block, report)
                    except NotConverged as error:
                        raise _of_body(error, bodies) from None
                    out[bodies] = block
            on_all_cores(fill, len(groups))
    found = None
    if events:
        found = [[]] * len(starts)
        for choice, bodies in groups:
            for body in bodies:
                found[body] = _events(choice, starts[body], times)
    return Ensemble(out, names, found, groups, (starts, times))


def _silent(bodies):
    """Report nothing."""


def _scenes(scene, overrides):
    """Return the scene of each body, or the one scene of all in a list."""
    if not overrides:
        return [scene]
    values = {key: list(given) for key, given in overrides.items()}
    sizes = {key: len(given) for key, given in values.items()}
    if len(set(sizes.values())) != 1:
        raise BadInput('overrides', f'got {sizes}',
                       'as many values of each key: one for each body')
    [count] = set(sizes.values())
    made, scenes = {}, []
    for body in range(count):
        given = {key: one[body] for key, one in values.items()}
        try:
            key = repr([np.asarray(value).tolist() for value in given.values()])
            if key not in made:
                made[key] = parse_scene(scene.text, given, f'{scene.name} of body {body}')
        except TypeError as error:
            raise BadInput('overrides', str(error), 'numbers, words, lists or arrays') from None
        scenes.append(made[key])
    return scenes


def _starts(starts, scene, scenes):
    """Return the starts as an array (bodies, 14)."""
    if starts is None:
        starts = [one.initial for one in scenes]
    elif len(scenes) > 1 and any(not np.array_equal(one.initial.vector, scene.initial.vector)
                                 for one in scenes):
        raise BadInput('starts', 'stand beside overrides of `initial`', 'give one of them')
    if not isinstance(starts, np.ndarray):
        starts = [getattr(start, 'vector', start) for start in starts]
    starts = doubles('starts', starts, f'numbers (bodies, {STATE_SIZE}), or a list of State')
    if starts.ndim != 2 or starts.shape[1] != STATE_SIZE:
        raise BadInput('ensemble', f'got starts of shape {starts.shape}',
                       f'(bodies, {STATE_SIZE})')
    if len(scenes) > 1 and len(scenes) != len(starts):
        raise BadInput('ensemble', f'got {len(starts)} starts and overrides of {len(scenes)}',
                       'one of each for a body')
    return starts


def _alike(scenes, starts):
    """Return (scene, places of its bodies) for each scene that differs from the others."""
    if len(scenes) == 1:
        return [(scenes[0], np.arange(len(starts)))]
    places = {}
    for body, scene in enumerate(scenes):
        places.setdefault(id(scene), (scene, []))[1].append(body)
    return [(scene, np.array(bodies)) for scene, bodies in places.values()]


def _groups(scenes, starts, times, integrator, accuracy, horizon):
    """Return (Choice, its bodies): one for all bodies, or one for each whose scene differs.

    The closed form of a scene nearly this one errs by what the start makes of the difference: a
    body has it only where it meets the accuracy from its own start.
    """
    alike = _alike(scenes, starts)
    if isinstance(integrator, Choice):
        return [(integrator, bodies) for _, bodies in alike]
    groups = []
    for scene, bodies in alike:
        choice = choose(scene, integrator, accuracy, horizon=horizon,
                        together=len(bodies) >= LANES)
        if not choice.is_nearly:
            if choice.settled and len(bodies) >= MANY:
                choice = _for_all(choice, starts[bodies], times)
            groups.append((choice, bodies))
            continue
        for k, body in enumerate(bodies.tolist()):
            own = replace(scene, initial=State(starts[body].copy()))
            groups.append((choose(own, integrator, accuracy, horizon=horizon), bodies[k:k + 1]))
    return groups


def _for_all(choice, starts, times):
    """Return a Choice of the method with the tolerance that a sample of bodies needs at the end.

    The sample is the quickest body and some at even distances. A finer run tells their errors,
    which grow about in proportion to the tolerance: a finer one is looked at again. A body that
    fails is left to the run itself, which tells its number.
    """
    if choice.method == 'exact' or not len(times):
        return choice
    with np.errstate(over='ignore'):    # it cannot be run, which the run itself tells
        x2, y2, z2 = np.square(starts[:, PLACES['angular_velocity']].T)
        quickest = (x2 + y2 + z2).argmax()
    others = np.arange(SAMPLED - 1) * (len(starts) - 1) // (SAMPLED - 2)
    sample, end = starts[[quickest, *others]], times[[times.argmax()]]
    found = Ensemble(np.empty((SAMPLED, 1, STATE_SIZE)), asked=(sample, end))
    suited = choice
    for _ in range(LOOKS):
        if suited.tolerance <= FINEST:
            break
        try:
            _fill(suited, sample, end, found.columns, found.vector, _silent)
            worst = float(found._apart(suited.finer(), np.arange(SAMPLED)).max())
        except NotConverged:
            return choice
        if worst <= choice.accuracy:
            break
        share = SPENT * choice.accuracy / worst
        suited = suited.suited(share * suited.tolerance, share * worst)
    return suited


def _columns(columns):
    names = tuple(PLACES) if columns is None else tuple(columns)
    for name in names:
        if name not in PLACES:
            raise BadInput('columns', f'got {name!r}', f'names of {", ".join(PLACES)}')
    if len(set(names)) != len(names) or not names:
        raise BadInput('columns', f'got {names}', 'each name once, at least one')
    return names


def _width(name):
    """Return how many doubles a part has."""
    return PLACES[name].stop - PLACES[name].start


def _result(shape, out, memory):
    """Return the array that takes the result, after a check that memory can hold it."""
    if out is not None:
        if getattr(out, 'shape', None) != shape or out.dtype != float:
            raise BadInput('out', f'got shape {getattr(out, "shape", None)} of '
                           f'{getattr(out, "dtype", type(out).__name__)}',
                           f'an array of doubles of shape {shape}')
        return out
    needed = float(np.prod(shape, dtype=float)) * DOUBLE
    limit = memory
    if limit is None:
        limit = SHARE * free_memory() if needed > UNLOOKED else needed
    if needed > limit:
        raise BadInput('ensemble', f'{shape[0]} bodies at {shape[1]} times need '
                       f'{needed / 1e9:.3g} GB, and {limit / 1e9:.3g} GB may be taken',
                       'fewer bodies or times, `columns`, or `out=` with a numpy.memmap')
    return np.empty(shape)


def free_memory():
    """Return how many bytes a program can still take without swapping."""
    with open('/proc/meminfo') as lines:
        for line in lines:
            if line.startswith('MemAvailable:'):
                return int(line.split()[1]) * 1024
    raise OSError('/proc/meminfo has no line MemAvailable')


def _fill(choice, starts, times, names, out, report):
    """Fill out with the columns of the states of bodies, block by block."""
    whole = names == tuple(PLACES) and out.flags.c_contiguous
    columns = [column for name in names for column in range(PLACES[name].start, PLACES[name].stop)]
    for part in _blocks(len(starts), len(times)):
        target = out[part] if whole else np.empty((part.stop - part.start, len(times), STATE_SIZE))
        try:
            choice.many(starts[part], times, target)
        except NotConverged as error:
            raise _of_body(error, range(part.start, part.stop)) from None
        if not whole:
            out[part] = target[:, :, columns]
        report(part.stop - part.start)


def _blocks(bodies, times):
    """Yield the slices of bodies whose states at so many times take about BLOCK_BYTES."""
    block = max(64, BLOCK_BYTES // (max(1, times) * STATE_SIZE * DOUBLE) // 64 * 64)
    for begin in range(0, bodies, block):
        yield slice(begin, min(begin + block, bodies))


def _of_body(error, bodies):
    """Return an error about a body of a block, with the body's number in the ensemble."""
    return NotConverged(re.sub(r'^body (\d+)', lambda found: f'body {bodies[int(found[1])]}',
                               str(error)), error.time)


def _events(choice, start, times):
    """Return the events of one body from its start to the last time."""
    begin, end = float(start[0]), float(times.max(initial=start[0]))
    return [Event(None, time, name, values)
            for time, name, values in choice.solver(start, Wrench()).events(begin, end)]
