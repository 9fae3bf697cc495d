"""Where a recorder goes on after its predecessor died: the files it left are made whole, and what they hold is not recorded again."""

import pathlib

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import compression, mcap_format
from rigid_body_sim.recording.recover import recording_files, recover_file
from rigid_body_sim.recording.summary import chunk_places, read_summary
from rigid_body_sim.recording.walk import heads, walk

# A report goes out after each flush, so the sender's knowledge is at most a few chunks old.
_LAST_CHUNKS = 16


def resume(path, ticking, report):
    """Make the files of a recording whole, bring `report` (Report) up to what they hold, and return their FileRecords.

    `ticking`: names of the topics recorded at every tick. The sequence of their messages is the number of the tick, that of others the
    number of the message (modulo 2**32).
    """
    folder = pathlib.Path(path)
    found = [recover_file(folder / name)[1] for name in recording_files(folder)]
    if not found:
        raise BadInput(str(path), 'the recording was deleted', 'a new one')
    names = {channel.id: channel.topic for channel in found[-1].channels}
    with open(folder / found[-1].file.name, 'rb') as stream:
        for place in chunk_places(read_summary(stream))[-_LAST_CHUNKS:]:
            stream.seek(place.offset + mcap_format.HEAD.size)
            content = stream.read(place.length - mcap_format.HEAD.size)
            head = mcap_format.read_chunk(content)
            records = compression.decompress(head.compression, content[head.data_offset:], head.size, head.crc)
            message_heads = heads(records, walk(records)[0])
            for number in np.unique(message_heads['channel']).tolist():
                last = message_heads[message_heads['channel'] == number][-1]
                sequence = int(last['sequence'])
                if names[number] in ticking:
                    report.ticks, report.last_tick = _later(report.ticks, sequence + 1), max(report.last_tick, int(last['log_time']))
                elif sequence:
                    report.acknowledged = _later(report.acknowledged, sequence)
    report.recorded = sum(sum(one.file.counts.values()) for one in found)
    report.written = sum((folder / one.file.name).stat().st_size for one in found)
    return [one.file for one in found]


def _later(known, found):
    """Return the larger of a number and one of which only the lowest 32 bits are known."""
    ahead = (found - known) & 0xffffffff
    return known + ahead if ahead < 2**31 else known
