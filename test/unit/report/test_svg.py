# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of Matplotlib inside a page."""

import re

from matplotlib import rc_context
import matplotlib.pyplot as plt
import numpy as np
import pytest

from quad_ident_ros.report.svg import FONTS, inline


@pytest.fixture
def picture(tmp_path):
    with rc_context(FONTS):
        figure, axis = plt.subplots()
        axis.plot(np.random.default_rng(0).normal(size=50), color='#d55e00')
        axis.set_title('1.23456 m')
        figure.savefig(tmp_path / 'picture.svg')
        plt.close(figure)
    return tmp_path / 'picture.svg'


def coordinates(text):
    """Return the coordinates of the line of a picture."""
    [path] = re.findall(r' d="([^"]*)"[^>]*stroke: (?:#d55e00|var\(--before\))', text)
    return np.array(re.findall(r'[-\d.]+', path), float)


def test_lines_stay_where_they_are_and_words_what_they_are(picture):
    text = inline(picture, 'name', 'alt')
    given = coordinates(picture.read_text(encoding='utf-8'))
    np.testing.assert_allclose(coordinates(text), given, atol=0.01)
    assert '>1.23456 m<' in text


def test_colours_are_those_of_the_page(picture):
    text = inline(picture, 'name', 'alt')
    assert '#d55e00' not in text and 'stroke: var(--before)' in text
