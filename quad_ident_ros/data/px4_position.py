# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which samples of position and velocity in a PX4 log are estimates and which are not."""

from collections.abc import Mapping

import numpy as np

VALID = ('xy_valid', 'z_valid', 'v_xy_valid', 'v_z_valid')
HALF = 0.5      # of the samples: with fewer estimates a flight is better off without them


def estimated(fields: Mapping[str, np.ndarray], position: np.ndarray,
              velocity: np.ndarray) -> np.ndarray:
    """
    Return which samples are estimates, (n,) of bool; none where they are fewer than half.

    PX4 logs its local position without GPS, camera or motion capture as well: then it is marked
    as not valid, is nan, or stays where it was.
    Args: fields name -> (n,) of the topic; position, velocity (n, 3).
    """
    known = np.isfinite(position).all(axis=1) & np.isfinite(velocity).all(axis=1)
    for name in VALID:
        if name in fields:
            known &= np.asarray(fields[name]) != 0
    across = np.hstack([position[:, :2], velocity[:, :2]])[known]
    if len(across) and not np.ptp(across, axis=0).any():
        known[:] = False
    return known if known.sum() > HALF * len(known) else np.zeros(len(known), bool)
