# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A made fleet whose truth is withheld from the command that looks at it."""
