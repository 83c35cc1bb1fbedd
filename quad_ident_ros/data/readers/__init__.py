# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The kinds of files that flights come in: one module each, entered in registry.READERS."""
