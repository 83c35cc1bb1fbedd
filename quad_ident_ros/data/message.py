# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a message of ROS is to those that read its fields."""

from typing import Any, TypeAlias

Message: TypeAlias = Any
"""Of rosbags or rclpy: its class, and so its fields, follow from a definition at run time."""
