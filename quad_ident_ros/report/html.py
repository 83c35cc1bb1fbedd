# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pages for a browser, in one file: tables and embedded pictures."""

from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files
import json
from pathlib import Path

from quad_ident_ros.errors import InputError
from quad_ident_ros.report.data import finite
from quad_ident_ros.whole_file import write_whole

MANY = 7    # columns
SCRIPT_DATA = '<script type="application/json">'


class Markup(str):
    """Text that is HTML already."""


def markup(value: object) -> Markup:
    """Return a value as HTML: text is escaped, Markup is not."""
    return value if isinstance(value, Markup) else Markup(escape(str(value)))


def tag(name: str, content: object, kind: str = '') -> Markup:
    """Return an HTML element with content and, where there is one, a class."""
    attribute = f' class="{kind}"' if kind else ''
    return Markup(f'<{name}{attribute}>{markup(content)}</{name}>')


def heard(content: object) -> Markup:
    """Return content that a screen reader reads out, and that is not seen."""
    return tag('span', content, 'heard')


def join(parts: Iterable[object], between: str = '\n') -> Markup:
    """Return parts as HTML, one after another."""
    return Markup(between.join(markup(part) for part in parts))


def table(head: Sequence[object], rows: Iterable[Sequence[object]], kinds: Iterable[str] = (), *,
          caption: str) -> Markup:
    """
    Return an HTML table, which can be scrolled with the keys where it is wider than the screen.

    Args: head: titles of the columns; rows: lists of cells, each text or Markup, or a td element
    of its own; kinds: class of each column, by default 'text' for the first and numbers after it.
    A row whose first cell is not empty begins a group, and that cell is the title of its row; a
    screen reader reads it out for the other rows of the group, too. A table of many columns is set
    smaller.
    """
    kinds = tuple(kinds) or ('text',) + ('',) * (len(head) - 1)
    titles = join((_title(title, 'col', kind and 'text') if title else tag('td', '')
                   for title, kind in zip(head, kinds, strict=True)), '')
    lines = []
    group: object = ''
    for row in rows:
        begins = row[0] != ''
        group = row[0] if begins else group
        cells = [group if begins or group == '' else heard(group), *row[1:]]
        lines.append(tag('tr', join((_cell(cell, kind, place) for place, (cell, kind) in
                                     enumerate(zip(cells, kinds, strict=True))), ''),
                         'first' if begins else ''))
    size = ' class="dense"' if len(head) > MANY else ''
    return Markup(f'<div class="wide" role="group" tabindex="0" aria-label="{escape(caption)}">'
                  f'<table{size}>{tag("caption", caption)}<thead><tr>{titles}</tr></thead>\n'
                  f'<tbody>{join(lines)}</tbody></table></div>')


def _cell(cell: object, kind: str, place: int) -> Markup:
    if isinstance(cell, Markup) and cell.startswith('<td'):
        return cell
    return _title(cell, 'row', kind) if place == 0 and cell != '' else tag('td', cell, kind)


def _title(content: object, scope: str, kind: str) -> Markup:
    attribute = f' class="{kind}"' if kind else ''
    return Markup(f'<th scope="{scope}"{attribute}>{markup(content)}</th>')


def drawing(content: object, alt: str, caption: str, data: object = None) -> Markup:
    """
    Return an SVG element as a figure, which can be scrolled where it is wider than it fits.

    Args: alt: what it shows, in place of the marks and numbers of the element; data: values from
    which web/page.js draws it in its place, or None.
    """
    moving = script_data(data) if data else ''
    return Markup(f'<figure><div class="picture" role="img" tabindex="0" aria-label='
                  f'"{escape(alt)}"><div aria-hidden="true">{content}</div></div>{moving}'
                  f'{tag("figcaption", caption)}</figure>')


def script_data(data: object) -> Markup:
    """Return data for the script of a page, as an element in which no text can be markup."""
    text = json.dumps(finite(data), separators=(',', ':'), ensure_ascii=False, allow_nan=False)
    return Markup(SCRIPT_DATA + text.replace('<', '\\u003c') + '</script>')


def bar(share: float) -> Markup:
    """Return a horizontal bar for a share from 0 to 1, as a drawing beside its number."""
    return Markup(f'<span class="bar" aria-hidden="true"><span style="width:{100 * share:.0f}%">'
                  '</span></span>')


def details(summary: object, content: object) -> Markup:
    """Return content that unfolds under a summary."""
    return Markup(f'<details><summary>{markup(summary)}</summary>{markup(content)}</details>')


def web(name: str) -> str:
    """Return the text of a file that goes into pages: style, or script."""
    return files('quad_ident_ros.report').joinpath('web', name).read_text(encoding='utf-8')


def write_page(path: str | Path, title: str, body: object, also: str = '') -> None:
    """
    Write a page of HTML; raises InputError where the file cannot be written.

    also: name of a further style and script in web/, for pages of one kind.
    """
    body = markup(body)
    moving = SCRIPT_DATA in body
    style = (web('page.css') + (web('uPlot.min.css') if moving else '')
             + (web(f'{also}.css') if also else ''))
    script = f'\n<script>\n{web(f"{also}.js")}</script>\n' if also else ''
    text = (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f'<title>{escape(title)}</title>\n<style>\n{style}</style></head>\n<body>\n'
            f'<main>{tag("h1", title)}\n{body}\n</main>{_scripts() if moving else ""}'
            f'{script}</body></html>\n')
    try:
        write_whole(path, text)
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None


def _scripts() -> str:
    """Return what draws the values of drawings: uPlot with its licence, and page.js."""
    return (f'\n<script>\n/*\n{web("uPlot.LICENSE")}\n*/\n{web("uPlot.iife.min.js")}</script>\n'
            f'<script>\n{web("page.js")}</script>\n')
