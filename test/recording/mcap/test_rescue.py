# SPDX-License-Identifier: Apache-2.0
"""Records of which some may be wrong, beside their message indexes."""

import numpy as np
import pytest

from rigid_body_sim.recording.mcap import chunks, rescue

RECORDS = b''.join(chunks.message(1 + k % 2, k, 10**9 + k, 7, bytes(8)) for k in range(4))
SIZE = len(RECORDS) // 4
CHANNEL, TIME = 9, 15    # of a record of a message: the places of their first bytes


def entries():
    found = np.empty(4, [('channel', '<u2'), ('time', '<u8'), ('offset', '<u8')])
    found['channel'], found['offset'] = [1, 2, 1, 2], SIZE * np.arange(4)
    found['time'] = 10**9 + np.arange(4)
    return found


@pytest.mark.parametrize('place', [CHANNEL, CHANNEL + 1, TIME, TIME + 7])
@pytest.mark.parametrize('number', range(4))
def test_one_wrong_byte_of_one_head_is_mended_by_the_indexes(number, place):
    wrong = bytearray(RECORDS)
    wrong[number * SIZE + place] ^= 4
    records, offsets, others = rescue._sift(bytes(wrong), entries())
    assert (records, offsets.tolist(), others) == (RECORDS, [SIZE * k for k in range(4)], [])


def test_records_that_agree_with_their_indexes_are_returned_as_they_are():
    records, offsets, others = rescue._sift(RECORDS, entries())
    assert records is RECORDS
    assert (offsets.tolist(), others) == ([SIZE * k for k in range(4)], [])
