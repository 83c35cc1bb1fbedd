# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The one error that bad input raises."""


class InputError(ValueError):
    """Input that cannot be used; the message says what, where and how to mend it."""
