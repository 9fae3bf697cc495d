"""The node, with its parameters from a file: ``ros2 launch rigid_body_sim sim.launch.py scene:=heavy_top rate:=500``."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def sim_node(context):
    """Return the node; an argument that is not given leaves the value of the file."""
    # rate without a type: what is no number reaches the node, which says what would be right
    arguments = {'scene': ParameterValue(LaunchConfiguration('scene'), value_type=str), 'rate': LaunchConfiguration('rate')}
    given = {name: value for name, value in arguments.items() if context.launch_configurations[name]}
    return [Node(package='rigid_body_sim', executable='sim_node', output='screen', emulate_tty=True,
                 parameters=[LaunchConfiguration('params_file'), given])]


def generate_launch_description():
    """Return the description that ``ros2 launch`` runs."""
    defaults = PathJoinSubstitution([FindPackageShare('rigid_body_sim'), 'config', 'sim_node.yaml'])
    return LaunchDescription([
        DeclareLaunchArgument('scene', default_value='', description='name of a scene that ships, or path of a scene file'),
        DeclareLaunchArgument('rate', default_value='', description='ticks per second of simulated time'),
        DeclareLaunchArgument('params_file', default_value=defaults, description='parameters of the node'),
        OpaqueFunction(function=sim_node),
    ])
