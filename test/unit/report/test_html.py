# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables and drawings of a page, as who does not see them hears them."""

from html.parser import HTMLParser

from quad_ident_ros.report.html import drawing, Markup, table


class Elements(HTMLParser):
    """Every element of a page with its attributes."""

    def __init__(self, text):
        super().__init__()
        self.all = []
        self.feed(text)

    def handle_starttag(self, name, attributes):
        """Keep an element."""
        self.all.append((name, dict(attributes)))


def test_every_row_of_a_group_has_its_title_which_is_seen_once():
    text = table(['effect', 'parameter'], [['wind', 'x'], ['', 'y'], ['', 'z'], ['drag', 'c']],
                 caption='parameters')
    rows = text.split('<tr')[2:]
    assert ['<th scope="row" class="text">wind</th>' in row for row in rows] == [
        True, False, False, False]
    unseen = '<th scope="row" class="text"><span class="heard">wind</span></th>'
    assert [unseen in row for row in rows] == [False, True, True, False]
    assert [row.startswith(' class="first"') for row in rows] == [True, False, False, True]


def test_the_words_of_a_drawing_may_have_quotes_and_its_marks_are_not_read():
    words = 'under "numbers" <all>'
    elements = Elements(drawing(Markup('<svg><text>1</text></svg>'), words, 'caption')).all
    [(_, picture)] = [one for one in elements if one[1].get('role') == 'img']
    assert picture['aria-label'] == words
    names = [name for name, _ in elements]
    assert elements[names.index('svg') - 1][1] == {'aria-hidden': 'true'}
