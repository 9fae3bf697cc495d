# SPDX-License-Identifier: Apache-2.0
"""Records of the package `mcap` as bytes, and bytes as its records.

The layout of every record is the library's. What is added here: a record is refused if it ends
early. The library's stream returns what is left instead, so that a cut record would pass as whole.
"""

import io
import struct

from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import McapError
from mcap.records import AttachmentIndex

HEAD = struct.Struct('<BQ')
"""The head of every record: its opcode, and the length of its content."""
PRIVATE = 0x80
"""Every reader skips records with opcodes from here on."""


class Damaged(ValueError):
    """Bytes that are not what an MCAP file would have there."""


class WholeStream(ReadDataStream):
    """A stream of bytes in memory; raises Damaged where less is left than asked for."""

    def __init__(self, content):
        super().__init__(io.BytesIO(content))
        self._size = len(content)

    def read(self, length):
        """Return the next `length` bytes."""
        missing = self.count + length - self._size
        if missing > 0:
            raise Damaged(f'a record that ends {missing} bytes too early')
        return super().read(length)


class LenientStream(WholeStream):
    """The same, with a sign in place of bytes that are no text."""

    def read_prefixed_string(self):
        """Return the next text."""
        return self.read(self.read4()).decode(errors='replace')


def to_bytes(*records):
    """Return records end to end."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return builder.end()


def of_bytes(kind, content, whole=True):
    """Return the record of a class of `mcap.records` that has this content.

    Raises Damaged if the content makes no sense; with `whole` False its last field may be cut.
    """
    try:
        return kind.read(WholeStream(content) if whole else ReadDataStream(io.BytesIO(content)))
    except (McapError, UnicodeDecodeError, struct.error, OverflowError) as error:
        raise Damaged(f'a {kind.__name__} record that makes no sense ({error})') from error


def attachment_index(offset, length, start):
    """Return the AttachmentIndex of an attachment whose content begins with the bytes `start`.

    `mcap.records.Attachment.read` takes the data along, which may not fit into memory.
    """
    stream = WholeStream(start)
    try:
        log_time, create_time = stream.read8(), stream.read8()
        name, media_type = stream.read_prefixed_string(), stream.read_prefixed_string()
        return AttachmentIndex(offset, length, log_time, create_time, stream.read8(), name,
                               media_type)
    except UnicodeDecodeError as error:
        raise Damaged(f'an attachment that makes no sense ({error})') from error
