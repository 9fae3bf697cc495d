# SPDX-License-Identifier: Apache-2.0
"""The subcommand `sim_node`: a scene as a ROS 2 node."""

from rigid_body_sim.node.starting import start

EXAMPLES = (
    'sim_node --ros-args -p scene:=tennis_racket -p rate:=1000 -p duration:=20\n'
    '  sim_node --ros-args --params-file config/sim_node.yaml -r __ns:=/left'
)


def main(arguments=None):
    """Run the subcommand, and end the process with its exit status."""
    start(
        'sim_node',
        'Run a scene as a ROS 2 node.',
        EXAMPLES,
        'rigid_body_sim.node.simulation_node:SimulationNode',
        arguments,
    )


if __name__ == '__main__':
    main()
