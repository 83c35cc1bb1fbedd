# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A run over the flights of a fleet: look at them, diagnose their groups, track their values."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
import json
from pathlib import Path
import random
from typing import Any

from quad_ident_ros.cluster import results, TimeOver, WorkerDied
from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.grouping import date_said, Group, groups_of, taken_together
from quad_ident_ros.fleet.look import look, Looked, Looks, without_content
from quad_ident_ros.fleet.manifest import ABOUT, Listed
from quad_ident_ros.fleet.plan import Plan
from quad_ident_ros.fleet.store import keys_of, missing, prepare, read_table
from quad_ident_ros.fleet.superseded import (
    follow_files,
    give_way,
    gone_with,
    out_of_reach,
    remove_group,
    remove_trackings,
    replaced_in,
    staying,
    superseded_by,
)
from quad_ident_ros.fleet.track import track, tracked_effects, Tracking
from quad_ident_ros.fleet.work import (
    DIAGNOSED,
    DONE,
    FAILED,
    one_line,
    Outcome,
    outcome_of,
    REFUSED,
    TIMEOUT,
    work,
    write,
)
from quad_ident_ros.whole_file import write_whole

AT_ONCE = 16    # flights that a task looks at: each is a matter of milliseconds
TIME_LIMIT = 1800.0     # s of a group: a hundred times the usual one on a slow core
SHOWN_AFTER = 90.0      # s; NFS shows an old list of a folder for up to 60 (acdirmax, nfs(5))
LOOKING, DIAGNOSING, TRACKING, COMPARING = 'reading', 'diagnosing', 'tracking', 'comparing'


@dataclass(frozen=True)
class Progress:
    """
    How far a run is.

    stage: of LOOKING (done and total are flights), DIAGNOSING, TRACKING (groups), COMPARING
    (parameters of vehicles); here: done of these before the run; refused, failed: groups of the
    run that were not diagnosed, by what is wrong with their flights and for other reasons; last:
    what has just been done.
    """

    stage: str
    total: int
    done: int = 0
    here: int = 0
    refused: int = 0
    failed: int = 0
    last: tuple[Group, Outcome] | None = None

    def after(self, group: Group, outcome: Outcome) -> 'Progress':
        """Return the Progress once a group is done."""
        return replace(self, done=self.done + 1, last=(group, outcome),
                       refused=self.refused + (outcome.status == REFUSED),
                       failed=self.failed + (outcome.status in (FAILED, TIMEOUT)))


@dataclass(frozen=True)
class Summary:
    """
    What a run has come to: flights, {status: groups}, and paths of copies of flights.

    before: groups that were done; untracked: reasons of the groups to whose single flights nothing
    could be fitted, which the next run tries again; replaced: groups whose flights another run has
    put into groups of its own; gave_way: why groups of this run have no result, because one of
    another run has some of their flights; kept: for each group whose results stay as they were, a
    flight of it that cannot be read any more; removed: flights that are in the data set no longer,
    each with the reason; stayed: why groups failed whose older results stay, for each one;
    undated: paths of flights that are dated by the last change of their files; together: folders
    whose flights are taken for those of one vehicle by their names alone.
    """

    flights: int
    groups: dict[str, int]
    before: int
    copies: tuple[str, ...]
    untracked: tuple[str, ...] = ()
    replaced: int = 0
    gave_way: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()
    stayed: tuple[str, ...] = ()
    undated: tuple[str, ...] = ()
    together: tuple[str, ...] = ()

    @property
    def nothing_diagnosed(self) -> bool:
        """
        Return whether the flights have no diagnosis, old or new, because all were refused.

        Results that stay without their flights, in place of groups that failed, or in groups of
        another run, are not counted as diagnosed and may be diagnoses.
        """
        return bool(self.groups[REFUSED] and not self.groups[DIAGNOSED] and not self.kept
                    and not self.replaced and not self.gave_way and not self.stayed)


Tell = Callable[[Progress], None]


class _Account:
    """The Progress of a stage, and who follows it."""

    def __init__(self, tell: Tell, progress: Progress) -> None:
        self.progress, self._tell = progress, tell

    def tick(self) -> None:
        """Tell how far it is, though nothing is new."""
        self._tell(replace(self.progress, last=None))

    def count(self, failed: int = 0) -> None:
        """Count one more as done, or as failed."""
        self.progress = replace(self.progress, done=self.progress.done + 1,
                                failed=self.progress.failed + failed)
        self._tell(self.progress)

    def count_group(self, group: Group, outcome: Outcome) -> None:
        """Count a group by its Outcome."""
        self.progress = self.progress.after(group, outcome)
        self._tell(self.progress)


