# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the quality of records share."""

from flightmaker import VEHICLE
import numpy as np

from quad_ident_ros.data.quality import findings

P, V, Q = ('px', 'py', 'pz'), ('vx', 'vy', 'vz'), ('qw', 'qx', 'qy', 'qz')
W, A, CMD = ('wx', 'wy', 'wz'), ('ax', 'ay', 'az'), ('cmd1', 'cmd2', 'cmd3', 'cmd4')


def named(names, table):
    return dict(zip(names, np.asarray(table).T, strict=True))


def codes(record, vehicle=VEHICLE):
    return {finding.code for finding in findings(record, vehicle)}
