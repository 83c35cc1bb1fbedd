# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Start the simulator, the recorder and the identifier side by side."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

# Name, default and description of each argument, and the type of the parameter it sets.
ARGUMENTS = (
    ('namespace', '', 'namespace of the three nodes and their topics', None),
    ('experiment', '', 'experiment to fly, a name or a YAML file; empty: the default one', str),
    ('vehicle', '', 'vehicle to simulate, a name or a YAML file; empty: the default one', str),
    ('real_time_factor', '1.0', 'seconds of simulated time for each second of real time', float),
    ('use_sim_time', 'true', 'whether recorder and identifier follow the topic /clock', bool),
    ('output', '', 'folder for the recording and the results; empty: the default one', str),
    ('method', '', 'method of identification; empty: the default one', str),
)
NODES = (
    ('simulator', ('experiment', 'vehicle', 'real_time_factor')),
    ('recorder', ('use_sim_time', 'output')),
    ('identifier', ('use_sim_time', 'method', 'output')),
)


def generate_launch_description():
    """Describe the arguments and the nodes."""
    types = {name: value_type for name, _, _, value_type in ARGUMENTS}
    return LaunchDescription(
        [
            DeclareLaunchArgument(name, default_value=default, description=description)
            for name, default, description, _ in ARGUMENTS
        ]
        + [
            Node(
                package='quad_ident_ros',
                executable=node,
                name=node,
                namespace=LaunchConfiguration('namespace'),
                output='screen',
                parameters=[
                    {
                        name: ParameterValue(LaunchConfiguration(name), value_type=types[name])
                        for name in parameters
                    }
                ],
            )
            for node, parameters in NODES
        ]
    )