def run_fleet(client: Any, plan: Plan, out: str | Path, *, time_limit: float = TIME_LIMIT,
              tell: Tell = lambda progress: None) -> Summary:
    """
    Diagnose the flights of a Plan, on a Dask client, into the data set `out`.

    Finished groups are not done again; failed ones are. Args: time_limit: s of a
    group; tell is called with the Progress, a few times per second. Raises InputError, and OSError
    where nothing can be written.
    """
    out = Path(out).absolute()      # workers are started in folders of their own
    prepare(out)
    write_whole(out / ABOUT, json.dumps(plan.origin, indent=2) + '\n')
    looked = _looked(client, plan.flights, plan.mapping, out, time_limit, tell)
    groups, copies = groups_of(zip(plan.flights, looked, strict=True), plan.nominal_of,
                               plan.mapping, plan.rules)
    kept = out_of_reach(groups, out)
    groups = [group for group in groups if group.key not in kept]
    older = superseded_by(groups, out)
    going = gone_with(older, groups, out)
    before, went, failed = _diagnose_all(client, groups, out, older, time_limit, tell)
    if before:
        follow_files(groups, out)
    replaced = _check_written([group for group in groups if group.key not in {*went, *failed}],
                              out)
    untracked = _track_all(client, groups, out, time_limit, tell)
    status = _statuses(out)
    tried = {key: outcome.status for key, (_, outcome) in failed.items()} | status
    ended = [tried.get(group.key) for group in groups]
    removed = {path: why for key, flights in going.items() if key not in status
               for path, why in flights.items()}
    return Summary(sum(len(group.flights) for group in groups),
                   {name: ended.count(name) for name in (DIAGNOSED, REFUSED, FAILED, TIMEOUT)},
                   before, tuple(one.path for one in copies), untracked, len(replaced),
                   tuple(went.values()), tuple(kept.values()),
                   tuple(f'{path} {why}' for path, why in removed.items()),
                   tuple(f'{group.vehicle}, {group.date.date()}: {outcome.reason}'
                         for key, (group, outcome) in failed.items()
                         if status.get(key) not in DONE),
                   tuple(one.path for one, seen in zip(plan.flights, looked, strict=True)
                         if not seen.reason and date_said(one, seen) is None),
                   taken_together(zip(plan.flights, looked, strict=True)))


def _looked(client: Any, flights: Sequence[Listed], mapping: Mapping | None, out: str | Path,
            time_limit: float, tell: Tell) -> list[Looked]:
    """Return the entries of flights, in their order; those seen before are not read again."""
    looks = Looks(out)
    known = [looks.known(one) for one in flights]
    new = [number for number, one in enumerate(known) if one is None]
    before = len(flights) - len(new)
    account = _Account(tell, Progress(LOOKING, len(flights), before, before))
    found: dict[int, Looked] = {}
    alone: list[list[int]] = []
    some = [new[k:k + AT_ONCE] for k in range(0, len(new), AT_ONCE)]
    # Where one of several ends the worker or takes too long, each is looked at by itself.
    for numbers in (some, alone):
        items = (tuple((number, flights[number]) for number in each) for each in numbers)
        for done in results(client, partial(_look, mapping), items, time_limit, account.tick):
            rows: list[tuple[int, Looked]] = done.value
            if done.error is not None:
                reason = _reason(done.error, time_limit)
                if numbers is some:
                    alone += [[number] for number, _ in done.item]
                    continue
                rows = [(number, without_content(one, reason)) for number, one in done.item]
            for number, seen in rows:
                found[number] = seen
                if done.error is None:
                    looks.add(seen)
                account.count()
    looks.flush()
    return [found[number] if one is None else one for number, one in enumerate(known)]


def _look(mapping: Mapping | None, some: Iterable[tuple[int, Listed]]
          ) -> list[tuple[int, Looked]]:
    return [(number, look(one, mapping)) for number, one in some]


