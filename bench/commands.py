# SPDX-License-Identifier: Apache-2.0
"""Cost of commands to the node: thousands of impulses a second from two publishers at once.

    .venv/bin/python bench/commands.py [--seconds 60] [--each 5000] [--json]

The node runs the racket at 1 kHz with recording and one subscriber. Its processor time is taken
for as long without commands, then with them; the difference is their cost. Then the recording is
read: each command must be applied once, at a recorded tick, in the order of its sender. The exit
status is 1 if one is missing, doubled or out of order.
"""

import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from node import ROOT, SETTLED, children, cpu_seconds, spawn

PUBLISHERS = (1, 2)


def publish(sender, each, seconds):
    """Send impulses with the sender's number as force and their counts as torque.

    The bytes are made beforehand, so that the sender keeps up.
    """
    import rclpy
    from geometry_msgs.msg import WrenchStamped
    from rclpy.serialization import serialize_message
    rclpy.init(args=[])
    node = rclpy.create_node(f'sender_{sender}')
    publisher = node.create_publisher(WrenchStamped, 'cmd_impulse', 5000)
    messages = []
    for k in range(round(each * seconds)):
        message = WrenchStamped()
        message.header.frame_id = 'body'
        # turns there and back alternate, so that the body's motion stays the same
        message.wrench.force.x, message.wrench.torque.z = float(sender), 1e-9 * k * (-1) ** k
        messages.append(serialize_message(message))
    while not publisher.get_subscription_count():
        time.sleep(0.01)
    print('ready', flush=True)
    sys.stdin.readline()
    began = time.monotonic()
    for k, data in enumerate(messages):
        if (ahead := began + k / each - time.monotonic()) > 1e-3:
            time.sleep(ahead)
        publisher.publish(data)
    print(time.monotonic() - began, flush=True)
    time.sleep(2.0)


def read(folder):
    """Return the commands of a recording, with their ticks."""
    from rigid_body_sim.recording.reader import Recording
    [path] = pathlib.Path(folder).iterdir()
    with Recording(path) as recording:
        return [(entry['tick'], command) for entry in recording.journal()
                if entry['kind'] == 'commands' for command in entry['commands']]


def measure(each, seconds):
    """Run the benchmark once; return its figures."""
    with tempfile.TemporaryDirectory() as folder:
        listener = spawn(ROOT / 'bench' / 'node.py', '--subscribe')
        node = spawn('-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p',
                     f'recording.directory:={folder}')
        senders = [subprocess.Popen(
            [sys.executable, __file__, '--publish', str(sender), '--each', str(each),
             '--seconds', str(seconds)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) for sender in PUBLISHERS]
        try:
            for process in (listener, *senders):
                process.stdout.readline()
            time.sleep(SETTLED)
            [recorder] = children(node.pid)
            idle = cpu_seconds(node.pid)
            time.sleep(seconds)
            idle = cpu_seconds(node.pid) - idle
            busy, recording = cpu_seconds(node.pid), cpu_seconds(recorder)
            for sender in senders:
                sender.stdin.write('\n')
                sender.stdin.flush()
            took = max(float(sender.stdout.readline()) for sender in senders)
            busy, recording = cpu_seconds(node.pid) - busy, cpu_seconds(recorder) - recording
            time.sleep(SETTLED)
        finally:
            for process in (*senders, node, listener):
                process.send_signal(signal.SIGTERM)
                process.communicate(timeout=20.0)
        commands = read(folder)
    sent = len(PUBLISHERS) * round(each * seconds)
    whole = all([command['torque'][2] for _, command in commands
                 if command['force'][0] == float(sender)]
                == [1e-9 * k * (-1) ** k for k in range(round(each * seconds))]
                for sender in PUBLISHERS)
    ticks = [tick for tick, _ in commands]
    return {'sent': sent, 'seconds': took, 'applied': len(commands),
            'each_once_in_order': whole and ticks == sorted(ticks),
            'cpu_without': 100.0 * idle / seconds, 'cpu_with': 100.0 * busy / took,
            'cpu_of_commands': 100.0 * (busy / took - idle / seconds),
            'us_a_command': 1e6 * (busy - idle * took / seconds) / sent,
            'cpu_of_recorder': 100.0 * recording / took}


def main():
    """Run the benchmark and print its figures; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--seconds', type=float, default=60.0,
                        help='duration with commands, and as long without (60)')
    parser.add_argument('--each', type=float, default=5000.0,
                        help='messages a second from each of two publishers (5000)')
    parser.add_argument('--json', action='store_true')
    parser.add_argument('--publish', type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.publish:
        return publish(options.publish, options.each, options.seconds)
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    os.environ.setdefault('ROS_DOMAIN_ID', '98')
    found = measure(options.each, options.seconds)
    if options.json:
        print(json.dumps(found, indent=2))
    else:
        print(f'{found["sent"]} impulses in {found["seconds"]:.1f} s from {len(PUBLISHERS)} '
              f'publishers: {found["applied"]} applied, '
              f'{"each" if found["each_once_in_order"] else "NOT each"} once and in order\n'
              f'node at 1 kHz, recording: {found["cpu_without"]:.1f} % of a core without, '
              f'{found["cpu_with"]:.1f} % with commands: '
              f'{found["cpu_of_commands"]:.1f} % for them, {found["us_a_command"]:.1f} us each; '
              f'the recorder takes {found["cpu_of_recorder"]:.1f} %')
    return 0 if found['each_once_in_order'] else 1


if __name__ == '__main__':
    sys.exit(main())
