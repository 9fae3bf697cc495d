"""The tail of an MCAP file: is it whole, and what does it say is in the file."""

import os
import struct
import typing
import zlib

from rigid_body_sim.recording import mcap_format
from rigid_body_sim.recording.mcap_file import Contents

_DATA_END_SIZE = mcap_format.HEAD.size + 4
_LARGEST_SUMMARY = 2**30


class ChunkPlace(typing.NamedTuple):
    """Where a chunk is, the times in ns of its first and last message, and the channels it has messages of (empty: not known)."""

    offset: int
    length: int
    start_time: int
    end_time: int
    channels: frozenset = frozenset()


def read_footer(stream):
    """Return (summary_start, summary's bytes up to and without its checksum), or None where the file does not end as an MCAP file does."""
    size = os.fstat(stream.fileno()).st_size
    if size < 2 * len(mcap_format.MAGIC) + mcap_format.FOOTER_SIZE:
        return None
    stream.seek(size - mcap_format.FOOTER_SIZE)
    footer = stream.read(mcap_format.FOOTER_SIZE)
    if not footer.endswith(mcap_format.MAGIC) or footer[:mcap_format.HEAD.size] != mcap_format.HEAD.pack(mcap_format.FOOTER, 20):
        return None
    start, _, crc = struct.unpack_from('<QQI', footer, mcap_format.HEAD.size)
    if start == 0:
        return 0, b''
    end = size - len(mcap_format.MAGIC) - 4
    if not len(mcap_format.MAGIC) < start <= end or end - start > _LARGEST_SUMMARY:
        return None
    stream.seek(start)
    summary = stream.read(end - start)
    if crc and zlib.crc32(summary) != crc:
        return None
    return start, summary


def tail_is_whole(stream, data_end):
    """Return whether a whole tail follows the data section, which ends at `data_end`."""
    footer = read_footer(stream)
    if footer is None:
        return False
    size = os.fstat(stream.fileno()).st_size
    return data_end + _DATA_END_SIZE == (footer[0] or size - mcap_format.FOOTER_SIZE)


def read_summary(stream):
    """Return the Contents of a whole file as its summary tells, or None where it does not tell all (then scan).

    ValueError where the file is cut, or its tail makes no sense.
    """
    footer = read_footer(stream)
    if footer is None:
        raise ValueError('the file is cut or damaged: its tail is not whole')
    contents, cursor, told = Contents(), mcap_format.Cursor(footer[1]), False
    while cursor.position < len(footer[1]):
        opcode, length = cursor.numbers('BQ')
        if opcode == mcap_format.FOOTER:
            break
        content = cursor.take(length)
        if opcode == mcap_format.CHUNK_INDEX:
            contents.add_chunk(mcap_format.record(opcode, content))
        elif opcode == mcap_format.STATISTICS:
            _read_statistics(contents, content)
            told = True
        elif opcode == mcap_format.METADATA_INDEX:
            contents.metadata_indexes += mcap_format.record(opcode, content)
        else:
            contents.describe(opcode, content)
    complete = told and set(contents.counts) <= set(contents.channels) and contents.chunk_count == contents.told_chunks
    return contents if complete else None


def _read_statistics(contents, content):
    cursor = mcap_format.Cursor(content)
    *_, contents.told_chunks, contents.start_time, contents.end_time, length = cursor.numbers('QHIIIIQQI')
    inner = mcap_format.Cursor(cursor.take(length))
    while inner.position < length:
        number, count = inner.numbers('HQ')
        if count:
            contents.counts[number] = count


def chunk_places(contents):
    """Return the ChunkPlaces in file order."""
    cursor, places = mcap_format.Cursor(bytes(contents.chunk_indexes)), []
    while cursor.position < len(cursor.content):
        _, length = cursor.numbers('BQ')
        inner = mcap_format.Cursor(cursor.take(length))
        start_time, end_time, offset, chunk_length, indexes_length = inner.numbers('QQQQI')
        channels = frozenset(number for number, _ in struct.iter_unpack('<HQ', inner.take(indexes_length // 10 * 10)))
        places.append(ChunkPlace(offset, chunk_length, start_time, end_time, channels))
    return sorted(places, key=lambda place: place.offset)


def read_metadata_record(stream, contents, name):
    """Return the texts of the first metadata record of that name, or None."""
    cursor = mcap_format.Cursor(bytes(contents.metadata_indexes))
    while cursor.position < len(cursor.content):
        _, length = cursor.numbers('BQ')
        inner = mcap_format.Cursor(cursor.take(length))
        offset, record_length = inner.numbers('QQ')
        if inner.text() == name and record_length <= _LARGEST_SUMMARY and offset < os.fstat(stream.fileno()).st_size:
            stream.seek(offset)
            record = stream.read(record_length)
            if record[:1] == bytes([mcap_format.METADATA]):
                return mcap_format.read_metadata(record[mcap_format.HEAD.size:])[1]
    return None
