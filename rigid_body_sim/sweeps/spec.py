# SPDX-License-Identifier: Apache-2.0
"""The checked spec of a sweep: scene, vary, sample, times, keep (see docs/sweeps.md).

::

    scene: tennis_racket
    vary:
      body.inertia.1: {linspace: [1.2, 2.8, 41]}
      initial.angular_velocity.0: {logspace: [-4, 0, 61]}
    times: {linspace: [0, 60, 601]}
    keep: [{first: flip}, {maximum: energy}, final]
"""

import collections.abc
import difflib
import functools
import hashlib
import importlib
import importlib.util
import inspect
import json
import math
import pathlib
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene import yaml_text
from rigid_body_sim.scene.scene import Scene, load_scene, parse_scene
from rigid_body_sim.scene.state import AXES
from rigid_body_sim.sweeps.quantities import QUANTITIES
from rigid_body_sim.sweeps.values import a_count, a_number, sample_of, times_of, values_of

WORDS = ('scene', 'integrator', 'accuracy', 'vary', 'sample', 'times', 'keep')
MOST_EVENTS = 16
"""Default number of times that `all` keeps of an event."""
KEPT = ('final', 'states', 'first', 'all', 'minimum', 'maximum', 'residuals', 'function')


@dataclass(frozen=True)
class Kept:
    """One entry of `keep`.

    Attributes
    ----------
    kind : str
        A name of KEPT.
    what : tuple of str or str
        Parts of the state, the name of an event, of a quantity or of a function.
    most : int
        Times of an event that `all` keeps.
    """

    kind: str
    what: object = ()
    most: int = 0


@dataclass(frozen=True)
class Spec:
    """A checked spec.

    Attributes
    ----------
    scene : str
        YAML text.
    integrator, accuracy
        As for Simulation.
    vary : dict of str to list or array
        The values of each key, in the order of the dimensions.
    sample : dict of str to Sampled
    runs : int
        Number of samples; 0 where nothing is sampled.
    times : array (n,)
        s, rising.
    keep : tuple of Kept
    functions : dict of str to callable
        By the names in `keep`.
    carried : dict of str to callable
        Those of them that were given as objects, not by name: workers need them with the text.
    text : str
        JSON of all of it: enough to make the Spec again, but for functions that have no name.
    """

    scene: str
    integrator: str
    accuracy: float
    vary: dict
    sample: dict
    runs: int
    times: np.ndarray
    keep: tuple
    functions: dict
    carried: dict
    text: str

    @property
    def shape(self):
        """The number of values of each dimension; the samples are the last one."""
        counts = tuple(len(values) for values in self.vary.values())
        return (*counts, self.runs) if self.runs else counts

    @property
    def size(self):
        """The number of runs."""
        return math.prod(self.shape)


def read(spec):
    """Return the Spec of a mapping, of a YAML text, or of the path of a YAML file.

    Raises
    ------
    BadInput
        One line: file, key path, value, what would be right.
    """
    if isinstance(spec, Spec):
        return spec
    if isinstance(spec, collections.abc.Mapping):
        return _checked(dict(spec), 'sweep', pathlib.Path())
    text = str(spec)
    if isinstance(spec, pathlib.Path) or '\n' not in text:
        path = pathlib.Path(text)
        try:
            content = path.read_text(encoding='utf-8')
        except (OSError, ValueError) as error:
            problem = getattr(error, 'strerror', None) or 'not UTF-8 text'
            raise BadInput('sweep', f'cannot read {text!r}: {problem}',
                           'give the path of a readable .yaml file') from None
        return _checked(yaml_text.parse(content, path.name), path.name, path.parent)
    return _checked(yaml_text.parse(text, 'sweep'), 'sweep', pathlib.Path())


def again(text, functions):
    """Return the Spec with this :attr:`Spec.text` and these functions."""
    return _checked(json.loads(text), 'sweep', pathlib.Path(), functions)


