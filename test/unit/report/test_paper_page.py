# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident paper`: what it writes and prints."""

from contextlib import redirect_stdout
from html.parser import HTMLParser
import io
import json

import numpy as np
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.report.html import Markup, markup, table, tag
from quad_ident_ros.report.picture import save_spread

pytestmark = pytest.mark.xdist_group('paper_page')      # one run for all tests
VOID = ('meta', 'br', 'img')
PRESETS = ['paper_unit_steps_newton_euler', 'paper_table3']
SEEDS = '2'


class Page(HTMLParser):
    """Checks that elements are nested, and collects what a page refers to and says."""

    def __init__(self, text):
        super().__init__()
        self.open, self.references, self.anchors, self.text = [], [], set(), []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, name, attributes):
        for key, value in attributes:
            if key in ('src', 'href', 'xlink:href'):
                self.references.append(value)
            if key == 'id':
                self.anchors.add(value)
        if name not in VOID:
            self.open.append(name)

    def handle_endtag(self, name):
        assert self.open.pop() == name

    def handle_data(self, data):
        self.text.append(data)


@pytest.fixture(scope='module')
def written(tmp_path_factory):
    """Return the folder that the command wrote, and what it printed."""
    folder = tmp_path_factory.mktemp('paper')
    shown = io.StringIO()
    with redirect_stdout(shown):
        assert main(['paper', '--seeds', SEEDS, *(word for name in PRESETS
                                                  for word in ('--preset', name)),
                     '-o', str(folder / 'out'), '--json', str(folder / 'copy.json')]) == 0
    return folder / 'out', shown.getvalue()


@pytest.fixture(scope='module')
def data(written):
    return json.loads((written[0] / 'paper.json').read_text(encoding='utf-8'))


@pytest.fixture(scope='module')
def text(written):
    return (written[0] / 'paper.html').read_text(encoding='utf-8')


@pytest.mark.slow
def test_the_page_is_whole_and_needs_nothing_else(written, text):
    page = Page(text)
    assert text.count('<svg ') == len(list(written[0].glob('*.svg'))) == 1 + 2 * len(PRESETS)
    assert page.references and '<img' not in text
    assert {one for one in page.references if not one.startswith('#')} == set()
    assert {one[1:] for one in page.references} <= page.anchors
    assert len(page.anchors) == text.count(' id="')     # no two are the same
    assert text.count('url(') == text.count('url(#') and '@import' not in text
    assert '<script' not in text


@pytest.mark.slow
def test_the_page_shows_all_presets_methods_and_claims(text, data):
    said = ' '.join(Page(text).text)
    for word in (*PRESETS, 'Table 1', 'Table 2', 'Table 3', 'ITSE', 'no rotor speeds give',
                 *(method.label for method in METHODS.values()),
                 *(claim[key] for claim in data['claims'] for key in ('text', 'numbers'))):
        assert word in said, word
    assert list(data['presets']) == PRESETS


@pytest.mark.slow
def test_another_run_gives_the_same_but_for_times(data, tmp_path, capsys):
    def timeless(value):
        if isinstance(value, dict):
            return {key: timeless(entry) for key, entry in value.items() if key != 'seconds'}
        return [timeless(entry) for entry in value] if isinstance(value, list) else value

    assert main(['paper', '--seeds', SEEDS, '--preset', PRESETS[1], '-o',
                 str(tmp_path / 'deep' / 'er'), '--json', '-']) == 0
    again = json.loads(capsys.readouterr().out)
    assert timeless(again['presets'][PRESETS[1]]) == timeless(data['presets'][PRESETS[1]])
    for key in ('table_3', 'round_trips', 'printed_equations'):
        assert again[key] == data[key]


@pytest.mark.slow
def test_the_terminal_has_errors_conclusions_and_files(written, data):
    folder, shown = written
    for text in ('NRMSE', 'PSO-CS', *PRESETS, 'does not hold', '59 of 64', 'took',
                 str(folder / 'paper.html'), *(claim['text'] for claim in data['claims'])):
        assert text in shown
    assert (folder.parent / 'copy.json').read_bytes() == (folder / 'paper.json').read_bytes()


@pytest.mark.parametrize('arguments', [
    ['--seeds', '0'], ['--seeds', '-3'], ['-o', 'FILE'], ['-o', 'FILE/below']], ids=' '.join)
def test_bad_input_gets_one_line_before_any_work(arguments, tmp_path, capsys):
    file = tmp_path / 'file'
    file.write_text('')
    assert main(['paper', *(word.replace('FILE', str(file)) for word in arguments)]) == 2
    said = capsys.readouterr().err.strip()
    assert said.startswith('quad_ident paper: error: ') and '\n' not in said
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.slow
def test_failures_and_exact_fits_have_a_place_in_the_picture(tmp_path):
    path = tmp_path / 'spread.png'
    save_spread({'some': {'pso': np.array([1.0, np.inf, 0.0]), 'ls': np.array([0.0])},
                 'none': {'pso': np.full(3, np.inf), 'ls': np.array([np.inf])}}, path, 'x', 'y')
    assert path.read_bytes().startswith(b'\x89PNG')


def test_text_is_escaped_and_markup_is_not():
    assert tag('td', 'a < b & c') == '<td>a &lt; b &amp; c</td>'
    assert markup(Markup('<b>x</b>')) == '<b>x</b>'
    page = Page(table(['<x>', 'y'], [['"1"', Markup('<td class="no">2</td>')], ['', '3']],
                      caption='a > b'))
    assert page.text[0] == 'a > b' and '<x>' in page.text and '"1"' in page.text
