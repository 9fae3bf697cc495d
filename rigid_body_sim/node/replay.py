# SPDX-License-Identifier: Apache-2.0
"""The subcommand `replay`: publish a recording again, at its own pace or another."""

import importlib
import math
import sys

from rigid_body_sim import command_line
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.realtime.shutdown import leave, say, signals
from rigid_body_sim.recording.reader import Recording

EXAMPLES = (
    'python -m rigid_body_sim replay recordings/racket --rate 0.5 --topics /pose /scene\n'
    '  python -m rigid_body_sim replay recordings/racket --paused\n'
    '  ros2 service call /replay/pause std_srvs/srv/SetBool "{data: false}"'
)
FASTEST = 1e6


def _parser():
    """Return the parser of the subcommand."""
    parser = command_line.parser(
        'replay',
        'Publish a recording again: its topics with their quality of service, /clock, and a '
        'service ~/pause.',
        EXAMPLES,
    )
    parser.add_argument(
        'recording', help='folder of a recording, or .mcap file; also of `ros2 bag record`'
    )
    parser.add_argument(
        '--rate', type=float, default=1.0, help='seconds of the recording per second (1)'
    )
    parser.add_argument(
        '--start',
        type=float,
        default=0.0,
        metavar='SECONDS',
        help='where in the recording to begin (0)',
    )
    parser.add_argument('--loop', action='store_true', help='begin anew at the end, until Ctrl-C')
    parser.add_argument('--topics', nargs='+', metavar='TOPIC', help='only these topics')
    parser.add_argument(
        '--paused',
        action='store_true',
        help='wait for the service ~/pause before the first message',
    )
    parser.add_argument(
        '--json', action='store_true', help='print counts and timing errors as JSON at the end'
    )
    return parser


def main(arguments=None):
    """Run the subcommand, and end the process with its exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    own = arguments[: arguments.index('--ros-args')] if '--ros-args' in arguments else arguments
    options = _parser().parse_args(own)
    with signals() as stop:
        try:
            recording = _opened(options)
        except BadInput as refusal:
            say(refusal)
            leave(command_line.BAD_INPUT)
        process = importlib.import_module('rigid_body_sim.node.process')
        node = importlib.import_module('rigid_body_sim.node.replay_node').ReplayNode
        leave(
            process.run(
                lambda stop, _: node(stop, recording, options), arguments[len(own) :], stop
            )
        )


def _opened(options):
    """Return the Recording; BadInput where the options do not fit it."""
    if not (math.isfinite(options.rate) and 0.0 < options.rate <= FASTEST):
        raise BadInput('--rate', f'got {options.rate:g}', f'a number above 0, up to {FASTEST:g}')
    recording = Recording(options.recording)
    for name in options.topics or ():
        recording.topic(name)
    seconds = (recording.end_time - recording.start_time) / NANOSECONDS
    if not recording.message_count:
        raise BadInput(options.recording, 'holds no messages', 'a recording that does')
    if not (math.isfinite(options.start) and 0.0 <= options.start <= seconds):
        raise BadInput(
            '--start',
            f'got {options.start:g}',
            f'from 0 to {seconds:.9g}, the length of the recording (s)',
        )
    if options.loop and options.start == seconds:
        raise BadInput(
            '--loop',
            'there is only one instant to play',
            'a recording that lasts, an earlier --start',
        )
    return recording


if __name__ == '__main__':
    sys.exit(main())