def _check_words(mapping, where):
    """Refuse a word that a sweep does not know, or the lack of one that it needs."""
    for key in mapping:
        if key not in WORDS:
            near = difflib.get_close_matches(str(key), WORDS, 1)
            raise BadInput(f'{where}: {key}', 'is not a word of a sweep',
                           f'did you mean {near[0]}?' if near else
                           f'the words are {", ".join(WORDS)}')
    for key in ('scene', 'keep'):
        if key not in mapping:
            raise BadInput(where, f'the key {key!r} is missing', f'give {key} (docs/sweeps.md)')


def _check_keys(vary, sample, where):
    """Refuse a sweep that changes nothing, a key given twice, and a key that no scene has."""
    if not vary and not sample:
        raise BadInput(where, 'neither vary nor sample names a key',
                       'give keys of the scene, for example vary: {body.mass: [1, 2]}')
    for key in sample:
        if key in vary:
            raise BadInput(f'{where}: sample.{key}', 'is in vary too', 'give it once')
    for key in (*vary, *sample):
        if '/' in key or key in ('run', 'time', 'axis', 'quaternion', 'block'):
            raise BadInput(f'{where}: {key}', 'is not a key of a scene',
                           'a key path such as body.mass')


def _checked(mapping, where, folder, functions=None):
    _check_words(mapping, where)
    scene = _scene(mapping['scene'], f'{where}: scene', folder)
    accuracy = a_number(mapping.get('accuracy', 1e-12), f'{where}: accuracy')
    integrator = mapping.get('integrator', 'auto')
    vary = {str(key): values_of(values, f'{where}: vary.{key}')
            for key, values in _mapping(mapping.get('vary'), f'{where}: vary').items()}
    sample, runs, seed = sample_of(_mapping(mapping.get('sample'), f'{where}: sample'),
                                   f'{where}: sample')
    _check_keys(vary, sample, where)
    times = times_of(mapping.get('times', 0.0), f'{where}: times')
    known = dict(functions or {})
    keep = tuple(_kept(entry, f'{where}: keep.{place}', folder, known)
                 for place, entry in enumerate(_list(mapping['keep'], f'{where}: keep')))
    _refuse_twice(keep, f'{where}: keep')
    written = {'scene': scene.text, 'integrator': integrator, 'accuracy': accuracy,
               'vary': {key: _plain(values)
                        for key, values in (mapping.get('vary') or {}).items()},
               'sample': _plain({**(mapping.get('sample') or {}), 'seed': seed})
               if sample else {},
               'times': _plain(mapping.get('times', 0.0)),
               'keep': [_entry(one) for one in keep]}
    text = json.dumps(written)
    used = {one.what: known[one.what] for one in keep if one.kind == 'function'}
    carried = {name: function for name, function in used.items()
               if name in (functions or {}) or _is_given(function, mapping['keep'])}
    return Spec(scene.text, integrator, accuracy, vary, sample, runs, times, keep, used, carried,
                text)


def fingerprint(spec):
    """Return everything that the results depend on, as a dict of texts: words and functions."""
    words = {key: json.dumps(value) for key, value in json.loads(spec.text).items()}
    return words | {f'function {name}': _digest(function)
                    for name, function in spec.functions.items()}


def _digest(function):
    """Return a digest of the source of a function, of its compiled code where it has none."""
    try:
        source = inspect.getsource(function).encode()
    except (OSError, TypeError):
        source = getattr(getattr(function, '__code__', None), 'co_code', b'')
    return hashlib.sha256(source).hexdigest()[:16]


def _scene(value, where, folder):
    if isinstance(value, Scene):
        return value
    if isinstance(value, collections.abc.Mapping):
        return parse_scene(json.dumps(value), where=where)
    text = str(value)
    if '\n' in text:
        return parse_scene(text, where=where)
    beside = folder / text
    return load_scene(beside if beside.suffix in ('.yaml', '.yml') and beside.is_file() else text)


def _mapping(value, where):
    if value is None:
        return {}
    if not isinstance(value, collections.abc.Mapping):
        raise BadInput(where, f'got {yaml_text.brief(value)}', 'a mapping of keys of the scene')
    return dict(value)


def _list(value, where):
    value = [value] if isinstance(value, (str, collections.abc.Mapping)) else value
    if not isinstance(value, (list, tuple)) or not value:
        raise BadInput(where, f'got {yaml_text.brief(value)}',
                       f'a list of {", ".join(KEPT)} (docs/sweeps.md)')
    return value


