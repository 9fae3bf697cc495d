# SPDX-License-Identifier: Apache-2.0
"""Figures of recordings: writing, size, reading, analysing, cost to the node, loss by a kill.

    PYTHONPATH=. .venv/bin/python bench/recordings.py [--seconds 60] [--hour]

The messages are those of a node's four topics on the racket scene. The output is JSON; single
times depend on the machine and on its other load.
"""

import argparse
import contextlib
import json
import os
import pathlib
import signal
import statistics
import struct
import subprocess
import sys
import tempfile
import time

import mcap.exceptions
import mcap.reader
import mcap.records
import mcap.stream_reader
import mcap.writer
import numpy as np

from rigid_body_sim.messages.definitions import definition
from rigid_body_sim.messages.state_topics import EVERY_TICK, Frames
from rigid_body_sim.messages.tick_messages import TickMessages
from rigid_body_sim.recording.mcap.compression import records_of
from rigid_body_sim.recording.mcap.reading import FileReader
from rigid_body_sim.recording.mcap.walk import heads, walk
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.recorder import Recorder
from rigid_body_sim.recording.recover import recover
from rigid_body_sim.recording.topics import Topic, journal_topic
from rigid_body_sim.recording.writer import Writer
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

MILLISECOND = 1_000_000
HERE = pathlib.Path(__file__).resolve().parent
SCENES = (
    'tennis_racket',
    'heavy_top',
    'billiard_low',
    'tennis_racket initial.velocity=[0.1,0.2,0.3]',
)
ENVIRONMENT = dict(os.environ, PYTHONPATH=f'{HERE}{os.pathsep}{HERE.parent}')


class Racket:
    """Ticks of the racket (or of another scene) at a rate (1/s).

    They have stamps, and packed messages of the four topics.
    """

    def __init__(self, count, rate, scene='tennis_racket'):
        simulation = Simulation(scene, rate=rate)
        states = simulation.states(np.arange(count) / rate)
        self.stamps = time.time_ns() + np.arange(count) * round(1e9 / rate)
        messages = TickMessages(EVERY_TICK, simulation.scene, Frames())
        self.rows = messages.columns(states.vector, *simulation.diagnose(states), self.stamps)
        self.ticking = [(Topic(f'/{output.name}', output.type), size)
                        for output, size in zip(EVERY_TICK, messages.sizes, strict=True)]
        self.payload = sum(rows.size for rows in self.rows)


def writing(folder, seconds, block=None, scene='tennis_racket'):
    """Write a scene at 1 kHz; return messages/s and size/payload.

    A chunk ends every `block` ticks, as in the node; without `block` it is written at full speed.
    """
    racket = Racket(round(seconds * 1000), 1000.0, scene)
    late = racket.stamps + np.random.default_rng(1).integers(30_000, 200_000, len(racket.stamps))
    began = time.perf_counter()
    with Writer(folder, racket.ticking, [], journal_topic(), {'scene': 'tennis_racket'}) as writer:
        for first in range(0, len(late), block or 4096):
            part = slice(first, first + (block or 4096))
            writer.ticks(
                first, racket.stamps[part], late[part], [rows[part] for rows in racket.rows])
            if block:
                writer.flush()
    spent = time.perf_counter() - began
    size = sum(path.stat().st_size for path in folder.iterdir())
    return 4 * len(late) / spent, size / racket.payload


def reading(folder):
    """Decode every column of a recording; return messages/s."""
    began, count = time.perf_counter(), 0
    with Recording(folder) as recording:
        for _, columns in recording.blocks():
            count += len(columns['log_time'])
    return count / (time.perf_counter() - began)


def beside_the_library(folder):
    """Time the work of recording/mcap and of the package mcap for the same; return seconds.

    Each entry is (ours, the library's), on a recording of `folder` as the node writes it.
    """
    racket = Racket(10_000, 1000.0)
    path = next(folder.glob('*.mcap'))
    chunks, cut = list(_chunks(path)), folder / 'cut'
    return {
        'write 40,000 messages': (_timed(_write_ours, folder / 'ours', racket),
                                  _timed(_write_theirs, folder / 'theirs', racket)),
        'walk the records of all chunks': (_timed(_walk_ours, chunks),
                                           _timed(_walk_theirs, chunks)),
        'read all messages': (_timed(_read_ours, path), _timed(_read_theirs, path)),
        'mend a file without its end': (_timed(_mend_ours, _cut(path, cut)),
                                        _timed(_mend_theirs, _cut(path, cut))),
    }


