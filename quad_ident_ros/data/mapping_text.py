# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A Mapping as the text of a mapping file."""

import json

from quad_ident_ros.data.mapping import unit_of


def columns_text(columns):
    """Return the lines of `columns:`, {column of the record: text of its entry}."""
    found = {}
    for name, column in columns.items():
        names = (_quoted(column.names[0]) if len(column.names) == 1 else
                 '[' + ', '.join(map(_quoted, column.names)) + ']')
        more = []
        if column.unit and column.unit != unit_of(name):
            more.append(f'unit: {column.unit}')
        if column.frame != 'world' and name in ('vx', 'vy', 'vz'):
            more.append(f'frame: {column.frame}')
        found[name] = f'{{{", ".join([f"column: {names}", *more])}}}' if more else names
    return found


def flow(mapping):
    """Return the columns of a Mapping in one line."""
    entries = columns_text(mapping.columns) or {'t': 'time', 'px': 'x'}
    return 'columns: {' + ', '.join(f'{name}: {text}' for name, text in entries.items()) + '}'


def _quoted(name):
    """Return a name as YAML reads it back."""
    plain = name.replace('_', '').replace('.', '').replace('/', '')
    sure = plain.isalnum() and plain.isascii() and not name[0].isdigit() and name.lower() not in (
        'y', 'n', 'yes', 'no', 'on', 'off', 'true', 'false', 'null')
    return name if sure and not name.startswith('.') else json.dumps(name, ensure_ascii=False)
