# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The gap between flights and the model: where it lies, what causes it, how far it shrinks."""
