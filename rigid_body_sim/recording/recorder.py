# SPDX-License-Identifier: Apache-2.0
"""The recorder as the node sees it: cheap calls from the tick thread, a process that writes.

That process is the recorder's own and outlives the node. ::

    recorder = Recorder('recordings/run', ticking=[(Topic('/pose', pose.type_name), pose.size)],
                        others=[Topic('/events', ...)], journal=journal_topic('/racket'),
                        about={'scene': text, ...})     # BadInput where nothing can be recorded
    recorder.important('/scene', stamp, wall_clock, data)       # never lost
    # at each tick, ~2 us, before or after publishing:
    recorder.tick(stamp, wall_clock, (pose_bytes, omega_bytes, ...))
    if recorder.state_wanted:                   # at the start, after each gap, in each file
        recorder.state_wanted = False
        recorder.journal('state', stamp, wall_clock, tick=k, state=[...])
    recorder.status()                           # 2 to 10 times a second, from another thread
    status = recorder.close()

What is published but refused by the pipe waits in memory; when that is full (`BACKLOG` bytes),
ticks are dropped, counted, and the gap is marked in the journal. Important messages are kept until
the recorder has them in its file, and sent again to its successor if it dies. All methods may be
called from any thread.
"""

import collections
import contextlib
import dataclasses
import fcntl
import itertools
import os
import pathlib
import subprocess
import sys
import threading
import time

from rigid_body_sim.errors import BadInput
from rigid_body_sim.recording import compression, packets
from rigid_body_sim.recording.needed import need_mcap
from rigid_body_sim.recording.packets import Report
from rigid_body_sim.recording.topics import journal_message

BACKLOG = 16 * 2**20        # bytes of packets that wait for the pipe
UNCONFIRMED = 256 * 2**20   # bytes of important messages that are not in the file yet
_PIPE = 2**20
_PIECES = 64                # packets written at once to catch up
_RESTART = 1.0              # s between restarts


@dataclasses.dataclass(frozen=True)
class Status:
    """The state of the recording.

    Attributes
    ----------
    recorded, written : int
        Messages and bytes in the file.
    dropped : int
        Ticks.
    lost : int
        Important messages; only if more than `UNCONFIRMED` bytes of them wait.
    waiting : int
        Bytes.
    restarts : int
        How often the recorder was started again.
    error : str
        The problem right now, or ''.
    closed : bool
        Whether the recording is complete.
    """

    recorded: int
    written: int
    dropped: int
    lost: int
    waiting: int
    restarts: int
    error: str
    closed: bool


