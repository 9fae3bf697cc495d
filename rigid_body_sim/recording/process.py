# SPDX-License-Identifier: Apache-2.0
"""The recorder process: takes packets from a pipe, writes the recording, outlives the node.

The Recorder (recorder.py) starts ``python -m rigid_body_sim.recording.process PACKETS REPORTS``
(two file descriptors). The process ends when the pipe is closed, by the node or by its death, and
leaves a complete recording either way. It sleeps between looks at the pipe, so that the node's
writing never wakes it: 50 times a second, whatever the rate.
"""

import json
import os
import signal
import sys
import time

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import packets
from rigid_body_sim.recording.command_messages import CommandMessages, CommandTopics
from rigid_body_sim.recording.packets import Report
from rigid_body_sim.recording.resume import resume
from rigid_body_sim.recording.topics import Topic, journal_message
from rigid_body_sim.recording.writer import Writer
from rigid_body_sim.simulation.command_rows import WIDTH

LOOK = 0.02             # s between looks at the pipe
FLUSH = 0.1             # s after which what was received is in the file
RETRY = 0.5             # s between tries while the disk refuses
_READ = 2**20


class RecorderProcess:
    """Packets in, recording out.

    Parameters
    ----------
    descriptor_in : int
        The pipe of packets, non-blocking.
    send : callable
        Sends bytes; returns whether it could.
    """

    def __init__(self, descriptor_in, send):
        self._in, self._send = descriptor_in, send
        self._buffer = b''
        self._writer = None
        self.report = Report()
        self._expected = 1          # number of the next numbered message
        # next tick expected, stamp of the last one taken (ns), and ticks missing so far
        self._next_tick = self._last_tick = self._dropped = 0
        self._retry_at = self._flush_at = self._ask_at = 0.0
        self._asked_for = 0
        self._ended, self._told = False, b''

    def run(self):
        """Record until the pipe is closed.

        Returns the exit code: 0 if all that came is recorded, 1 if not, 2 if nothing could be.
        """
        try:
            while not self._ended:
                data = self._read()
                if data:
                    self._buffer += data
                    self._take_packets()
                elif data == b'':
                    break
                now = time.monotonic()
                due = self._retry_at if self.report.error else self._flush_at
                if self._writer is not None and now >= due:
                    self._flush(now)
                if data is None or len(data) < _READ // 4:
                    time.sleep(LOOK)
        except BadInput as error:
            self.report.refused = (error.where, error.problem, error.remedy)
            self._send(self.report.line())
            return 2
        return self._close()

    def _read(self):
        try:
            return os.read(self._in, _READ)
        except BlockingIOError:
            return None

    def _take_packets(self):
        """Take all whole packets from the buffer."""
        buffer, position = self._buffer, 0
        while position + packets.HEAD.size <= len(buffer) and not self._ended:
            tag, length = packets.HEAD.unpack_from(buffer, position)
            end = position + packets.HEAD.size + length
            if end > len(buffer):
                break
            if tag == packets.TICK:
                position = self._take_ticks(buffer, position)
                continue
            content = buffer[position + packets.HEAD.size:end]
            if tag == packets.MESSAGE:
                self._take_message(buffer, position, end)
            elif tag == packets.COMMANDS:
                self._take_commands(buffer, position, end)
            elif tag == packets.SETUP:
                self._open(json.loads(content))
            else:
                self._end(json.loads(content)['ticks'])
            position = end
        self._buffer = buffer[position:]

    def _open(self, setup):
        ticking = [(Topic(**topic), size) for topic, size in setup['ticking']]
        others, journal = [Topic(**topic) for topic in setup['others']], Topic(**setup['journal'])
        topics = [*(topic for topic, _ in ticking), *others, journal]
        self._names = [topic.name for topic in topics]
        self._journal, self._commands = journal.name, None
        if setup['commands']:
            self._commands = CommandMessages(CommandTopics(**setup['commands']), journal.name)
        self._tick = np.dtype(packets.tick_fields([size for _, size in ticking]))
        self.report = Report(**setup['report'])
        files = ()
        try:
            if setup['resume']:
                names = [topic.name for topic, _ in ticking]
                files = resume(setup['path'], names, self.report)
            self._before = (self.report.recorded, self.report.written)
            self._writer = Writer(setup['path'], ticking, others, journal, setup['about'],
                                  setup['compression'], setup['split_bytes'],
                                  setup['split_seconds'], files)
        except OSError as error:
            raise BadInput(setup['path'], f'nothing can be recorded here ({error.strerror})',
                           'a folder on a disk with room') from error
        self._expected, self._next_tick = self.report.acknowledged + 1, self.report.ticks
        self._last_tick, self._dropped = self.report.last_tick, self.report.dropped
        self.report.error = ''
        self.report.resend += 1
        self._tell()

    def _take_ticks(self, buffer, position):
        """Take a run of ticks; return where the next other packet begins."""
        size, end = self._tick.itemsize, position
        while end + size <= len(buffer) and buffer[end] == packets.TICK:
            end += size
        if not self.report.error:
            rows = np.frombuffer(buffer, self._tick, (end - position) // size, position)
            first, last = rows['number'][[0, -1]].tolist()
            if last - first == len(rows) - 1:
                self._record_ticks(rows)
                return end
            breaks = np.flatnonzero(np.diff(rows['number'].astype(np.int64)) != 1) + 1
            for run in np.split(rows, breaks):
                self._record_ticks(run)
                if self.report.error:
                    break
        return end

    def _record_ticks(self, rows):
        """Record ticks with consecutive numbers, and a gap before them if there is one."""
        first = int(rows['number'][0])
        try:
            if first > self._next_tick:
                self._gap(first - self._next_tick, int(rows['log_time'][0]),
                          int(rows['publish_time'][0]))
            messages = [rows[name] for name in self._tick.names if name.startswith('message')]
            done = self._writer.ticks(first, rows['log_time'], rows['publish_time'], messages)
        except OSError as error:
            self._fail(error)
            return
        self._next_tick, self._last_tick = first + done, int(rows['log_time'][done - 1])

    def _gap(self, ticks, until, publish_time):
        """Mark in the journal that ticks are missing.

        `until` (ns) is the stamp of the next one, None if there is none.
        """
        data = journal_message('gap', ticks=ticks, after=self._last_tick, until=until)
        self._writer.message(self._journal, self._writer.last_time, publish_time, data)
        self._dropped += ticks
        self._next_tick += ticks
        self.report.state_wanted += 1

    def _take_message(self, buffer, position, end):
        head = packets.MESSAGE_HEAD
        _, _, number, topic, log_time, publish_time = head.unpack_from(buffer, position)
        message = (self._names[topic], buffer[position + head.size:end])
        self._record(number, log_time, publish_time, [message])

    def _take_commands(self, buffer, position, end):
        head = packets.COMMANDS_HEAD
        _, _, number, tick, log_time, publish_time = head.unpack_from(buffer, position)
        rows = np.frombuffer(buffer[position + head.size:end]).reshape(-1, WIDTH)
        self._record(number, log_time, publish_time, self._commands.messages(tick, log_time, rows))

    def _record(self, number, log_time, publish_time, messages):
        """Record those of some messages, (topic name, bytes) or None, that are not recorded yet.

        The first of them has this number.
        """
        if self.report.error:
            return
        if number > self._expected:
            self._ask_for_missing()
            return
        begin = self._expected - number if number else 0
        for message in messages[begin:]:
            try:
                if message:
                    self._writer.message(message[0], log_time, publish_time, message[1],
                                         self._expected if number else 0)
            except OSError as error:
                self._fail(error)
                return
            self._expected += number > 0

    def _ask_for_missing(self):
        """Ask for the numbered messages from the expected one on.

        This is done once until that one comes or RETRY has passed.
        """
        now = time.monotonic()
        if self._asked_for != self._expected or now >= self._ask_at:
            self._asked_for, self._ask_at = self._expected, now + RETRY
            self.report.resend += 1
            self._tell()

    def _flush(self, now):
        """Write what is pending; report."""
        self._flush_at = now + FLUSH
        try:
            self._writer.flush()
        except OSError as error:
            self._fail(error)
            return
        if self.report.error:
            self.report.error = ''
            self.report.resend += 1
        self._confirm()
        self._tell()

    def _confirm(self):
        """Note that all taken so far is in the file."""
        self.report.acknowledged, self.report.ticks = self._expected - 1, self._next_tick
        self.report.last_tick, self.report.dropped = self._last_tick, self._dropped

    def _tell(self):
        """Send a report if anything is new."""
        self.report.recorded = self._before[0] + self._writer.messages_written
        self.report.written = self._before[1] + self._writer.bytes_written
        if self._writer.state_wanted:
            self._writer.state_wanted = False
            self.report.state_wanted += 1
        line = self.report.line()
        if line != self._told and self._send(line):
            self._told = line

    def _fail(self, error):
        """Go on without recording until a flush succeeds.

        What comes meanwhile is dropped; numbered messages are sent again later.
        """
        self._retry_at = time.monotonic() + RETRY
        problem = f'{self._writer.path}: {error.strerror or error}'
        if self.report.error != problem:
            self.report.error = problem
            self._tell()

    def _end(self, ticks):
        """Take the END packet: how many ticks there were."""
        self._ended = True
        if ticks > self._next_tick and not self.report.error:
            try:
                self._gap(ticks - self._next_tick, None, self._writer.last_time)
            except OSError as error:
                self._fail(error)
        self.report.dropped = self._dropped + max(0, ticks - self._next_tick)

    def _close(self):
        if self._writer is None:
            return 2
        try:
            self._writer.close()
        except OSError as error:
            self.report.error = (f'{self._writer.path}: {error.strerror or error}; not closed, '
                                 f'"recover" makes it whole once there is room')
        else:
            self.report.error, self.report.closed = '', True
            self._confirm()
        self._tell()
        return 1 if self.report.error else 0


def main(descriptor_in, descriptor_out):
    """Run the process on its two pipes."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        # these signals are for the node; this process ends with the pipe
        signal.signal(number, signal.SIG_IGN)
    if os.sched_getscheduler(0) != os.SCHED_OTHER:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    os.set_blocking(descriptor_in, False)
    os.set_blocking(descriptor_out, False)

    def send(line):
        try:
            return os.write(descriptor_out, line) == len(line)
        except (BlockingIOError, BrokenPipeError):
            return False
    return RecorderProcess(descriptor_in, send).run()


if __name__ == '__main__':
    sys.exit(main(int(sys.argv[1]), int(sys.argv[2])))
