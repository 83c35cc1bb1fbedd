# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Benchmarks keep the run that a new one replaces, and show how the figures went."""

import pytest

from benchmarks import runs, tables
from benchmarks.__main__ import main

ROW = ('| what | target | measured | met |\n| ---- | -----: | -------: | --: |\n'
       '| time | <= 3 s | {} s | {} |\n\nMeasured: {}; Some CPU, 2 cores, one used; Python 3.')


@pytest.fixture
def page(tmp_path, monkeypatch):
    monkeypatch.setattr(runs, 'DOCUMENTS', tmp_path)
    monkeypatch.setattr(tables, 'DOCUMENTS', tmp_path)
    page = tmp_path / 'performance.md'
    page.write_text('# Speed\n\n<!-- bench: p1 -->\n<!-- end: p1 -->\n\n'
                    '<!-- bench: trend -->\n<!-- end: trend -->\n', encoding='utf-8')
    return page


def test_the_page_has_the_latest_run_and_a_file_the_older_ones(page):
    for day, met in ((1, '**no**'), (2, 'yes'), (3, 'yes')):
        with runs.older_kept('performance.md', 'p1'):
            tables.keep('performance.md', 'p1', ROW.format(5 - day, met, f'2026-01-0{day}'))
    text = page.read_text(encoding='utf-8')
    assert 'Measured: 2026-01-03' in text and 'Measured: 2026-01-02' not in text
    older = (page.parent / 'performance' / 'p1.md').read_text(encoding='utf-8')
    assert older.count('# Older runs') == 1
    assert older.index('## 2026-01-02, Some CPU') < older.index('## 2026-01-01, Some CPU')
    [row] = [line for line in text.partition('bench: trend')[2].splitlines() if 'time' in line]
    assert [cell.strip() for cell in row.split('|')[1:-1]] == ['time', '4 s', '3 s', '2 s']


def test_the_help_says_why_no_cluster_is_used(capsys):
    with pytest.raises(SystemExit):
        main(['--help'])
    assert 'There is no --scheduler: most sections measure times of this machine' in ' '.join(
        capsys.readouterr().out.split())


def test_the_first_run_replaces_none(page):
    with runs.older_kept('performance.md', 'p1'):
        tables.keep('performance.md', 'p1', ROW.format(1, 'yes', '2026-01-01'))
    assert not (page.parent / 'performance').exists()


def test_the_trend_has_what_the_runs_measured():
    text = (runs.DOCUMENTS / runs.DOCUMENT).read_text(encoding='utf-8')
    assert runs.with_trend(text) == text
