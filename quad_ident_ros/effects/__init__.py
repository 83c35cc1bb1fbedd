# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The effects that reality may have and the nominal vehicle does not, one file each."""
