# SPDX-License-Identifier: Apache-2.0
"""The subcommand `run` (of `make run`): run the node for a while, then report on its recording.

The node is a process of its own, so nothing here disturbs its ticks; modules that take long to
import are imported when it has ended.
"""

import contextlib
import datetime
import os
import pathlib
import signal
import subprocess
import sys

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput

FOLDER = 'recordings'


def main(arguments=None):
    """Run the subcommand; return the exit status."""
    parser = command_line.parser(
        'run', 'Run the node on a scene in real time, record it, and report on the recording.',
        'python -m rigid_body_sim run --scene tennis_racket --rate 1000 --duration 20')
    parser.add_argument('--scene', default='tennis_racket',
                        help='name of a scene that ships, or a .yaml file (tennis_racket)')
    parser.add_argument('--rate', type=float, default=1000.0, help='ticks per second (1000)')
    parser.add_argument('--duration', type=float, default=20.0,
                        help='seconds (20); 0: until Ctrl-C')
    parser.add_argument('--json', action='store_true',
                        help='print what report.json holds, as the last thing on stdout')
    # the node compiles those of the scene, and says so
    return command_line.run(_run, parser.parse_args(arguments), kernels='the report')


def _run(options):
    name = f'{pathlib.Path(options.scene).stem}_{datetime.datetime.now():%Y-%m-%d_%H-%M-%S}'
    while (pathlib.Path(FOLDER) / name).exists():
        name += '_'
    status, by = _node(options, name)
    path = pathlib.Path(FOLDER) / name
    if status or by not in (None, signal.SIGINT):
        return status or 128 + by
    if not path.exists():
        raise BadInput(str(path), 'the node made no recording', 'see its messages above')
    from rigid_body_sim.analysis.analyze import analyze, report_folder, show
    found, written = analyze(path, report_folder(path), short=True)
    if options.json:
        command_line.print_json({'recording': str(path), 'bodies': found,
                                 'files': [str(one) for one in written]})
    else:
        show(found, written)
        print(_next_steps(path))
    return command_line.GOOD


def _next_steps(path):
    """Return what to do with the recording next, as lines that can be pasted into the shell."""
    python = os.path.relpath(sys.executable) if os.path.sep in sys.executable else sys.executable
    return (f'next:\n  {python} -m rigid_body_sim analyze {path}      # all figures, as a page\n'
            f'  {python} -m rigid_body_sim view {path}         # the body in a browser')


def _node(options, name):
    """Run the node until it ends; return its exit status, and the signal that ended it or None."""
    parameters = {'scene': options.scene, 'rate': options.rate, 'duration': options.duration,
                  'recording.directory': FOLDER, 'recording.name': name}
    assignments = [word for key, value in parameters.items() for word in ('-p', f'{key}:={value}')]
    command = [sys.executable, '-m', 'rigid_body_sim', 'sim_node', '--ros-args', *assignments]
    with forwarding() as forwarder:
        # a demonstration stays off the network
        environment = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', **os.environ}
        process = subprocess.Popen(command, env=environment,
                                   stdout=sys.stderr if options.json else None)
        forwarder.to(process)
        return process.wait(), forwarder.number


@contextlib.contextmanager
def forwarding():
    """Yield a Forwarder, which passes signals that end a process on to a child instead."""
    forwarder = Forwarder()
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = {number: signal.signal(number, forwarder.forward) for number in numbers
              if signal.getsignal(number) != signal.SIG_IGN}
    try:
        yield forwarder
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


class Forwarder:
    """Passes signals on to a child process.

    A signal that arrives before the child has started is passed on once it has.

    Attributes
    ----------
    number : int or None
        The last signal.
    """

    def __init__(self):
        self._process = self.number = None

    def to(self, process):
        """Pass signals on to this process from now on."""
        self._process = process
        if self.number:
            process.send_signal(self.number)

    def forward(self, number, _):
        """Handle a signal."""
        self.number = number
        if self._process:
            self._process.send_signal(number)


if __name__ == '__main__':
    sys.exit(main())
