# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of results, and their place in a document."""

from pathlib import Path

from quad_ident_ros.errors import InputError

DOCUMENTS = Path(__file__).resolve().parents[1] / 'docs'


def markdown(head, rows):
    """Return a table in Markdown, its columns aligned; all but the first are numbers."""
    cells = [list(map(str, row)) for row in (head, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]

    def line(row):
        padded = [cell.rjust(width) if i else cell.ljust(width)
                  for i, (cell, width) in enumerate(zip(row, widths, strict=True))]
        return f'| {" | ".join(padded)} |'

    rule = ['-' * width if i == 0 else '-' * (width - 1) + ':' for i, width in enumerate(widths)]
    return '\n'.join([line(cells[0]), line(rule), *map(line, cells[1:])])


def targets(rows):
    """
    Return the table of targets, from (what, target as text, measured as text, whether met).

    Whether it is met is None where nothing was measured.
    """
    met = {True: 'yes', False: '**no**', None: '–'}
    return markdown(('what', 'target', 'measured', 'met'),
                    [(*row[:3], met[row[3]]) for row in rows])


def keep(document, name, text):
    """
    Put text between the markers of a name in a document of docs/.

    Raises InputError where the document or the markers are missing.
    """
    path = DOCUMENTS / document
    try:
        path.write_text(replaced(path.read_text(encoding='utf-8'), name, text), encoding='utf-8')
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None
    except ValueError:
        raise InputError(f'{path}: the lines <!-- bench: {name} --> and <!-- end: {name} --> are '
                         'missing: put them where the results belong') from None


def replaced(document, name, text):
    """Return a document with text between the markers of a name; raises ValueError."""
    begin, end = f'<!-- bench: {name} -->\n', f'<!-- end: {name} -->'
    start = document.index(begin) + len(begin)
    return f'{document[:start]}\n{text}\n\n{document[document.index(end, start):]}'


def number(value, digits=3):
    """Return a number with so many digits that count, without an exponent where that is short."""
    if value is None or value != value:
        return '–'
    if value == float('inf'):
        return '∞'
    if value == 0:
        return '0'
    if abs(value) >= 10 ** digits:
        rounded = float(f'{value:.{digits - 1}e}')
        return f'{rounded:,.0f}' if abs(value) < 1e7 else f'{value:.1e}'
    shown = f'{value:#.{digits}g}'
    return shown.rstrip('.') if 'e' not in shown else f'{value:.1e}'
