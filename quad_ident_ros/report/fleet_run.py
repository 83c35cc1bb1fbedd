# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A run over a fleet as it goes on: a line that a person follows, lines of JSON for a machine."""

from contextlib import suppress
from importlib.util import find_spec
import json
from pathlib import Path
import sys
from time import monotonic
from types import TracebackType
from typing import Any

from rich.progress import TaskID

from quad_ident_ros.data.counted import counted
from quad_ident_ros.fleet.insight import Insight
from quad_ident_ros.fleet.run import Progress, Summary
from quad_ident_ros.fleet.work import REFUSED
from quad_ident_ros.report.data import finite
from quad_ident_ros.report.screen import progress_bar
from quad_ident_ros.whole_file import Lines

OFTEN = 0.2     # s between two changes of the line, and
RARELY = 30.0   # between two lines where standard error is no terminal
REASONS = 3     # of refused flights that are said; all are in the data set
UNITS = {'reading': 'flights', 'comparing': 'parameters of vehicles'}
"""What a stage of a run counts, if not groups."""


class Reporter:
    """
    Says how far a run is, on standard error and as lines of JSON; to be used in a `with`.

    Args: client of Dask; out: the data set; json: file, - for standard output, or None. The file
    takes the place of an older one when the run ends or is interrupted, not where it fails.
    """

    def __init__(self, client: Any, out: str | Path, json: str | Path | None) -> None:
        self._client, self._out, self._path = client, out, json
        self._bar = progress_bar()
        self._lines: Lines | None = None
        self._stage: str | None = None
        self._task: TaskID | None = None
        self._begun = self._said = 0.0
        self._refused = 0

    def __enter__(self) -> 'Reporter':
        """Name the data set, the workers and the dashboard."""
        if self._path and self._path != '-':
            self._lines = Lines(self._path)
        self._note(f'data set: {self._out}; {workers(self._client)}')
        link = dashboard(self._client)
        if link:
            self._note(link)
        self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        """Take the line away and end the file."""
        self._bar.stop()
        if self._lines is not None:
            if kind in (None, KeyboardInterrupt):
                self._lines.keep()
            else:
                self._lines.drop()

    def tell(self, progress: Progress) -> None:
        """Say how far the run is."""
        if progress.stage != self._stage:
            self._stage, self._begun = progress.stage, monotonic()
            if self._task is not None:
                self._bar.remove_task(self._task)
            self._task = self._bar.add_task('', total=max(progress.total, 1))
        if progress.last:
            group, outcome = progress.last
            if outcome.status == REFUSED:
                self._refused += 1
                if self._refused <= REASONS:
                    self._note(f'refused: {outcome.reason}')
            self._write({
                'group': group.key, 'vehicle': group.vehicle,
                'configuration': group.configuration, 'date': group.date.isoformat(),
                'status': outcome.status, 'reason': outcome.reason, 'seconds': outcome.seconds,
                'done': progress.done, 'total': progress.total, 'refused': progress.refused,
                'failed': progress.failed, 'seconds_left': self._left(progress)})
        if monotonic() - self._said < (RARELY if self._bar.disable else OFTEN):
            return
        self._said = monotonic()
        text = line(progress, monotonic() - self._begun)
        if not self._client.ncores():
            text += '; waiting for a worker to join'
        assert self._task is not None
        self._bar.update(self._task, description=text, completed=progress.done)
        if self._bar.disable:
            self._note(text)

    def end(self, summary: Summary) -> None:
        """Say what the run has come to."""
        self._bar.stop()
        if self._refused > REASONS:
            self._note(f'refused: {self._refused - REASONS} more; the column reason of '
                       f'{self._out}/flights says why')
        groups = summary.groups
        self._write({'schema': 'quad_ident/fleet_run/1', 'out': str(self._out),
                     'flights': summary.flights, 'groups': groups, 'before': summary.before,
                     'copies': list(summary.copies), 'untracked': list(summary.untracked),
                     'replaced': summary.replaced, 'gave_way': list(summary.gave_way),
                     'kept': list(summary.kept), 'removed': list(summary.removed),
                     'stayed': list(summary.stayed), 'undated': list(summary.undated),
                     'together': list(summary.together)})
        if self._path != '-':
            sys.stdout.write(summary_text(summary, self._out))

    def tell_insight(self, found: Insight) -> None:
        """Write an Insight as a line of JSON."""
        self._write(found.as_data())

    def _left(self, progress: Progress) -> float | None:
        return seconds_left(progress, monotonic() - self._begun)

    def _write(self, data: object) -> None:
        if self._path:
            text = json.dumps(finite(data), allow_nan=False)
            if self._lines is None:
                print(text, flush=True)
            else:
                self._lines.write(text)

    def _note(self, text: str) -> None:
        print(text, file=sys.stderr)


