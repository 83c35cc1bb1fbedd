# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The change from aerospace frames (NED, FRD) to those of ROS (ENU, FLU)."""

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.model.attitude import product

WORLDS = ('ENU', 'NED')
BODIES = ('FLU', 'FRD')

_HALF = np.sqrt(0.5)
_ENU_FROM_NED = np.array([0.0, _HALF, _HALF, 0.0])   # half a turn about x + y
_FRD_FROM_FLU = np.array([0.0, 1.0, 0.0, 0.0])       # half a turn about x


def world_vector(vector: ArrayLike, world: str) -> np.ndarray:
    """Return vectors (..., 3) of the named world frame in ENU."""
    v = np.asarray(vector, float)
    return v if world == 'ENU' else v[..., [1, 0, 2]] * np.array([1.0, 1.0, -1.0])


def body_vector(vector: ArrayLike, body: str) -> np.ndarray:
    """Return vectors (..., 3) of the named body frame in FLU."""
    v = np.asarray(vector, float)
    return v if body == 'FLU' else v * np.array([1.0, -1.0, -1.0])


def attitude(quaternion: ArrayLike, world: str, body: str) -> np.ndarray:
    """Return attitudes (..., 4) of the named body in the named world as FLU in ENU."""
    q = np.asarray(quaternion, float)
    if world == 'NED':
        q = product(_ENU_FROM_NED, q)
    return product(q, _FRD_FROM_FLU) if body == 'FRD' else q
