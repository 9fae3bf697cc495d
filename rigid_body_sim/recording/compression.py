"""Compression of chunks: zstd, lz4 or none, whichever is installed; decompression never makes more than was announced."""

import zlib

from rigid_body_sim.errors import BadInput

try:
    import zstandard
except ImportError:
    zstandard = None
try:
    import lz4.frame
except ImportError:
    lz4 = None

NAMES = ('zstd', 'lz4', 'none')
DEFAULT = 'zstd' if zstandard else 'lz4' if lz4 else 'none'
# Level 1 packs the doubles of a recording as well as level 9 does (0.1 % apart) in a third of the time of the default, 3.
ZSTD_LEVEL = 1
LARGEST_CHUNK = 256 * 2**20


def compressor(name):
    """Return the function bytes -> bytes of ``zstd``, ``lz4`` or ``none``; BadInput for another name or a missing library."""
    if name == 'none':
        return bytes
    if name == 'zstd' and zstandard:
        return zstandard.ZstdCompressor(level=ZSTD_LEVEL).compress
    if name == 'lz4' and lz4:
        return lz4.frame.compress
    if name in NAMES:
        raise BadInput('compression', f'{name} is not installed', f'install {_library(name)}, or compression {DEFAULT}')
    raise BadInput('compression', repr(name), f'one of {", ".join(NAMES)}')


def decompress(name, data, size, crc):
    """Return the `size` bytes of a chunk; ValueError where the data is damaged, BadInput where it cannot be read here.

    `name` as in MCAP (``''`` for none); a `crc` of 0 is not checked. At most `size` bytes are ever allocated, and `size` is limited.
    """
    if size > LARGEST_CHUNK:
        raise ValueError(f'a chunk that claims {size} bytes, more than {LARGEST_CHUNK}')
    if name == '':
        raw = bytes(data)
    elif name == 'zstd' and zstandard:
        raw = _unzstd(data, size)
    elif name == 'lz4' and lz4:
        raw = _unlz4(data, size)
    else:
        raise BadInput('compression', f'chunks are compressed by {name!r}, which is not installed here', f'install {_library(name)}')
    if len(raw) != size:
        raise ValueError(f'a chunk of {len(raw)} bytes that claims {size}')
    if crc and zlib.crc32(raw) != crc:
        raise ValueError('a chunk whose checksum is wrong')
    return raw


def _library(name):
    return {'zstd': 'zstandard', 'lz4': 'lz4'}.get(name, 'a tool that converts the recording to zstd')


def _unzstd(data, size):
    try:
        with zstandard.ZstdDecompressor(max_window_size=2**28).stream_reader(bytes(data)) as stream:
            return stream.read(size + 1)
    except zstandard.ZstdError as error:
        raise ValueError(f'a damaged chunk ({error})') from error


def _unlz4(data, size):
    try:
        return lz4.frame.LZ4FrameDecompressor().decompress(bytes(data), max_length=size + 1)
    except RuntimeError as error:
        raise ValueError(f'a damaged chunk ({error})') from error
