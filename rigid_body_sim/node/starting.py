# SPDX-License-Identifier: Apache-2.0
"""The start of the subcommands that are nodes.

Help works without ROS, and signals are handled before anything slow is imported.
"""

import importlib
import sys

from rigid_body_sim import command_line
from rigid_body_sim.realtime.shutdown import leave, signals


def start(name, about, examples, node_class, arguments):
    """Run a node and end the process with its exit status.

    Parameters
    ----------
    name, about, examples : str
        For ``--help``.
    node_class : str
        ``package.module:Class``, imported when it is needed; see process.run for what it must
        have.
    arguments : list of str or None
        The command line; None: that of the process.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    parser = command_line.parser(
        name, f'{about} Everything is a ROS parameter (docs/reference/parameters.md).', examples
    )
    parser.parse_args(
        arguments[: arguments.index('--ros-args')] if '--ros-args' in arguments else arguments
    )
    with signals() as stop:
        run = importlib.import_module('rigid_body_sim.node.process').run
        module, _, class_name = node_class.partition(':')
        leave(run(getattr(importlib.import_module(module), class_name), arguments, stop))
