# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the readers of logs with known names share: outputs, attitudes, and the mapping."""

from pathlib import Path

import numpy as np

from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.streams import HELD, Stream
from quad_ident_ros.errors import InputError


def known_names(path: Path, title: str, mapping: Mapping | None, instances: bool = False
                ) -> Mapping:
    """
    Return a mapping for a log whose names and frames are known.

    Args: title as in `of TITLE`; instances: whether the log may have several of a kind.
    Raises InputError where the mapping says what is known.
    """
    mapping = mapping or Mapping()
    held = 'instances and actuators hold' if instances else 'actuators hold'
    if (mapping.topics or mapping.world != 'ENU' or mapping.body != 'FLU'
            or (mapping.instances and not instances)):
        raise InputError(f'{path}: the names and frames of {title} are known; of a mapping only '
                         f'{held} for it')
    return mapping


def outputs_stream(source: str, stamps: np.ndarray, values: np.ndarray) -> Stream:
    """Return the HELD Stream output1..m of actuator outputs (N, m), of motors 1..m."""
    return Stream(source, stamps, {f'output{k + 1}': column
                                   for k, column in enumerate(np.asarray(values, float).T)}, HELD)


def unit_quaternions(quaternion: np.ndarray) -> np.ndarray:
    """Return quaternions (N, 4) of unit length; nan where they are no attitude."""
    with np.errstate(all='ignore'):
        q = np.asarray(quaternion, float)
        norm = np.linalg.norm(q, axis=-1, keepdims=True)
        return np.where(np.abs(norm - 1.0) < 0.5, q / norm, np.nan)
