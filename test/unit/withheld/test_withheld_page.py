# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What several runs of the withheld check reached together, from their pages."""

import pytest

from withheld.goals import GOALS, goals, LIMITS, met, target
from withheld.page import calibration, share, together, with_tables

GOAL_HEAD = '| goal | column | reached | target |  |\n| --- | --- | --- | --- | --- |\n'
BIN_HEAD = ('| probability: mean given / present (count) | all | forms as ours | logs |\n'
            '| --- | --- | --- | --- |\n')
SINGLE = 'exact set, single'
MIDDLE = 'calibration error over 0.05 to 0.95'


def page(*reached, bins=()):
    """Return the text of a run with rows (goal, column, figure) and of (bin, ours, logs)."""
    rows = ''.join(f'| {goal} | {column} | {figure} | - | - |\n'
                   for goal, column, figure in reached)
    text = f'# 2026-01-01, version 0.1.0 (abc): 9 cases, seed 7\n\n{GOAL_HEAD}{rows}'
    return text + (f'\n{BIN_HEAD}' + ''.join(
        f'| {name} | 0.999 / 0.001 (999) | {ours} | {logs} |\n' for name, ours, logs in bins)
        if bins else '')


def rows_of(table):
    """Return {(goal, column): (together, target, met)} of the first table."""
    first = table.partition('\n\n')[0]
    cells = [[cell.strip() for cell in line.split('|')[1:-1]] for line in first.splitlines()[2:]]
    return {(what, column): tuple(rest) for what, column, *rest in cells}


def test_shares_are_counted_in_whole_cases():
    # 2 of 3, 5 of 6 and 0 of 1: 7 of 10. The rounded percentages make 7.0 of 2.01 + 4.98.
    assert share(['67 % of 3', '83 % of 6', '0 % of 1']) == (0.7, 10)
    # 1 of 3 five times is 5 of 15, and not 4.95.
    assert share(['33 % of 3'] * 5) == (5 / 15, 15)


def test_figures_without_a_count_are_not_counted():
    assert share(['-', '100 %', '0.07 of 12', '', '50 % of 2']) == (0.5, 2)
    assert share(['-']) == (0.0, 0)


@pytest.mark.parametrize('count', [1, 3, 7, 20, 45, 100])
def test_whole_cases_are_what_the_percentage_was_of(count):
    for right in range(count + 1):
        assert share([f'{100 * right / count:.0f} % of {count}']) == (right / count, count)


def test_goals_are_counted_together_and_held_to_their_targets():
    runs = [page((SINGLE, 'forms as ours', '100 % of 30'), (SINGLE, 'logs', '88 % of 8'),
                 ('exact set, pairs', 'logs', '-')),
            page((SINGLE, 'forms as ours', '93 % of 30'), (SINGLE, 'logs', '86 % of 7'),
                 ('exact set, pairs', 'logs', '-'))]
    assert rows_of(together(runs)) == {
        (SINGLE, 'forms as ours'): ('96.7 % of 60', '≥ 97 %', '**missed**'),    # 58
        (SINGLE, 'logs'): ('86.7 % of 15', '≥ 88 %', '**missed**')}             # 7 + 6
    assert rows_of(together(runs[:1])) == {
        (SINGLE, 'forms as ours'): ('100 % of 30', '≥ 97 %', 'met'),
        (SINGLE, 'logs'): ('87.5 % of 8', '≥ 88 %', '**missed**')}              # 7, not 88 %


def test_a_target_between_two_limits_and_none():
    kept = 'coverage of 95 % intervals'
    table = rows_of(together([page(
        (kept, 'forms as ours', '96 % of 25'), (kept, 'logs', '100 % of 6'),
        ('refused', 'forms as ours', '0 % of 9'),
        ('the change named, and nothing else', 'real flights, changed', '33 % of 3'))]))
    assert table == {
        (kept, 'forms as ours'): ('96 % of 25', '93 to 97 %', 'met'),
        (kept, 'logs'): ('100 % of 6', '85 to 99 %', '**missed**'),
        ('refused', 'forms as ours'): ('0 % of 9', '-', '-'),
        ('the change named, and nothing else', 'real flights, changed'):
            ('33.3 % of 3', '-', '-')}


def test_the_gap_closed_and_goals_of_other_names_are_left_out():
    table = rows_of(together([page(
        ('share of the gap closed, median', 'logs', '100 %'),
        ('an older goal', 'logs', '50 % of 2'), (SINGLE, 'an older column', '50 % of 2'),
        (SINGLE, 'logs', '100 % of 1'))]))
    assert list(table) == [(SINGLE, 'logs')]


def test_the_last_five_runs_with_a_table_of_goals_count():
    first = page((SINGLE, 'logs', '0 % of 4'))
    rest = [page((SINGLE, 'logs', '100 % of 1')) for _ in range(5)]
    without = ('# 2026-01-01, version 0.1.0: 9 cases\n\n'
               '| what | target |\n| --- | --- |\n| a | 1 |\n')
    figure = rows_of(together([first, without, *rest[:2], without, *rest[2:]]))[SINGLE, 'logs']
    assert figure[0] == '100 % of 5'
    figure = rows_of(together([first, *rest[:4]]))[SINGLE, 'logs']
    assert figure[0] == '50 % of 8'


