# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the launch files have in common. Only they import it: `launch` comes with a whole ROS 2."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from quad_ident_ros.nodes.launch_plan import planned


def describe(nodes, arguments, usual):
    """
    Return the LaunchDescription of nodes of this package, which ends when one of them does.

    Args: as those of launch_plan.planned.
    """
    def start(context):
        values = {argument.name: LaunchConfiguration(argument.name).perform(context)
                  for argument in arguments}
        return [Node(package='quad_ident_ros', executable=plan.node, name=plan.node,
                     namespace=values['namespace'], output='screen',
                     ros_arguments=list(plan.words),
                     on_exit=Shutdown(reason=f'{plan.node} has ended'))
                for plan in planned(nodes, arguments, values, usual)]

    return LaunchDescription([
        *(DeclareLaunchArgument(argument.name, default_value=argument.default,
                                description=argument.description) for argument in arguments),
        OpaqueFunction(function=start)])
