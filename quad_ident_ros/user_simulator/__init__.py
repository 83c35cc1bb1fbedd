# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulators that users bring: flown along records, with effects around them."""
