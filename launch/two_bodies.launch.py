# SPDX-License-Identifier: Apache-2.0
"""Start two bodies, each in a namespace of its own.

::

    ros2 launch rigid_body_sim two_bodies.launch.py left:=tennis_racket right:=symmetric_top

Their topics are /left/pose, /right/pose and so on; their frames left/body and right/body.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare

SIDES = {'left': 'tennis_racket', 'right': 'heavy_top'}


def generate_launch_description():
    """Return the description that ``ros2 launch`` runs."""
    file = PathJoinSubstitution([FindPackageShare('rigid_body_sim'), 'launch', 'sim.launch.py'])
    rate = DeclareLaunchArgument('rate', default_value='',
                                 description='ticks per second of simulated time, for both bodies')
    scenes = [DeclareLaunchArgument(side, default_value=scene, description=f'scene on the {side}')
              for side, scene in SIDES.items()]
    # each body has a group, which confines what the included file sets
    bodies = [GroupAction([IncludeLaunchDescription(
        PythonLaunchDescriptionSource(file),
        launch_arguments={'namespace': side, 'scene': LaunchConfiguration(side),
                          'rate': LaunchConfiguration('rate')}.items())]) for side in SIDES]
    return LaunchDescription([rate, *scenes, *bodies])
