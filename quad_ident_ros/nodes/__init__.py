# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 nodes: thin adapters over the library. Nothing else imports rclpy."""

import sys

from quad_ident_ros.interrupted import end_on_interrupt
from quad_ident_ros.linear_algebra_threads import use_one

use_one()
if sys.argv[:1] == ['-m']:  # `python -m quad_ident_ros.nodes.NAME`, whose module comes next
    end_on_interrupt()
