# SPDX-License-Identifier: Apache-2.0
"""A reader in another language: @mcap/core (make soak installs it where npm is there)."""

import hashlib
import json
import os
import pathlib
import shutil
import subprocess

import pytest
from recording.conftest import ABOUT, Ticks, write

from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.recover import recover

FOLDER = pathlib.Path(__file__).resolve().parents[2] / '.cache' / 'mcap_core'
NODE = shutil.which('node')

pytestmark = pytest.mark.skipif(
    not (NODE and (FOLDER / 'node_modules' / '@mcap' / 'core').is_dir()),
    reason='needs @mcap/core (make soak)',
)


@pytest.mark.parametrize('mended', [False, True], ids=['whole', 'mended'])
@pytest.mark.parametrize('compression_name', ['zstd', 'lz4', 'none'])
def test_it_reads_every_byte_and_decodes_by_the_recorded_definitions(tmp_path, compression_name,
                                                                     mended):
    path = write(tmp_path / 'bag', compression_name=compression_name)
    if mended:      # cut in its tail
        os.truncate(path / 'bag_0.mcap', (path / 'bag_0.mcap').stat().st_size - 1000)
        assert recover(path)[0].changed
    done = subprocess.run(
        [NODE, FOLDER / 'read.mjs', path / 'bag_0.mcap'],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    with Recording(path) as recording:
        assert {name: topic.count for name, topic in recording.topics.items()} == {
            name: topic['count'] for name, topic in told.items()
        }
        for name, topic in told.items():
            messages = list(recording.messages([name]))
            assert (
                topic['digest']
                == hashlib.sha256(b''.join(message.data for message in messages)).hexdigest()
            )
            assert (int(topic['first']), int(topic['last'])) == (
                messages[0].log_time,
                messages[-1].log_time,
            )
            assert topic['type'] == recording.topics[name].type
    ticks = Ticks(999, 1)
    assert (
        list(told['/pose']['message']['pose']['orientation'].values())
        == ticks.orientation[0].tolist()
    )
    assert told['/energy']['message']['data'] == ticks.energy[0]
    assert told['/scene']['message']['data'] == ABOUT['scene']
