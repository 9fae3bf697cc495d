# SPDX-License-Identifier: Apache-2.0
"""Cost of the node compared with the floor: a tick thread that only publishes the same bytes.

    .venv/bin/python bench/node.py [--seconds 20] [--turns 3] [--rates 1000 4000]
        [--subscribers 1 3] [--rows node] [--normal] [--json]

The floor has no simulation, commands, diagnostics or recording. Each row is a process of its own,
with its subscriber processes (plain rclpy). Floor, node without recording, node with recording and
node with the server of `view --node` attached (without a browser) take turns, so that other load
on the machine affects all; the figures are medians over the turns. CPU is in percent of one core
and lateness in microseconds, over the whole life of the process, `p99 of 1 s` over a second (the
median over the seconds measured: without the start of the process and of its viewer); memory
counts from one second after the first message. Where the system allows it the tick threads have
real-time priority; with --normal they do not.
"""

import argparse
import contextlib
import ctypes
import itertools
import json
import os
import pathlib
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
TOPICS = ('pose', 'angular_velocity', 'energy', 'angular_momentum_squared')
SETTLED = 1.0
VIEWED = 'node, view'
ROWS = ('floor', 'node', 'node, recording', VIEWED)
PR_CAPBSET_DROP, CAP_SYS_NICE = 24, 23
LATENESS = re.compile(r'p50 (\d+), p99 (\d+), max (\d+) us')
ACHIEVED = re.compile(r'(\d+) ticks in ([\d.]+) s \(([\d.]+) Hz\)')


def floor(rate):
    """Publish the bytes of one state of the racket at every tick, until a signal.

    The report is that of the node.
    """
    import importlib

    import rclpy
    from rclpy.signals import SignalHandlerOptions

    from rigid_body_sim.messages.state_topics import EVERY_TICK, Frames
    from rigid_body_sim.messages.tick_messages import TickMessages
    from rigid_body_sim.realtime.shutdown import leave, signals
    from rigid_body_sim.realtime.ticking import Steady, Ticker
    from rigid_body_sim.simulation.simulation import Simulation
    simulation = Simulation('tennis_racket')
    ticking = TickMessages(EVERY_TICK, simulation.scene, Frames())
    [messages] = ticking.messages(simulation.vector[None], [simulation.energy],
                                  [simulation.angular_momentum_squared], [0])

    class Publish:
        next_tick, finished = 0, False

        def __init__(self, publishers):
            self._pairs = [(publisher.handle.publish_raw, data)
                           for publisher, data in zip(publishers, messages, strict=True)]

        def begin(self):
            pass

        between_ticks = begin

        def run_tick(self, _):
            for publish, data in self._pairs:
                publish(data)
            self.next_tick += 1

    with signals() as stop:
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        node = rclpy.create_node('floor')
        types = [getattr(importlib.import_module(output.type.split('/')[0] + '.msg'),
                         output.type.split('/')[2]) for output in EVERY_TICK]
        publishers = [node.create_publisher(kind, name, 10)
                      for kind, name in zip(types, TOPICS, strict=True)]
        ticker = Ticker(Publish(publishers), Steady(), rate, 1.0, False, lambda: None)
        ticker.start()
        while not stop.wanted:
            time.sleep(0.05)
        ticker.stop()
        ticker.join()
        late, (ticks, running) = ticker.lateness.summary(), ticker.latest
        print(f'{ticks} ticks in {running * 1e-9} s ({(ticks - 1) / running * 1e9} Hz)')
        print(f'lateness p50 {late["p50"] * 1e6:.0f}, p99 {late["p99"] * 1e6:.0f}, '
              f'max {late["max"] * 1e6:.0f} us; {ticker.overruns} overruns')
        node.destroy_node()
        leave(0)


