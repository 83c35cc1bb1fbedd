# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A live view of a vehicle on ROS 2 in the terminal: its state, and how that is shown."""
