# SPDX-License-Identifier: Apache-2.0
"""The recorder's treatment of each packet: nothing twice, nothing out of order.

This holds whatever the order of arrival.
"""

import dataclasses
import errno
import json
import os
import select

import numpy as np
import pytest
from made_clock import clock_of
from recording.conftest import ABOUT, JOURNAL, SCENE, START, TICKING, Ticks, scene_text

from rigid_body_sim.recording import packets, resume
from rigid_body_sim.recording import process as module
from rigid_body_sim.recording.mcap.writing import McapFile
from rigid_body_sim.recording.packets import Report
from rigid_body_sim.recording.process import RecorderProcess
from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.recording.recover import recover
from rigid_body_sim.recording.topics import Topic
from rigid_body_sim.simulation.command_rows import FORCE, WIDTH

SCENE_POSITION = len(TICKING)
IMPULSES = Topic('/cmd_impulse', 'geometry_msgs/msg/WrenchStamped')


def setup(path, resume=False, report=None):
    return packets.json_packet(
        packets.SETUP,
        {
            'path': str(path),
            'ticking': [(dataclasses.asdict(topic), size) for topic, size in TICKING],
            'others': [dataclasses.asdict(SCENE), dataclasses.asdict(IMPULSES)],
            'journal': dataclasses.asdict(JOURNAL),
            'about': ABOUT,
            'compression': 'zstd',
            'split_bytes': 0,
            'split_seconds': 0.0,
            'commands': {'topics': [IMPULSES.name, '/none'], 'frames': ['world', 'body']},
            'resume': resume,
            'report': dataclasses.asdict(report or Report()),
        },
    )


def message(number):
    return packets.message_packet(number, SCENE_POSITION, START, START, scene_text(str(number)))


def ticks(first, count):
    made, size = Ticks(first, count), sum(size for _, size in TICKING)
    return b''.join(
        packets.TICK_HEAD.pack(
            packets.TICK,
            24 + size,
            first + index,
            int(made.stamps[index]),
            int(made.wall_clock[index]),
        )
        + b''.join(made.messages(index))
        for index in range(count)
    )


def commands(number, count, tick=0):
    """Return impulses of one tick, numbered from `number` on, with their numbers as force.

    The entry of the journal is the last one.
    """
    rows = np.zeros((count, WIDTH))
    rows[:, FORCE.start] = np.arange(number, number + count)
    return packets.commands_packet(number, tick, START, START, rows)


def end(sent):
    return packets.json_packet(packets.END, {'ticks': sent})


def run(*sent):
    """Run a process on packets; return (exit code, its reports)."""
    packets_out, packets_in = os.pipe()
    reports = []

    def send(line):
        reports.append(Report.of(line))
        return True
    os.write(packets_in, b''.join(sent))
    os.close(packets_in)
    os.set_blocking(packets_out, False)
    code = RecorderProcess(packets_out, send).run()
    os.close(packets_out)
    return code, reports


def recorded(path):
    """Return (numbers of messages, numbers of ticks, gaps).

    A gap is (ticks, after, until), in ticks since the start.
    """
    with Recording(path) as recording:
        numbers = [message.sequence for message in recording.messages(['/scene'])]
        poses = (
            recording.read('/pose')['sequence'].tolist() if recording.topics['/pose'].count else []
        )
        gaps = [
            (
                entry['ticks'],
                *(
                    (time - START) // 10**6 if time else time
                    for time in (entry['after'], entry['until'])
                ),
            )
            for entry in recording.journal()
            if entry['kind'] == 'gap'
        ]
    return numbers, poses, gaps


def test_packets_split_anywhere_are_put_together(tmp_path):
    sent = setup(tmp_path / 'bag') + message(1) + ticks(0, 3) + message(2) + ticks(3, 2) + end(5)
    process = RecorderProcess(-1, lambda line: True)
    for byte in sent:
        process._buffer += bytes([byte])
        process._take_packets()
    assert process._close() == 0
    assert recorded(tmp_path / 'bag') == ([1, 2], list(range(5)), [])