def subscribe():
    """Subscribe as users do, until a signal.

    It prints when all topics are heard, and at the end how many messages of each have come.
    """
    import rclpy
    from diagnostic_msgs.msg import DiagnosticArray
    from geometry_msgs.msg import PoseStamped, Vector3Stamped
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.signals import SignalHandlerOptions
    from std_msgs.msg import Float64

    from rigid_body_sim.realtime.shutdown import leave, signals
    counts, late = dict.fromkeys(TOPICS, 0), []

    def count(topic):
        counts[topic] += 1
        if counts[topic] == 1 and all(counts.values()):
            print('heard', flush=True)

    def diagnose(message):
        late.extend((time.monotonic(), 1e6 * float(value.value)) for status in message.status
                    for value in status.values if value.key == 'lateness_p99')
    with signals() as stop:
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        node = rclpy.create_node('subscriber')
        for topic, kind in zip(
                TOPICS, (PoseStamped, Vector3Stamped, Float64, Float64), strict=True):
            node.create_subscription(kind, topic, lambda _, topic=topic: count(topic), 1000)
        node.create_subscription(DiagnosticArray, '/diagnostics', diagnose, 10)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        while not stop.wanted:
            executor.spin_once(timeout_sec=0.1)
        print(json.dumps([counts, late]), flush=True)
        leave(0)


def cpu_seconds(pid):
    """Return the processor time that all threads of a process have taken, s."""
    total = 0
    for task in pathlib.Path(f'/proc/{pid}/task').iterdir():
        with contextlib.suppress(OSError):
            total += int((task / 'schedstat').read_text().split()[0])
    return total * 1e-9


def memory(pid):
    """Return the resident memory of a process, bytes."""
    return (int(pathlib.Path(f'/proc/{pid}/statm').read_text().split()[1])
            * os.sysconf('SC_PAGE_SIZE'))


def children(pid):
    """Return the processes that a process has started."""
    return [int(child) for task in pathlib.Path(f'/proc/{pid}/task').iterdir()
            for child in (task / 'children').read_text().split()]


def without_priority():
    """Give up the right to real-time scheduling, in a process that is about to start."""
    ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, CAP_SYS_NICE, 0, 0, 0)


def spawn(*arguments, before=None):
    """Start a Python process; it calls `before` first."""
    return subprocess.Popen([sys.executable, *map(str, arguments)], cwd=ROOT,
                            stdout=subprocess.PIPE, text=True, preexec_fn=before)


def measure(row, rate, seconds, subscribers, folder, normal):
    """Run one row once; return its figures."""
    before = without_priority if normal else None
    listeners = [spawn(__file__, '--subscribe') for _ in range(subscribers)]
    if row == 'floor':
        process = spawn(__file__, '--floor', rate, before=before)
    else:
        record = str(row == 'node, recording').lower()
        process = spawn('-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p', f'rate:={rate}',
                        '-p', f'record:={record}', '-p', f'recording.directory:={folder}',
                        before=before)
    viewers = []
    try:
        for listener in listeners:
            listener.stdout.readline()
        if row == VIEWED:
            # the node is there now; the address is printed when its topics are subscribed
            viewers.append(spawn('-m', 'rigid_body_sim', 'view', '--node', '/sim_node',
                                 '--port', 0))
            if not viewers[0].stdout.readline():
                raise SystemExit('the view did not start: see above')
        time.sleep(SETTLED)
        recorders = children(process.pid)
        began, cpu, size = time.monotonic(), cpu_seconds(process.pid), memory(process.pid)
        recording = sum(map(cpu_seconds, recorders))
        time.sleep(seconds)
        took, cpu, growth = (time.monotonic() - began, cpu_seconds(process.pid) - cpu,
                             memory(process.pid) - size)
        recording = sum(map(cpu_seconds, recorders)) - recording
    finally:
        for one in (process, *listeners):
            one.send_signal(signal.SIGTERM)
        for one in viewers:
            one.kill()
            one.wait()
    text, _ = process.communicate(timeout=10.0)
    heard = [json.loads(listener.communicate(timeout=10.0)[0]) for listener in listeners]
    counts = [count for count, _ in heard]
    # the first second was partly before
    late = [p99 for at, p99 in heard[0][1] if began + 1.0 < at < began + took]
    p50, p99, worst = map(int, LATENESS.search(text).groups())
    ticks, _, achieved = ACHIEVED.search(text).groups()
    [overruns] = re.findall(r'(\d+) overruns', text)
    return {'cpu': 100.0 * cpu / took, 'recorder_cpu': 100.0 * recording / took,
            'tick_us': cpu / took / rate * 1e6, 'rate': float(achieved),
            'p50': p50, 'p99': p99, 'max': worst,
            'p99_of_1_s': statistics.median(late) if late else float('nan'),
            'growth_kib': growth / 1024, 'overruns': int(overruns),
            'received': (min(min(count.values()) for count in counts) / int(ticks)
                         if counts else float('nan'))}


