# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a check of a flight record says."""

from dataclasses import dataclass

SEVERITIES = ('info', 'warning', 'error')
"""info: good to know; warning: results suffer; error: results are wrong until it is mended."""


@dataclass(frozen=True)
class Finding:
    """A finding: a code for programs, one of SEVERITIES, where, what, and how to mend it."""

    code: str
    severity: str
    where: str
    message: str
    remedy: str
