# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the launch files have in common. Only they import it: `launch` comes with a whole ROS 2."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def describe(arguments, nodes):
    """
    Return the LaunchDescription of nodes of this package.

    Args: arguments: (name, default, description, type) of each; nodes: {executable: {parameter:
    the argument that it comes from}}.
    """
    values = {name: ParameterValue(LaunchConfiguration(name), value_type=value_type)
              for name, _, _, value_type in arguments}
    return LaunchDescription([
        *(DeclareLaunchArgument(name, default_value=default, description=description)
          for name, default, description, _ in arguments),
        *(Node(package='quad_ident_ros', executable=node, name=node,
               namespace=LaunchConfiguration('namespace'), output='screen',
               parameters=[{name: values[source] for name, source in parameters.items()}])
          for node, parameters in nodes.items())])
