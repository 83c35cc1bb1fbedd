# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Stamps of ROS in tables: whole seconds in one column, nanoseconds in another."""

import re

import numpy as np

_SECONDS = re.compile(r'(?i)(.*[^a-z]|)secs?')
_REST = ('nanosec', 'nanosecs', 'nsec', 'nsecs')


def with_whole_stamps(columns: dict[str, np.ndarray]) -> tuple[dict[str, np.ndarray], list[str]]:
    """
    Return columns (N,) by name, those of seconds with their nanoseconds, and notes on it.

    A column of nanoseconds is one of that name, header.stamp.nanosec beside header.stamp.sec,
    with whole numbers below 1e9; it is left out.
    """
    found, notes = dict(columns), []
    by_name = {name.lower(): name for name in columns}
    for name in columns:
        seconds = _SECONDS.fullmatch(name)
        rest = next((by_name[one] for end in _REST if seconds
                     and (one := f'{seconds[1]}{end}'.lower()) in by_name), None)
        if rest is None or not _whole(columns[name]) or not _whole(columns[rest], 1e9):
            continue
        found[name] = columns[name] + 1e-9 * found.pop(rest)
        notes.append(f'{name} and {rest}: one time')
    return found, notes


def _whole(values: np.ndarray, end: float = np.inf) -> bool:
    known = values[np.isfinite(values)]
    return bool(len(known) and (known == np.round(known)).all() and 0 <= known.min()
                and known.max() < end)