def main():
    """Run the benchmark and print its table; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--seconds', type=float, default=20.0,
                        help='measured time of each row in each turn (20)')
    parser.add_argument('--turns', type=int, default=3, help='number of turns (3)')
    parser.add_argument('--rates', type=float, nargs='+', default=[1000.0], help='Hz (1000)')
    parser.add_argument('--subscribers', type=int, nargs='+', default=[1],
                        help='subscriber processes, at least 1 (1)')
    parser.add_argument('--rows', nargs='+', choices=ROWS, default=ROWS,
                        help='rows to measure, of these four (all)')
    parser.add_argument('--normal', action='store_true', help='without real-time priority')
    parser.add_argument('--json', action='store_true')
    parser.add_argument('--floor', type=float, help=argparse.SUPPRESS)
    parser.add_argument('--subscribe', action='store_true', help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.floor:
        return floor(options.floor)
    if options.subscribe:
        return subscribe()
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    os.environ.setdefault('ROS_DOMAIN_ID', '97')
    from rigid_body_sim.compilation.environment import processor
    from rigid_body_sim.messages.state_topics import Frames, chosen, scene_messages
    from rigid_body_sim.node.rehearsal import rehearse
    from rigid_body_sim.simulation.simulation import Simulation
    simulation = Simulation('tennis_racket')
    rehearse(simulation, scene_messages(chosen(()), simulation.scene, Frames()))
    cases = []
    with tempfile.TemporaryDirectory() as folder:
        for subscribers, rate in itertools.product(options.subscribers, options.rates):
            turns = [{row: measure(row, rate, options.seconds, subscribers, folder,
                                   options.normal) for row in options.rows}
                     for _ in range(options.turns)]
            rows = {row: {name: statistics.median(turn[row][name] for turn in turns)
                          for name in turns[0][row]} for row in options.rows}
            for row in rows:
                if row != 'floor' and 'floor' in rows:
                    rows[row]['over_floor'] = statistics.median(
                        turn[row]['cpu'] / turn['floor']['cpu'] for turn in turns)
            cases.append({'subscribers': subscribers, 'rate': rate, 'rows': rows})
    load = os.getloadavg()[0]
    if options.json:
        print(json.dumps({'machine': processor(), 'cores': os.cpu_count(), 'load': load,
                          'normal': options.normal, 'seconds': options.seconds,
                          'turns': options.turns, 'cases': cases}, indent=2))
        return 0
    scheduling = 'normal' if options.normal else 'real-time'
    print(f'medians of {options.turns} turns of {options.seconds:g} s, {scheduling} scheduling, '
          f'load {load:.1f}\n')
    print(f'{"heard by":>8}{"rate":>7} {"":16}{"CPU %":>7}{"/ floor":>9}{"us/tick":>9}'
          f'{"recorder %":>12}{"rate Hz":>12}{"late p50":>10}{"p99":>7}{"max":>8}'
          f'{"p99 of 1 s":>12}'
          f'{"overruns":>10}{"growth KiB":>12}{"received":>10}')
    for case in cases:
        for row, found in case['rows'].items():
            ratio = f'{found["over_floor"]:.2f}' if 'over_floor' in found else ''
            print(f'{case["subscribers"]:8}{case["rate"]:7.0f} {row:16}{found["cpu"]:7.1f}'
                  f'{ratio:>9}{found["tick_us"]:9.1f}{found["recorder_cpu"]:12.1f}'
                  f'{found["rate"]:12.3f}{found["p50"]:10.0f}{found["p99"]:7.0f}'
                  f'{found["max"]:8.0f}{found["p99_of_1_s"]:12.0f}{found["overruns"]:10.0f}'
                  f'{found["growth_kib"]:12.0f}{found["received"]:10.5f}')
    return 0


if __name__ == '__main__':
    sys.exit(main())
