# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The console that every table, line and progress bar is printed by."""

from collections.abc import Collection, Iterable, Sequence
import os
import sys
from typing import TextIO

from rich import box
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn
from rich.table import Table

WIDTH = 150   # columns that a table may need: a narrower screen wraps it, and loses no digit


def console(stream: TextIO | None = None) -> Console:
    """
    Return a console on a stream (default: standard output) that does not cut a table.

    Names of files and columns are printed as they are, whatever signs they contain. With NO_COLOR
    in the environment nothing is coloured or bold (https://no-color.org).
    """
    screen = _plain_or_coloured(stream)
    screen.width = max(screen.width, WIDTH)
    return screen


def say(screen: Console, text: str, style: str | None = None) -> None:
    """Print a line on a console as it is, however long."""
    screen.print(text, style=style, markup=False, highlight=False, soft_wrap=True)


def table_of(titles: Iterable[str], rows: Iterable[Sequence[str]],
             numbers: Collection[str] = ()) -> Table:
    """Return a Table of rows of text; numbers: titles of the columns on the right."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    for title in titles:
        table.add_column(title, overflow='fold', justify='right' if title in numbers else 'left')
    for row in rows:
        table.add_row(*row)
    return table


def progress_bar(quiet: bool = False) -> Progress:
    """Return a progress bar on standard error that goes away at the end; quiet: none."""
    return Progress(TextColumn('{task.description}', markup=False), BarColumn(),
                    TextColumn('{task.percentage:>3.0f} %'), transient=True,
                    console=_plain_or_coloured(sys.stderr),
                    disable=quiet or not sys.stderr.isatty())


def _plain_or_coloured(stream: TextIO | None) -> Console:
    plain = bool(os.environ.get('NO_COLOR'))
    return Console(file=stream, markup=False, emoji=False, color_system=None if plain else 'auto')
