# SPDX-License-Identifier: Apache-2.0
"""Columns of a topic as tables: for files, pandas and xarray, and several topics joined."""

import numpy as np

NANOSECONDS = 1e9


def seconds(log_times, start):
    """Return seconds since `start` (ns) of log times (ns)."""
    return (log_times - start) / NANOSECONDS


def flat(columns, components):
    """Return one array (n,) a number: ``x.0``, ``x.1`` or, for a struct, ``pose.position.x``.

    Texts stay texts. `components` names the numbers of structs, see
    :attr:`rigid_body_sim.recording.columns.Decoder.components`.
    """
    made = {}
    for name, column in columns.items():
        if column.dtype.kind == 'S':
            made[name] = np.char.decode(column, 'utf-8', 'replace')
        elif column.ndim == 1:
            made[name] = column
        else:
            for index, part in enumerate(components.get(name, range(column.shape[1]))):
                made[f'{name}.{part}'] = np.ascontiguousarray(column[:, index])
    return made


def dataset(xarray, columns, components, start):
    """Return columns as an xarray.Dataset; `start` (ns) is second 0 of its times."""
    variables, coordinates = {}, {'time': seconds(columns['log_time'], start)}
    for name, column in columns.items():
        if column.dtype.kind == 'S':
            column = np.char.decode(column, 'utf-8', 'replace')
        dimensions = ('time',)
        if column.ndim > 1:
            dimensions = ('time', f'{name}.component')
            coordinates[dimensions[1]] = list(components.get(name, range(column.shape[1])))
        variables[name] = (dimensions, column)
    found = xarray.Dataset(variables, coordinates)
    found['time'].attrs['units'] = 's'
    return found


class Joined:
    """Joins blocks of several topics into rows of the messages that have the same log time.

    A row comes as soon as all topics have got beyond it, so little is kept in memory.

    Parameters
    ----------
    prefixes : dict of str to str
        Topic -> what its columns' names begin with.
    """

    def __init__(self, prefixes):
        self._prefixes = prefixes
        self._waiting = {topic: [] for topic in prefixes}

    def add(self, topic, columns):
        """Take the columns of a block; return the joined columns that are complete now, or None.

        Raises KeyError where a block lacks columns that the one before had.
        """
        self._waiting[topic].append(columns)
        if not all(self._waiting.values()):
            return None
        parts = {name: _concatenated(blocks) for name, blocks in self._waiting.items()}
        until = min(int(part['log_time'][-1]) for part in parts.values())
        ready = {name: np.searchsorted(part['log_time'], until, side='right')
                 for name, part in parts.items()}
        self._waiting = {
            name: [{key: column[ready[name]:] for key, column in part.items()}]
            if ready[name] < len(part['log_time']) else [] for name, part in parts.items()}
        return self._join({name: {key: column[:ready[name]] for key, column in part.items()}
                           for name, part in parts.items()})

    def _join(self, parts):
        first = next(iter(parts.values()))['log_time']
        if not all(np.array_equal(part['log_time'], first) for part in parts.values()):
            common = first
            for part in parts.values():
                common = np.intersect1d(common, part['log_time'])
            parts = {name: _chosen(part, np.searchsorted(part['log_time'], common))
                     for name, part in parts.items()}
            first = common
        joined = {'log_time': first}
        for name, part in parts.items():
            joined |= {f'{self._prefixes[name]}.{key}': column for key, column in part.items()
                       if key not in ('log_time', 'sequence', 'seconds')}
        return joined if len(first) else None


def _concatenated(blocks):
    return blocks[0] if len(blocks) == 1 else {
        name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}


def _chosen(part, rows):
    return {name: column[rows] for name, column in part.items()}
