# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Start the recorder and the diagnoser, and the simulator or nothing in a vehicle's place."""

from quad_ident_ros.nodes.launch_plan import Argument, COMMON
from quad_ident_ros.nodes.launching import describe

NODES = ('simulator', 'recorder', 'diagnoser')
ARGUMENTS = (
    *COMMON,
    Argument('vehicle', 'Nominal vehicle, by name or file.', str,
             (('diagnoser', 'vehicle'),)),
    Argument('reality', 'Vehicle that the simulator flies, by name or file.', str,
             (('simulator', 'vehicle'),)),
    Argument('seed', 'Seed of the noise and of the trajectories.', int,
             (('simulator', 'seed'),)),
    Argument('mode', 'once, or continuous.', str, (('diagnoser', 'mode'),)),
    Argument('window', 'Seconds at the end of a record that are diagnosed.', float,
             (('diagnoser', 'window'),)),
    Argument('tolerance', "Gaps that do not matter, for example ['velocity=0.1'].", list,
             (('diagnoser', 'tolerance'),)),
)
USUAL = {'simulator': {'experiment': 'closed_loop'}, 'diagnoser': {'vehicle': 'hummingbird'}}


def generate_launch_description():
    """Describe the arguments and the nodes."""
    return describe(NODES, ARGUMENTS, USUAL)
