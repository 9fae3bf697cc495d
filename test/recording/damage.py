# SPDX-License-Identifier: Apache-2.0
"""Recordings damaged in many ways, for readers that have to cope with them."""

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer


def damaged_copy(content, rng):
    """Return a damaged copy of a file.

    Bytes are changed, lengths are wrong, pieces are missing, doubled or zero.
    """
    damaged = bytearray(content)
    at, size = rng.randrange(len(damaged)), rng.choice((1, 8, 100, 5000))
    kind = rng.randrange(8)
    if kind == 0:
        del damaged[at:at + size]
    elif kind == 1:
        damaged[at:at] = damaged[at:at + size]
    elif kind == 2:
        damaged[at:at + size] = bytes(len(damaged[at:at + size]))
    elif kind == 3:
        damaged[at : at + 8] = rng.choice((2**63, 2**40, 2**31 - 1, 2**28, 0)).to_bytes(
            8, 'little'
        )[: len(damaged[at : at + 8])]
    else:
        for _ in range(rng.choice((1, 1, 5, 100))):
            damaged[rng.randrange(len(damaged))] = rng.choice(
                (0, 1, 0x7F, 0xFF, rng.randrange(256))
            )
    if (
        rng.random() < 0.3 and len(damaged) > 12
    ):  # make the summary's checksum right again: it is not what protects us
        damaged[-12:-8] = bytes(4)
    return damaged


def without_checksums(path):
    """Write a recording again by another writer, which leaves checksums out.

    What the file says is then all there is to believe.
    """
    with open(path, 'rb') as stream:
        found = [
            (schema, channel, message)
            for schema, channel, message in make_reader(stream).iter_messages()
        ]
    with open(path, 'wb') as stream:
        writer = Writer(
            stream, chunk_size=20_000, compression=CompressionType.NONE, enable_crcs=False
        )
        writer.start('ros2', 'theirs')
        channels = {}
        for schema, channel, message in found:
            if channel.id not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, number, channel.metadata
                )
            writer.add_message(
                channels[channel.id],
                message.log_time,
                message.data,
                message.publish_time,
                message.sequence,
            )
        writer.finish()
