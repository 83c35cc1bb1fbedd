# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Systems of every kind that the tests of methods identify."""

from quad_ident_ros.identify.transfer import SecondOrder

SYSTEMS = {
    'stable': SecondOrder.from_poles(3.5, 2.0, 0.5),
    'integrating': SecondOrder.from_poles(3.5, 2.0, 0.0),
    'double_integrator': SecondOrder.from_poles(30.0, 0.0, 0.0),
    'unstable': SecondOrder.from_poles(-2.0, 1.0, -0.4),
    'equal': SecondOrder.from_poles(3.5, 0.8, 0.8),
    'complex': SecondOrder.from_half_difference(5.0, 0.5, -3.0),
}