def _diagnose_all(client: Any, groups: Sequence[Group], out: str | Path,
                  replaced: dict[str, list[str]], time_limit: float, tell: Tell
                  ) -> tuple[int, dict[str, str], dict[str, tuple[Group, Outcome]]]:
    """
    Diagnose the groups that are not done; each takes the place of those of `replaced`.

    Returns how many were, why some gave way to those of another run, {key: why}, and which
    failed and left older results in their place, {key: (group, outcome)}.
    """
    status = _statuses(out)
    done_before = {key for key, one in status.items() if one in DONE}
    older = staying(replaced, groups, out, done_before)
    todo = [replace(group, older=older.get(group.key, ())) for group in groups
            if group.key not in done_before]
    before = len(groups) - len(todo)
    _remove_replaced(out, replaced, status)
    # Each run in an order of its own: two on one data set seldom do the same group at once.
    random.shuffle(todo)
    account = _Account(tell, Progress(DIAGNOSING, len(groups), before, before))
    ended = {group.key: status.get(group.key, '') for group in groups}
    failed: dict[str, tuple[Group, Outcome]] = {}
    for done in results(client, partial(_work, out), todo, time_limit, account.tick):
        group = done.item
        outcome = done.value
        if done.error is not None:
            outcome = outcome_of(group, out) or Outcome(
                TIMEOUT if isinstance(done.error, TimeOver) else FAILED,
                _reason(done.error, time_limit),
                time_limit if isinstance(done.error, TimeOver) else None)
            if outcome.status not in DONE:
                write(group, out, outcome)
        if outcome.status not in DONE and group.older:
            failed[group.key] = group, outcome
        for key in set(replaced.get(group.key, ())).difference(
                () if outcome.status in DONE else group.older):
            remove_group(out, key)
        ended[group.key] = outcome.status
        account.count_group(group, outcome)
    if not todo:
        return before, {}, {}
    # A run beside this one may have ended with some of these flights meanwhile, and a worker with
    # a group just after its time. What this run has done is known, though a list of the files may
    # not show it yet.
    now_done = {key for some in (_statuses(out), ended) for key, one in some.items()
                if one in DONE}
    return before, give_way(groups, out, now_done), failed


def _check_written(groups: Sequence[Group], out: Path) -> set[str]:
    """
    Return the keys of groups that a run beside this one has replaced.

    Raises InputError where results of other groups that are done are not in the data set.
    """
    wanted = {group.key for group in groups}
    replaced = replaced_in(groups, out) if missing(out, 'groups', wanted, 0.0) else set()
    if lost := missing(out, 'groups', wanted - replaced, SHOWN_AFTER):
        raise InputError(f'{out}: the results of {counted(len(lost), "group")} are not in it, but '
                         'where the workers see this path; name a folder that they share with '
                         'this machine')
    return replaced


def _work(out: str | Path, group: Group) -> Outcome:
    return work(group, out)


def _remove_replaced(out: str | Path, replaced: dict[str, list[str]], status: dict[str, str]
                     ) -> None:
    """Remove what groups take the place of, where they are done."""
    for key, others in replaced.items():
        if status.get(key) in DONE:
            for other in others:
                remove_group(out, other)


def _track_all(client: Any, groups: Sequence[Group], out: str | Path, time_limit: float,
               tell: Tell) -> tuple[str, ...]:
    """Fit the effects of each vehicle to its flights; return why groups failed, for each one."""
    effects = tracked_effects(read_table(
        out, 'effects', ['group', 'vehicle', 'effect', 'form', 'named']))
    status = _statuses(out)
    wanted = [Tracking(group, effects[group.vehicle]) for group in groups
              if status.get(group.key) == DIAGNOSED and effects.get(group.vehicle)]
    there = keys_of(out, 'covariances')
    todo = [one for one in wanted if one.key not in there]
    random.shuffle(todo)
    before = len(wanted) - len(todo)
    account = _Account(tell, Progress(TRACKING, len(wanted), before, before))
    reasons, failed = [], set()
    for done in results(client, partial(_track, out), todo, time_limit, account.tick):
        if done.error is not None:
            reasons.append(_reason(done.error, time_limit))
            failed.add(done.item.group.key)     # what earlier runs fitted to its flights stays
        account.count(failed=int(done.error is not None))
    kept = {group.key: '' for group in groups} | {one.group.key: one.key for one in wanted}
    # Of a group that another run has replaced meanwhile nothing stays.
    there = keys_of(out, 'groups')
    kept = {key: new if key in there else '' for key, new in kept.items()}
    remove_trackings(out, {key: new for key, new in kept.items() if key not in failed})
    return tuple(reasons)


def _track(out: str | Path, tracking: Tracking) -> None:
    track(tracking, out)


def _reason(error: Exception, time_limit: float) -> str:
    """
    Return why a task has no result, in words; raises what no other task can escape either.

    That is bad input, such as workers of another version, a disk that is full, a package that is
    missing. Anything else is of the flights of this task, and takes no other with it.
    """
    if isinstance(error, TimeOver):
        return f'it took more than {time_limit:g} s (--time-limit)'
    if isinstance(error, WorkerDied):
        return ('the process of each worker that began it ended: it may need more memory than a '
                'worker has (--memory), or it hung in a library')
    if isinstance(error, (InputError, OSError, ImportError)):
        raise error
    return f'{type(error).__name__}: {one_line(error)}'


def _statuses(out: str | Path) -> dict[str, str]:
    """Return {key of a group: status} of a data set."""
    table = read_table(out, 'groups', ['group', 'status'])
    return dict(zip(table['group'].to_pylist(), table['status'].to_pylist(), strict=True))
