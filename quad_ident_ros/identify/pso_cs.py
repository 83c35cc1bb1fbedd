# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The cooperative PSO-CS: cuckoo search whose flights are drawn to the best, eq. (29)."""

from quad_ident_ros.identify.cs import hatch
from quad_ident_ros.identify.search import Search


def pso_cs(search: Search) -> None:
    """Minimise by PSO-CS; two evaluations per nest and generation."""
    hatch(search, search.settings.c2)
