# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Serialized messages of a header and numbers, read without making the message: far sooner."""

from collections.abc import Callable, Sequence
from operator import itemgetter
import struct

PLAIN = b'\x00\x01'     # CDR, little endian, with numbers at multiples of their size
START = 4               # bytes before the message, from which places count
HEADER = struct.Struct('<iII')      # s, ns, bytes of the name of the frame, which follow

Reader = Callable[[bytes], tuple[int, tuple[float, ...]] | None]


def stamped_numbers(count: int, places: Sequence[int]) -> Reader:
    """
    Return a function that reads messages of a std_msgs/Header and so many doubles.

    It takes a serialized message and returns its stamp in ns and the doubles at some places, or
    None for one of another encoding or length, which the message class has to read.
    Source: OMG Common Data Representation, formal/2021-11-03, 15.3.
    """
    numbers = struct.Struct(f'<{count}d')
    chosen = itemgetter(*places) if len(places) > 1 else None

    def read(data: bytes) -> tuple[int, tuple[float, ...]] | None:
        if data[:2] != PLAIN or len(data) < START + HEADER.size:
            return None
        seconds, nanoseconds, name = HEADER.unpack_from(data, START)
        begin = START + (HEADER.size + name + 7 & ~7)
        if len(data) - begin < numbers.size:
            return None
        values = numbers.unpack_from(data, begin)
        return (seconds * 1_000_000_000 + nanoseconds,
                chosen(values) if chosen else (values[places[0]],))

    return read
