# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Closed-loop flights with known truth: trajectories, a controller, the plant, the sensors."""
