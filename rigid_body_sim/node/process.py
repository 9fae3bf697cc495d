# SPDX-License-Identifier: Apache-2.0
"""A node in a process of its own: rclpy, the executor in the main thread, and the end."""

import rclpy
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.logging import LoggingSeverity, set_logger_level
from rclpy.signals import SignalHandlerOptions

from rigid_body_sim.command_line import BAD_INPUT, CHECK_FAILED, GOOD
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.node import overrides
from rigid_body_sim.realtime.shutdown import say

RCLError = rclpy_implementation.RCLError


def run(make_node, arguments, stop):
    """Run a node until it should end; return the exit status.

    Parameters
    ----------
    make_node : callable
        Called with `stop` and the names of parameters that may be meant for other nodes
        (overrides.settled); returns the node. The node has ``close()``, which ends it in order
        and returns an exit status.
    arguments : list of str
        The command line, with ``--ros-args``.
    stop : shutdown.Stop

    Returns
    -------
    int
        0, or 2 after one line about bad input or what ROS refuses, or 1 after one line about a
        failure.
    """
    # its error about arguments takes two lines, and ours says the same
    set_logger_level('rcl', LoggingSeverity.FATAL)
    try:
        with overrides.settled(arguments) as (settled, shared):
            try:
                _init(settled)
            except RCLError:
                _init(arguments)    # so that the error names the file that the user gave
    except Exception as error:  # rclpy has a class of its own for each fault of the command line
        say(f'ROS arguments: {_one_line(error)}; see --help')
        return BAD_INPUT
    set_logger_level('rcl', LoggingSeverity.UNSET)
    stop.last_resort = rclpy.try_shutdown
    node = None
    try:
        node = make_node(stop, shared)
        return _spin(node, stop)
    except BadInput as refusal:
        say(refusal)
        return BAD_INPUT
    except NotConverged as failure:    # a motion that cannot begin
        say(failure)
        return CHECK_FAILED
    except RCLError as error:
        say(f'ROS: {_one_line(error)}')
        return BAD_INPUT
    except InvalidParameterTypeException as error:
        say(f'parameter {_one_line(error)}')
        return BAD_INPUT
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


def _init(arguments):
    # rclpy takes the first argument for the program's name
    rclpy.init(args=['', *arguments], signal_handler_options=SignalHandlerOptions.NO)


def _spin(node, stop):
    """Serve the node until it should end; close it in any case."""
    status = GOOD
    executor = SingleThreadedExecutor()
    try:
        executor.add_node(node)
        stop.on_request(executor.wake)
        while not stop.wanted:
            executor.spin_once()
    except ExternalShutdownException:
        pass
    except Exception as error:
        say(f'{node.get_name()}: a callback failed: {type(error).__name__}: {_one_line(error)}')
        status = CHECK_FAILED
    finally:
        stop.on_request(lambda: None)
        executor.shutdown(timeout_sec=0.0)
    return node.close() or status


def _one_line(error):
    return ' '.join(str(error).split())[:300]
