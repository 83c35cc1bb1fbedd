# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A Mapping as the text of a mapping file."""

from collections.abc import Iterable, Sequence
from collections.abc import Mapping as Pairs
import json

from quad_ident_ros.data.mapping import ATTITUDE, Column, Mapping, ROLES, unit_of
from quad_ident_ros.data.message_roles import could_be
from quad_ident_ros.data.readers.base import Content
from quad_ident_ros.model.motors import KINDS


def columns_text(columns: Pairs[str, Column]) -> dict[str, str]:
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


def flow(mapping: Mapping) -> str:
    """Return the columns of a Mapping in one line."""
    entries = columns_text(mapping.columns) or {'t': 'time', 'px': 'x'}
    return 'columns: {' + ', '.join(f'{name}: {text}' for name, text in entries.items()) + '}'


def topics_text(source: object, found: Sequence[Content],
                chosen: Pairs[str, str] | None = None) -> str:
    """
    Return a mapping file to begin with for a bag: a role with one candidate is filled in.

    Args: source: what the file is of; found: the Content of its topics; chosen: role -> topic, as
    they are read without a mapping, or None where that is in doubt.
    """
    roles = {role: [content for content in found if role in content.roles] for role in ROLES}
    sole = {role: topics[0].name for role, topics in roles.items() if len(topics) == 1
            and not (roles['pose'] and role in ('position', 'attitude'))}   # a pose has both
    if sole.get('rotors') == sole.get('commands'):
        sole.pop('rotors', None)    # measured speeds that are the commands would deny every lag
    chosen = sole | dict(chosen or {})
    lines = []
    for role, topics in roles.items():
        for one in topics:
            field = could_be(one.name, one.type, one.fields)[1] if role in _OUTPUTS else ''
            more = f', field: {_quoted(field)}' if field else ''
            more += ', unit: rpm' if role == 'rotors' and 'rpm' in field else ''
            sign = '' if chosen.get(role) == one.name else '# '
            lines.append(f'  {sign}{role}: {{topic: {_quoted(one.name)}{more}}}')
        if not topics:
            lines.append(f'  # {role}: no topic has a type that is known for this')
    head = 'topics:' if any(not line.startswith('  #') for line in lines) else '# topics:'
    return _text(source, ['world: ENU                     # or NED',
                          'body: FLU                      # or FRD', head, *lines, *_ACTUATORS])


def names_text(source: object, outputs: Sequence[int], kind: str,
               instances: Pairs[str, Sequence[int]]) -> str:
    """
    Return a mapping file to begin with for a log whose names are known.

    Nothing is filled in, as the log says by itself what it has. Args: source; outputs: numbers of
    those that motors are on; kind of them (KINDS), or ''; instances: the numbers of what occurs
    several times.
    """
    order = ', '.join(map(str, outputs)) or '1, 2, 3, 4'
    listed = ['instances: {}                  # such as {NAME: NUMBER}: which of several is '
              'read']
    listed += [f'#   {name}: there are {", ".join(map(str, numbers))}'
               for name, numbers in instances.items()]
    told = {'kind: pwm'.ljust(29): f'kind: {kind}'.ljust(29), '[1, 2, 3, 4]': f'[{order}]'}
    lines = _ACTUATORS
    for usual, here in told.items():
        lines = [line.replace(usual, here) for line in lines]
    return _text(source, [*listed, *lines])


def table_text(source: object, mapping: Mapping, doubts: Sequence[str],
               columns: Iterable[str]) -> str:
    """
    Return a mapping file to begin with for a table.

    Args: source; mapping and doubts of a guess.Guess; columns: names of all in the file.
    """
    used = {name for column in mapping.columns.values() for name in column.names}
    lines = [f'# not recognised by names and values: {doubt}' for doubt in doubts]
    lines += [f'world: {mapping.world}', f'body: {mapping.body}']
    if ATTITUDE in mapping.columns:
        lines.append(f'quaternion: {mapping.quaternion}')
    entries = [f'  {name}: {text}' for name, text in columns_text(mapping.columns).items()]
    if 't' not in mapping.columns:      # without a time nothing else can be read
        entries = ['  # t: {column: time, unit: us}', *(f'  # {line[2:]}' for line in entries)]
    others = [name for name in columns if name not in used]
    if others:
        entries.append('  # columns that are not read: ' + ', '.join(map(_quoted, others)))
    head = 'columns:' if 't' in mapping.columns else '# columns:'
    outputs = any(name.startswith('output') for name in mapping.columns)
    return _text(source, [*lines, head, *entries, *(_ACTUATORS if outputs else [])])


_OUTPUTS = 'commands', 'rotors'
_ACTUATORS = ['# actuators:                     # how outputs become rotor speeds',
              '#   kind: pwm                    # ' + ', '.join(KINDS),
              '#   order: [1, 2, 3, 4]          # the output of each rotor of the vehicle file',
              '#   curve: linear                # or thrust: the square of the speed is']


def _text(source: object, lines: Sequence[str]) -> str:
    clean = ' '.join(str(source).split())
    return '\n'.join([f'# Mapping to begin with, for {clean}: check each line; lines that '
                      'begin with # have no effect.', *lines]) + '\n'


def _quoted(name: str) -> str:
    """Return a name as YAML reads it back."""
    plain = name.replace('_', '').replace('.', '').replace('/', '')
    sure = plain.isalnum() and plain.isascii() and not plain[0].isdigit() and name.lower() not in (
        'y', 'n', 'yes', 'no', 'on', 'off', 'true', 'false', 'null')
    return name if sure and not name.startswith('.') else json.dumps(name, ensure_ascii=False)
