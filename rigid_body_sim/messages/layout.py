# SPDX-License-Identifier: Apache-2.0
"""Fixed layouts: the place of each number in a message.

A message whose strings and sequences keep their lengths always has the same layout. Its numbers
are then *columns*, named by their path:

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


import numpy as np

from rigid_body_sim.messages import cdr

NANOSECONDS = 1_000_000_000
_TIME = [('sec', 'i', 1), ('nanosec', 'I', 1)]


class Layout:
    """The layout of all messages of a type with the same string and sequence lengths.

    Parameters
    ----------
    schemas : dict
        Schemas of :mod:`rigid_body_sim.messages.definitions`.
    type_name : str
    sample : bytes
        One of the messages.

    Attributes
    ----------
    size : int
        Number of bytes.
    leaves : list
        Parts of the message, see :func:`rigid_body_sim.messages.cdr.decode`.
    dtype : numpy.dtype
        Format of one message.
    components : dict
        Column that is a struct of doubles -> names of its numbers.
    """

    def __init__(self, schemas, type_name, sample):
        self.type_name = type_name
        self.leaves = []
        cdr.decode(schemas, type_name, sample, self.leaves)
        self.size = len(sample)
        self._times, self.components = [], {}
        fields = self._fields()
        self.dtype = np.dtype({
            'names': [name for name, _, _ in fields], 'formats': [form for _, form, _ in fields],
            'offsets': [offset for _, _, offset in fields], 'itemsize': self.size})
        lengths = [np.arange(offset, offset + 4)
                   for _, code, offset, _ in self.leaves if code == '#']
        self._shape_bytes = np.concatenate([np.arange(2), *lengths]).astype(int)
        self._shape = np.frombuffer(bytes(sample), np.uint8)[self._shape_bytes]

    def _fields(self):
        """Return (column, NumPy format, offset) of each column; a struct of doubles is one."""
        siblings, sequences = {}, {path for path, code, _, _ in self.leaves if code == '#'}
        for path, code, _, count in self.leaves:
            parent, _, last = path.rpartition('.')
            siblings.setdefault(parent, []).append((last, code, count))
        fields = []
        for path, code, offset, count in self.leaves:
            parent, _, last = path.rpartition('.')
            if code == '#' or count == 0:
                continue
            if (parent and len(siblings[parent]) > 1
                    and all(leaf[1:] == ('d', 1) for leaf in siblings[parent])):
                if parent not in self.components:
                    self.components[parent] = []
                    fields.append((parent, ('<f8', (len(siblings[parent]),)), offset))
                self.components[parent].append(last)
            elif parent and siblings[parent] == _TIME and last == 'sec':
                self._times.append(parent)
                fields.append((path, '<i4', offset))
            else:
                shape = (count,) if count > 1 or path in sequences else ()
                fields.append((
                    path, f'S{count}' if code == 's' else (np.dtype(f'<{code}').str, shape),
                    offset))
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
        """Return whether each message has this layout, (n,) bool; messages are uint8 (n, size)."""
        return (rows[:, self._shape_bytes] == self._shape).all(axis=1)

    def unpack(self, rows, names=None):
        """Return the columns, all or those in `names`, of messages, uint8 (n, size)."""
        view = np.ascontiguousarray(rows).view(self.dtype)[:, 0]
        columns = {}
        for name in self.columns if names is None else names:
            if name in self._times:
                columns[name] = (view[f'{name}.sec'].astype(np.int64) * NANOSECONDS
                                 + view[f'{name}.nanosec'])
            else:
                columns[name] = view[name].copy()
        return columns
