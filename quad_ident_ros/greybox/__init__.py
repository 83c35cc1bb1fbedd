# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Physical parameters from flights: short rollouts, free initial states, prediction errors."""
