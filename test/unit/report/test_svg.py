# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of Matplotlib inside a page."""

import re

from matplotlib import rc_context
import matplotlib.pyplot as plt
import numpy as np
import pytest

from quad_ident_ros.report.svg import inline, SETTINGS


@pytest.fixture
def picture(tmp_path):
    with rc_context(SETTINGS):
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
    text = inline(picture, 'name')
    given = coordinates(picture.read_text(encoding='utf-8'))
    np.testing.assert_allclose(coordinates(text), given, atol=0.01)
    assert '>1.23456 m<' in text


def test_colours_are_those_of_the_page(picture):
    text = inline(picture, 'name')
    assert '#d55e00' not in text and 'stroke: var(--before)' in text


def test_ids_are_those_that_are_referred_to_and_of_this_picture(picture):
    text = inline(picture, 'name')
    wanted = re.findall(r'(?:href="|url\()#([^")]+)', text)
    assert wanted and set(re.findall(r'id="([^"]*)"', text)) == set(wanted)
    assert all(one.startswith('name-') for one in wanted)


def test_a_line_without_its_invisible_points_is_the_same_line(tmp_path):
    """To a third of a point, on a curve with a thousand points."""
    x = np.linspace(0.0, 1.0, 1000)
    with rc_context(SETTINGS):
        figure, axis = plt.subplots()
        axis.plot(x, np.sin(20.0 * x), color='#d55e00')
        figure.savefig(tmp_path / 'line.svg')
        # In points, from below.
        across, up = 72 / figure.dpi * axis.transData.transform(
            np.stack([x, np.sin(20.0 * x)], axis=1)).T
        height = 72 * figure.get_figheight()
        plt.close(figure)
    drawn = coordinates(inline(tmp_path / 'line.svg', 'name')).reshape(-1, 2)
    assert len(drawn) < 400
    slope = np.gradient(up, across)
    off = (np.interp(across, drawn[:, 0], height - drawn[:, 1]) - up) / np.hypot(1.0, slope)
    assert np.abs(off).max() < 0.33