def _timed(function, *arguments):
    began = time.process_time()
    function(*arguments)
    return time.process_time() - began


def _write_ours(folder, racket):
    with Writer(folder, racket.ticking, [], journal_topic(), {}) as writer:
        writer.ticks(0, racket.stamps, racket.stamps, racket.rows)


def _write_theirs(path, racket):
    with open(path, 'wb') as stream:
        writer = mcap.writer.Writer(stream, chunk_size=2**16)
        writer.start('ros2')
        channels = []
        for topic, _ in racket.ticking:
            text = definition(topic.type).text.encode()
            schema = writer.register_schema(topic.type, 'ros2msg', text)
            channels.append(writer.register_channel(topic.name, 'cdr', schema))
        for k, stamp in enumerate(racket.stamps.tolist()):
            for channel, rows in zip(channels, racket.rows, strict=True):
                writer.add_message(channel, stamp, rows[k].tobytes(), stamp, k)
        writer.finish()


def _chunks(path):
    with open(path, 'rb') as stream:
        reader = mcap.stream_reader.StreamReader(stream, emit_chunks=True)
        yield from (record for record in reader.records if isinstance(record, mcap.records.Chunk))


def _walk_ours(chunks):
    for chunk in chunks:
        records = records_of(chunk)
        heads(records, walk(records)[0])


def _walk_theirs(chunks):
    for chunk in chunks:
        mcap.stream_reader.breakup_chunk(chunk, validate_crc=True)


def _read_ours(path):
    reader = FileReader(path)
    for place in reader.places():
        reader.piece(place, reader.channels, 0, 2**63)
    reader.close()


def _read_theirs(path):
    with open(path, 'rb') as stream:
        for _ in mcap.reader.make_reader(stream, validate_crcs=True).iter_messages():
            pass


def _cut(path, cut):
    """Make and return a copy of a file without its tail."""
    content = path.read_bytes()
    cut.write_bytes(content[:-2000])
    return cut


def _mend_ours(path):
    recover(path)


def _mend_theirs(path):
    """Read up to the cut, and write the records found into another file."""
    with open(path, 'rb') as stream, open(path.with_suffix('.new'), 'wb') as new:
        writer, numbers = mcap.writer.Writer(new, chunk_size=2**16), {}
        writer.start('ros2')
        with contextlib.suppress(mcap.exceptions.McapError, struct.error):
            for record in mcap.stream_reader.StreamReader(stream).records:
                if isinstance(record, mcap.records.Schema):
                    writer.register_schema(record.name, record.encoding, record.data)
                elif isinstance(record, mcap.records.Channel):
                    numbers[record.id] = writer.register_channel(
                        record.topic, record.message_encoding, record.schema_id, record.metadata)
                elif isinstance(record, mcap.records.Message):
                    writer.add_message(numbers[record.channel_id], record.log_time, record.data,
                                       record.publish_time, record.sequence)
        writer.finish()


def analysing(folder, seconds):
    """Run `simulate` for some seconds and `analyze` on its recording.

    Return messages/s of the first, and seconds and peak memory (MB) of the second.
    """
    command = [sys.executable, '-m', 'rigid_body_sim']
    simulated = subprocess.run(
        [*command, 'simulate', '--duration', str(seconds), '--output', folder, '--json'],
        capture_output=True, check=True, env=ENVIRONMENT)
    cost = json.loads(simulated.stdout)['cost']
    began = time.perf_counter()
    _, status, usage = os.wait4(subprocess.Popen(
        [*command, 'analyze', folder, '--json'], stdout=subprocess.DEVNULL,
        env=ENVIRONMENT).pid, 0)
    if status:
        raise RuntimeError('analyze failed')
    return {
        'messages': cost['messages'],
        'simulate_messages_per_second': cost['messages'] / cost['run'],
        'analyze_seconds': time.perf_counter() - began,
        'analyze_cpu_seconds': usage.ru_utime + usage.ru_stime,
        'analyze_peak_mb': usage.ru_maxrss / 1024,
    }


