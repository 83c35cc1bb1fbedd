# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""docs/withheld.md with the latest run and the trend; older runs are in files beside it."""

import datetime
from pathlib import Path
import re

from withheld.table import markdown

LATEST = '\n## Latest run\n'
BEGIN, END = '<!-- trend -->\n', '<!-- end of trend -->'

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
        (folder / f'run_{number:02d}.md').write_text(apart(before), encoding='utf-8')
    head = (f'### {day}, version {result["version"]}: {result["count"]} cases, '
            f'seed {result["seed"]}')
    document.write_text(f'{page}{LATEST}\n{head}\n\n{markdown(result)}\n', encoding='utf-8')
    document.write_text(with_trend(document), encoding='utf-8')


def apart(run: str) -> str:
    """Return the section of a run as a page of its own, one folder deeper."""
    run = re.sub(r'^###', '##', run.strip(), flags=re.M).replace('## ', '# ', 1)
    return re.sub(r'\]\((?!https?:|#)', '](../', run) + '\n'


def with_trend(document: Path) -> str:
    """Return the text of the document with the trend of all runs that have a table of goals."""
    text = document.read_text(encoding='utf-8')
    runs = {f'{document.stem}/{path.name}': path.read_text(encoding='utf-8')
            for path in sorted(document.with_suffix('').glob('run_*.md'))}
    rows = [row for link, run in (runs | {'#latest-run': text.partition(LATEST)[2]}).items()
            if (row := trend_row(link, run))]
    head = ['version', 'date', 'cases', *SHOWN.values()]
    rule = ['---', '---', *['--:'] * (len(head) - 2)]
    table = '\n'.join(f'| {" | ".join(cells)} |' for cells in (head, rule, *rows))
    before, _, rest = text.partition(BEGIN)
    return f'{before}{BEGIN}\n{table}\n\n{END}{rest.partition(END)[2]}'


def trend_row(link: str, run: str) -> list[str] | None:
    """Return the cells of a run in the trend, or None where it has no table of goals."""
    reached = {(goal, column): figure for goal, column, figure in
               re.findall(r'^\| ([^|]+) \| ([^|]+) \| ([^|]+) \|', run, re.M)}
    title = re.search(r'^#+ ([\d-]+), version ([\d.]+)(?: \((\w+)\))?: (\d+) cases', run, re.M)
    if title is None or not any(key in reached for key in SHOWN):
        return None
    day, version, commit, count = title.groups()
    return [f'[{commit or version}]({link})', day, count,
            *(reached.get(key, '-').replace('-', '–') for key in SHOWN)]
