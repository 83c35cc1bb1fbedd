# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Online identification of quadrotors on ROS 2."""

__version__ = '0.1.0'
