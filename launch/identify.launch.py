# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Start the recorder and the identifier, and the simulator or nothing in a vehicle's place."""

from quad_ident_ros.nodes.launch_plan import Argument, COMMON
from quad_ident_ros.nodes.launching import describe

NODES = ('simulator', 'recorder', 'identifier')
ARGUMENTS = (
    *COMMON,
    Argument('vehicle', 'Vehicle that flies, by name or file.', str,
             (('simulator', 'vehicle'), ('identifier', 'vehicle'))),
    Argument('seed', 'Seed of the noise and of the searches.', int,
             (('simulator', 'seed'), ('identifier', 'seed'))),
    Argument('method', 'Method of identification, or all.', str, (('identifier', 'method'),)),
    Argument('mode', 'once, or continuous.', str, (('identifier', 'mode'),)),
    Argument('window', 'Seconds at the end of a record that are fitted.', float,
             (('identifier', 'window'),)),
    Argument('trim', 'U1..U4 from which inputs count, for example [6.4, 0, 0, 0].', list,
             (('identifier', 'trim'),)),
)
USUAL = {}


def generate_launch_description():
    """Describe the arguments and the nodes."""
    return describe(NODES, ARGUMENTS, USUAL)
