"""MCAP records as bytes, both ways (MCAP 0 specification). Every record is an opcode, a length of 8 bytes, and its content, little-endian.

Functions named after a record return its bytes; those named ``read_...`` take its content and raise ValueError where it makes no sense.
"""

import struct
import typing

import numpy as np

MAGIC = b'\x89MCAP0\r\n'
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX, ATTACHMENT, ATTACHMENT_INDEX = range(1, 11)
STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = range(11, 16)
PRIVATE = 0x80      # opcodes from here on are skipped by every reader

HEAD = struct.Struct('<BQ')
MESSAGE_HEAD = struct.Struct('<BQHIQQ')
MESSAGE_FIXED = MESSAGE_HEAD.size - HEAD.size      # bytes of a message's content before its data
MESSAGE_FIELDS = [('opcode', 'u1'), ('length', '<u8'), ('channel', '<u2'), ('sequence', '<u4'), ('log_time', '<u8'),
                  ('publish_time', '<u8')]
_CHUNK_HEAD = struct.Struct('<QQQII')
FOOTER_SIZE = HEAD.size + 20 + len(MAGIC)


class Chunk(typing.NamedTuple):
    """The head of a chunk: times in ns, size and checksum of the uncompressed records, name of the compression, where its data is."""

    start_time: int
    end_time: int
    size: int
    crc: int
    compression: str
    data_offset: int
    data_size: int


class Channel(typing.NamedTuple):
    """A topic as one file knows it."""

    id: int
    schema: int
    topic: str
    encoding: str
    metadata: dict


def record(opcode, content):
    """Return a record of given content."""
    return HEAD.pack(opcode, len(content)) + content


def _text(text):
    data = text.encode()
    return struct.pack('<I', len(data)) + data


def _text_map(texts):
    data = b''.join(_text(key) + _text(value) for key, value in texts.items())
    return struct.pack('<I', len(data)) + data


def header(profile, library):
    """Return the first record of a file."""
    return record(HEADER, _text(profile) + _text(library))


def schema(number, name, encoding, text):
    """Return the record of a message type."""
    data = text.encode()
    return record(SCHEMA, struct.pack('<H', number) + _text(name) + _text(encoding) + struct.pack('<I', len(data)) + data)


def channel(number, schema_number, topic, encoding, metadata):
    """Return the record of a topic."""
    return record(CHANNEL, struct.pack('<HH', number, schema_number) + _text(topic) + _text(encoding) + _text_map(metadata))


def message(channel_number, sequence, log_time, publish_time, data):
    """Return the record of a message."""
    return MESSAGE_HEAD.pack(MESSAGE, 22 + len(data), channel_number, sequence, log_time, publish_time) + data


def chunk(start_time, end_time, size, crc, compression, data):
    """Return a chunk: compressed records of `size` bytes."""
    content = _CHUNK_HEAD.pack(start_time, end_time, size, crc, len(compression)) + compression.encode() + struct.pack('<Q', len(data))
    return record(CHUNK, content + data)


def message_index(channel_number, times_and_offsets):
    """Return where in a chunk the messages of one channel are: uint64 of shape (n, 2)."""
    data = np.ascontiguousarray(times_and_offsets, '<u8').tobytes()
    return record(MESSAGE_INDEX, struct.pack('<HI', channel_number, len(data)) + data)


def chunk_index(head, offset, length, index_offsets, index_length):
    """Return where in the file a chunk is (`head`: Chunk), and its message indexes (channel number -> offset)."""
    offsets = b''.join(struct.pack('<HQ', *item) for item in index_offsets.items())
    return record(CHUNK_INDEX, struct.pack('<QQQQI', head.start_time, head.end_time, offset, length, len(offsets)) + offsets
                  + struct.pack('<Q', index_length) + _text(head.compression) + struct.pack('<QQ', head.data_size, head.size))


def metadata(name, texts):
    """Return named texts about the recording."""
    return record(METADATA, _text(name) + _text_map(texts))


def metadata_index(offset, length, name):
    """Return where in the file a metadata record is."""
    return record(METADATA_INDEX, struct.pack('<QQ', offset, length) + _text(name))


def statistics(schemas, channels, attachments, metadatas, chunks, start_time, end_time, counts):
    """Return the totals of a file; `counts` maps channel number -> messages."""
    per_channel = b''.join(struct.pack('<HQ', *item) for item in sorted(counts.items()))
    return record(STATISTICS, struct.pack('<QHIIIIQQI', sum(counts.values()), schemas, channels, attachments, metadatas, chunks, start_time,
                                          end_time, len(per_channel)) + per_channel)


class Cursor:
    """Reads fields one after another from a record's content."""

    def __init__(self, content):
        self.content, self.position = content, 0

    def take(self, size):
        """Return the next `size` bytes."""
        if size > len(self.content) - self.position:
            raise ValueError(f'a record that ends {size - len(self.content) + self.position} bytes too early')
        self.position += size
        return self.content[self.position - size:self.position]

    def numbers(self, form):
        """Return the next numbers, `form` as in struct."""
        return struct.unpack('<' + form, self.take(struct.calcsize('<' + form)))

    def text(self):
        """Return the next text."""
        return bytes(self.take(self.numbers('I')[0])).decode(errors='replace')

    def text_map(self):
        """Return the next map of texts."""
        inner = Cursor(self.take(self.numbers('I')[0]))
        texts = {}
        while inner.position < len(inner.content):
            key = inner.text()
            texts[key] = inner.text()
        return texts


def read_schema(content):
    """Return (number, name, encoding, text)."""
    cursor = Cursor(content)
    return cursor.numbers('H')[0], cursor.text(), cursor.text(), cursor.text()


def read_channel(content):
    """Return a Channel."""
    cursor = Cursor(content)
    return Channel(*cursor.numbers('HH'), cursor.text(), cursor.text(), cursor.text_map())


def read_metadata(content):
    """Return (name, texts)."""
    cursor = Cursor(content)
    return cursor.text(), cursor.text_map()


def read_chunk(content):
    """Return the Chunk head of a chunk record's content; the data need not be there."""
    cursor = Cursor(content)
    start_time, end_time, size, crc = cursor.numbers('QQQI')
    compression = cursor.text()
    data_size, = cursor.numbers('Q')
    return Chunk(start_time, end_time, size, crc, compression, cursor.position, data_size)


def read_attachment(content):
    """Return (log_time, create_time, name, media type, data size) of an attachment's content, of which the first bytes are enough."""
    cursor = Cursor(content)
    log_time, create_time = cursor.numbers('QQ')
    return log_time, create_time, cursor.text(), cursor.text(), cursor.numbers('Q')[0]


def attachment_index(offset, length, attachment):
    """Return where in the file an attachment is; `attachment` as from read_attachment."""
    log_time, create_time, name, media_type, size = attachment
    return record(ATTACHMENT_INDEX, struct.pack('<QQQQQ', offset, length, log_time, create_time, size) + _text(name) + _text(media_type))
