# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of Matplotlib as drawings inside a page, in the colours of its style."""

from pathlib import Path
import re

from quad_ident_ros.report.html import Markup

COLOURS = {'#000000': 'ink', '#ffffff': 'paper', '#ebebeb': 'grid', '#e0e0e0': 'noise',
           '#555555': 'second', '#9aa0a6': 'measured', '#d55e00': 'before', '#0072b2': 'after'}
"""What a colour of the pictures is in web/page.css, light and dark."""

FONTS = {'svg.fonttype': 'none', 'svg.hashsalt': 'quad_ident_ros'}
"""Settings of Matplotlib: text stays text, and the same picture has the same names."""


def inline(path: str | Path, name: str, alt: str) -> Markup:
    """
    Return an SVG file of Matplotlib as an element of a page.

    Args: name: what tells its ids from those of other pictures of the page; alt: what it shows.
    """
    text = Path(path).read_text(encoding='utf-8')
    text = re.sub(r'<metadata>.*?</metadata>|<!--.*?-->|<style[^>]*>.*?</style>', '',
                  text[text.index('<svg'):], flags=re.DOTALL)
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'(href="|url\()#', rf'\g<1>#{name}-', text)
    for colour, variable in COLOURS.items():
        text = text.replace(colour, f'var(--{variable})')
    text = re.sub(r'\n\s*', '\n', text)
    # A hundredth of a point is less than any screen or printer shows.
    text = re.sub(r' d="[^"]*"', lambda path: re.sub(r'(\.\d\d)\d+', r'\1', path[0]), text)
    return Markup(re.sub(r'<svg ([^>]*?)width="[^"]*"', rf'<svg role="img" aria-label="{alt}" \1',
                         re.sub(r' height="[\d.]+pt"', '', text, count=1), count=1))
