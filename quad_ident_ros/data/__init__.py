# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records: in memory, as CSV, as rosbag2 and as logs of PX4, and their quality."""
