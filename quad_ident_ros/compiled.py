# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the inner loops to machine code, kept on disk between starts."""

import numba


def compiled(function):
    """
    Compile a numerical function, without the interpreter's lock and with an on-disk cache.

    Where no folder can be written the function is compiled again at each start.
    """
    try:
        return numba.njit(cache=True, nogil=True)(function)
    except RuntimeError:
        return numba.njit(nogil=True)(function)
