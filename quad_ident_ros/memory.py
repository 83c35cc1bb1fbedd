# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Memory that is free, but still held."""

import ctypes
import sys

LIBRARY = ctypes.CDLL(None) if sys.platform == 'linux' else None
MAPPED, LARGE = -3, 8 * 2 ** 20     # M_MMAP_THRESHOLD of malloc.h, and bytes of an array
# M_TRIM_THRESHOLD, and bytes that a process keeps for the arrays that come next: as many as the C
# library comes to by itself where no threshold is set (mallopt(3): twice its largest, of 32 MB).
TRIMMED, KEPT = -1, 64 * 2 ** 20


def give_back() -> None:
    """
    Give back to the system what was freed; nothing where its C library has no way to.

    The C library of Linux keeps what lies below anything in use: after reading a log of 50 MB
    that is 160 MB.
    """
    trim = getattr(LIBRARY, 'malloc_trim', None)
    if trim is not None:
        trim(0)


def hand_back_large() -> None:
    """
    Let large arrays go back to the system as soon as they are freed, where its C library can.

    That of Linux does so with what is larger than any array that was freed before: after one of
    30 MB it keeps all smaller ones, with gaps between them that fit none of the next. Small ones
    stay: Dask has its workers give back all that is freed, and almost half of the time of a
    diagnosis is then that of mapping the pages of its arrays anew.
    """
    option = getattr(LIBRARY, 'mallopt', None)
    if option is not None:
        option(MAPPED, LARGE)
        option(TRIMMED, KEPT)
