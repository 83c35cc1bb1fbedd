# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers of things, as messages say them."""


def counted(number: int, what: str) -> str:
    """Return a number with its noun, whose plural ends in s: 1 gap, 2 gaps."""
    return f'{number} {what}' if number == 1 else f'{number} {what}s'
