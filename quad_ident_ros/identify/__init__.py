# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Identification of the four models K/((s+a)(s+b)) from a flight record."""
