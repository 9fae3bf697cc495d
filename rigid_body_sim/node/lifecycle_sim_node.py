# SPDX-License-Identifier: Apache-2.0
"""The subcommand `lifecycle_sim_node`: the node in its managed form."""

from rigid_body_sim.node.starting import start

EXAMPLES = (
    'lifecycle_sim_node --ros-args -p scene:=tennis_racket\n'
    '  ros2 lifecycle set /lifecycle_sim_node configure && '
    'ros2 lifecycle set /lifecycle_sim_node activate'
)


def main(arguments=None):
    """Run the subcommand, and end the process with its exit status."""
    start(
        'lifecycle_sim_node',
        'Run a scene as a managed ROS 2 node.',
        EXAMPLES,
        'rigid_body_sim.node.managed_node:ManagedNode',
        arguments,
    )


if __name__ == '__main__':
    main()