BINS = ([('0 to 0.05', '0.010 / 0.900 (500)', '-'),
         ('0.05 to 0.2', '0.100 / 0.500 (10)', '-'),
         ('0.8 to 0.95', '0.900 / 0.800 (5)', '0.900 / 0.500 (2)'),
         ('0.95 to 1', '0.990 / 0.100 (500)', '-'),
         ('error, 0.05 to 0.95', '0.300 (15)', '0.400 (2)')],
        [('0.05 to 0.2', '0.200 / 0.000 (30)', '-'),
         ('0.8 to 0.95', '0.900 / 1.000 (5)', '-'),
         ('0.95 to 1', '0.990 / 0.100 (500)', '-')])


def test_probabilities_are_held_against_what_is_there_in_each_bin_of_all_runs():
    runs = [page((MIDDLE, 'logs', '0.40 of 2'), bins=some) for some in BINS]
    # 0.05 to 0.2: given (1 + 6) / 40, present 5 / 40, a difference of 0.05; 0.8 to 0.95: 0.9 of 10
    # given, 9 present. (40 * 0.05 + 10 * 0) / 50.
    error, count = calibration(runs, 'forms as ours')
    assert count == 50 and error == pytest.approx(0.04)
    error, count = calibration(runs, 'logs')
    assert count == 2 and error == pytest.approx(0.4)
    assert calibration(runs, 'faulty records') == (0.0, 0)
    assert rows_of(together(runs)) == {
        (MIDDLE, 'forms as ours'): ('0.040 of 50', '≤ 0.1', 'met'),
        (MIDDLE, 'logs'): ('0.400 of 2', '≤ 0.15', '**missed**')}
    probabilities = together(runs).partition('\n\n')[2].splitlines()
    head = '| probability: mean given / present (count) | forms as ours | logs |'
    assert probabilities[0] == head
    assert probabilities[3] == '| 0.05 to 0.2 | 0.175 / 0.125 (40) | - |'
    assert probabilities[-1] == '| 0.95 to 1 | 0.990 / 0.100 (1000) | - |'


def test_a_run_alone_has_the_calibration_error_of_its_page():
    error, count = calibration([page(bins=BINS[0])], 'forms as ours')
    assert count == 15 and error == pytest.approx((10 * 0.4 + 5 * 0.1) / 15)


def test_a_run_without_a_reliability_table_adds_nothing():
    runs = [page((SINGLE, 'logs', '100 % of 1')), page(bins=BINS[1])]
    assert calibration(runs, 'forms as ours') == calibration(runs[1:], 'forms as ours')


def test_every_goal_of_every_column_has_its_limits():
    columns = {name: {'coverage': {}, 'calibration': None, 'closed': None,
                      'instead': {'rate': None, 'count': 0}, 'refused': {'rate': 0.0, 'count': 1}}
               for name in GOALS}
    hybrid = {'right': True, 'refused': False, 'text': 'changed'}
    rows = goals({'columns': columns, 'groups': {}, 'cases': [], 'hybrids': [hybrid]})
    assert [(row.what, row.column) for row in rows] == list(LIMITS)
    assert all(row.target == target(row.what, row.column) for row in rows)


def test_limits_count_as_met():
    assert met(SINGLE, 'ours', 0.97) and not met(SINGLE, 'ours', 0.96)
    assert met('coverage of 95 % intervals', 'ours', 0.97)
    assert not met('coverage of 95 % intervals', 'ours', 0.98)
    assert met('refused', 'ours', 1.0) is None


def test_tables_stand_between_their_marks_and_nothing_else_changes(tmp_path):
    document = tmp_path / 'withheld.md'
    latest = page((SINGLE, 'logs', '100 % of 1')).replace('# 2026', '### 2026')
    document.write_text(
        'Before.\n<!-- trend -->\nold\n<!-- end of trend -->\nBetween.\n<!-- together -->\nold\n'
        f'<!-- end of together -->\nAfter.\n\n## Latest run\n\n{latest}', encoding='utf-8')
    (tmp_path / 'withheld').mkdir()
    (tmp_path / 'withheld' / 'run_01.md').write_text(page((SINGLE, 'logs', '0 % of 1')),
                                                     encoding='utf-8')
    text = with_tables(document)
    assert 'old' not in text and text.startswith('Before.\n<!-- trend -->\n\n| version |')
    assert '\n<!-- end of trend -->\nBetween.\n<!-- together -->\n\n| goal |' in text
    assert '| logs | 50 % of 2 | ≥ 88 % | **missed** |\n\n<!-- end of together' in text
    assert text.endswith(f'<!-- end of together -->\nAfter.\n\n## Latest run\n\n{latest}')
    document.write_text(text, encoding='utf-8')
    assert with_tables(document) == text


def test_the_trend_and_the_last_runs_together_are_what_the_pages_give():
    from withheld.__main__ import DOCUMENT
    assert with_tables(DOCUMENT) == DOCUMENT.read_text(encoding='utf-8')
