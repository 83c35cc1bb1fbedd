# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Many flights of many vehicles: diagnosed in groups, kept in a data set of Parquet files."""
