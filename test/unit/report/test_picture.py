# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of responses: that what was measured can be seen."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.report import picture

T = np.arange(2001) * 0.01


@pytest.fixture
def drawn(monkeypatch):
    """Return a function that draws a roll response and returns its figure."""
    monkeypatch.setattr(picture, 'save', lambda plt, figure, path: None)

    def draw(phi):
        columns = {'u2': np.ones(2001), 'phi': phi, 'theta': 0 * T, 'psi': 0 * T}
        flight = FlightRecord(T, columns, {'trim': [0.0] * 4, 'starts_at_rest': True})
        result = identify([flight], Settings(methods=('vp',), compare_orders=False))
        picture.save_responses(result, 'none.png', 'title')
        return plt.gcf()

    yield draw
    plt.close('all')


@pytest.mark.parametrize('turns', [0.2, 5, 30, 400])
def test_a_measured_line_does_not_fill_what_lies_between_its_turns(drawn, turns):
    figure = drawn(np.sin(2 * np.pi * turns * T / T[-1]))
    figure.canvas.draw()
    axis = figure.axes[0]
    line = axis.lines[0]
    points = axis.get_window_extent().width * 72 / figure.dpi
    seen = line.get_linewidth() < points / turns / 2
    # Where no line is thin enough the title says so.
    assert seen != ('only its range' in axis.get_title())
    assert line.get_linewidth() == 5 or turns > 1


@pytest.mark.slow
def test_the_legend_lies_beside_the_panels(drawn):
    figure = drawn(T)
    figure.canvas.draw()
    legend = figure.legends[0].get_window_extent()
    assert all(axis.get_legend() is None for axis in figure.axes)
    assert not any(legend.overlaps(axis.get_window_extent()) for axis in figure.axes)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ['measured', 'VP']


@pytest.mark.slow
@pytest.mark.parametrize('title', ['$x_{$: a file', r'\frac{ $\frac{$', '$^^$'])
def test_titles_with_mathematics_are_drawn_as_they_are(tmp_path, title):
    """Names of files and experiments have any text; matplotlib fails on such between two $."""
    columns = {'u2': np.ones(2001), 'phi': T, 'theta': 0 * T, 'psi': 0 * T}
    flight = FlightRecord(T, columns, {'trim': [0.0] * 4, 'starts_at_rest': True})
    result = identify([flight], Settings(methods=('vp',), compare_orders=False))
    picture.save_responses(result, tmp_path / 'x.svg', title)
    picture.save_spread({title: {'vp': np.array([1.0, 2.0])}}, tmp_path / 'y.svg', title, 'error')
    assert min((tmp_path / name).stat().st_size for name in ('x.svg', 'y.svg')) > 1000
