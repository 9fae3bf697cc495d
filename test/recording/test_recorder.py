# SPDX-License-Identifier: Apache-2.0
"""The recorder in its own process: complete after a kill of the node, all gaps marked.

Nothing important is lost whatever happens.
"""

import contextlib
import itertools
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from recording.conftest import ABOUT, JOURNAL, SCENE, START, TICKING, Ticks, scene_text
from rosbags.rosbag2 import Reader

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import recorder as module
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.recorder import Recorder
from rigid_body_sim.recording.recover import recover

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATIENCE = 30.0
NODE = """
import itertools, os, sys, time
from recording.conftest import ABOUT, JOURNAL, SCENE, TICKING, Ticks
from rigid_body_sim.recording.recorder import Recorder
recorder = Recorder(sys.argv[1], TICKING, [SCENE], JOURNAL, ABOUT)
print(recorder.process_id, flush=True)
start = time.monotonic()
for first in itertools.count(0, 1000):
    ticks = Ticks(first, 1000)
    for k in range(1000):
        time.sleep(max(0.0, start + (first + k) / 1000 - time.monotonic()))
        recorder.tick(int(ticks.stamps[k]), int(ticks.wall_clock[k]), ticks.messages(k))
        os.write(1, b'.')
"""


def start(path, **options):
    return Recorder(path, TICKING, [SCENE], JOURNAL, ABOUT, **options)


def tick(recorder, first, count, each=None):
    """Record ticks as a node does, with an entry of the journal at every tenth."""
    ticks = Ticks(first, count)
    for index in range(count):
        recorder.tick(
            int(ticks.stamps[index]), int(ticks.wall_clock[index]), ticks.messages(index)
        )
        if (first + index) % 10 == 0:
            recorder.journal(
                'impulse',
                int(ticks.stamps[index]),
                int(ticks.wall_clock[index]),
                tick=first + index,
            )
        if each:
            each()


def wait_for(condition, what):
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, f'waited {PATIENCE} s for {what}'
        time.sleep(0.01)


def check(path, sent):
    """Check a closed recording of `sent` ticks made by tick(); return the gaps.

    It is right but for marked gaps, and nothing important is lost.
    """
    with Recording(path) as recording:
        pose, journal = recording.read('/pose'), recording.journal()
    numbers = pose['sequence'].astype(int)
    ticks = Ticks(0, sent)
    if len(numbers):
        np.testing.assert_array_equal(pose['header.stamp'], ticks.stamps[numbers])
        np.testing.assert_array_equal(pose['pose.orientation'], ticks.orientation[numbers])
    assert [entry['tick'] for entry in journal if entry['kind'] == 'impulse'] == list(
        range(0, sent, 10)
    )
    gaps = [entry for entry in journal if entry['kind'] == 'gap']
    missing = sorted(set(range(sent)) - set(numbers.tolist()))
    assert np.all(np.diff(numbers) > 0)
    assert sum(gap['ticks'] for gap in gaps) == len(missing) == sent - len(numbers)
    begins, ends = (
        [number for number in missing if number + step not in missing] for step in (-1, 1)
    )
    assert [gap['after'] for gap in gaps] == [
        int(ticks.stamps[begin - 1]) if begin else 0 for begin in begins
    ]
    assert [gap['until'] for gap in gaps] == [
        int(ticks.stamps[end + 1]) if end + 1 < sent else None for end in ends
    ]
    return gaps


def test_everything_is_recorded_in_order(tmp_path):
    recorder = start(tmp_path / 'bag')
    assert recorder.state_wanted
    recorder.important('/scene', START, START, scene_text('x'))
    recorder.message('/scene', START, START, scene_text('y'))
    tick(recorder, 0, 3000)
    status = recorder.close()
    assert (
        status.recorded,
        status.dropped,
        status.lost,
        status.waiting,
        status.restarts,
        status.error,
        status.closed,
    ) == (12_303, 0, 0, 0, 0, '', True)      # 4 topics, 300 entries, begin, 2 scenes
    assert check(tmp_path / 'bag', 3000) == []
    assert status.written == (tmp_path / 'bag' / 'bag_0.mcap').stat().st_size
    with Reader(tmp_path / 'bag') as reader:
        assert reader.message_count == 12_303


def test_full_state_is_asked_for_in_every_file(tmp_path):
    recorder, asked, seen = start(tmp_path / 'bag', split_seconds=0.2), [], 0

    def look():
        if recorder.state_wanted:
            recorder.state_wanted = False
            asked.append(1)
        time.sleep(0.0005)

    def files():
        return len(list((tmp_path / 'bag').glob('*.mcap')))
    for part in range(5):
        before = files()
        tick(recorder, 200 * part, 200, look)
        # one that was kept from running begins two files at once, and asks once
        seen += files() > before
        patience = time.monotonic() + 5.0
        while len(asked) < seen and time.monotonic() < patience:
            recorder.status()       # reads what the recorder reports, as a tick does now and then
            look()
    recorder.close()
    assert files() >= 3
    assert seen <= len(asked) <= files()


