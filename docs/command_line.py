# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The reference of the command line, from its parsers: a page of the site."""

import argparse
import textwrap

from quad_ident_ros.cli.main import COMMANDS, parser

HEAD = """\
# Command line

`quad_ident COMMAND`, in a checkout `./run COMMAND`, in a ROS 2 workspace
`ros2 run quad_ident_ros quad_ident COMMAND`. This page is made from the parsers:
`quad_ident COMMAND --help` says the same.

| command | what it does |
| --- | --- |
"""


def reference() -> str:
    """Return the page: a table of the commands, then each with its arguments and examples."""
    _, commands = parser(COMMANDS)
    table = ''.join(f'| [`{name}`](#{name}) | {_cell(said)} |\n'
                    for name, said in COMMANDS.items())
    return HEAD + table + ''.join(
        _command(name, commands[name]) for name in COMMANDS)


def _command(name: str, command: argparse.ArgumentParser) -> str:
    usage = ' '.join(command.format_usage().removeprefix('usage: ').split())
    usage = textwrap.fill(usage, 95, subsequent_indent='    ', break_on_hyphens=False)
    parts = [f'## {name}', f'```text\n{usage}\n```']
    if command.description:
        parts.append(' '.join(command.description.split()))
    rows = [_row(action, command) for group in command._action_groups
            for action in group._group_actions]
    parts.append('\n'.join(['| argument | what it is |', '| --- | --- |', *rows]))
    if command.epilog:
        parts.append(f'```text\n{command.epilog.rstrip()}\n```')
    return '\n' + '\n\n'.join(parts) + '\n'


def _row(action: argparse.Action, command: argparse.ArgumentParser) -> str:
    formatter = command._get_formatter()
    if action.option_strings:
        value = '' if action.nargs == 0 else ' ' + formatter._format_args(
            action, formatter._get_default_metavar_for_optional(action))
        name = ', '.join(f'{option}{value}' for option in action.option_strings)
    else:
        name = formatter._format_args(
            action, formatter._get_default_metavar_for_positional(action))
    said = formatter._expand_help(action) if action.help else ''
    needed = ' (required)' if action.required and action.option_strings else ''
    return f'| `{_cell(name)}`{needed} | {_cell(said)} |'


def _cell(text: str) -> str:
    return ' '.join(text.split()).replace('|', '\\|').replace('<', '&lt;')
