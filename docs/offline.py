# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a page of HTML loads from a network."""

from html.parser import HTMLParser

# Elements whose attribute a browser loads by itself; a link to click is not one of them.
LOADED = {'script': 'src', 'img': 'src', 'iframe': 'src', 'source': 'src', 'video': 'src',
          'audio': 'src', 'embed': 'src', 'object': 'data', 'link': 'href', 'image': 'href'}
NOT_LOADED = {'canonical', 'next', 'prev', 'alternate', 'license', 'author'}   # rel of <link>


class _Addresses(HTMLParser):

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attrs):
        values = dict(attrs)
        address = values.get(LOADED.get(tag, '')) or ''
        named = tag == 'link' and set((values.get('rel') or '').split()) <= NOT_LOADED
        if address.startswith(('http:', 'https:', '//')) and not named:
            self.found.append(address)
        style = values.get('style') or ''
        if 'url(http' in style.replace('"', '').replace("'", ''):
            self.found.append(style)


def loaded(html: str) -> list[str]:
    """Return the addresses of other hosts that a browser loads with a page."""
    parser = _Addresses()
    parser.feed(html)
    return parser.found
