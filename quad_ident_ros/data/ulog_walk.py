# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the messages of a ULog lie, by one pass over their heads."""

from array import array
from dataclasses import dataclass
import struct

import numpy as np

HEADER = struct.Struct('<HB')   # size and kind, before each message
START = 16                      # bytes before the first message
DATA, FORMAT, SUBSCRIPTION = b'DFA'
_KINDS = frozenset(b'BFIMPQALRCSODT')


@dataclass(frozen=True, eq=False)
class Messages:
    """
    The messages of the bytes of a log, up to where one is damaged or cut off.

    data (N,): where those with samples begin, after their heads; numbers, sizes (N,): the
    subscriptions that these are of, and their bytes; others: (kind, begin, size) of the rest;
    whole: whether there is nothing after them but the begin of one that is cut off; cut: whether
    there is such a begin.
    """

    data: np.ndarray
    numbers: np.ndarray
    sizes: np.ndarray
    others: list[tuple[int, int, int]]
    whole: bool
    cut: bool


def walk(data: bytes) -> Messages:
    """Return the Messages of the bytes of a log."""
    places, others = array('q'), []
    head, place, whole = HEADER.unpack_from, places.append, True
    at, end = START + HEADER.size, len(data)
    while at <= end:
        size, kind = head(data, at - 3)
        if at + size > end:
            whole = kind in _KINDS
            break
        if kind == DATA and size >= 2:
            place(at)
        elif kind in _KINDS and kind != DATA:
            others.append((kind, at, size))
        else:
            whole = False
            break
        at += 3 + size
    begins = np.array(places, np.int64)
    content = np.frombuffer(data, np.uint8)
    return Messages(begins, _words(content, begins), _words(content, begins - 3), others,
                    whole, whole and at - HEADER.size < end)


def _words(content: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the 16-bit numbers at some places (N,) of bytes."""
    return content[places] | content[places + 1].astype(np.uint16) << 8


def rows_of(data: bytes, begins: np.ndarray, size: int) -> np.ndarray:
    """Return the bytes that begin at some places (N,), (N, size) uint8."""
    windows = np.lib.stride_tricks.as_strided(np.frombuffer(data, np.uint8),
                                              (max(len(data) - size + 1, 0), size), (1, 1))
    return windows[begins]
