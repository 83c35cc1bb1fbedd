# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The simulators that vehicles are written for, by name."""

from quad_ident_ros.vehicle_files import (
    out_drone_models,
    out_mjcf,
    out_px4_sih,
    out_rotorpy,
    out_sdf,
    out_urdf,
)
from quad_ident_ros.vehicle_files.target import Target

TARGETS: dict[str, Target] = {
    'gazebo': out_sdf.TARGET,
    'mujoco': out_mjcf.TARGET,
    'urdf': out_urdf.TARGET,
    'rotorpy': out_rotorpy.TARGET,
    'crazyflow': out_drone_models.TARGET,
    'px4_sih': out_px4_sih.TARGET}
