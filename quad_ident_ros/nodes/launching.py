# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the launch files have in common. Only they import it: `launch` comes with a whole ROS 2."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from quad_ident_ros.nodes.launch_plan import NAMESPACE, planned, was_killed

# s until a killed node starts again. In this time a launch that ends keeps it from starting.
RESPAWN_DELAY = 2.0


def describe(nodes, arguments, usual):
    """
    Return the LaunchDescription of nodes of this package, which ends when one of them does.

    Nodes that are respawned end it only by themselves: told to, or where they refuse a parameter.
    Args: as those of launch_plan.planned.
    """
    def start(context):
        values = {argument.name: LaunchConfiguration(argument.name).perform(context)
                  for argument in arguments}
        # That of a group around this file (PushRosNamespace), which launch_ros puts before ours.
        group = context.launch_configurations.get('ros_namespace', '')
        space = values[NAMESPACE.name]
        whole = space if space.startswith('/') else f'{group}/{space}'
        plans = planned(nodes, arguments, {**values, NAMESPACE.name: whole}, usual)
        return [Node(package='quad_ident_ros', executable=plan.node, name=plan.node,
                     namespace=space, output='screen',
                     ros_arguments=list(plan.words), respawn=plan.respawn,
                     respawn_delay=RESPAWN_DELAY, on_exit=_on_exit(plan))
                for plan in plans]

    return LaunchDescription([
        *(DeclareLaunchArgument(argument.name, default_value=argument.default,
                                description=argument.description) for argument in arguments),
        OpaqueFunction(function=start)])


def _on_exit(plan):
    """Return what is called when a node ends, and ends all unless it is started once more."""
    def on_exit(event, _):
        if plan.respawn and was_killed(event.returncode):
            return None
        return [Shutdown(reason=f'{plan.node} has ended')]

    return on_exit
