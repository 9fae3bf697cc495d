# SPDX-License-Identifier: Apache-2.0
"""Layouts, which load a flat array of floats into a named view and store a view in an array.

A view is a NamedTuple. Its annotations say what a field is: ``float``, a vector (``Vector``,
``Pair``, ``tuple[float, float]``, ...), a matrix (a tuple of vectors, its rows), or another view.
The places in the array follow from the order of the fields:

    class Throw(NamedTuple):
        time: float            # s
        velocity: Vector       # m/s, world axes

    THROW = layout(Throw)
    load_throw, store_throw, store_time = THROW.load, THROW.store, THROW.part('time').store

    @compiled
    def later(array, duration, out):
        throw = load_throw(array)
        vx, vy, vz = throw.velocity
        store_throw(out, Throw(throw.time + duration, (vx, vy, vz - G * duration)))

Kernels find functions by global names, so a module names those that it uses, as above. They are
inlined: what a kernel loads but does not use costs no instruction, and without numba they are
plain Python. numba keeps compiled callers on disk as if the subscripts stood in them: every view
is importable, and the sources of kernels, this one included, are the key of the cache.
"""

import functools
import itertools
import linecache
import typing

import numpy as np

from rigid_body_sim.compilation.jit import HAVE_NUMBA, inlined

Pair = tuple[float, float]                          # a double-double number, or a plane vector
Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]      # x, y, z, w
Matrix = tuple[Vector, Vector, Vector]              # rows


def layout(view, stride=1):
    """Return the layout of an array that begins with the fields of a view (a NamedTuple class).

    Parameters
    ----------
    stride : int
        Distance of two neighbouring numbers of a view. An array of columns, one per number, holds
        up to `stride` views side by side, which ``load`` and ``store`` tell apart by `at`.

    Raises
    ------
    TypeError
        If a field is neither a float nor made of floats.
    """
    return Layout(view, view, 0, view.__name__, stride)


class Layout:
    """The places of a value in an array: a view, or a part of one.

    Attributes
    ----------
    load : function (array, at=0) -> value
        Read the value. `at` moves all places on, for arrays that hold several such values.
    store : function (array, value, at=0)
        Write the value.
    numbers : function (value) -> list of float
        Return the floats in their order; not for kernels.
    first, size, places : int, int, slice
        The place of the first float, the number of floats, and all their places.
    """

    def __init__(self, view, kind, first, name, stride):
        self._view, self._kind, self._name, self._stride = view, kind, name, stride
        self._made = {}    # parts that were asked for: their functions are written once
        self.first, self.size = first, sum(1 for _ in _leaves(kind, name))
        self.places = slice(first, first + self.size * stride, stride)

    def part(self, field):
        """Return the layout of a field of a view, or of a row of a matrix (an index)."""
        if field not in self._made:
            self._made[field] = self._part(field)
        return self._made[field]

    def _part(self, field):
        before = self.first
        for name, kind in _parts(self._kind, self._name):
            if name == field:
                return Layout(self._view, kind, before, f'{self._name}.{field}', self._stride)
            before += self._stride * sum(1 for _ in _leaves(kind, self._name))
        raise KeyError(f'{self._name} has no field {field!r}')

    @functools.cached_property
    def load(self):
        """Read the value (see the class)."""
        views, places = {}, range(self.first, self.places.stop, self._stride)
        if HAVE_NUMBA:
            lines, numbers = [], [f'array[at + {place}]' for place in places]
        else:
            lines, numbers = self._read_at_once(), [f'x{k}' for k in range(self.size)]
        value = _written(self._kind, self._name, iter(numbers), views)
        return self._function('load', '(array, at=0)', [*lines, f'return {value}'], views)

    def _read_at_once(self):
        """Return the lines that read the numbers as floats, for plain Python.

        Arithmetic of NumPy's scalars has the same bits and takes five times as long.
        """
        names = ''.join(f'x{k}, ' for k in range(self.size))
        return [f'part = array[at + {self.first}:at + {self.places.stop}:{self._stride}]',
                f'{names}= part if isinstance(part, (list, tuple)) else part.tolist()']

    @functools.cached_property
    def store(self):
        """Write the value (see the class)."""
        places = itertools.count(self.first, self._stride)
        lines = [f'array[at + {next(places)}] = value{path}'
                 for path in _leaves(self._kind, self._name)]
        return self._function('store', '(array, value, at=0)', lines, {})

    @functools.cached_property
    def numbers(self):
        """Return the floats of a value in their order (see the class)."""
        names = [f'x{k}' for k in range(self.size)]
        lines = [f'{_unpacked(self._kind, self._name, iter(names))} = value',
                 f'return [{", ".join(names)}]']
        return self._function('numbers', '(value)', lines, {})

    def array(self, value):
        """Return a new array that holds a value, without a stride."""
        return np.fromiter(self.numbers(value), float, self.size)

    def _function(self, does, signature, lines, names):
        """Return an inlined function with these lines."""
        name = f'{does}_{self._name}'.replace('.', '_')
        source = ''.join(f'{line}\n' for line in [
            f'def {name}{signature}:', f'    """{does.capitalize()} {self._name}."""',
            *(f'    {line}' for line in lines)])
        # tracebacks and numba's messages quote the generated lines
        file = f'<{self._view.__module__}:{name}>'
        linecache.cache[file] = len(source), None, source.splitlines(keepends=True), file
        namespace = {'__name__': self._view.__module__, **names}
        exec(compile(source, file, 'exec'), namespace)
        return inlined(namespace[name])


def _parts(kind, name):
    """Return (name, kind) of the parts that a kind is made of; a float has none."""
    if kind is float:
        return []
    if isinstance(kind, type) and issubclass(kind, tuple) and hasattr(kind, '_fields'):
        return list(typing.get_type_hints(kind).items())
    if typing.get_origin(kind) is tuple and Ellipsis not in typing.get_args(kind):
        return list(enumerate(typing.get_args(kind)))
    raise TypeError(f'{name} is {kind}; a view is made of floats, tuples of them, and views')


def _leaves(kind, name):
    """Yield the path from a value to each of its floats, in order: '.velocity[0]', ..."""
    if kind is float:
        yield ''
    for part, its_kind in _parts(kind, name):
        reach = f'[{part}]' if isinstance(part, int) else f'.{part}'
        for path in _leaves(its_kind, f'{name}.{part}'):
            yield reach + path


def _unpacked(kind, name, names):
    """Return the target of an assignment that gives each float of a value a name."""
    if kind is float:
        return next(names)
    return f'({"".join(f"{_unpacked(part, name, names)}, " for _, part in _parts(kind, name))})'


def _written(kind, name, numbers, views):
    """Return the expression of a value made of numbers; `views` collects the classes it names."""
    if kind is float:
        return next(numbers)
    parts = _parts(kind, name)
    inside = ''.join(f'{_written(part, name, numbers, views)}, ' for _, part in parts)
    if typing.get_origin(kind) is tuple:
        return f'({inside})'
    views[f'{kind.__name__}_{len(views)}'] = kind
    return f'{list(views)[-1]}({inside[:-2]})'