def test_repeated_messages_are_recorded_once(tmp_path):
    code, reports = run(setup(tmp_path / 'bag'), *map(message, (1, 2, 1, 2, 3, 3, 1)))
    assert code == 0
    assert reports[-1].acknowledged == 3
    assert recorded(tmp_path / 'bag')[0] == [1, 2, 3]


def test_missing_messages_are_asked_for_and_order_is_kept(tmp_path):
    code, reports = run(setup(tmp_path / 'bag'), *map(message, (1, 3, 4)))
    assert code == 0
    assert recorded(tmp_path / 'bag')[0] == [1]
    assert reports[-1].acknowledged == 1
    # one that begins asks for all; then once, though two came too early
    assert (reports[0].resend, reports[-1].resend) == (1, 2)
    run(setup(tmp_path / 'again'), *map(message, (1, 3, 2, 3)))
    assert recorded(tmp_path / 'again')[0] == [1, 2, 3]


def test_missing_messages_are_asked_for_again_after_a_while(tmp_path, monkeypatch):
    clock, _ = clock_of(monkeypatch, module)
    process = RecorderProcess(-1, lambda line: True)

    def asked(*sent):
        process._buffer = b''.join(sent)
        process._take_packets()
        return process.report.resend
    begun = asked(setup(tmp_path / 'bag'))
    assert asked(message(3), message(4)) == begun + 1
    clock[0] += 0.9 * module.RETRY
    assert asked(message(5)) == begun + 1
    clock[0] += 0.2 * module.RETRY
    assert asked(message(6), message(7)) == begun + 2
    assert asked(message(1), message(3)) == begun + 3    # another one is missing
    process._close()


@pytest.mark.parametrize(('full', 'least', 'most'), [(False, 16, 20), (True, 3, 4)])
def test_what_came_is_in_the_file_after_a_tenth_of_a_second(
        tmp_path, monkeypatch, full, least, most):
    """In two seconds without a packet; a disk that refuses is tried twice a second."""
    clock, slept = clock_of(monkeypatch, module)
    process = RecorderProcess(-1, lambda line: True)
    process._buffer = setup(tmp_path / 'bag') + message(1)
    process._take_packets()
    tries, flush = [], process._writer.flush

    def flushes():
        tries.append(clock[0])
        if full and clock[0] < 102.0:
            raise OSError(errno.ENOSPC, 'No space left on device')
        flush()
    process._writer.flush = flushes
    process._read = lambda: None if clock[0] < 102.0 else b''
    assert process.run() == 0
    in_time = [time for time in tries if time < 102.0]
    assert len(slept) in (100, 101)    # 50 looks a second
    assert least <= len(in_time) <= most
    assert process.report.acknowledged == 1


def recorded_commands(path):
    """Return the forces of recorded impulses, and those in the journal, tick by tick."""
    with Recording(path) as recording:
        entries = [entry for entry in recording.journal() if entry['kind'] == 'commands']
        forces = recording.read(IMPULSES.name, ['wrench.force'])['wrench.force'][:, 0].tolist()
    return forces, [
        (entry['tick'], [one['force'][0] for one in entry['commands']]) for entry in entries
    ]


def test_commands_of_a_tick_become_messages_and_one_entry_once_each_between_ticks(tmp_path):
    code, reports = run(
        setup(tmp_path / 'bag'),
        message(1),
        commands(2, 3, 5),
        ticks(5, 1),
        commands(2, 3, 5),
        commands(6, 2, 6),
        ticks(6, 1),
    )
    assert (code, reports[-1].acknowledged) == (0, 8)
    assert recorded_commands(tmp_path / 'bag') == (
        [2.0, 3.0, 4.0, 6.0, 7.0],
        [(5, [2.0, 3.0, 4.0]), (6, [6.0, 7.0])],
    )
    assert recorded(tmp_path / 'bag')[1] == [5, 6]


