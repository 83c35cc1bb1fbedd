# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Long runs and faults of the nodes, for anyone to repeat: `./run soak`."""
