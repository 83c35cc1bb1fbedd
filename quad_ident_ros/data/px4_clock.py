# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The date of a log of PX4, whose stamps count from the start of the autopilot."""

from collections.abc import Mapping

import numpy as np

RECEIVER = 'vehicle_gps_position'


def utc_of(receiver: Mapping[str, np.ndarray] | None, start_ns: int) -> int | None:
    """
    Return the time (ns, UTC) at a stamp of a log, by its satellite receiver, or None.

    Args: receiver: fields of vehicle_gps_position, name -> (n,), or None; start_ns: the stamp.
    """
    if receiver is None or not {'timestamp', 'time_utc_usec'} <= receiver.keys():
        return None
    # Before a fix the receiver gives 0.
    known = np.flatnonzero(receiver['time_utc_usec'] > 0)
    if not len(known):
        return None
    # One time that is damaged is no matter.
    ahead = (receiver['time_utc_usec'][known].astype(float)
             - receiver['timestamp'][known].astype(float))
    return start_ns + int(np.median(ahead)) * 1000
