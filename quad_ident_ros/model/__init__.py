# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The vehicle: its description, its equations of motion and their integration."""
