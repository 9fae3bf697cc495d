# SPDX-License-Identifier: Apache-2.0
"""Messages of one topic in a chunk, decoded at once into columns.

Their names are those of :mod:`rigid_body_sim.messages.layout`.
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr, definitions
from rigid_body_sim.messages.layout import Layout
from rigid_body_sim.recording.mcap.walk import MESSAGE_FIXED, MESSAGE_HEAD

_MOST_LAYOUTS = 16


class Decoder:
    """Decodes the messages of a type.

    Parameters
    ----------
    type_name : str
    schema_text : str
        As recorded (``ros2msg``), or '' for one of the types that the package ships.
    """

    def __init__(self, type_name, schema_text=''):
        self.type_name = type_name
        self._schemas = (definitions.parse(type_name, schema_text) if schema_text
                         else definitions.schema(type_name))
        self._layouts = []

    def decode(self, data):
        """Return one message (bytes) as a nested dict."""
        return cdr.decode(self._schemas, self.type_name, data)

    @property
    def components(self):
        """Names of the numbers of columns that are structs of doubles.

        Known once columns were decoded.
        """
        return {name: names for layout in self._layouts
                for name, names in layout.components.items()}

    def columns(self, records, offsets, lengths, names=None):
        """Return the columns of messages, all arrays of n rows.

        Parameters
        ----------
        records : bytes
        offsets, lengths : int64 arrays (n,)
            Where the messages' records begin, and the lengths of their contents.
        names : sequence of str, optional
            Chooses columns; without it all that every message here has.

        Raises
        ------
        BadInput
            Where a chosen column is not in every message, has no fixed length, or the messages
            have too many different forms (sequences of many lengths: decode those one by one).
        """
        data, parts, rows_of = np.frombuffer(records, np.uint8), [], []
        for length in np.unique(lengths).tolist():
            left = np.flatnonzero(lengths == length)
            while len(left):
                begin = offsets[left] + MESSAGE_HEAD.size
                rows = data[begin[:, None] + np.arange(length - MESSAGE_FIXED)]
                layout, fits = self._layout(rows)
                parts.append(layout.unpack(rows[fits], self._known(layout, names)))
                rows_of.append(left[fits])
                left = left[~fits]
                if len(parts) > _MOST_LAYOUTS:
                    raise BadInput(self.type_name, 'messages of many different forms',
                                   'decode them one by one')
        return _merged(self.type_name, parts, rows_of, names)

    def _layout(self, rows):
        """Return a layout that the first row has, and which rows have it."""
        for layout in self._layouts:
            if layout.size == rows.shape[1]:
                fits = layout.fits(rows)
                if fits[0]:
                    return layout, fits
        layout = Layout(self._schemas, self.type_name, rows[0].tobytes())
        self._layouts = [layout, *self._layouts[:_MOST_LAYOUTS]]
        return layout, layout.fits(rows)

    def _known(self, layout, names):
        missing = set(names or ()) - set(layout.columns)
        if missing:
            raise BadInput(self.type_name, f'a message without a column {sorted(missing)[0]!r}',
                           f'some of {", ".join(layout.columns)}')
        return names


def _merged(type_name, parts, rows_of, names):
    """Put parts of the rows together; `rows_of` says which rows each has."""
    if len(parts) == 1:
        return parts[0]
    count = sum(len(rows) for rows in rows_of)
    merged = {}
    for name in names or [name for name in parts[0] if all(name in part for part in parts)]:
        if len({part[name].shape[1:] for part in parts}) > 1:
            if names:
                raise BadInput(f'{type_name}: {name}', 'sequences of different lengths',
                               'decode these messages one by one')
            continue
        kind = np.result_type(*(part[name].dtype for part in parts))
        merged[name] = np.empty((count, *parts[0][name].shape[1:]), kind)
        for part, rows in zip(parts, rows_of, strict=True):
            merged[name][rows] = part[name]
    return merged