def test_commands_that_are_half_recorded_are_gone_on_with(tmp_path):
    """The file was full after the second of three messages: the packet comes again."""
    process = RecorderProcess(-1, lambda line: True)
    process._buffer = setup(tmp_path / 'bag')
    process._take_packets()
    record, left = process._writer.message, [2]

    def fills(*arguments):
        left[0] -= 1
        if left[0] < 0:
            raise OSError(errno.ENOSPC, 'No space left on device')
        record(*arguments)
    process._writer.message = fills
    process._buffer = commands(1, 3)
    process._take_packets()
    assert process.report.error
    left[0], asked = 10, process.report.resend
    process._flush(0.0)    # there is room again: what was dropped is asked for
    assert (process.report.error, process.report.resend) == ('', asked + 1)
    process._buffer = commands(1, 3)
    process._take_packets()
    assert process._close() == 0
    assert process.report.acknowledged == 4
    assert recorded_commands(tmp_path / 'bag') == ([1.0, 2.0, 3.0], [(0, [1.0, 2.0, 3.0])])


def test_gaps_at_the_start_in_the_middle_and_at_the_end(tmp_path):
    code, reports = run(
        setup(tmp_path / 'bag'),
        ticks(2, 3),
        ticks(7, 2),
        message(1),
        ticks(9, 1),
        ticks(20, 1),
        end(25),
    )
    assert code == 0
    assert (reports[-1].dropped, reports[-1].closed) == (2 + 2 + 10 + 4, True)
    assert reports[-1].state_wanted == 1 + 4    # at the start of the file, and after each gap
    assert recorded(tmp_path / 'bag') == (
        [1],
        [2, 3, 4, 7, 8, 9, 20],
        [(2, 0, 2), (2, 4, 7), (10, 9, 20), (4, 20, None)],
    )
    with Recording(tmp_path / 'bag') as recording:
        told = [one.publish_time for one in recording.messages(['/journal']) if b'gap' in one.data]
    # a gap is known when the tick after it comes, or the end
    assert told == [*(Ticks(tick, 1).wall_clock[0] for tick in (2, 7, 20)), START + 20 * 10**6]


def test_one_tick_that_is_missing_among_those_that_come_at_once_is_told(tmp_path):
    code, reports = run(setup(tmp_path / 'bag'), ticks(0, 2), ticks(3, 2), end(5))
    assert (code, reports[-1].dropped) == (0, 1)
    assert recorded(tmp_path / 'bag') == ([], [0, 1, 3, 4], [(1, 1, 3)])


@pytest.mark.parametrize(('sent', 'dropped'), [(8, 5), (3, 0), (2, 0)])
def test_ticks_that_are_missing_where_a_full_disk_ends_are_told(tmp_path, sent, dropped):
    process = RecorderProcess(-1, lambda line: True)
    process._buffer = setup(tmp_path / 'bag') + ticks(0, 3)
    process._take_packets()

    def full(*arguments):
        raise OSError(errno.ENOSPC, 'No space left on device')
    process._writer.message = process._writer.flush = full
    process._buffer = end(sent)
    process._take_packets()
    assert ('No space left' in process.report.error) == (dropped > 0)
    assert process.report.dropped == dropped
    process._writer.close = full
    assert process._close() == 1
    assert process.report.error.endswith('left on device; not closed, "recover" makes it whole '
                                         'once there is room')
    assert not process.report.closed


def test_without_a_packet_nothing_is_recorded():
    assert run() == (2, [])


def test_a_report_begins_with_nothing_done():
    told = dataclasses.asdict(Report())
    assert told.pop('error') == '' and told.pop('refused') == ()
    assert set(told.values()) == {0}
    report = Report(3, 4, 5, 6, 7, 8, 9, 10, 'full', ['a', 'b', 'c'], True)
    assert Report.of(report.line()) == report and report.line().count(b'\n') == 1


