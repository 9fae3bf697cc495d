# SPDX-License-Identifier: Apache-2.0
"""Starts nodes in fresh processes and tells what each did for the first time under its clock.

``python cold_starts.py CASE ...``, each case a JSON list of the node's arguments, prints one JSON
object a case. A case is a fork of a process that has imported the package and run nothing: no
kernel has been loaded in it. Kernels that are loaded from the cache once the clock runs are those
that a machine without a cache would compile then, so the outcome does not depend on what the cache
holds.
"""

import json
import os
import sys
import threading
import time
import traceback

import rclpy
from geometry_msgs.msg import WrenchStamped
from numba.core import event as numba_event
from rclpy.executors import SingleThreadedExecutor

from rigid_body_sim.node.simulation_node import SimulationNode
from rigid_body_sim.realtime.session import QUIET, Session

ALL_THREADS = ('import', 'compile', 'exec')
TICK_THREAD = (*ALL_THREADS, 'open', 'ctypes.dlopen', 'subprocess.Popen')
TICKS = 2 * QUIET + 8
"""Ticks before the commands, after them, and after the reset: enough that some are prefetched."""
PATIENCE = 60.0


class Watch:
    """Notes what happens for the first time from :meth:`start` on."""

    def __init__(self):
        self.found, self._on, self._busy = [], False, threading.local()
        self.thread = None
        sys.addaudithook(self._audit)
        numba_event.register('numba:compile', self._Compilations(self))

    class _Compilations(numba_event.Listener):
        def __init__(self, watch):
            self._watch = watch

        def on_start(self, event):
            self._watch.note('numba compiles', event.data['dispatcher'])

        def on_end(self, event):
            pass

    def start(self):
        """Watch from now on; this is the tick thread."""
        self.thread, self._on = threading.get_ident(), True

    def stop(self):
        """Watch no more."""
        self._on = False

    def _audit(self, event, arguments):
        if self._on and event in (TICK_THREAD if threading.get_ident() == self.thread
                                  else ALL_THREADS):
            self.note(event, arguments[0])

    def note(self, event, what):
        """Note an event, with the package's lines that led there."""
        if self._on and not getattr(self._busy, 'now', False):
            self._busy.now = True
            lines = [f'{frame.filename.rpartition("rigid_body_sim/")[2]}:{frame.lineno}'
                     for frame in traceback.extract_stack() if 'rigid_body_sim' in frame.filename]
            self.found.append(f'{event} {str(what)[:120]} by {" ".join(lines[-4:])}')
            self._busy.now = False


class Stop:
    """Stands for shutdown.Stop."""

    wanted = False

    def request(self):
        """Note that the node has come to its end."""
        self.wanted = True


def run(arguments):
    """Run one node; return what it did for the first time, and its dearest tick's CPU time (s)."""
    watch, costs, begin, run_tick = Watch(), [], Session.begin, Session.run_tick

    def watched_begin(session):
        # the rehearsal begins a session too, in the main thread
        if threading.current_thread() is not threading.main_thread():
            watch.start()
        begin(session)

    def timed_tick(session, publish):
        before = time.thread_time()
        run_tick(session, publish)
        costs.append(time.thread_time() - before)
    Session.begin = watched_begin
    rclpy.init(args=[])
    sender = rclpy.create_node('sender')
    publishers = [sender.create_publisher(WrenchStamped, topic, 10)
                  for topic in ('cmd_impulse', 'cmd_wrench')]
    stop = Stop()
    words = [word for argument in arguments for word in ('-p', argument)]
    node = SimulationNode(stop, cli_args=['--ros-args', *words], use_global_arguments=False)
    Session.run_tick = timed_tick
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    session, deadline = node.engine.session, time.monotonic() + PATIENCE

    def spin(condition):
        while not condition():
            if time.monotonic() > deadline or node.engine.ticker.failure:
                raise TimeoutError(f'{arguments}: tick {session.next_tick}, '
                                   f'{node.engine.ticker.failure}')
            executor.spin_once(timeout_sec=0.01)

    def ticks():
        until = session.next_tick + TICKS
        spin(lambda: session.next_tick >= until or session.finished)
    spin(lambda: all(publisher.get_subscription_count() for publisher in publishers))
    ticks()
    node.engine.diagnostics.publish()
    received = node.engine.commands

    def send(publisher, frame='world', torque=0.0):
        message, before = WrenchStamped(), received.received
        message.header.frame_id, message.wrench.torque.z = frame, torque
        publisher.publish(message)
        spin(lambda: received.received > before)
    for frame in ('body', 'world'):
        for publisher in publishers:
            send(publisher, frame, 1e-6)
            # of commands that meet one tick the last wrench alone would be held
            spin(lambda until=session.next_tick + 2: session.next_tick >= until)
    ticks()
    send(publishers[1])
    ticks()
    session.request(Session.reset)
    ticks()
    node.engine.diagnostics.publish()
    ticks()
    watch.stop()
    node.engine.ticker.stop()
    return {'arguments': arguments, 'first_times': watch.found, 'ticks': session.next_tick,
            'refused': sum(received.refusals.values()), 'dearest_tick': max(costs)}


def main(cases):
    """Run all cases, each in a child of its own; print what each says."""
    for case in cases:
        # a fork of a process with one thread, where numba has called no kernel and rclpy is down
        child = os.fork()
        if child == 0:
            try:
                print(json.dumps(run(json.loads(case))), flush=True)
            except BaseException:
                traceback.print_exc()
                os._exit(1)
            os._exit(0)
        if os.waitpid(child, 0)[1]:
            return 1
    return 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
