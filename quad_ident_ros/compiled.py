# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the inner loops to machine code, kept on disk between starts."""

import numba


def compiled(function=None, *, fused=False, reordered=False, inlined=False):
    """
    Compile a numerical function, without the interpreter's lock and with an on-disk cache.

    fused lets a product and a sum be one operation and division by zero give infinity, reordered
    lets sums be taken in another order, for kernels that the processor then does several elements
    at a time of; inlined makes it a part of the function that calls it. Not a number and infinity
    keep their meaning. Where no folder can be written the function is compiled again at each
    start.
    """
    if function is None:
        return lambda function: compiled(function, fused=fused, reordered=reordered,
                                         inlined=inlined)
    flags = {name for name, wanted in (('contract', fused), ('reassoc', reordered)) if wanted}
    # To raise an error at a division by zero is a branch, which keeps a loop from being widened.
    options = {'nogil': True, 'fastmath': flags, 'forceinline': inlined,
               'error_model': 'numpy' if fused else 'python'}
    try:
        return numba.njit(cache=True, **options)(function)
    except RuntimeError:
        return numba.njit(**options)(function)
