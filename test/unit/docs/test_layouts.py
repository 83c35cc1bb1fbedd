# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The layouts for Foxglove and PlotJuggler: whole, alike, and as docs/layouts.py writes them."""

import xml.etree.ElementTree as ET

from layout_files import FOLDER, foxglove, foxglove_paths, plotjuggler_curves
import pytest

from docs.layouts import texts


@pytest.mark.parametrize('name', ['foxglove.json', 'plotjuggler.xml'])
def test_the_files_are_those_of_the_program(name):
    # If this fails: .venv/bin/python -m docs.layouts
    assert (FOLDER / name).read_text('utf-8') == texts()[name]


def test_both_draw_the_same():
    # PlotJuggler joins a topic and the fields of its message by slashes.
    assert plotjuggler_curves() == {'/'.join(path) for path in foxglove_paths()}


def panels_in(part):
    """Return the panels of a part of a window of Foxglove."""
    if isinstance(part, dict):
        assert 0 < part['splitPercentage'] < 100 and part['direction'] in ('row', 'column')
        return [*panels_in(part['first']), *panels_in(part['second'])]
    return [part]


def test_each_panel_of_foxglove_has_its_place_once():
    data = foxglove()
    tabs = data['configById'][data['layout']]['tabs']
    placed = [name for tab in tabs for name in panels_in(tab['layout'])]
    assert sorted([*placed, data['layout']]) == sorted(data['configById'])


def test_each_split_of_plotjuggler_has_as_many_parts_as_it_says():
    splits = list(ET.parse(FOLDER / 'plotjuggler.xml').getroot().iter('DockSplitter'))
    assert splits
    for split in splits:
        assert len(split) == int(split.get('count')) == len(split.get('sizes').split(';'))
