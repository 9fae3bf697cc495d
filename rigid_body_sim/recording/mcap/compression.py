# SPDX-License-Identifier: Apache-2.0
"""Compression of chunks; decompression never makes more bytes than the chunk announces.

Why not `mcap.stream_reader.get_chunk_data_stream`: it believes the size in the compressed data, so
33 kB that claim to hold 1 kB make it allocate 1 GB. Why not the compression in `mcap.writer`: its
level of zstd is fixed at 3, which packs a recording of the racket 1 % worse than level 1 and takes
1.3 times as long.
"""

import zlib

import lz4.frame
import zstandard
from mcap.exceptions import UnsupportedCompressionError

from rigid_body_sim.recording.mcap.records import Damaged

ZSTD_LEVEL = 1
LARGEST_CHUNK = 256 * 2**20


def compressor(name):
    """Return the function bytes -> bytes of ``zstd``, ``lz4`` or ``''`` (no compression)."""
    if name == '':
        return bytes
    if name == 'zstd':
        return zstandard.ZstdCompressor(level=ZSTD_LEVEL).compress
    if name == 'lz4':
        return lz4.frame.compress
    raise UnsupportedCompressionError(name)


def records_of(chunk):
    """Return the uncompressed records of a `mcap.records.Chunk`.

    At most the announced size is ever allocated, and that is limited. A checksum of 0 is not
    checked, as the format says.

    Raises
    ------
    Damaged
        Where the data is damaged.
    mcap.exceptions.UnsupportedCompressionError
        For a compression other than zstd and lz4.
    """
    size = chunk.uncompressed_size
    if size > LARGEST_CHUNK:
        raise Damaged(f'a chunk that claims {size} bytes, more than {LARGEST_CHUNK}')
    if chunk.compression == '':
        raw = chunk.data
    elif chunk.compression == 'zstd':
        raw = _unzstd(chunk.data, size)
    elif chunk.compression == 'lz4':
        raw = _unlz4(chunk.data, size)
    else:
        raise UnsupportedCompressionError(chunk.compression)
    if len(raw) != size:
        raise Damaged(f'a chunk of {len(raw)} bytes that claims {size}')
    if chunk.uncompressed_crc and zlib.crc32(raw) != chunk.uncompressed_crc:
        raise Damaged('a chunk whose checksum is wrong')
    return raw


def zstd_length(data):
    """Return the bytes of the zstd frame that begins some data; 0 where it does not end in it.

    Raises zstandard.ZstdError where no frame begins.
    """
    parameters = zstandard.get_frame_parameters(data)
    at = zstandard.frame_header_size(data)
    while at + 3 <= len(data):
        block = int.from_bytes(data[at:at + 3], 'little')
        at += 3 + (1 if block >> 1 & 3 == 1 else block >> 3)
        if block & 1:
            at += 4 * parameters.has_checksum
            return at if at <= len(data) else 0
    return 0


def _unzstd(data, size):
    try:
        with zstandard.ZstdDecompressor(max_window_size=2**28).stream_reader(data) as stream:
            raw = stream.read(size + 1)
        ended = zstd_length(data) > 0
    except zstandard.ZstdError as error:
        raise Damaged(f'a damaged chunk ({error})') from error
    return _whole(raw, size, ended)


def _unlz4(data, size):
    decompressor = lz4.frame.LZ4FrameDecompressor()
    try:
        raw = decompressor.decompress(data, max_length=size + 1)
    except RuntimeError as error:
        raise Damaged(f'a damaged chunk ({error})') from error
    return _whole(raw, size, decompressor.eof)


def _whole(raw, size, ended):
    """Return what was decompressed; Damaged where its frame has no end: others refuse that."""
    if len(raw) == size and not ended:
        raise Damaged('a chunk whose compressed data does not end')
    return raw
