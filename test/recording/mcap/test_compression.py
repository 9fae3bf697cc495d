# SPDX-License-Identifier: Apache-2.0
"""Chunks are decompressed to as many bytes as they announce, or refused."""

import random
import zlib

import lz4.frame
import pytest
import zstandard
from mcap.exceptions import UnsupportedCompressionError
from mcap.records import Chunk

from rigid_body_sim.recording.mcap import compression
from rigid_body_sim.recording.mcap.compression import compressor, records_of, zstd_length
from rigid_body_sim.recording.mcap.records import Damaged

NAMES = ('', 'zstd', 'lz4')
CONTENT = random.Random(1).randbytes(20_000) + bytes(500)
SIZE, CHECKSUM = len(CONTENT), zlib.crc32(CONTENT)


def chunk(name, data, size=SIZE, checksum=CHECKSUM):
    return Chunk(name, data, 9, 5, checksum, size)


@pytest.mark.parametrize('checksum', [CHECKSUM, 0])
@pytest.mark.parametrize('name', NAMES)
def test_a_chunk_is_decompressed_and_without_a_checksum_none_is_checked(name, checksum):
    assert records_of(chunk(name, compressor(name)(CONTENT), checksum=checksum)) == CONTENT


@pytest.mark.parametrize('size', [0, 1, SIZE - 1, SIZE + 1])
@pytest.mark.parametrize('name', NAMES)
def test_a_chunk_of_another_size_than_it_announces_is_refused(name, size):
    with pytest.raises(Damaged):
        records_of(chunk(name, compressor(name)(CONTENT), size, 0))


@pytest.mark.parametrize('name', NAMES)
def test_a_chunk_with_a_wrong_checksum_is_refused(name):
    with pytest.raises(Damaged, match='checksum'):
        records_of(chunk(name, compressor(name)(CONTENT), checksum=1))


@pytest.mark.parametrize('more', [0, 1])
@pytest.mark.parametrize('name', NAMES)
def test_a_chunk_larger_than_memory_allows_is_refused(name, more, monkeypatch):
    monkeypatch.setattr(compression, 'LARGEST_CHUNK', SIZE - more)
    if more:
        with pytest.raises(Damaged, match='more than'):
            records_of(chunk(name, compressor(name)(CONTENT)))
    else:
        assert records_of(chunk(name, compressor(name)(CONTENT))) == CONTENT


def test_a_frame_without_an_end_is_refused_though_all_its_bytes_are_there():
    stream = zstandard.ZstdCompressor(level=1).compressobj()
    endless = stream.compress(CONTENT) + stream.flush(zstandard.COMPRESSOBJ_FLUSH_BLOCK)
    for name, data in (('zstd', endless), ('lz4', lz4.frame.compress(CONTENT)[:-4])):
        with pytest.raises(Damaged, match='does not end'):
            records_of(chunk(name, data))


@pytest.mark.parametrize('name', NAMES[1:])
def test_what_is_no_compressed_data_is_refused(name):
    with pytest.raises(Damaged):
        records_of(chunk(name, CONTENT))


def test_no_other_compression_is_known():
    with pytest.raises(UnsupportedCompressionError):
        compressor('gzip')
    with pytest.raises(UnsupportedCompressionError):
        records_of(chunk('gzip', CONTENT))


@pytest.mark.parametrize('checksum', [True, False])
@pytest.mark.parametrize('content', [b'', b'some', CONTENT, bytes(200_000)])
def test_a_zstd_frame_ends_behind_its_checksum_if_it_has_one(content, checksum):
    frame = zstandard.ZstdCompressor(write_checksum=checksum).compress(content)
    assert zstd_length(frame) == zstd_length(frame + b'more bytes') == len(frame)
    assert zstd_length(frame[:-1]) == 0
