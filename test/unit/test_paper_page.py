# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident paper`: what it writes and prints."""

from html.parser import HTMLParser
import json

import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.report.html import Markup, markup, table, tag

VOID = ('meta', 'br', 'img')
ARGUMENTS = ['paper', '--seeds', '2', '--preset', 'paper_table3', '--preset', 'hover_single_axis']


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
            if key in ('src', 'href'):
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
    """Return the folder that the command wrote."""
    folder = tmp_path_factory.mktemp('paper')
    assert main([*ARGUMENTS, '-o', str(folder)]) == 0
    return folder


def test_the_page_is_whole_and_needs_nothing_else(written):
    text = (written / 'paper.html').read_text(encoding='utf-8')
    page = Page(text)
    pictures = [value for value in page.references if value.startswith('data:image/png;base64,')]
    assert len(pictures) == 5 and len(list(written.glob('*.png'))) == 5
    links = {value for value in page.references if value.startswith('#')}
    assert links == {f'#{anchor}' for anchor in page.anchors}
    assert len(pictures) + len(links) == len(page.references)
    assert 'url(' not in text and '@import' not in text and '<script' not in text


def test_the_page_shows_all_presets_methods_and_claims(written):
    text = ' '.join(Page((written / 'paper.html').read_text(encoding='utf-8')).text)
    data = json.loads((written / 'paper.json').read_text(encoding='utf-8'))
    for word in ('hover_single_axis', 'paper_table3', 'Table 1', 'Table 2', 'Table 3', 'ITSE',
                 *(method.label for method in METHODS.values()),
                 *(claim['text'] for claim in data['claims']),
                 *(claim['numbers'] for claim in data['claims'])):
        assert word in text, word
    assert list(data['presets']) == ['paper_table3', 'hover_single_axis']


def test_a_second_run_gives_the_same_but_for_times(written, tmp_path, capsys):
    def timeless(value):
        if isinstance(value, dict):
            return {key: timeless(entry) for key, entry in value.items() if key != 'seconds'}
        return [timeless(entry) for entry in value] if isinstance(value, list) else value

    assert main([*ARGUMENTS, '-o', str(tmp_path / 'deep' / 'er'), '--json', '-']) == 0
    again = json.loads(capsys.readouterr().out)
    first = json.loads((written / 'paper.json').read_text(encoding='utf-8'))
    for data in (first, again):
        data['claims'] = [claim for claim in data['claims'] if 'time' not in claim['text']]
    assert timeless(again) == timeless(first)


def test_the_terminal_has_errors_conclusions_and_files(tmp_path, capsys):
    copy = tmp_path / 'copy.json'
    assert main(['paper', '--seeds', '1', '--preset', 'paper_table3', '-o',
                 str(tmp_path / 'out'), '--json', str(copy)]) == 0
    shown = capsys.readouterr().out
    for text in ('NRMSE', 'PSO-CS', 'paper_table3', 'does not hold', '59 of 64', 'paper.html',
                 'took'):
        assert text in shown
    assert copy.read_bytes() == (tmp_path / 'out' / 'paper.json').read_bytes()


@pytest.mark.parametrize('arguments', [
    ['--seeds', '0'], ['--seeds', '-3'], ['-o', 'FILE'], ['-o', 'FILE/below']], ids=' '.join)
def test_bad_input_gets_one_line_before_any_work(arguments, tmp_path, capsys):
    file = tmp_path / 'file'
    file.write_text('')
    assert main(['paper', *(word.replace('FILE', str(file)) for word in arguments)]) == 2
    said = capsys.readouterr().err.strip()
    assert said.startswith('quad_ident paper: error: ') and '\n' not in said
    assert list(tmp_path.iterdir()) == [file]


def test_text_is_escaped_and_markup_is_not():
    assert tag('td', 'a < b & c') == '<td>a &lt; b &amp; c</td>'
    assert markup(Markup('<b>x</b>')) == '<b>x</b>'
    page = Page(table(['<x>', 'y'], [['"1"', Markup('<td class="no">2</td>')], ['', '3']],
                      caption='a > b'))
    assert page.text[0] == 'a > b' and '<x>' in page.text and '"1"' in page.text
