# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Names by which topics and columns say which vehicle they are of."""

VEHICLE = (r'(?:vehicle|drone|uav|quad|quadrotor|robot|agent|rigid ?_?body|body|mav|cf|crazyflie|'
           r'px4|iris|x500)[ _]?\d{1,3}')
"""A vehicle of several by its name."""
