# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Start the simulator, the recorder and the identifier side by side."""

from quad_ident_ros.nodes.launching import describe

# Name, default, description and type of each argument.
ARGUMENTS = (
    ('namespace', '', 'Namespace of the nodes and of their topics.', str),
    ('experiment', 'hover_single_axis', 'Name of an experiment or path of its file.', str),
    ('vehicle', '', "Name of a vehicle or path of its file; empty: the experiment's.", str),
    ('real_time_factor', '1.0', 'Simulated seconds per second; 0.0: as fast as it goes.', float),
    ('use_sim_time', 'false', 'Publish the simulated time on /clock and follow it.', bool),
    ('output', '', 'Folder for recordings; empty: nothing is written.', str),
    ('method', 'all', 'Method of identification, or all.', str),
)
# The parameters of each node, and the arguments that they come from.
NODES = {
    'simulator': {
        'experiment': 'experiment',
        'vehicle': 'vehicle',
        'real_time_factor': 'real_time_factor',
        'publish_clock': 'use_sim_time',
    },
    'recorder': {'use_sim_time': 'use_sim_time', 'output': 'output'},
    'identifier': {'use_sim_time': 'use_sim_time', 'method': 'method'},
}


def generate_launch_description():
    """Describe the arguments and the nodes."""
    return describe(ARGUMENTS, NODES)
