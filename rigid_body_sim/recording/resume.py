# SPDX-License-Identifier: Apache-2.0
"""How a recorder goes on after its predecessor died.

The files it left are made whole, and what they hold is not recorded again.
"""

import pathlib

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording.file_reader import FileReader
from rigid_body_sim.recording.recover import recording_files
from rigid_body_sim.recording.repair import recover_file

# A report goes out after each flush, so the sender's knowledge is at most a few chunks old.
_LAST_CHUNKS = 16


def resume(path, ticking, report):
    """Make the files of a recording whole and bring a Report up to what they hold.

    Parameters
    ----------
    path : path-like
    ticking : sequence of str
        Names of the topics recorded at every tick. The sequence of their messages is the number of
        the tick, that of others the number of the message (modulo 2**32).
    report : Report

    Returns
    -------
    list of FileRecord
    """
    folder = pathlib.Path(path)
    found = [recover_file(folder / name)[1] for name in recording_files(folder)]
    if not found:
        raise BadInput(str(path), 'the recording was deleted', 'a new one')
    reader = FileReader(folder / found[-1].file.name)
    for place in reader.places()[-_LAST_CHUNKS:]:
        heads = reader.piece(place, reader.channels, 0, 2**64 - 1).heads
        for number in np.unique(heads['channel']).tolist():
            last = heads[heads['channel'] == number][-1]
            sequence = int(last['sequence'])
            if reader.channels[number].topic in ticking:
                report.ticks = _later(report.ticks, sequence + 1)
                report.last_tick = max(report.last_tick, int(last['log_time']))
            elif sequence:
                report.acknowledged = _later(report.acknowledged, sequence)
    reader.close()
    report.recorded = sum(sum(one.file.counts.values()) for one in found)
    report.written = sum((folder / one.file.name).stat().st_size for one in found)
    return [one.file for one in found]


def _later(known, found):
    """Return the larger of a number and one of which only the lowest 32 bits are known."""
    ahead = (found - known) & 0xffffffff
    return known + ahead if ahead < 2**31 else known