class Recorder:
    """Starts a recorder and feeds it.

    More than eight arguments: all is settled at the start, and most have a default.

    Parameters are those of the Writer (writer.py), and `commands`: CommandTopics, for those who
    call :meth:`commands`.

    Attributes
    ----------
    state_wanted : bool
        True when the full state should be written into the journal; who does so sets it False.

    Raises
    ------
    BadInput
        Where nothing can be recorded.
    """

    def __init__(self, path, ticking, others, journal, about,
                 compression_name=compression.DEFAULT, split_bytes=0, split_seconds=0.0,
                 commands=None):
        need_mcap()
        self._setup = {
            'path': str(path),
            'ticking': [(dataclasses.asdict(topic), size) for topic, size in ticking],
            'others': [dataclasses.asdict(topic) for topic in others],
            'journal': dataclasses.asdict(journal), 'about': about,
            'compression': compression_name, 'split_bytes': split_bytes,
            'split_seconds': split_seconds, 'commands': commands and dataclasses.asdict(commands)}
        topics = [*(topic for topic, _ in ticking), *others, journal]
        self._positions = {topic.name: position for position, topic in enumerate(topics)}
        self._journal = journal.name
        self._tick_size = sum(size for _, size in ticking)
        self._tick_length = packets.TICK_HEAD.size - packets.HEAD.size + self._tick_size
        self._lock = threading.Lock()           # guards everything below; held for microseconds
        # (last number, packet); number 0 for what may be lost
        self._waiting = collections.deque()
        # bytes; of the first packet, bytes already in the pipe
        self._waiting_size = self._begun = 0
        self._unconfirmed = collections.deque()     # (last number, packet)
        self._unconfirmed_size = self._number = self._lost = 0
        self._ticks = self._dropped_now = self._restarts = 0
        self._dropping = self._ready = self._left = self.state_wanted = False
        self._report, self._look_at = Report(), 0.0
        self._keeping = threading.Lock()        # held while recorders are started and ended
        self._start(resume=False)
        deadline = time.monotonic() + 30.0
        while not self._ready and time.monotonic() < deadline and self._process.poll() is None:
            time.sleep(0.01)
            self._look_now()
        self._look_now()
        if not self._ready:
            self._process.kill()
            raise BadInput(*(self._report.refused or (
                'recording', 'the recorder did not start', 'see its message above, if any')))

    def _start(self, resume):
        """Start a recorder and tell it what to do; the lock is not held meanwhile."""
        from_here, to_there = os.pipe(), os.pipe()
        (packets_out, packets_in), (reports_out, reports_in) = from_here, to_there
        with contextlib.suppress(OSError):      # an administrator may have set a lower limit
            fcntl.fcntl(packets_in, fcntl.F_SETPIPE_SZ, _PIPE)
        root = str(pathlib.Path(__file__).resolve().parents[2])
        python_path = os.pathsep.join(filter(None, (root, os.environ.get('PYTHONPATH'))))
        environment = dict(os.environ, PYTHONPATH=python_path, OPENBLAS_NUM_THREADS='1',
                           OMP_NUM_THREADS='1')
        command = [sys.executable, '-m', 'rigid_body_sim.recording.process', str(packets_out),
                   str(reports_in)]
        # A session of its own: Ctrl-C and the end of a terminal are for the node.
        self._process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            pass_fds=(packets_out, reports_in), start_new_session=True, env=environment)
        os.close(packets_out)
        os.close(reports_in)
        self._started_at = time.monotonic()
        setup = packets.json_packet(packets.SETUP, {
            **self._setup, 'resume': resume, 'report': dataclasses.asdict(self._report)})
        with contextlib.suppress(BrokenPipeError):
            while setup:
                setup = setup[os.write(packets_in, setup):]
        os.set_blocking(packets_in, False)
        os.set_blocking(reports_out, False)
        with self._lock:
            self._packets_in, self._reports_out = packets_in, reports_out
            self._lines, self._begun = b'', 0

    @property
    def process_id(self):
        """Process id of the newest recorder."""
        return self._process.pid

    def tick(self, log_time, publish_time, messages):
        """Record a tick; return `state_wanted`.

        Parameters
        ----------
        log_time, publish_time : int
            Its stamp and the wall clock, ns.
        messages : sequence of bytes
            Of the ticking topics in their order.
        """
        data = b''.join(messages)
        if len(data) != self._tick_size:
            raise ValueError(f'messages of {len(data)} bytes where the ticking topics have '
                             f'{self._tick_size}')
        with self._lock:
            packet = packets.TICK_HEAD.pack(packets.TICK, self._tick_length, self._ticks, log_time,
                                            publish_time) + data
            self._ticks += 1
            if self._waiting or not self._ready:
                self._wait(packet)
            else:
                self._write(0, packet)
            if time.monotonic() >= self._look_at:
                self._look()
        return self.state_wanted

    def message(self, topic_name, log_time, publish_time, data):
        """Record a message that may be lost under duress."""
        packet = packets.message_packet(0, self._positions[topic_name], log_time, publish_time,
                                        data)
        with self._lock:
            self._wait(packet)

    def important(self, topic_name, log_time, publish_time, data):
        """Record a message that must not be lost."""
        with self._lock:
            self._keep(1, packets.message_packet(self._number + 1, self._positions[topic_name],
                                                 log_time, publish_time, data))

    def commands(self, tick, log_time, publish_time, rows):
        """Record the commands that took effect at a tick (rows of command_rows.py).

        CommandMessages makes the messages of them; none is ever lost.
        """
        with self._lock:
            packet = packets.commands_packet(self._number + 1, tick, log_time, publish_time, rows)
            self._keep(len(rows) + 1, packet)

    def _keep(self, count, packet):
        """Send a packet with the next `count` numbers.

        It is kept until the recorder has it in its file.
        """
        if self._unconfirmed_size + len(packet) > UNCONFIRMED:
            self._lost += count
            return
        self._number += count
        self._unconfirmed.append((self._number, packet))
        self._unconfirmed_size += len(packet)
        self._append(self._number, packet)
        self._pump()

    def journal(self, kind, log_time, publish_time, **values):
        """Record an entry of the journal; it is never lost.

        See :func:`rigid_body_sim.recording.topics.journal_topic`.
        """
        self.important(self._journal, log_time, publish_time, journal_message(kind, **values))

    def _append(self, number, packet):
        self._waiting.append((number, packet))
        self._waiting_size += len(packet)

    def _wait(self, packet):
        """Queue a packet that may be lost, or drop it where too much waits already.

        Once something was dropped, half of what waits has to go before anything is queued again.
        """
        self._dropping = self._waiting_size > (BACKLOG // 2 if self._dropping else BACKLOG)
        if self._dropping:
            self._dropped_now += packet[0] == packets.TICK
        else:
            self._dropped_now = 0
            self._append(0, packet)
        self._pump()

    def _write(self, number, packet):
        """Write a packet into the pipe, or queue it."""
        written = self._try_to_write(packet)
        if written < len(packet):
            self._append(number, packet)
            self._begun = written

    def _try_to_write(self, data):
        try:
            return os.write(self._packets_in, data)
        except BlockingIOError:
            return 0
        except BrokenPipeError:
            self._ready = False
            return 0

    def _pump(self):
        """Write what waits, as far as the pipe takes it.

        A call writes some of it only, so that no tick is late for it.
        """
        if not self._ready or not self._waiting:
            return
        pieces = [packet for _, packet in itertools.islice(self._waiting, _PIECES)]
        pieces[0] = pieces[0][self._begun:]
        written = self._begun + self._try_to_write(b''.join(pieces))
        while self._waiting and written >= len(self._waiting[0][1]):
            size = len(self._waiting.popleft()[1])
            written -= size
            self._waiting_size -= size
        self._begun = written

    def _look_now(self):
        with self._lock:
            self._look()

    def _look(self):
        """Read the recorder's reports and act on the newest."""
        self._look_at = time.monotonic() + 0.05
        try:
            self._lines += os.read(self._reports_out, 2**16)
        except BlockingIOError:
            return
        *lines, self._lines = self._lines.split(b'\n')
        if not lines:
            return
        before, self._report = self._report, Report.of(lines[-1])
        self._ready = self._ready or self._report.resend > before.resend
        self.state_wanted = self.state_wanted or self._report.state_wanted > before.state_wanted
        while self._unconfirmed and self._unconfirmed[0][0] <= self._report.acknowledged:
            self._unconfirmed_size -= len(self._unconfirmed.popleft()[1])
        if self._report.resend > before.resend:
            self._send_again()

    def _send_again(self):
        """Queue the important messages that the recorder lacks before everything that waits.

        Those that wait already stay where they are.
        """
        first = next((number for number, _ in self._waiting if number), self._number + 1)
        begun = [self._waiting.popleft()] if self._begun else []
        again = [entry for entry in self._unconfirmed if entry[0] < first]
        self._waiting.extendleft(reversed([*begun, *again]))
        self._waiting_size += sum(len(packet) for _, packet in again)
        self._pump()

    def status(self):
        """Return the Status.

        Call it a few times a second, but not from the tick thread: it also starts a new recorder
        where one died.
        """
        with self._keeping:
            self._look_after()
        return self._status()

    def _look_after(self):
        """Send what waits, read reports, and start a new recorder if none is alive."""
        with self._lock:
            self._look()
            self._pump()
        died = self._process.poll() is not None and not self._report.closed
        if died and time.monotonic() >= self._started_at + _RESTART:
            self._close_pipes()
            self._restarts += 1
            self._start(resume=True)

    def _close_pipes(self):
        with self._lock:
            self._ready = False
            os.close(self._packets_in)
            os.close(self._reports_out)

    def _status(self):
        with self._lock:
            report = self._report
            error = report.error or '; '.join(report.refused)
            if not error and self._left and self._waiting:
                error = f'the recorder was too slow to take the last {self._waiting_size} bytes'
            elif not error and not self._left and not self._ready and not report.closed:
                error = 'the recorder died; a new one is starting'
            now = max(0, self._ticks - report.ticks) if report.error else self._dropped_now
            return Status(report.recorded, report.written, report.dropped + now, self._lost,
                          self._waiting_size, self._restarts, error, report.closed)

    def close(self, timeout=30.0):
        """End the recording: send all that waits, let the recorder finish.

        A recorder that takes longer than `timeout` (s) finishes on its own.

        Returns the last Status, whose `closed` says whether the recording is complete.
        """
        with self._keeping:
            deadline = time.monotonic() + timeout
            while time.monotonic() < deadline and not self._report.closed:
                self._look_after()
                if self._ready and not self._waiting:
                    self._end(deadline)
                    if self._report.error:
                        break
                time.sleep(0.005)
            self._close_pipes()
            self._left = True
        return self._status()

    def _end(self, deadline):
        """Send the END packet and wait for the recorder to end."""
        with self._lock:
            self._append(0, packets.json_packet(packets.END, {'ticks': self._ticks}))
        while self._process.poll() is None and time.monotonic() < deadline:
            with self._lock:
                self._pump()
                self._look()
            time.sleep(0.005)
        self._look_now()
