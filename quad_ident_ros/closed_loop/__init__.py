# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The gap in closed loop: how much worse a controller tracks, and what of it effects cost."""
