# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Older runs of the benchmarks, in docs/performance/, and the trend in docs/performance.md."""

from collections.abc import Iterator
import contextlib
import re

from benchmarks.tables import DOCUMENTS, markdown, replaced

DOCUMENT = 'performance.md'
TREND = 'trend'     # the markers of the trend in that document


@contextlib.contextmanager
def older_kept(document: str, name: str) -> Iterator[None]:
    """While a section gets a new run: keep the one before, and write the trend again."""
    path = DOCUMENTS / document
    if document == DOCUMENT:
        set_aside(run_of(path.read_text(encoding='utf-8'), name), name)
    yield
    if document == DOCUMENT:
        path.write_text(with_trend(path.read_text(encoding='utf-8')), encoding='utf-8')


def set_aside(run: str, name: str) -> None:
    """Put a run of a section on top of the older ones in its file."""
    path = _older(name)
    head = f'# Older runs: {name}\n\n`./run bench {name}`, the newest first.\n'
    before = path.read_text(encoding='utf-8') if path.exists() else head
    if run and run not in before:
        path.parent.mkdir(exist_ok=True)
        path.write_text(f'{head}\n## {measured(run)}\n\n{run}\n{before.removeprefix(head)}',
                        encoding='utf-8')


def run_of(document: str, name: str) -> str:
    """Return what is between the markers of a section, without blank lines around it."""
    found = re.search(f'<!-- bench: {name} -->\n(.*?)<!-- end: {name} -->', document, re.S)
    return found[1].strip() if found else ''


def measured(run: str) -> str:
    """Return the day and the processor of a run, from the line that says so."""
    found = re.search(r'^Measured: ([\d-]+); ([^,;]*)', run, re.M)
    return f'{found[1]}, {found[2]}' if found else 'day not known'


def with_trend(document: str) -> str:
    """Return the document with a table of each section with older runs: its figures by run."""
    parts = []
    for path in sorted(_older('').parent.glob('*.md')):
        older = re.split(r'^## .*$', path.read_text(encoding='utf-8'), flags=re.M)[1:]
        runs = [*reversed(older), run_of(document, path.stem)]
        figures = [_figures(run) for run in runs]
        table = markdown([f'`{path.stem}`', *(measured(run) for run in runs)],
                         [[what, *(one.get(what, '') for one in figures)] for what in figures[-1]])
        parts.append(f'{table}\n\n[The older runs]({_older("").parent.name}/{path.name}).')
    return replaced(document, TREND, '\n\n'.join(parts))


def _older(name):
    return DOCUMENTS / DOCUMENT.removesuffix('.md') / f'{name}.md'


def _figures(run):
    """Return {what: measured} of a run's table of targets; the rate of a machine is left out."""
    table = run.strip().split('\n\n')[0]
    rows = [[cell.strip() for cell in line.split('|')[1:-1]] for line in table.splitlines()[2:]]
    return {re.sub(r', of \S+ GFLOP/s$', '', row[0]): row[2] for row in rows if len(row) == 4}
