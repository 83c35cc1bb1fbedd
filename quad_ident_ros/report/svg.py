# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of Matplotlib as drawings inside a page, in the colours of its style."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
import re
from typing import TYPE_CHECKING

from matplotlib import rc_context

from quad_ident_ros.report.html import drawing, Markup

if TYPE_CHECKING:
    from matplotlib.typing import RcKeyType

COLOURS = {'#000000': 'ink', '#ffffff': 'paper', '#ebebeb': 'grid', '#e0e0e0': 'noise',
           '#555555': 'second', '#999999': 'line', '#9aa0a6': 'measured', '#d55e00': 'before',
           '#0072b2': 'after', '#e69f00': 'amber', '#009e73': 'green', '#cc79a7': 'rose'}
"""What a colour of the pictures is in web/page.css, light and dark."""

SETTINGS: 'dict[RcKeyType, object]' = {
    'svg.fonttype': 'none', 'svg.hashsalt': 'quad_ident_ros', 'path.simplify_threshold': 0.25}
"""Of Matplotlib: text stays text, the same picture has the same names, and lines have no points
that move them by less than a quarter of a point, a third of a pixel at the width of a page."""


@dataclass(frozen=True, eq=False)
class Figure:
    """
    A picture with its words.

    save: a function that saves it at a path, by whose ending; alt: what it shows, for readers who
    cannot see it; data: its values for the script of a page, None where there is nothing to move.
    """

    save: Callable[[str | Path], None]
    alt: str
    caption: str
    data: dict | None = None


def drawings(figures: dict[str, Figure], folder: str | Path) -> dict[str, Markup]:
    """Save {name: Figure} as SVG in a folder, return each for a page; raises InputError."""
    drawn = {}
    with rc_context(SETTINGS):
        for name, figure in figures.items():
            file = Path(folder) / f'{name}.svg'
            figure.save(file)
            drawn[name] = drawing(inline(file, name), figure.alt, figure.caption,
                                  figure.data)
    return drawn


def inline(path: str | Path, name: str) -> Markup:
    """
    Return an SVG file of Matplotlib as an element of a page.

    name: what distinguishes its ids from those of other pictures of the page.
    """
    text = Path(path).read_text(encoding='utf-8')
    text = re.sub(r'<metadata>.*?</metadata>|<!--.*?-->|<style[^>]*>.*?</style>', '',
                  text[text.index('<svg'):], flags=re.DOTALL)
    wanted = set(re.findall(r'(?:href="|url\()#([^")]+)', text))
    text = re.sub(r' id="([^"]*)"',
                  lambda one: f' id="{name}-{one[1]}"' if one[1] in wanted else '', text)
    text = re.sub(r'(href="|url\()#', rf'\g<1>#{name}-', text)
    text = re.sub(r'font-family: [^;"]*;? ?', '', text)       # the page has its own
    for colour, variable in COLOURS.items():
        text = text.replace(colour, f'var(--{variable})')
    text = re.sub(r'\n\s*', '\n', text)
    # A hundredth of a point is less than any screen or printer shows.
    text = re.sub(r' (?:d|x|y|transform)="[^"]*"',
                  lambda one: re.sub(r'(\.\d\d)\d+', r'\1', one[0]), text)
    return Markup(re.sub(r'<svg ([^>]*?)width="[^"]*"', r'<svg \1',
                         re.sub(r' height="[\d.]+pt"', '', text, count=1), count=1))
