# SPDX-License-Identifier: Apache-2.0
"""One file of a recording, read by mcap/reading.py; errors become BadInput with a remedy."""

import contextlib

from mcap.exceptions import InvalidMagic, UnsupportedCompressionError

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.mcap import reading
from rigid_body_sim.recording.mcap.records import Damaged


class FileReader(reading.FileReader):
    """A whole MCAP file, see :class:`rigid_body_sim.recording.mcap.reading.FileReader`.

    Raises BadInput where there is none, where it is cut or makes no sense.
    """

    def __init__(self, path):
        self.path = path
        try:
            with readable(path, '"recover" makes a cut recording whole'):
                super().__init__(path)
        except OSError as error:
            raise BadInput(str(path), f'cannot be read ({error.strerror})',
                           'a recording') from error

    def schema(self, channel):
        """Return the Schema of a channel; BadInput where there is none."""
        if channel.schema_id not in self.schemas:
            raise BadInput(f'{self.path}: {channel.topic}', 'has no message type',
                           'a recording of ROS 2 messages')
        return self.schemas[channel.schema_id]

    def metadata(self, name):
        """Return the texts of a metadata record, or None."""
        with readable(self.path):
            return super().metadata(name)

    def places(self):
        """Return where to read a Piece."""
        with readable(self.path):
            return list(super().places())

    def piece(self, place, channels, start, end):
        """Return the Piece at a place with the messages of some channels in [start, end] ns."""
        with readable(self.path):
            return super().piece(place, channels, start, end)


@contextlib.contextmanager
def readable(path, remedy='an undamaged recording; "recover" keeps what can be read of it'):
    """Turn errors of an MCAP file into BadInput; `remedy` is for a damaged file."""
    try:
        yield
    except InvalidMagic as error:
        raise BadInput(str(path), 'is not an MCAP file', 'a recording (.mcap)') from error
    except UnsupportedCompressionError as error:
        raise BadInput(str(path), f'chunks cannot be read ({error})',
                       'zstd, lz4 or no compression') from error
    except Damaged as error:
        raise BadInput(str(path), str(error), remedy) from error