def _kept(entry, where, folder, functions):
    if isinstance(entry, str):
        entry = {entry: None}
    if not isinstance(entry, collections.abc.Mapping) or not entry:
        raise BadInput(where, f'got {yaml_text.brief(entry)}', f'one of {", ".join(KEPT)}')
    kind, value = next(iter(entry.items()))
    surplus = set(entry) - {kind} - ({'most'} if kind == 'all' else set())
    if kind not in KEPT or surplus:
        near = difflib.get_close_matches(str(kind), KEPT, 1) if kind not in KEPT else ()
        raise BadInput(where, f'got {yaml_text.brief(dict(entry))}',
                       f'did you mean {near[0]!r}?' if near else f'one of {", ".join(KEPT)}')
    if kind == 'residuals':
        return Kept(kind)
    if kind in ('final', 'states'):
        names = (value,) if isinstance(value, str) else tuple(AXES if value is None else value)
        wrong = [name for name in names if name not in AXES]
        if wrong or not names or len(set(names)) != len(names):
            raise BadInput(f'{where}.{kind}', f'got {yaml_text.brief(value)}',
                           f'parts of the state: {", ".join(AXES)}')
        return Kept(kind, names)
    if kind == 'function':
        name = _function(value, where, folder, functions)
        return Kept(kind, name)
    if not isinstance(value, str):
        raise BadInput(f'{where}.{kind}', f'got {yaml_text.brief(value)}',
                       'the name of an event (flip, rolling began, turning point)'
                       if kind in ('first', 'all') else f'one of {", ".join(QUANTITIES)}')
    if kind in ('minimum', 'maximum') and value not in QUANTITIES:
        near = difflib.get_close_matches(value, QUANTITIES, 1)
        raise BadInput(f'{where}.{kind}', f'got {value!r}', f'did you mean {near[0]}?' if near
                       else f'one of {", ".join(QUANTITIES)}')
    most = a_count(entry.get('most', MOST_EVENTS), f'{where}.most', most=10**6)
    return Kept(kind, value, most if kind == 'all' else 0)


def _refuse_twice(keep, where):
    names = [(one.kind, one.what if isinstance(one.what, str) else '') for one in keep]
    for place, name in enumerate(names):
        if name in names[:place]:
            raise BadInput(f'{where}.{place}', f'{" ".join(name).strip()} is listed twice',
                           'list it once')


def _is_given(function, keep):
    """Return whether an entry of `keep` has the function itself, not its name."""
    return any(isinstance(entry, collections.abc.Mapping) and entry.get('function') is function
               for entry in ([keep] if isinstance(keep, collections.abc.Mapping) else keep))


def _function(value, where, folder, functions):
    """Return the name of a function, and put it into functions."""
    if callable(value):
        name = f'{getattr(value, "__module__", "")}:{getattr(value, "__qualname__", value)}'
        functions[name] = value
        return name
    if value in functions:
        return value
    module, colon, name = str(value).partition(':')
    try:
        if not colon:
            raise ImportError('no colon')
        if module.endswith('.py'):
            path = (folder / module).resolve()
            value = f'{path}:{name}'
            functions[value] = getattr(_module_of(path), name)
        else:
            functions[value] = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError, OSError) as error:
        raise BadInput(f'{where}.function', f'got {yaml_text.brief(value)} ({error})',
                       'module:name, or file.py:name with the path from the spec on') from None
    return value


@functools.cache
def _module_of(path):
    found = importlib.util.spec_from_file_location(f'sweep_{path.stem}', path)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def _entry(kept):
    """Return the entry of `keep` that a Kept is of."""
    if kept.kind == 'residuals':
        return kept.kind
    if kept.kind == 'all':
        return {kept.kind: kept.what, 'most': kept.most}
    return {kept.kind: list(kept.what) if isinstance(kept.what, tuple) else kept.what}


def _plain(value):
    """Return a value as JSON has it."""
    return json.loads(json.dumps(value, default=lambda array: array.tolist()))
