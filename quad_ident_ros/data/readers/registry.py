# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""All kinds of files that flights are read from."""

from quad_ident_ros.data.readers import (
    ardupilot,
    betaflight,
    crazyflie,
    parquet,
    px4,
    rosbag1,
    rosbag2,
    table,
)

READERS = (rosbag1.READER, rosbag2.READER, px4.READER, ardupilot.READER, betaflight.READER,
           crazyflie.READER, parquet.READER, table.READER)
"""In the order in which they are tried: what no other reader recognises is a table."""
