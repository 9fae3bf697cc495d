# SPDX-License-Identifier: Apache-2.0
"""Start the managed node, configure it and activate it.

::

    ros2 launch rigid_body_sim lifecycle.launch.py scene:=tennis_racket

Without this file: ``ros2 launch rigid_body_sim sim.launch.py lifecycle:=true``, and then
``ros2 lifecycle set /lifecycle_sim_node configure`` and ``activate``.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, OpaqueFunction, RegisterEventHandler
from launch.events import matches_action
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode
from launch_ros.event_handlers import OnStateTransition
from launch_ros.events.lifecycle import ChangeState
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare
from lifecycle_msgs.msg import Transition


def managed(context):
    """Return the node and the actions that configure and activate it."""
    given = {name: value for name, value in (
        ('scene', ParameterValue(LaunchConfiguration('scene'), value_type=str)),
        ('rate', LaunchConfiguration('rate'))) if context.launch_configurations[name]}
    node = LifecycleNode(
        package='rigid_body_sim', executable='lifecycle_sim_node', name='lifecycle_sim_node',
        namespace=LaunchConfiguration('namespace'), output='screen', emulate_tty=True,
        parameters=[LaunchConfiguration('params_file'), given])
    activate = RegisterEventHandler(OnStateTransition(
        target_lifecycle_node=node, start_state='configuring', goal_state='inactive',
        entities=[_change(node, Transition.TRANSITION_ACTIVATE)]))
    # the handler comes first, because the transition may end before the next action starts
    return [activate, node, _change(node, Transition.TRANSITION_CONFIGURE)]


def _change(node, transition):
    return EmitEvent(event=ChangeState(lifecycle_node_matcher=matches_action(node),
                                       transition_id=transition))


def generate_launch_description():
    """Return the description that ``ros2 launch`` runs."""
    defaults = PathJoinSubstitution(
        [FindPackageShare('rigid_body_sim'), 'config', 'sim_node.yaml'])
    return LaunchDescription([
        DeclareLaunchArgument('scene', default_value='',
                              description='name of a scene that ships, or path of a scene file'),
        DeclareLaunchArgument('rate', default_value='',
                              description='ticks per second of simulated time'),
        DeclareLaunchArgument('namespace', default_value='', description='namespace of the node'),
        DeclareLaunchArgument('params_file', default_value=defaults,
                              description='parameters of the node'),
        OpaqueFunction(function=managed),
    ])
