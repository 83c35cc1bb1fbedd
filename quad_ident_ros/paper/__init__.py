# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The paper reproduced: its tables and figures, and what of its claims holds."""
