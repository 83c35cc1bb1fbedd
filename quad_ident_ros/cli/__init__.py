# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line `quad_ident`, one file per command."""

from quad_ident_ros.linear_algebra_threads import use_one

use_one()
