# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The terminal: tables in a narrow one, and the bar that tells of the first compilation."""

from io import StringIO

import pytest
from rich.cells import cell_len

from quad_ident_ros import compiling
from quad_ident_ros.compiling import Compilation
from quad_ident_ros.report import screen
from quad_ident_ros.report.screen import console, progress_bar, table_of


class Terminal(StringIO):
    """A stream that is a terminal."""

    def isatty(self):
        """Return that it is one."""
        return True


@pytest.fixture
def narrow(monkeypatch):
    """Make terminals 80 columns wide, without colours."""
    monkeypatch.setenv('COLUMNS', '80')
    monkeypatch.setenv('NO_COLOR', '1')
    monkeypatch.setenv('TERM', 'xterm')


EFFECTS = (('effect', 'form, explains', 'probability', 'contribution', 'parameters',
            'velocity gap\nwithout it, m/s'),
           [('attitude_misalignment\nmisaligned attitude or gyro', 'gyro, 100 %', '1.00',
             '117 %', 'gyro_roll -0.003129 ± 0.001 rad, gyro_pitch -0.001669 ± 0.00095 rad',
             '0.142')])


def printed(stream, table):
    """Return the lines of a table on a stream."""
    console(stream).print(table)
    return stream.getvalue().splitlines()


def test_a_table_fits_a_terminal_of_80_columns_and_breaks_no_number(narrow):
    lines = printed(Terminal(), table_of(*EFFECTS))
    assert max(map(cell_len, lines)) <= 80
    words = ' '.join(lines).split()
    for text in (*EFFECTS[0], *EFFECTS[1][0]):
        assert set(text.split()) <= set(words)


def test_a_table_that_cannot_be_narrow_is_wider_and_loses_no_digit(narrow):
    row = [f'{k}.{10 ** 14 + k}' for k in range(8)]
    [line] = [line for line in printed(Terminal(), table_of(map(str, range(8)), [row]))
              if '.1' in line]
    assert line.split() == row and cell_len(line) > 80


def test_a_table_in_a_pipe_is_as_wide_as_it_needs(narrow):
    lines = printed(StringIO(), table_of(*EFFECTS))
    assert any('gyro, 100 %' in line and '117 %' in line and '0.142' in line for line in lines)
    assert max(map(cell_len, lines)) > 80


class Watch:
    """Stands in for what counts the compiled functions."""

    at = Compilation(True, 3, 160, 12.4)
    open = 0

    def __init__(self):
        Watch.open += 1

    def state(self):
        """Return how far it is."""
        return self.at

    def close(self):
        """Stop counting."""
        Watch.open -= 1


def shown(monkeypatch):
    """Return what the bar of a task shows."""
    stream = Terminal()
    monkeypatch.setattr(screen.sys, 'stderr', stream)
    with progress_bar() as bar:
        bar.add_task('flying')
        bar.refresh()
    assert Watch.open == 0
    return stream.getvalue()


def test_a_bar_tells_of_compiling_and_how_far_it_is(narrow, monkeypatch):
    monkeypatch.setattr(compiling, 'CompilationWatch', Watch)
    said = shown(monkeypatch)
    assert 'compiling, only once: 3 of at most 160 functions, 12 s' in said
    assert 'flying' not in said


@pytest.mark.parametrize('state', [Compilation(False, 160, 160, 40.0),
                                   Compilation(True, 3, 160, 0.5)])
def test_a_bar_does_not_tell_of_compiling_that_is_over_or_brief(state, narrow, monkeypatch):
    monkeypatch.setattr(compiling, 'CompilationWatch', Watch)
    monkeypatch.setattr(Watch, 'at', state)
    said = shown(monkeypatch)
    assert 'flying' in said and 'compiling' not in said