def ticking(folder, rate, seconds):
    """Record at a rate in real time.

    Return the cost of a tick in us (median, p99), dropped ticks, and the recorder's CPU share.
    """
    racket = Racket(min(round(rate * seconds), 40_000), rate)
    messages = [[rows[index].tobytes() for rows in racket.rows]
                for index in range(len(racket.stamps))]
    recorder = Recorder(folder, racket.ticking, [], journal_topic(), {})
    costs, start, period = [], time.perf_counter(), round(1e9 / rate)
    for k in range(round(rate * seconds)):
        while (wait := start + k / rate - time.perf_counter()) > 0.0:
            time.sleep(wait)
        stamp, begun = int(racket.stamps[0]) + k * period, time.perf_counter()
        recorder.tick(stamp, time.time_ns(), messages[k % len(messages)])
        costs.append(time.perf_counter() - begun)
    cpu = sum(map(int, pathlib.Path(f'/proc/{recorder.process_id}/stat').read_text()
                  .rpartition(')')[2].split()[11:13]))
    status = recorder.close()
    return {
        'median_us': statistics.median(costs) * 1e6,
        'p99_us': float(np.quantile(costs, 0.99)) * 1e6,
        'dropped': status.dropped,
        'recorder_cpu': cpu / os.sysconf('SC_CLK_TCK') / seconds,
        'complete': status.closed,
    }


_NODE = """
import sys, time
from recordings import Racket, Recorder, journal_topic
racket = Racket(2000, 1000.0)
recorder = Recorder(sys.argv[1], racket.ticking, [], journal_topic(), {})
print(recorder.process_id, flush=True)
start = time.monotonic()
for k in range(10**9):
    time.sleep(max(0.0, start + k / 1000 - time.monotonic()))
    messages = [rows[k % 2000].tobytes() for rows in racket.rows]
    recorder.tick((1 + k) * 1_000_000, time.time_ns(), messages)
    sys.stdout.write('.')
    sys.stdout.flush()
"""


def killing(folder, runs=10):
    """Kill a 1 kHz recording and its recorder, `runs` times.

    Return the losses in ms of stamps, in ascending order.
    """
    lost = []
    for number in range(runs):
        path = folder / f'killed{number}'
        with subprocess.Popen([sys.executable, '-c', _NODE, str(path)], stdout=subprocess.PIPE,
                              env=ENVIRONMENT) as node:
            recorder = int(node.stdout.readline())
            said = 0
            while said < 500 + 37 * number:
                said += len(node.stdout.read1())
            os.kill(recorder, signal.SIGKILL)
            node.kill()
            said += len(node.stdout.read())
        while pathlib.Path(f'/proc/{recorder}').exists():
            time.sleep(0.01)
        recover(path)
        with Recording(path) as recording:
            lost.append(said - recording.end_time / MILLISECOND)
    return sorted(lost)


def main():
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description='Figures of recordings.')
    parser.add_argument(
        '--seconds', type=float, default=60.0, help='length of the recording at 4 kHz (60)')
    parser.add_argument(
        '--hour', action='store_true',
        help='simulate and analyse an hour, not a minute: 14.4 million messages, 0.5 GB')
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder, figures = pathlib.Path(name), {}
        for title, block in (('simulate', None), ('node', 100)):
            speed, ratio = writing(folder / title, 60.0, block)
            figures[f'writer as {title}'] = {
                'messages_per_second': speed, 'size_by_payload': ratio}
        figures['size by payload'] = {
            scene: writing(folder / f'size{number}', 20.0, 100,
                           load_scene(scene.split()[0], scene.split()[1:]))[1]
            for number, scene in enumerate(SCENES)}
        figures['ours and the library: CPU seconds'] = beside_the_library(folder / 'node')
        figures['reader'] = {'messages_per_second': reading(folder / 'node')}
        figures['4 topics at 1 kHz'] = ticking(folder / 'slow', 1000.0, 10.0)
        figures['4 topics at 4 kHz'] = ticking(folder / 'fast', 4000.0, options.seconds)
        figures['node and recorder killed: ms lost'] = killing(folder)
        figures['simulate and analyze'] = analysing(
            folder / 'run', 3600.0 if options.hour else 60.0)
    print(json.dumps(figures, indent=2))


if __name__ == '__main__':
    main()
