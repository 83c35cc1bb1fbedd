# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The flat outputs of a path in rotorpy's form."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray


def flat(middle: NDArray[np.float64], parts: Sequence[NDArray[np.float64]]) -> dict:
    """Return rotorpy's flat outputs of derivatives 0 to 4 of (x, y, z, heading)."""
    place = middle + parts[0]
    return {'x': place[:3], 'x_dot': parts[1][:3], 'x_ddot': parts[2][:3], 'x_dddot': parts[3][:3],
            'x_ddddot': parts[4][:3], 'yaw': place[3], 'yaw_dot': parts[1][3],
            'yaw_ddot': parts[2][3]}
