# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Online identification of quadrotors and diagnosis of their sim-to-real gap."""

__version__ = '0.1.0'
