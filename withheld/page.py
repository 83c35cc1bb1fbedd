# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
docs/withheld.md with the latest run, the trend and the last runs together.

Older runs are in files beside it.
"""

import datetime
from itertools import pairwise
from pathlib import Path
import re

from withheld.goals import CALIBRATION, LIMITS, met, target
from withheld.score import BINS, TITLES
from withheld.table import markdown, MET

LATEST = '\n## Latest run\n'
TREND = '<!-- trend -->\n', '<!-- end of trend -->'
TOGETHER = '<!-- together -->\n', '<!-- end of together -->'
LAST = 5        # runs that are counted together

# Goals and columns of the trend, by the names that the table of goals has, and their titles.
SHOWN = {
    ('exact set, single', 'forms as ours'): 'forms as ours',
    ('exact set, single', 'other forms'): 'other forms',
    ('exact set, single', 'wrong files'): 'wrong files',
    ('exact set, single', 'logs'): 'logs',
    ('exact set, single', 'estimator states'): 'estimator states',
    ('exact set, single', 'faulty records'): 'faulty records',
    ('false alarms on `none`', 'forms as ours'): 'false alarms, forms as ours',
    ('coverage of 95 % intervals', 'forms as ours'): 'coverage, forms as ours',
}


def keep(document: Path, result: dict, day: datetime.date) -> None:
    """
    Put a run into the document as the latest one, and the one before into a file of its own.

    Args: document: docs/withheld.md; result: the score with its version, seed and count.
    """
    text = document.read_text(encoding='utf-8')
    page, _, before = text.partition(LATEST)
    if before.strip():
        folder = document.with_suffix('')
        folder.mkdir(exist_ok=True)
        number = len(list(folder.glob('run_*.md'))) + 1
        (folder / f'run_{number:02d}.md').write_text(apart(before, document.name),
                                                     encoding='utf-8')
    head = (f'### {day}, version {result["version"]}: {result["count"]} cases, '
            f'seed {result["seed"]}')
    document.write_text(f'{page}{LATEST}\n{head}\n\n{markdown(result)}\n', encoding='utf-8')
    document.write_text(with_tables(document), encoding='utf-8')


def apart(run: str, page: str) -> str:
    """Return the section of a run on a page as a page of its own, one folder deeper."""
    run = re.sub(r'^###', '##', run.strip(), flags=re.M).replace('## ', '# ', 1)
    headings = {re.sub(r'[^\w -]', '', heading.lower()).replace(' ', '-')
                for heading in re.findall(r'^#+ (.*)$', run, flags=re.M)}
    run = re.sub(r'\]\((?!https?:|#)', '](../', run)
    return re.sub(r'\]\(#([^)]*)\)', lambda link: link[0] if link[1] in headings
                  else f'](../{page}#{link[1]})', run) + '\n'


def with_tables(document: Path) -> str:
    """Return the text of the document with the tables over several runs as its pages give them."""
    text = document.read_text(encoding='utf-8')
    runs = {f'{document.stem}/{path.name}': path.read_text(encoding='utf-8')
            for path in sorted(document.with_suffix('').glob('run_*.md'))}
    runs['#latest-run'] = text.partition(LATEST)[2]
    text = _between(*TREND, text, trend(runs))
    return _between(*TOGETHER, text, together(list(runs.values())))


def _between(begin: str, end: str, text: str, table: str) -> str:
    """Return a text with a table in place of what is between two marks."""
    before, _, rest = text.partition(begin)
    return f'{before}{begin}\n{table}\n\n{end}{rest.partition(end)[2]}'


def _lines(*rows: list[str]) -> str:
    return '\n'.join(f'| {" | ".join(cells)} |' for cells in rows)


def _table(run: str, first: str) -> list[list[str]]:
    """Return the cells of the table whose head begins with `first`, [] where a run has none."""
    found = re.search(rf'^\| {re.escape(first)} \|.*(\n\|.*)*', run, re.M)
    return [[cell.strip() for cell in line.strip().strip('|').split('|')]
            for line in found[0].splitlines()] if found else []


def _figures(run: str) -> dict[tuple[str, str], str]:
    """Return {(goal, column): what was reached} of a run, {} where it has no table of goals."""
    return {(goal, column): figure for goal, column, figure, *_ in _table(run, 'goal')[2:]}


def trend(runs: dict[str, str]) -> str:
    """Return the table with a row for each run, of {link: text}, that has a table of goals."""
    head = ['version', 'date', 'cases', *SHOWN.values()]
    rule = ['---', '---', *['--:'] * (len(head) - 2)]
    rows = [row for link, run in runs.items() if (row := trend_row(link, run))]
    return _lines(head, rule, *rows)


def trend_row(link: str, run: str) -> list[str] | None:
    """Return the cells of a run in the trend, or None where it has no table of goals."""
    reached = _figures(run)
    title = re.search(r'^#+ ([\d-]+), version ([\d.]+)(?: \((\w+)\))?: (\d+) cases', run, re.M)
    if title is None or not any(key in reached for key in SHOWN):
        return None
    day, version, commit, count = title.groups()
    return [f'[{commit or version}]({link})', day, count,
            *(reached.get(key, '-').replace('-', '–') for key in SHOWN)]


def together(runs: list[str]) -> str:
    """
    Return the tables of what the last runs reached together.

    The first has the goals whose cases can be counted over the pages of runs, and the calibration
    error; the second has the probabilities.
    Args: runs: texts, oldest first; those without a table of goals are passed over.
    """
    last = [run for run in runs if _figures(run)][-LAST:]
    rows = []
    for what, column in LIMITS:
        title = TITLES[column]
        if what == CALIBRATION:
            reached, count = calibration(last, title)
            figure = f'{reached:.3f} of {count}'
        else:
            reached, count = share([_figures(run).get((what, title), '') for run in last])
            figure = f'{100 * reached:.1f}'.removesuffix('.0') + f' % of {count}'
        if count:
            rows.append([what, title, figure, target(what, column) or '-',
                         MET[met(what, column, reached)]])
    goals = _lines(['goal', 'column', 'together', 'target', ''],
                   ['---', '---', '--:', '---', '---'], *rows)
    return '\n\n'.join(filter(None, (goals, _probabilities(last))))


def _probabilities(runs: list[str]) -> str:
    """Return the table of the mean probability given, and the share present; or nothing."""
    columns = {title: reliability(runs, title) for title in TITLES.values()}
    columns = {title: found for title, found in columns.items() if found}
    if not columns:
        return ''
    bins = [f'{low:g} to {high:g}' for low, high in pairwise(BINS)]
    rows = [[name, *(f'{given / count:.3f} / {present / count:.3f} ({count})' if count else '-'
                     for given, present, count in
                     (found.get(name, (0.0, 0.0, 0)) for found in columns.values()))]
            for name in bins]
    return _lines(['probability: mean given / present (count)', *columns],
                  ['---'] * (1 + len(columns)), *rows)


def share(figures: list[str]) -> tuple[float, int]:
    """
    Return (share, count) of figures such as '67 % of 3' together; those of another form are none.

    The pages have rounded percentages. What they were counted from is the nearest whole number:
    exactly up to 100 cases, to about one of 100 beyond.
    """
    parts = [(int(found[1]), int(found[2])) for figure in figures
             if (found := re.fullmatch(r'(\d+) % of (\d+)', figure))]
    count = sum(cases for _, cases in parts)
    return sum(round(percent * cases / 100) for percent, cases in parts) / max(count, 1), count


def calibration(runs: list[str], title: str) -> tuple[float, int]:
    """
    Return (calibration error, count) of the middle of a column over several runs.

    In each bin the means of what was given and of what was present are those over all runs; the
    error is the mean difference between the two, each bin weighted by its count.
    """
    found = reliability(runs, title)
    middle = [found[name] for name in found
              if BINS[1] <= float(name.split()[0]) and float(name.split()[-1]) <= BINS[-2]]
    total = sum(count for *_, count in middle)
    return sum(abs(given - present) for given, present, _ in middle) / max(total, 1), total


def reliability(runs: list[str], title: str) -> dict[str, tuple[float, float, int]]:
    """Return {bin: (sum given, number present, count)} of a column over several runs' tables."""
    sums: dict[str, tuple[float, float, int]] = {}
    for run in runs:
        head, *rows = _table(run, 'probability: mean given / present (count)') or [[]]
        if title not in head:
            continue
        for cells in rows:
            ends = re.fullmatch(r'[\d.]+ to [\d.]+', cells[0])
            found = re.fullmatch(r'([\d.]+) / ([\d.]+) \((\d+)\)', cells[head.index(title)])
            if ends and found:
                count = int(found[3])
                given, present, before = sums.get(cells[0], (0.0, 0.0, 0))
                sums[cells[0]] = (given + count * float(found[1]),
                                  present + count * float(found[2]), before + count)
    return sums
