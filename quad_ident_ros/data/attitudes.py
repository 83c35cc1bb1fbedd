# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The attitudes of a record, whichever columns it has for them."""

import numpy as np

from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION
from quad_ident_ros.model.attitude import quaternion_from_euler


def attitudes_of(record: FlightRecord) -> np.ndarray | None:
    """Return the unit quaternions of a record, (N, 4), or None where one is not a rotation."""
    if record.has(*QUATERNION):
        q = record.stack(*QUATERNION)
    elif record.has(*EULER):
        q = quaternion_from_euler(record.stack(*EULER))
    else:
        return None
    norm = np.linalg.norm(q, axis=-1, keepdims=True)
    return None if norm.min() < 1e-3 else q / norm