def test_messages_of_another_size_are_an_error(tmp_path):
    recorder = start(tmp_path / 'bag')
    with pytest.raises(ValueError, match='messages of 4 bytes where the ticking topics have 160'):
        recorder.tick(START, START, [b'four'])
    recorder.close()


@contextlib.contextmanager
def stopped(recorder):
    """Stop the recorder for a while."""
    os.kill(recorder.process_id, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(recorder.process_id, signal.SIGCONT)


@pytest.fixture
def node(tmp_path):
    """Yield (process, pid of its recorder): it records 1000 ticks a second until it is killed.

    It says '.' after each.
    """
    environment = dict(os.environ, PYTHONPATH=f'{ROOT}{os.pathsep}{ROOT / "test"}')
    with subprocess.Popen(
        [sys.executable, '-c', NODE, str(tmp_path / 'bag')],
        stdout=subprocess.PIPE,
        env=environment,
        start_new_session=True,
    ) as process:
        yield process, int(process.stdout.readline())
        process.kill()


def _gone(pid):
    """Return whether a process has ended."""
    try:
        return pathlib.Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()[0] == 'Z'
    except (FileNotFoundError, ProcessLookupError):
        return True


def _kill_after(process, ticks, *pids):
    """Kill after so many ticks; return how many were recorded as far as the node knew."""
    said = len(process.stdout.read1(1))
    while said < ticks:
        said += len(process.stdout.read1())
    for pid in pids:
        os.kill(pid, signal.SIGKILL)
    return said + len(process.stdout.read())


def test_killed_node_leaves_a_complete_recording(tmp_path, node):
    process, recorder = node
    said = _kill_after(process, 700, process.pid)
    wait_for(lambda: _gone(recorder), 'the recorder to end')
    with Reader(tmp_path / 'bag') as reader:
        recorded = {connection.topic: connection.msgcount for connection in reader.connections}
    # at most the tick between recording and saying so is there unsaid
    assert recorded['/pose'] == recorded['/angular_momentum_squared'] in (said, said + 1)


def test_killed_node_and_recorder_leave_all_but_the_last_moment(tmp_path, node):
    process, recorder = node
    said = _kill_after(process, 1200, recorder, process.pid)
    wait_for(lambda: _gone(recorder), 'the recorder to end')
    assert not (tmp_path / 'bag' / 'metadata.yaml').exists()
    recover(tmp_path / 'bag')
    with Reader(tmp_path / 'bag') as reader:
        recorded = max(timestamp for _, timestamp, _ in reader.messages())
    lost = said - 1 - (recorded - START) / 10**6
    assert lost <= 600      # ticks: on a quiet machine up to 130


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_are_for_the_node(tmp_path, number):
    recorder = start(tmp_path / 'bag')
    assert os.getpgid(recorder.process_id) != os.getpgid(0)
    os.kill(recorder.process_id, number)
    tick(recorder, 0, 100)
    assert recorder.close().closed
    assert check(tmp_path / 'bag', 100) == []


def test_killed_recorder_is_followed_by_another_and_nothing_important_is_lost(tmp_path):
    recorder = start(tmp_path / 'bag')
    tick(recorder, 0, 300)
    time.sleep(0.25)        # some of it is in the file, some in its memory, some in the pipe
    tick(recorder, 300, 200)
    os.kill(recorder.process_id, signal.SIGKILL)
    tick(recorder, 500, 200)
    wait_for(
        lambda: recorder.status().restarts == 1 and not recorder.status().error,
        'the next recorder',
    )
    tick(recorder, 700, 300)
    status = recorder.close()
    assert (status.closed, status.restarts) == (True, 1)
    gaps = check(tmp_path / 'bag', 1000)
    assert len(gaps) <= 1  # what was in its memory; if it just had written that, the pipe at most
    assert status.dropped == sum(gap['ticks'] for gap in gaps)
    with Reader(tmp_path / 'bag') as reader:
        assert len(list((tmp_path / 'bag').glob('*.mcap'))) == 2
        assert reader.message_count == status.recorded


def test_recorder_killed_at_the_last_moment_is_followed_by_one_that_finishes(tmp_path):
    recorder = start(tmp_path / 'bag')
    tick(recorder, 0, 100)
    os.kill(recorder.process_id, signal.SIGKILL)
    assert recorder.close().closed
    check(tmp_path / 'bag', 100)


def test_stopped_recorder_costs_bounded_memory_and_only_ticks(tmp_path, monkeypatch):
    monkeypatch.setattr(module, 'BACKLOG', 100_000)
    recorder = start(tmp_path / 'bag')
    tick(recorder, 0, 100)
    wait_for(lambda: recorder.state_wanted, 'the first wish for a state')
    with stopped(recorder):
        recorder.state_wanted = False
        tick(recorder, 100, 9900)       # 2 MB: the pipe takes 1
        status = recorder.status()
        assert status.dropped > 2000
        assert (
            status.waiting < 100_000 + 990 * 100
        )  # ticks up to the limit, journal entries beyond
    for first in itertools.count(10_000, 100):
        tick(recorder, first, 100)
        if recorder.status().waiting == 0 and recorder.state_wanted:
            break
        time.sleep(0.01)
    status = recorder.close()
    assert status.closed
    gaps = check(tmp_path / 'bag', first + 100)
    assert gaps
    assert status.dropped == sum(gap['ticks'] for gap in gaps) > 2000


def test_what_a_stopped_recorder_has_not_taken_at_the_end_is_said(tmp_path):
    recorder = start(tmp_path / 'bag')
    with stopped(recorder):
        for k in range(8):
            recorder.important(SCENE.name, k, k, bytes(2**20))
        status = recorder.close(timeout=0.1)
        assert not status.closed
        assert re.fullmatch(
            r'the recorder was too slow to take the last \d{7} bytes', status.error
        )
        assert int(re.search(r'\d+', status.error)[0]) == status.waiting > 2**20
    os.waitpid(recorder.process_id, 0)


def test_full_disk_is_reported_and_recording_resumes_when_there_is_room(tmp_path):
    recorder = start(tmp_path / 'bag')
    tick(recorder, 0, 200)
    wait_for(lambda: recorder.status().recorded > 800, 'the first messages')
    resource.prlimit(recorder.process_id, resource.RLIMIT_FSIZE, (40_000, resource.RLIM_INFINITY))
    sent = 200
    while not recorder.status().error:
        tick(recorder, sent, 100)
        sent += 100
        assert sent < 20_000
        time.sleep(0.05)
    assert recorder.status().error == f'{tmp_path / "bag"}: File too large'
    tick(recorder, sent, 500)       # the simulation goes on
    sent += 500
    time.sleep(0.2)
    assert recorder.status().dropped >= 400
    resource.prlimit(
        recorder.process_id,
        resource.RLIMIT_FSIZE,
        (resource.RLIM_INFINITY, resource.RLIM_INFINITY),
    )
    recorder.state_wanted = False
    wait_for(lambda: not recorder.status().error, 'the end of the error')
    tick(recorder, sent, 300)
    wait_for(
        lambda: recorder.status() and recorder.state_wanted,
        'the wish for a full state after the gap',
    )
    status = recorder.close()
    assert status.closed
    assert len(check(tmp_path / 'bag', sent + 300)) == 1


def test_disk_that_stays_full_leaves_what_recover_makes_whole(tmp_path):
    recorder = start(tmp_path / 'bag')
    resource.prlimit(recorder.process_id, resource.RLIMIT_FSIZE, (120_000, resource.RLIM_INFINITY))
    for first in range(0, 2000, 100):
        tick(recorder, first, 100)
        time.sleep(0.02)
    status = recorder.close()
    assert not status.closed
    assert (
        status.error
        == f'{tmp_path / "bag"}: File too large; not closed, '
        '"recover" makes it whole once there is room'
    )
    result, = recover(tmp_path / 'bag')
    assert result.changed
    with Recording(tmp_path / 'bag') as recording:
        numbers = recording.read('/pose')['sequence']
        assert recording.message_count == status.recorded
    np.testing.assert_array_equal(numbers, np.arange(len(numbers)))
    assert len(numbers) > 100


def test_deleted_recording_is_reported(tmp_path):
    recorder = start(tmp_path / 'bag')
    tick(recorder, 0, 100)
    shutil.rmtree(tmp_path / 'bag')
    tick(recorder, 100, 100)
    wait_for(lambda: recorder.status().error, 'the error')
    assert recorder.status().error == f'{tmp_path / "bag"}: the recording was deleted'
    tick(recorder, 200, 100)
    assert not recorder.close().closed


def test_renamed_recording_goes_on_in_its_folder(tmp_path):
    recorder = start(tmp_path / 'bag')
    tick(recorder, 0, 100)
    (tmp_path / 'bag').rename(tmp_path / 'moved')
    tick(recorder, 100, 100)
    assert recorder.close().closed
    assert check(tmp_path / 'moved', 200) == []


def test_places_that_will_not_do_are_refused_before_anything_runs(tmp_path):
    (tmp_path / 'there').mkdir()
    (tmp_path / 'file').write_text('')
    with pytest.raises(
        BadInput, match='there: exists already; the name of a recording that does not exist yet'
    ):
        start(tmp_path / 'there')
    with pytest.raises(BadInput, match='no recording can be made here'):
        start(tmp_path / 'file' / 'bag')
    with pytest.raises(BadInput, match="compression: 'rar'; one of zstd, lz4, none"):
        start(tmp_path / 'bag', compression_name='rar')


def test_important_messages_beyond_the_limit_are_counted_not_hoarded(tmp_path, monkeypatch):
    monkeypatch.setattr(module, 'UNCONFIRMED', 5000)
    recorder = start(tmp_path / 'bag')
    with stopped(recorder):
        for k in range(200):
            recorder.journal('impulse', START + k, START + k, tick=k)
        lost = recorder.status().lost
    assert recorder.close().closed
    with Recording(tmp_path / 'bag') as recording:
        assert [
            entry['tick'] for entry in recording.journal() if entry['kind'] == 'impulse'
        ] == list(range(200 - lost))
    assert 100 < lost < 200
