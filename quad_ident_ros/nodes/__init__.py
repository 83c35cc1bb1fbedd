# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The ROS 2 nodes: thin adapters over the library. Nothing else imports rclpy."""
