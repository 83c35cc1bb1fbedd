# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The file that a vehicle goes back into: what it says now, and what it is to say."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.effects.registry import Values
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.wanted import Wanted


@dataclass(frozen=True)
class Base:
    """
    A base file: its Source, what was read of it, and what is Wanted of it.

    mass kg; inertia (3, 3) kg m^2; thrust N/(rad/s)^2, torque N m/(rad/s)^2, speed_max rad/s, None
    where the file has none; effects: those that it has by itself.
    """

    source: Source
    mass: float
    inertia: np.ndarray
    thrust: float | None
    torque: float | None
    speed_max: float | None
    effects: Values
    wanted: Wanted
