# SPDX-License-Identifier: Apache-2.0
"""Messages made from columns of numbers, independent of the serialisation under test."""

import numpy as np

from rigid_body_sim.messages import cdr
from rigid_body_sim.messages.definitions import schema
from rigid_body_sim.messages.layout import Layout


class Packed:
    """Messages of one type that differ in some columns only.

    Parameters
    ----------
    type_name : str
    constants : dict
        The other fields, and the lengths of all strings and sequences.
    """

    def __init__(self, type_name, constants):
        self.type_name, self._blank = type_name, cdr.encode(type_name, constants)
        self.layout, self.size = (
            Layout(schema(type_name), type_name, self._blank), len(self._blank))

    def pack_many(self, columns):
        """Return messages as uint8 of shape (n, size) from columns, named as in Layout."""
        rows = np.tile(
            np.frombuffer(self._blank, np.uint8), (len(next(iter(columns.values()))), 1))
        view = rows.view(self.layout.dtype)[:, 0]
        for name, values in columns.items():
            if name.endswith('stamp'):
                view[f'{name}.sec'], view[f'{name}.nanosec'] = np.divmod(values, 10**9)
            else:
                view[name] = values
        return rows
