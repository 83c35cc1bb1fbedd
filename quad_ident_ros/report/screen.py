# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The console that every table, line and progress bar is printed by."""

from collections.abc import Collection, Iterable, Sequence
import os
import sys
from typing import Any, TextIO

from rich import box
from rich.cells import cell_len
from rich.console import Console, RenderableType
from rich.measure import Measurement
from rich.progress import BarColumn, Progress, TextColumn
from rich.table import Column, Table
from rich.text import Text

WIDTH = 150   # columns of what is no terminal: as many as a table may need
BRIEF = 1.0   # s of compiling that are not told of


def console(stream: TextIO | None = None) -> Console:
    """
    Return a console on a stream (default: standard output) that does not cut a table.

    On a terminal a table is as wide as that, or as its longest words need.
    Names of files and columns are printed as they are, whatever signs they contain. With NO_COLOR
    in the environment nothing is coloured or bold (https://no-color.org).
    """
    screen = _plain_or_coloured(stream)
    if not screen.is_terminal:
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
    # On a narrow terminal the text goes on in a line below: its end says what failed.
    return _Bar(TextColumn('{task.description}', markup=False, table_column=Column()),
                BarColumn(20), TextColumn('{task.percentage:>3.0f} %'), transient=True,
                console=_plain_or_coloured(sys.stderr),
                disable=quiet or not sys.stderr.isatty())


class _Bar(Progress):
    """A bar that tells of compiling, which the first start does, in place of a task at 0 %."""

    def __init__(self, *columns: TextColumn | BarColumn, **options: Any) -> None:
        self._watch: Any = None
        super().__init__(*columns, **options)
        # Numba takes a second to load, and only a command that has loaded it compiles.
        if not self.disable and 'numba' in sys.modules:
            from quad_ident_ros.compiling import CompilationWatch
            self._watch = CompilationWatch()

    def get_renderables(self) -> Iterable[RenderableType]:
        """Return what is shown now."""
        state = self._watch and self._watch.state()
        if state and state.under_way and state.seconds > BRIEF:
            yield Text(f'compiling, only once: {state.ready} of at most {state.all} functions, '
                       f'{state.seconds:.0f} s')
        else:
            yield from super().get_renderables()

    def stop(self) -> None:
        """Take the bar away."""
        super().stop()
        if self._watch:
            self._watch.close()
            self._watch = None


class _Screen(Console):
    """A console that breaks no word or number of a table, however narrow it is."""

    def print(self, *objects: Any, **options: Any) -> None:
        """Print as rich does; a table that cannot be as narrow as the console goes beyond it."""
        wide = self.width
        self.width = max([wide, *(self._fit(one) for one in objects if isinstance(one, Table))])
        super().print(*objects, **options)
        self.width = wide

    def on_broken_pipe(self) -> None:
        """Go on though nobody reads any more, as after `| head`: there may be files to write."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.file.fileno())
        os.close(nowhere)

    def _fit(self, table: Table) -> int:
        """Make the columns of a table as wide as they may be, and return the width that it has."""
        cells = [[str(cell) for cell in (column.header, *column.cells)]
                 for column in table.columns]
        most = [_longest(line for cell in column for line in cell.splitlines())
                for column in cells]
        least = [full if column.no_wrap else _longest(word for cell in texts for word in
                                                      cell.split())
                 for column, texts, full in zip(table.columns, cells, most, strict=True)]
        if self._around(table, most) + sum(most) > self.width:
            if self._around(table, most) + sum(least) > self.width:
                table.padding = 0
            spare = max(self.width - self._around(table, most) - sum(least), 0)
            wanted = max(sum(most) - sum(least), 1)
            for column, low, high in zip(table.columns, least, most, strict=True):
                column.width = low + (high - low) * min(spare, wanted) // wanted
            return max(self.width, self._around(table, most) + sum(least))
        return self.width

    def _around(self, table: Table, widths: list[int]) -> int:
        """Return how much of a table's width is not cells, by the widths that these would like."""
        whole = self.options.update(width=sum(widths) + 10 * len(widths))
        return Measurement.get(self, whole, table).maximum - sum(widths)


def _longest(parts: Iterable[str]) -> int:
    return max(map(cell_len, parts), default=0)


def _plain_or_coloured(stream: TextIO | None) -> Console:
    plain = bool(os.environ.get('NO_COLOR'))
    return _Screen(file=stream, markup=False, emoji=False, color_system=None if plain else 'auto')