def test_as_much_as_a_pipe_takes_at_once():
    assert packets.ATOMIC == select.PIPE_BUF


def _die_after(path, *sent):
    """Record packets up to a flush and then die without a word.

    The sender knows nothing of what was flushed.
    """
    process = RecorderProcess(-1, lambda line: True)
    process._buffer = b''.join(sent)
    process._take_packets()
    process._flush(0.0)
    process._writer._file.close()


def test_successor_does_not_record_again_what_its_predecessor_did_not_report(tmp_path):
    _die_after(
        tmp_path / 'bag', setup(tmp_path / 'bag'), message(1), ticks(0, 10), message(2), message(3)
    )
    code, reports = run(
        setup(tmp_path / 'bag', resume=True), *map(message, (1, 2, 3, 4)), ticks(12, 3), end(15)
    )
    assert code == 0
    assert (reports[0].acknowledged, reports[0].ticks) == (3, 10)
    assert recorded(tmp_path / 'bag') == ([1, 2, 3, 4], [*range(10), 12, 13, 14], [(2, 9, 12)])
    assert reports[-1].recorded == 13 * 4 + 4 + 1 + 2       # ticks, messages, gap, begins


def test_successor_believes_the_sender_where_the_last_file_says_nothing(tmp_path):
    _die_after(tmp_path / 'bag', setup(tmp_path / 'bag'), message(0))
    known = Report(acknowledged=2**32 + 5, ticks=2**32 + 7, last_tick=START, dropped=3)
    code, reports = run(
        setup(tmp_path / 'bag', resume=True, report=known),
        message(2**32 + 6),
        message(2**32 + 5),
        ticks(2**32 + 8, 1),
    )
    assert code == 0
    assert reports[-1].acknowledged == 2**32 + 6
    assert reports[-1].dropped == 4
    assert recorded(tmp_path / 'bag')[:2] == ([0, 6], [8])      # MCAP has 32 bits for it


@pytest.mark.parametrize(('known', 'found', 'later'), [
    (5, 5, 5), (5, 6, 6), (6, 5, 6), (0, 2 ** 31 - 1, 2 ** 31 - 1), (0, 2 ** 31, 0),
    (2 ** 32 - 1, 0, 2 ** 32), (2 ** 32, 2 ** 32 - 1, 2 ** 32), (2 ** 32 + 7, 9, 2 ** 32 + 9),
    (2 ** 33, 2 ** 31 - 1, 2 ** 33 + 2 ** 31 - 1), (2 ** 33, 2 ** 31, 2 ** 33)])
def test_of_a_number_the_lowest_32_bits_are_in_the_file(known, found, later):
    """What seems half a turn ahead or more is behind."""
    assert resume._later(known, found) == later


def test_deleted_recording_cannot_be_resumed(tmp_path):
    code, reports = run(setup(tmp_path / 'bag', resume=True))
    assert code == 2
    assert reports[-1].refused[0] == str(tmp_path / 'bag')
    assert json.loads(reports[-1].line())['closed'] is False


@pytest.mark.parametrize('let_through', [0, 1, 100])
def test_refused_write_leaves_the_file_as_it_was(tmp_path, monkeypatch, let_through):
    path = tmp_path / 'x.mcap'
    file = McapFile(os.open(path, os.O_RDWR | os.O_CREAT), 'zstd')
    before, really = path.read_bytes(), os.pwrite

    def refuse(descriptor, data, offset):
        if offset > len(before) or not let_through:
            raise OSError(errno.ENOSPC, 'No space left on device')
        return really(descriptor, data[:let_through], offset)
    monkeypatch.setattr(os, 'pwrite', refuse)
    with pytest.raises(OSError, match='No space left'):
        file.metadata('a', {'b': 'c' * 1000})
    assert path.read_bytes() == before
    monkeypatch.undo()
    file.metadata('a', {'b': 'c'})
    file.finish()
    assert recover(path)[0].changed is False
