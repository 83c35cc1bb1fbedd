# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Charts: one table of values, as a picture and as the data of a page."""

import json
import re

import numpy as np
import pytest

from quad_ident_ros.report.chart import breaks, Chart, Line, Panel, rounded, save_chart
from quad_ident_ros.report.html import script_data


def chart(**changes):
    x = np.arange(1.0, 6.0)
    lines = (Line('measured', 'measured', x ** 2), Line('predicted', 'before', -x / 3.0))
    values = {'quantity': 'time', 'unit': 's', 'x': x, 'widths': (2.0, 1.0), 'height': 2.0,
              'panels': (Panel('vx', 'm/s', lines), Panel('error', 'm/s', lines[1:], band=0.5))}
    return Chart(**{**values, 'band': 'noise', **changes})


def test_data_are_those_of_the_table():
    data = json.loads(json.dumps(chart().as_data()))
    assert data['x'] == [1.0, 2.0, 3.0, 4.0, 5.0]
    first, second = data['panels']
    assert first['lines'][0]['values'] == [1.0, 4.0, 9.0, 16.0, 25.0]
    assert second['lines'] == [{'label': 'predicted', 'style': 'before', 'values': [
        -0.3333, -0.6667, -1.0, -1.333, -1.667]}] and second['band'] == 0.5


def test_numbers_are_as_long_as_can_be_seen():
    values = np.array([1234.5678, 0.00012345678, -3.0])
    assert rounded(values) == [1235.0, 0.0001235, -3.0]
    random = np.random.default_rng(0).normal(size=1000)
    assert np.abs(np.array(rounded(random)) / random - 1.0).max() < 1e-3


def test_text_in_data_ends_no_element():
    text = script_data({'name': '</script><b>', 'values': [1.0, float('inf')]})
    assert text.count('</script>') == 1 and '<b>' not in text
    inside = re.fullmatch(r'<script type="application/json">(.*)</script>', text)[1]
    assert json.loads(inside) == {'name': '</script><b>', 'values': [1.0, None]}


@pytest.mark.slow
@pytest.mark.parametrize('logarithmic', [False, True])
def test_the_picture_names_what_it_shows(tmp_path, logarithmic):
    import matplotlib
    path = tmp_path / 'chart.svg'
    x = np.geomspace(0.1, 10.0, 30)
    with matplotlib.rc_context({'svg.fonttype': 'none'}):
        save_chart(chart(x=x, logarithmic=logarithmic, panels=tuple(
            Panel(title, 'm/s', (Line('measured', 'measured', x),)) for title in ('vx', 'vy'))),
            path)
    text = path.read_text(encoding='utf-8')
    assert all(f'>{said}<' in text for said in ('vx, m/s', 'vy, m/s', 'time, s', 'measured'))


def test_no_line_leads_over_a_time_of_which_nothing_is_known(tmp_path):
    t = np.array([0.1, 0.2, 0.3, 2.0, 2.1, 2.2, 5.0, 5.1])
    assert breaks(t) == [3, 6] and breaks(np.linspace(0.0, 9.0, 300)) == []
    panels = (Panel('vx', 'm/s', (Line('measured', 'measured', t),)),) * 2
    save_chart(chart(x=t, panels=panels), tmp_path / 'chart.svg')
    drawn = re.findall(r'<path d="([^"]*)" clip-path=[^>]*stroke: #9aa0a6',
                       (tmp_path / 'chart.svg').read_text(encoding='utf-8'))
    assert [path.count('M') for path in drawn] == [3, 3]
