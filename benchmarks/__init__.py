# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Measurements of speed and accuracy against known truth and other libraries: `./run bench`."""