def line(progress: Progress, seconds: float) -> str:
    """Return how far a Progress is after so many seconds of its stage, in one line."""
    what = UNITS.get(progress.stage, 'groups')
    new = progress.done - progress.here
    parts = [f'{progress.stage}: {progress.done} of {progress.total} {what}']
    if new and seconds > 0.0:
        rate = 60.0 * new / seconds
        parts.append(f'{rate:{".3g" if rate < 999.5 else ".0f"}} per minute')
    left = seconds_left(progress, seconds)
    if left is not None:
        parts.append(f'{_span(left)} left')
    parts += [f'{count} {name}' for name, count in (
        ('refused', progress.refused), ('failed', progress.failed)) if count]
    return ', '.join(parts)


def seconds_left(progress: Progress, seconds: float) -> float | None:
    """Return the time (s) that a stage still takes at its rate until now, None where unknown."""
    new = progress.done - progress.here
    return seconds * (progress.total - progress.done) / new if new else None


def summary_text(summary: Summary, out: str | Path) -> str:
    """Return what a run has come to, as lines."""
    groups = summary.groups
    lines = [f'{counted(summary.flights, "flight")} in {counted(sum(groups.values()), "group")}: '
             + ', '.join(f'{count} {said}' for said, count in (
                 ('diagnosed', groups['diagnosed']), ('refused', groups['refused']),
                 ('failed', groups['failed']), ('beyond the time limit', groups['timeout']))
                 if count or said == 'diagnosed')
             + (f' ({summary.before} of them before)' if summary.before else '')]
    if summary.copies:
        lines.append(f'{counted(len(summary.copies), "file")} left out, whose content is that of '
                     f'another: {", ".join(summary.copies[:3])}'
                     + (' ...' if len(summary.copies) > 3 else ''))
    if summary.kept:
        count = len(summary.kept)
        lines.append(f'{counted(count, "group")} not counted: '
                     f'{"its result stays" if count == 1 else "their results stay"}, but flights '
                     f'cannot be read any more: {", ".join(summary.kept[:3])}'
                     + (' ...' if count > 3 else '') + '; bring them back, or no longer name them')
    if summary.removed:
        lines.append(f'{counted(len(summary.removed), "flight")} removed from the data set: '
                     f'{"; ".join(summary.removed[:3])}'
                     + (' ...' if len(summary.removed) > 3 else '')
                     + '; to keep a flight, give its file a name of its own and leave it there')
    if summary.together:
        lines.append('taken for flights of one vehicle, by the names of folders: '
                     + '; '.join(summary.together[:3])
                     + (' ...' if len(summary.together) > 3 else '')
                     + '; if they are of several, name the folder that the folders of the '
                     'vehicles are in, or a manifest with a column vehicle')
    if summary.undated:
        lines.append(f'{counted(len(summary.undated), "flight")} without a date in manifest, log '
                     'or name, dated by the last change of the file, which a copy may not keep: '
                     f'{", ".join(summary.undated[:3])}'
                     + (' ...' if len(summary.undated) > 3 else '')
                     + '; write dates into a manifest or into the names')
    if summary.replaced:
        lines.append(f'{counted(summary.replaced, "group")} not counted: another run has put the '
                     'flights into groups of its own meanwhile')
    if summary.gave_way:
        lines.append(f'{counted(len(summary.gave_way), "group")} without a result: '
                     + '; '.join(summary.gave_way))
    if summary.untracked:
        lines.append(f'{counted(len(summary.untracked), "group")} without values of single '
                     f'flights: {summary.untracked[0]}; the same command tries again')
    if summary.stayed:
        count = len(summary.stayed)
        lines.append(f'{counted(count, "group")} failed, and the older results of '
                     f'{"its" if count == 1 else "their"} flights stay until there are new ones: '
                     f'{"; ".join(summary.stayed[:3])}' + (' ...' if count > 3 else ''))
    if summary.nothing_diagnosed:
        lines.append(f'no flight could be diagnosed; the column reason of {out}/flights says what '
                     'is wrong with each of those refused: mend them, or name other flights')
    if failed := groups['failed'] + groups['timeout']:
        lines.append('the same command tries again what failed'
                     + (f'; the reasons are in the column reason of {out}/groups'
                        if failed > len(summary.stayed) else ''))
    return '\n'.join(lines) + '\n'


def workers(client: Any) -> str:
    """Return how many workers a client has, and what memory each may have, in words."""
    found = client.scheduler_info(n_workers=-1)['workers'].values()
    if not found:
        return 'waiting for a worker to join'
    memory = min(one['memory_limit'] for one in found)
    bound = (f', each up to {memory / 1e9:.3g} GB of memory' if memory else
             '; memory is not bounded: start each with `dask worker --memory-limit 2GB`')
    return f'{counted(len(found), "worker")}{bound}'


def dashboard(client: Any) -> str:
    """Return where the dashboard of Dask is, in words, where there is one."""
    link = drawn = None
    with suppress(Exception):       # a scheduler may have none, and needs bokeh to draw it
        link = client.dashboard_link
        drawn = client.run_on_scheduler(find_spec, 'bokeh')
    return f"Dask's dashboard: {link}" if link and drawn else ''


def _span(seconds: float) -> str:
    hours, rest = divmod(round(seconds), 3600)
    return f'{hours} h {rest // 60} min' if hours else (
        f'{rest // 60} min {rest % 60} s' if rest >= 60 else f'{rest} s')
