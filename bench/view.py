# SPDX-License-Identifier: Apache-2.0
"""Cost of an open page on the server's side: its two processes, without the browser.

    .venv/bin/python bench/view.py [--scenes heavy_top kater_pendulum] [--seconds 20] [--json]

A client on the page's websocket takes what a browser would take, and draws nothing. CPU is in
percent of one core, of the process that serves the page and of the one that simulates. Pictures
are counted by the second, and ms/picture is the CPU time of both processes for one of them, which
other load on the machine changes little. Growth is that of the resident memory of both from ten
seconds after the first picture (or a tenth of the time) on, and in the second half. A long run
prints the memory of each minute. The goals are 60 pictures a second, 20 % of a core (3.3 ms a
picture), and no growth in an hour (--seconds 3600).
"""

import argparse
import asyncio
import json
import os
import pathlib
import subprocess
import sys
import time

import msgspec
import viser
import websockets

ROOT = pathlib.Path(__file__).resolve().parent.parent
SETTLED = 10.0
MINUTE = 60.0
CAMERA = {'type': 'ViewerCameraMessage', 'wxyz': (1.0, 0.0, 0.0, 0.0),
          'position': (2.2, -3.2, 1.7), 'fov': 0.7, 'near': 0.01, 'far': 1000.0,
          'image_height': 900, 'image_width': 1400, 'look_at': (0.0, 0.0, 0.0),
          'up_direction': (0.0, 0.0, 1.0)}
"""What a browser sends once it draws: the motion waits for it."""
SCENES = ('tennis_racket', 'heavy_top', 'rolling_disk', 'kater_pendulum')


def processes(pid):
    """Return the page's process and those that it has started."""
    return [pid, *(int(child) for task in pathlib.Path(f'/proc/{pid}/task').iterdir()
                   for child in (task / 'children').read_text().split())]


def cpu_seconds(pid):
    """Return the processor time that a process has taken, s."""
    fields = pathlib.Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def memory(pid):
    """Return the resident memory of a process, bytes."""
    return (int(pathlib.Path(f'/proc/{pid}/statm').read_text().split()[1])
            * os.sysconf('SC_PAGE_SIZE'))


async def watch(address, pid, seconds):
    """Take what the page sends for a time; return the figures."""
    settle = min(SETTLED, seconds / 10.0)
    async with websockets.connect(
            address.replace('http', 'ws'), subprotocols=[f'viser-v{viser.__version__}'],
            max_size=None, origin=address.rstrip('/')) as socket:
        size = len(await socket.recv())
        await socket.send(msgspec.msgpack.encode(CAMERA))
        began, before, half, marks, curve = time.monotonic(), None, None, 0, []
        while True:
            size += len(await socket.recv())
            now = time.monotonic()
            if now - began < settle:
                continue
            if before is None:
                pids = processes(pid)
                before, began_at = {one: cpu_seconds(one) for one in pids}, now
                start, size = sum(map(memory, pids)), 0
            marks += 1
            if now - began_at >= MINUTE * len(curve):
                curve.append(round(sum(map(memory, pids)) / 2**20, 1))
            if half is None and now - began_at > 0.5 * seconds:
                half = sum(map(memory, pids))
            if now - began_at > seconds:
                break
        took = now - began_at
        end = sum(map(memory, pids))
        page, *rest = (100.0 * (cpu_seconds(one) - before[one]) / took for one in pids)
        return {'pictures': marks / took, 'cpu_page': page, 'cpu_simulation': sum(rest),
                'milliseconds': 10.0 * (page + sum(rest)) * took / marks, 'minutes_mib': curve,
                'kilobytes': size / took / 1e3, 'memory_mib': end / 2**20,
                'growth_mib': (end - start) / 2**20, 'growth_late_mib': (end - half) / 2**20}


def measure(scene, seconds):
    """Open the page of a scene, watch it, and return the figures."""
    with subprocess.Popen([sys.executable, '-m', 'rigid_body_sim', 'view', scene, '--port', '0'],
                          cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        try:
            address = process.stdout.readline().split()[0]
            return asyncio.run(watch(address, process.pid, seconds))
        finally:
            process.terminate()    # a job in the background of a script ignores SIGINT


def main():
    """Run the benchmark and print its table; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition('\n')[0])
    parser.add_argument('--scenes', nargs='+', default=SCENES, metavar='SCENE')
    parser.add_argument('--seconds', type=float, default=20.0, help='of each scene (20)')
    parser.add_argument('--json', action='store_true')
    options = parser.parse_args()
    found = {scene: measure(scene, options.seconds) for scene in options.scenes}
    if options.json:
        from rigid_body_sim.compilation.environment import processor
        print(json.dumps({'machine': processor(), 'cores': os.cpu_count(),
                          'load': os.getloadavg()[0], 'seconds': options.seconds,
                          'scenes': found}, indent=2))
        return 0
    print(f'{options.seconds:g} s each, load {os.getloadavg()[0]:.1f}\n')
    print(f'{"":22}{"pictures/s":>11}{"page %":>8}{"simulation %":>14}{"both %":>8}'
          f'{"ms/picture":>12}{"kB/s":>8}{"MiB":>7}{"growth MiB":>12}{"2nd half":>10}')
    for scene, row in found.items():
        print(f'{scene:22}{row["pictures"]:11.1f}{row["cpu_page"]:8.1f}'
              f'{row["cpu_simulation"]:14.1f}{row["cpu_page"] + row["cpu_simulation"]:8.1f}'
              f'{row["milliseconds"]:12.2f}{row["kilobytes"]:8.0f}'
              f'{row["memory_mib"]:7.0f}{row["growth_mib"]:12.2f}{row["growth_late_mib"]:10.2f}')
        if len(row['minutes_mib']) > 1:
            print('    MiB of each minute:', *row['minutes_mib'])
    return 0


if __name__ == '__main__':
    sys.exit(main())
