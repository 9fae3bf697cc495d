# SPDX-License-Identifier: Apache-2.0
"""Start the node, and RViz or the page in the browser if asked.

::

    ros2 launch rigid_body_sim sim.launch.py scene:=heavy_top rate:=500 rviz:=true
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess, OpaqueFunction
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import LifecycleNode, Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import ExecutableInPackage, FindPackageShare

BOOLEAN = ['true', 'false']
SHOWN = '[marker, odom]'
"""The topics beside pose that the RViz configuration shows."""


def nodes(context):
    """Return the node; an argument that is not given leaves the value of the parameter file."""
    # rate has no type here: the node itself refuses a wrong value and says what would be right
    arguments = {'scene': ParameterValue(LaunchConfiguration('scene'), value_type=str),
                 **{name: LaunchConfiguration(name)
                    for name in ('rate', 'record', 'use_sim_time')}}
    given = {name: value for name, value in arguments.items()
             if context.launch_configurations[name]}
    if context.launch_configurations['rviz'] == 'true':
        given['publish'] = ParameterValue(SHOWN)
    settings = {'package': 'rigid_body_sim', 'namespace': LaunchConfiguration('namespace'),
                'output': 'screen', 'emulate_tty': True,
                'parameters': [LaunchConfiguration('params_file'), given]}
    if context.launch_configurations['lifecycle'] == 'true':
        return [LifecycleNode(executable='lifecycle_sim_node', name='lifecycle_sim_node',
                              **settings)]
    return [Node(executable='sim_node', name='sim_node', **settings)]


def rviz(context):
    """Return RViz in the namespace of the node: its topics are relative, its frame is not."""
    namespace = context.launch_configurations['namespace'].strip('/')
    configuration = PathJoinSubstitution(
        [FindPackageShare('rigid_body_sim'), 'config', 'rigid_body_sim.rviz'])
    frame = ['-f', f'{namespace}/world'] if namespace else []
    return [Node(package='rviz2', executable='rviz2', output='screen', namespace=namespace,
                 arguments=['-d', configuration, *frame])]


def view(context):
    """Return the page in the browser, which shows and pushes the node."""
    name = 'lifecycle_sim_node' if context.launch_configurations['lifecycle'] == 'true' else \
        'sim_node'
    namespace = context.launch_configurations['namespace'].strip('/')
    shown = f'/{namespace}/{name}' if namespace else f'/{name}'
    return [ExecuteProcess(
        cmd=[ExecutableInPackage(package='rigid_body_sim', executable='view'), '--node', shown],
        output='screen')]


def generate_launch_description():
    """Return the description that ``ros2 launch`` runs."""
    share = FindPackageShare('rigid_body_sim')
    declare = DeclareLaunchArgument
    return LaunchDescription([
        declare('scene', default_value='',
                description='name of a scene that ships, or path of a scene file'),
        declare('rate', default_value='', description='ticks per second of simulated time'),
        declare('namespace', default_value='', description='namespace of the node'),
        declare('use_sim_time', default_value='', choices=['', *BOOLEAN],
                description='whether the node follows /clock'),
        declare('params_file',
                default_value=PathJoinSubstitution([share, 'config', 'sim_node.yaml']),
                description='parameters of the node'),
        declare('lifecycle', default_value='false', choices=BOOLEAN,
                description='whether the node is a managed one, to be configured and activated'),
        declare('record', default_value='', choices=['', *BOOLEAN],
                description='whether to record to MCAP'),
        declare('rviz', default_value='false', choices=BOOLEAN,
                description='whether to open RViz, and to publish what it shows'),
        declare('view', default_value='false', choices=BOOLEAN,
                description='whether to show the body in a browser'),
        OpaqueFunction(function=nodes),
        OpaqueFunction(function=rviz, condition=IfCondition(LaunchConfiguration('rviz'))),
        OpaqueFunction(function=view, condition=IfCondition(LaunchConfiguration('view'))),
    ])
