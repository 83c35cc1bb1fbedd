# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What gap does not matter, as users give it: GROUP=VALUE."""

from collections.abc import Iterable
from dataclasses import replace

from quad_ident_ros import schema
from quad_ident_ros.diagnose.rules import RULES, Rules
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.errors import UNITS

EXAMPLE = 'velocity=0.02'


def rules_from(entries: Iterable[str], where: str) -> Rules:
    """
    Return the Rules with other floors of the tolerance.

    Args: entries: GROUP=VALUE, of greybox.errors.GROUPS in UNITS; where: what messages begin
    with. Raises InputError for what cannot be used.
    """
    floors: dict[str, float] = {}
    for entry in entries:
        name, sign, value = (part.strip() for part in entry.partition('='))
        if not sign:
            raise InputError(f'{where}: {schema.shown(entry)}: expected GROUP=VALUE, for example '
                             f'{EXAMPLE}')
        if name not in UNITS:
            raise schema.unknown_key(where, name, UNITS)
        if name in floors:
            raise InputError(f'{where}: {name} is given twice')
        floors[name] = schema.number(f'{where}: {name}', value, 0.0)
    return replace(RULES, floors=RULES.floors | floors)
