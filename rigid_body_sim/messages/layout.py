# SPDX-License-Identifier: Apache-2.0
"""Fixed layouts: where in a message each number lies.

So one message is packed in under a microsecond, and thousands by NumPy at once. A message whose
strings and sequences keep their lengths has the same layout each time. Its numbers are then
*columns*, named by their path:

=================== ======================================== ====================================
field               column                                   array
=================== ======================================== ====================================
Time, Duration      ``header.stamp``                         (n,) int64, nanoseconds
struct of doubles   ``pose.position``, ``pose.orientation``  (n, 3), (n, 4) float64, in wire order
array of numbers    ``pose.covariance``, ``velocity``        (n, length)
number              ``data``                                 (n,)
string              ``header.frame_id``                      (n,) bytes
=================== ======================================== ====================================
"""

import struct

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr, definitions

NANOSECONDS = 1_000_000_000
_TIME = [('sec', 'i', 1), ('nanosec', 'I', 1)]


class Layout:
    """The layout of all messages of a type with the same string and sequence lengths.

    Parameters
    ----------
    schemas : dict
        See :mod:`rigid_body_sim.messages.definitions`.
    type_name : str
    sample : bytes
        One such message.

    Attributes
    ----------
    size : int
        Bytes.
    leaves : list
        See :func:`rigid_body_sim.messages.cdr.decode`.
    dtype : numpy.dtype
        View of one message.
    components : dict
        A column that is a struct of doubles -> the names of its numbers.
    """

    def __init__(self, schemas, type_name, sample):
        self.type_name = type_name
        self.leaves = []
        cdr.decode(schemas, type_name, sample, self.leaves)
        self.size = len(sample)
        self._times, self.components = [], {}
        fields = self._fields()
        self.dtype = np.dtype(
            {
                'names': [name for name, _, _ in fields],
                'formats': [form for _, form, _ in fields],
                'offsets': [offset for _, _, offset in fields],
                'itemsize': self.size,
            }
        )
        lengths = [
            np.arange(offset, offset + 4) for _, code, offset, _ in self.leaves if code == '#'
        ]
        self._shape_bytes = np.concatenate([np.arange(2), *lengths]).astype(int)
        self._shape = np.frombuffer(bytes(sample), np.uint8)[self._shape_bytes]

    def _fields(self):
        """Return (column, NumPy format, offset) for each column; structs of doubles are one."""
        siblings, sequences = {}, {path for path, code, _, _ in self.leaves if code == '#'}
        for path, code, _, count in self.leaves:
            parent, _, last = path.rpartition('.')
            siblings.setdefault(parent, []).append((last, code, count))
        fields = []
        for path, code, offset, count in self.leaves:
            parent, _, last = path.rpartition('.')
            if code == '#' or count == 0:
                continue
            if (
                parent
                and len(siblings[parent]) > 1
                and all(leaf[1:] == ('d', 1) for leaf in siblings[parent])
            ):
                if parent not in self.components:
                    self.components[parent] = []
                    fields.append((parent, ('<f8', (len(siblings[parent]),)), offset))
                self.components[parent].append(last)
            elif parent and siblings[parent] == _TIME and last == 'sec':
                self._times.append(parent)
                fields.append((path, '<i4', offset))
            else:
                shape = (count,) if count > 1 or path in sequences else ()
                fields.append(
                    (
                        path,
                        f'S{count}' if code == 's' else (np.dtype(f'<{code}').str, shape),
                        offset,
                    )
                )
        return fields

    @property
    def columns(self):
        """Names of the columns, in wire order."""
        names = []
        for name in self.dtype.names or ():
            parent, _, last = name.rpartition('.')
            if parent not in self._times:
                names.append(name)
            elif last == 'sec':
                names.append(parent)
        return names

    def fits(self, rows):
        """Return which of the messages, uint8 (n, size), have this layout, as (n,) bool."""
        return (rows[:, self._shape_bytes] == self._shape).all(axis=1)

    def unpack(self, rows, names=None):
        """Return the columns, all or those in `names`, of messages, uint8 (n, size)."""
        view = np.ascontiguousarray(rows).view(self.dtype)[:, 0]
        columns = {}
        for name in self.columns if names is None else names:
            if name in self._times:
                columns[name] = (
                    view[f'{name}.sec'].astype(np.int64) * NANOSECONDS + view[f'{name}.nanosec']
                )
            else:
                columns[name] = view[name].copy()
        return columns

    def put(self, view, name, values):
        """Set one column of messages viewed as `dtype`."""
        if name in self._times:
            view[f'{name}.sec'], view[f'{name}.nanosec'] = np.divmod(values, NANOSECONDS)
        else:
            view[name] = values


class Packer:
    """Messages of one topic: everything constant but a few numbers.

    Parameters
    ----------
    type_name : str
        ``package/msg/Name``, one of the types we ship.
    constants : dict
        Nested values of the constant fields, and the lengths of all strings and sequences (a
        sequence that changes is given as zeros).
    variable : sequence of str
        Paths of what changes, with all numbers below them: ``('header.stamp', 'pose')``.
    """

    def __init__(self, type_name, constants, variable):
        self.type_name = type_name
        self._blank = cdr.encode(type_name, constants)
        self.layout = Layout(definitions.schema(type_name), type_name, self._blank)
        self.size = len(self._blank)
        self._runs = []
        self.count = 0
        for path, code, offset, count in self.layout.leaves:
            if code in '#s' or not any(
                path == name or path.startswith((f'{name}.', f'{name}[')) for name in variable
            ):
                continue
            self._append_run(code, offset, count)
        if not self._runs:
            raise BadInput(
                type_name,
                f'none of {", ".join(variable)} is a number in it',
                f'some of {", ".join(self.layout.columns)}',
            )
        self._runs = [
            (struct.Struct('<' + codes).pack_into, offset, first, last)
            for codes, offset, first, last in self._runs
        ]

    def _append_run(self, code, offset, count):
        """Add numbers to the last run of neighbours, or begin another."""
        codes, first = code * count, self.count
        self.count += count
        if self._runs:
            before, start, first_before, _ = self._runs[-1]
            if start + struct.calcsize('<' + before) == offset:
                self._runs[-1] = (before + codes, start, first_before, self.count)
                return
        self._runs.append((codes, offset, first, self.count))

    def pack(self, *values):
        """Return one message of all variable numbers in wire order.

        A time is two integers, seconds and nanoseconds.

        About 0.6 us. struct.error where a number has the wrong type or their count is not `count`.
        """
        if len(values) != self.count:
            raise struct.error(
                f'{self.type_name} takes {self.count} numbers here, got {len(values)}'
            )
        message = bytearray(self._blank)
        for pack_into, offset, first, last in self._runs:
            pack_into(message, offset, *values[first:last])
        return bytes(message)

    def pack_many(self, columns):
        """Return n messages as uint8 of shape (n, size).

        `columns` maps column names (see the module) to arrays of n rows.
        """
        count = len(next(iter(columns.values())))
        rows = np.empty((count, self.size), np.uint8)
        rows[:] = np.frombuffer(self._blank, np.uint8)
        view = rows.view(self.layout.dtype)[:, 0]
        for name, values in columns.items():
            self.layout.put(view, name, values)
        return rows
