# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The parts of the site that ./run site makes; MkDocs itself checks links and headings."""

from fnmatch import fnmatch
from pathlib import Path
import re

import pytest

from docs.command_line import reference
from docs.offline import loaded
from quad_ident_ros.cli.main import COMMANDS, parser

ROOT = Path(__file__).resolve().parents[3]
PAGE = reference()


@pytest.mark.parametrize('name', COMMANDS)
def test_the_reference_has_every_option_of_every_command(name):
    _, commands = parser([name])
    section = PAGE.partition(f'\n## {name}\n')[2].partition('\n## ')[0]
    wanted = [option for action in commands[name]._actions
              for option in action.option_strings]
    assert wanted or name == 'withheld'     # which hands all arguments on
    assert [option for option in wanted if option not in section] == []
    rows = [line for line in section.splitlines() if line.startswith('|')]
    assert all(len(re.split(r'(?<!\\)\|', row)) == 4 for row in rows)


@pytest.mark.parametrize('html', [
    '<script src="https://cdn.example/a.js"></script>', '<img src="//example.org/a.png">',
    '<link rel="stylesheet" href="https://fonts.example/css">',
    '<link rel="preconnect" href="https://fonts.example">',
    '<p style="background: url(\'https://example.org/a.png\')">'])
def test_what_a_page_loads_from_a_network_is_noticed(html):
    assert len(loaded(f'<html><body>{html}</body></html>')) == 1


@pytest.mark.parametrize('html', [
    '<a href="https://example.org">a link</a>', '<script src="assets/a.js"></script>',
    '<link rel="canonical" href="https://example.org/page">',
    '<img src="data:image/png;base64,">'])
def test_links_and_files_of_the_site_are_not(html):
    assert loaded(html) == []


def test_the_tutorials_call_commands_that_exist():
    pages = sorted((ROOT / 'docs' / 'tutorials').glob('*.md'))
    text = '\n'.join(page.read_text(encoding='utf-8') for page in pages)
    text = re.sub(r' \\\n *', ' ', text.replace('$path', 'circle'))
    calls = re.findall(r'^ {4,}quad_ident (\S+)(.*?)(?:  #.*)?$', text, re.MULTILINE)
    assert {name for name, _ in calls} >= {'fly', 'info', 'diagnose', 'vehicle', 'export'}
    for name, rest in calls:
        parser([name])[0].parse_args([name, *rest.split()])


def test_every_page_is_in_the_navigation_or_older_results_that_one_leads_to():
    docs = ROOT / 'docs'
    pages = {str(path.relative_to(docs)) for path in docs.rglob('*.md')}
    older = {page for folder in ('withheld', 'performance')
             for page in pages if page.startswith(f'{folder}/')}
    settings, _, navigation = (ROOT / 'mkdocs.yml').read_text('utf-8').partition('\nnav:\n')
    named = set(re.findall(r'(\S+\.md)$', navigation, re.M))
    made = {'index.md', 'contributing.md', 'command_line.md', 'tutorials/notebook.md'}
    assert named - made == pages - older - made
    patterns = re.findall(r'^  /(\S+\.md)$', settings, re.M)
    assert all(any(fnmatch(page, pattern) for pattern in patterns) for page in older)
    led_to = {page for folder in ('withheld', 'performance') for page in re.findall(
        rf'\(({folder}/[^)#]+)', (docs / f'{folder}.md').read_text('utf-8'))}
    assert led_to == older


def test_pages_lead_to_files_of_the_repository_in_the_site():
    pytest.importorskip('mkdocs', reason='./run site installs MkDocs, in .venv-site')
    from docs.site import on_page_markdown

    class Page:
        class file:     # noqa: N801
            src_uri = 'withheld/run_01.md'
    text = on_page_markdown('[the score](../../withheld/score.py) [method](../method.md) '
                            '[experiments](../../config/experiments)\n'
                            '```\n[code](../../setup.py)\n```\n', Page)
    assert text == ('[the score](../source/withheld/score.py) [method](../method.md) experiments\n'
                    '```\n[code](../../setup.py)\n```\n')
