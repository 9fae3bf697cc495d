# SPDX-License-Identifier: Apache-2.0
"""The bytes of a file, read anywhere in it.

Why not `mcap.data_stream.ReadDataStream`: it only reads forwards, and a damaged file is read at
many places.
"""

import os

_BLOCK = 2**20


class FileBytes:
    """The bytes of an open file.

    Parameters
    ----------
    descriptor : int

    Attributes
    ----------
    size : int
        Bytes.
    """

    def __init__(self, descriptor):
        self._descriptor, self.size = descriptor, os.fstat(descriptor).st_size
        self._block, self._begin = b'', 0

    def read(self, offset, length):
        """Return `length` bytes from `offset` on, or what there is of them."""
        begin = offset - self._begin
        if begin >= 0 and begin + length <= len(self._block):
            return self._block[begin:begin + length]
        if length > _BLOCK // 4:
            return self._pread(offset, length)
        self._begin, self._block = offset, self._pread(offset, _BLOCK)
        return self._block[:length]

    def _pread(self, offset, length):
        pieces, length = [], min(length, self.size - offset)
        while length > 0:
            piece = os.pread(self._descriptor, length, offset)
            if not piece:
                break
            pieces.append(piece)
            offset, length = offset + len(piece), length - len(piece)
        return pieces[0] if len(pieces) == 1 else b''.join(pieces)


class MemoryBytes:
    """Bytes in memory, read in the same way."""

    def __init__(self, content):
        self._content, self.size = content, len(content)

    def read(self, offset, length):
        """Return `length` bytes from `offset` on, or what there is of them."""
        return self._content[offset:offset + length]
