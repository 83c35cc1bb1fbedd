# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The withheld check: realities that are not our own model, their labels sealed."""
