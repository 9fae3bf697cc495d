"""The command `sim_node`: a scene as a ROS 2 node."""

import sys

from rigid_body_sim import command_line
from rigid_body_sim.node.shutdown import leave, signals

EXAMPLE = 'sim_node --ros-args -p scene:=tennis_racket -p rate:=1000 -p duration:=20'


def main(arguments=None):
    """Run the command, and end the process with its exit status."""
    arguments = sys.argv[1:] if arguments is None else arguments
    parser = command_line.parser('sim_node', 'Run a scene as a ROS 2 node; everything is a ROS parameter (README, section Parameters).',
                                 f'{EXAMPLE}\n  sim_node --ros-args --params-file config/sim_node.yaml -r __ns:=/left')
    own = arguments[:arguments.index('--ros-args')] if '--ros-args' in arguments else arguments
    parser.parse_args(own)
    with signals() as stop:
        # what takes long to import comes after signals are in order
        from rigid_body_sim.node.process import run
        from rigid_body_sim.node.simulation_node import SimulationNode
        leave(run(SimulationNode, arguments, stop))


if __name__ == '__main__':
    main()
