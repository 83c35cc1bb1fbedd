# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How long a flight must be to bear a verdict: the one rule of library, command and node."""

from quad_ident_ros.errors import InputError

SHORTEST = 8.0      # s: of a single flight one half is held out


def length_of(record):
    """Return the length of a flight record, s; a nanosecond counts for nothing."""
    return round(float(record.t[-1] - record.t[0]) + record.period(), 6)


def refuse_short(record):
    """Raise InputError where a flight record is too short for a diagnosis."""
    if length_of(record) < SHORTEST:
        name = record.info.get('source') or record.info.get('name', 'a record')
        raise InputError(f'{name}: {length_of(record):.3g} s are '
                         f'too short for a diagnosis; at least {SHORTEST:g} s are needed')
