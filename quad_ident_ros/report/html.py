# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pages for a browser, in one file: tables and embedded pictures."""

import base64
from html import escape
from pathlib import Path

from quad_ident_ros.errors import InputError
from quad_ident_ros.whole_file import write_whole

STYLE = """\
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; color: #222; background: #fff;
  max-width: 1180px; margin: 2rem auto; padding: 0 1.2rem; }
h1 { font-size: 1.7rem; line-height: 1.2; } h2 { font-size: 1.3rem; margin-top: 2.6rem;
  border-bottom: 1px solid #ddd; padding-bottom: .2rem; } h3 { font-size: 1.05rem;
  margin-top: 1.8rem; }
p, li { max-width: 75ch; } a { color: #0b5a9a; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: .6rem 0 1.2rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: #555; padding-bottom: .3rem; }
th, td { padding: .18rem .7rem; text-align: right; vertical-align: top; white-space: nowrap; }
th { border-bottom: 1px solid #999; font-weight: 600; }
tr.first td { border-top: 1px solid #ddd; }
.text { text-align: left; } td.prose { text-align: left; white-space: normal; min-width: 14rem; }
table.dense { font-size: .86em; } .dense th, .dense td { padding: .15rem .42rem; }
.second { color: #777; } .warn { background: #fdeccb; } .best { font-weight: 700; }
.tag { padding: .05rem .5rem; border-radius: .7rem; white-space: nowrap; background: #eee; }
.yes { background: #d5efdc; } .part { background: #fdeccb; } .no { background: #f8d4d0; }
figure { margin: 1rem 0; } img { max-width: 100%; height: auto; }
figcaption { color: #555; }
details { margin: .4rem 0 1.2rem; } summary { cursor: pointer; color: #0b5a9a; }
code { background: #f3f3f3; padding: 0 .25rem; }
"""


MANY = 7    # columns


class Markup(str):
    """Text that is HTML already."""


def markup(value):
    """Return a value as HTML: text is escaped, Markup is not."""
    return value if isinstance(value, Markup) else Markup(escape(str(value)))


def tag(name, content, kind=''):
    """Return an HTML element with content and, where there is one, a class."""
    attribute = f' class="{kind}"' if kind else ''
    return Markup(f'<{name}{attribute}>{markup(content)}</{name}>')


def join(parts, between='\n'):
    """Return parts as HTML, one after another."""
    return Markup(between.join(markup(part) for part in parts))


def table(head, rows, kinds=(), caption=''):
    """
    Return an HTML table.

    Args: head: titles of the columns; rows: lists of cells, each text or Markup, or a td element
    of its own; kinds: class of each column, by default 'text' for the first and numbers after it.
    A row whose first cell is not empty begins a group. A table of many columns is set smaller.
    """
    kinds = tuple(kinds) or ('text',) + ('',) * (len(head) - 1)
    titles = join((tag('th', title, kind and 'text')
                   for title, kind in zip(head, kinds, strict=True)), '')
    lines = []
    for row in rows:
        cells = join((cell if isinstance(cell, Markup) and cell.startswith('<td')
                      else tag('td', cell, kind) for cell, kind in zip(row, kinds, strict=True)),
                     '')
        lines.append(tag('tr', cells, 'first' if row[0] != '' else ''))
    top = tag('caption', caption) if caption else Markup()
    size = ' class="dense"' if len(head) > MANY else ''
    return Markup(f'<div class="wide"><table{size}>{top}<thead><tr>{titles}</tr></thead>\n<tbody>'
                  f'{join(lines)}</tbody></table></div>')


def figure(path, caption):
    """Return a PNG file as an embedded figure."""
    data = base64.b64encode(Path(path).read_bytes()).decode('ascii')
    return Markup(f'<figure><img src="data:image/png;base64,{data}" alt="{escape(caption)}">'
                  f'<figcaption>{escape(caption)}</figcaption></figure>')


def details(summary, content):
    """Return content that unfolds under a summary."""
    return Markup(f'<details><summary>{markup(summary)}</summary>{markup(content)}</details>')


def write_page(path, title, body):
    """Write a page of HTML; raises InputError where the file cannot be written."""
    text = (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f'<title>{escape(title)}</title>\n<style>\n{STYLE}</style></head>\n<body>\n'
            f'{tag("h1", title)}\n{markup(body)}\n</body></html>\n')
    try:
        write_whole(path, text)
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None
