# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The diagnosis of one group of flights, in a worker: flights in, rows of the data set out."""

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
import json
import os
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from quad_ident_ros import __version__
from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.quality.fleet import vehicles
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.split import joined
from quad_ident_ros.data.told_apart import renamed
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.result import Diagnosis
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.grouping import Group, Member, rules_hash
from quad_ident_ros.fleet.look import why_missing
from quad_ident_ros.fleet.store import read_rows, write_rows
from quad_ident_ros.memory import give_back
from quad_ident_ros.report.data import finite

DIAGNOSED, REFUSED, FAILED, TIMEOUT = 'diagnosed', 'refused', 'failed', 'timeout'
DONE = DIAGNOSED, REFUSED
"""States of a group that is not tried again: the same flights would give the same."""

FIRST = 1.0     # s of a flight over which its first and last voltage are taken


@dataclass(frozen=True)
class Outcome:
    """
    What came of a group: its status, the reason ('' where it was diagnosed), and s of work.

    Nobody knows the seconds where a worker ended, and they are None.
    """

    status: str
    reason: str
    seconds: float | None


@dataclass(frozen=True, eq=False)
class _Read:
    """A flight of a group: its records, if it could be read, and why it is refused, if it is."""

    member: Member
    records: tuple[FlightRecord, ...]
    reason: str = ''


def work(group: Group, out: str | Path) -> Outcome:
    """
    Diagnose a Group, write its rows into the data set, and return the Outcome.

    One that another run has done meanwhile is not done again. A flight that cannot be diagnosed
    is left out, with its reason. Raises OSError where nothing can be written.
    """
    if group.version != __version__:
        raise InputError(f'the worker has version {__version__} of quad_ident_ros, the command '
                         f'{group.version}; install the same one on all')
    if (stored := outcome_of(group, out)) is not None:
        return stored
    begun = perf_counter()
    reads: list[_Read] = []
    found, reason = None, ''
    try:
        reads = _told_apart([_read(member, group) for member in group.flights])
        reads, found, reason = _diagnosed(reads, group)
        status = REFUSED if found is None else DIAGNOSED
    except Exception as error:      # of a library: it takes no other group with it
        status, reason = FAILED, f'{type(error).__name__}: {one_line(error)}'
    outcome = Outcome(status, reason, perf_counter() - begun)
    write(group, out, outcome, reads, found)
    del reads, found
    give_back()
    return outcome


def outcome_of(group: Group, out: str | Path) -> Outcome | None:
    """Return the Outcome of a Group that is done, or None."""
    rows = read_rows(out, 'groups', group.key, ['status', 'reason', 'seconds'])
    return next((Outcome(**row) for row in rows if row['status'] in DONE), None)


def write(group: Group, out: str | Path, outcome: Outcome, reads: Sequence[_Read] = (),
          found: Diagnosis | None = None) -> None:
    """
    Write the rows of a group; the row in `groups`, which says that it is done, is the last.

    Of a group that failed only flights without an older result have rows. reads: what was read of
    its flights, if that is known; found: its Diagnosis, if there is one.
    """
    whose = {'group': group.key, 'vehicle': group.vehicle, 'configuration': group.configuration}
    dated = whose | {'date': group.date}
    reads = reads or [_Read(member, ()) for member in group.flights]
    if outcome.status not in DONE:
        there = {row['flight'] for key in group.older
                 for row in read_rows(out, 'flights', key, ['flight'])}
        reads = [one for one in reads if one.member.flight not in there]
        if not reads:
            return
    used = [one for one in reads if not one.reason]
    write_rows(out, 'flights', group.key, [
        whose | _flight(one, outcome, found, len(used) > 1 and one is used[-1]) for one in reads])
    if found is not None:
        minor = [one.effect for one in found.minor]
        write_rows(out, 'effects', group.key, [dated | {
            'effect': one.effect, 'probability': one.probability,
            'contribution': one.contribution, 'form': one.form,
            'named': one.effect in found.verdict, 'minor': one.effect in minor,
            'form_errors': np.asarray(found.form_errors.get(one.effect, ())).tolist()}
            for one in found.ranking])
    write_rows(out, 'groups', group.key, [dated | {
        'flights': len(reads), 'status': outcome.status, 'reason': outcome.reason,
        'version': group.version, 'rules': rules_hash(group.rules), 'nominal': group.against,
        'seconds': outcome.seconds, 'diagnosis': '', **(_verdict(found) if found else {})}])


def one_line(error: Exception) -> str:
    """Return the message of an error as one line."""
    return ' '.join(str(error).split())


def _read(member: Member, group: Group) -> _Read:
    try:
        records = load_all(member.path, group.mapping, group.nominal)
        if several := vehicles(records):
            raise InputError(
                f'{member.path}: {several[0]["message"]}; write a file for each, by `quad_ident '
                'convert FILE NEW.csv --segment N`, into a folder of its vehicle')
        return _Read(member, tuple(records))
    except InputError as error:
        if why := why_missing(member.path, member.flight):
            raise FileNotFoundError(why) from None
        return _Read(member, (), one_line(error))
    except Exception as error:      # of a library: it takes no other flight with it
        return _Read(member, (), f'{member.path}: {type(error).__name__} while it was read')


def _told_apart(reads: Sequence[_Read]) -> list[_Read]:
    """Return what was read, with names by which no two files of a group are taken for one."""
    if len(reads) < 2:
        return list(reads)
    of_files = [{str(record.info.get('name')) for record in joined(one.records)} for one in reads]
    counts = Counter(name for names in of_files for name in names)
    top = os.path.commonpath([Path(one.member.path).parent for one in reads])
    return [replace(one, records=tuple(renamed(one.records, Path(one.member.path), top)))
            if any(counts[name] > 1 for name in names) else one
            for one, names in zip(reads, of_files, strict=True)]


def _diagnosed(reads: list[_Read], group: Group) -> tuple[list[_Read], Diagnosis | None, str]:
    """
    Return what was read and is used, and its Diagnosis, or None and why there is none.

    Where together they are refused, those that are refused by themselves are left out.
    """
    some = [one for one in reads if not one.reason]
    if not some:
        return reads, None, reads[0].reason
    try:
        return reads, _of(some, group), ''
    except InputError as error:
        first = one_line(error)
    refusals = {id(one): reason for one in some if (reason := _refusal(one, group))}
    reads = [replace(one, reason=refusals.get(id(one), one.reason)) for one in reads]
    if 0 < len(refusals) < len(some):
        with suppress(InputError):
            return reads, _of([one for one in reads if not one.reason], group), ''
    return reads, None, first


def _of(reads: Sequence[_Read], group: Group) -> Diagnosis:
    return diagnose([record for one in reads for record in one.records], group.nominal,
                    rules=group.rules)


def _refusal(one: _Read, group: Group) -> str:
    """Return why a flight is refused by itself, or ''."""
    try:
        take_in(one.records, group.nominal, None, group.rules)
    except InputError as error:
        return one_line(error)
    return ''


def _flight(one: _Read, outcome: Outcome, found: Diagnosis | None, last: bool) -> dict[str, Any]:
    """Return the columns of a flight that are not those of its group."""
    names = {record.info.get('name') for record in joined(one.records)}
    t = [record.t for record in one.records]
    return {
        'flight': one.member.flight, 'path': one.member.path, 'date': one.member.date,
        'duration_s': float(sum(each[-1] - each[0] for each in t)) if t else None,
        'rate_hz': 1.0 / one.records[0].period() if t else None,
        'held_out': last and found is not None,
        'status': REFUSED if one.reason else outcome.status,
        'reason': one.reason or outcome.reason,
        'findings': [f'{each["where"]}: {each["message"]}' for each in
                     (found.findings if found else ()) if each['flight'] in names],
        'covariates': {**_battery(one.records), **one.member.covariates}}


def _battery(records: Sequence[FlightRecord]) -> dict[str, float]:
    """Return the voltage (V) at the beginning and end of a flight, where it was recorded."""
    known = [record for record in records if record.has('vbat')]
    if not known:
        return {}
    first, last = known[0], known[-1]
    return {'battery_v_start': float(np.median(
                first.columns['vbat'][first.t <= first.t[0] + FIRST])),
            'battery_v_end': float(np.median(
                last.columns['vbat'][last.t >= last.t[-1] - FIRST]))}


def _verdict(found: Diagnosis) -> dict[str, Any]:
    """Return the columns of a group that its Diagnosis fills."""
    gap = found.gap
    return {
        'verdict': list(found.verdict), 'minor': [one.effect for one in found.minor],
        **{f'gap_{when}_{name}': float(value)
           for when, values in (('before', gap.before), ('after', gap.after),
                                ('noise', gap.noise)) for name, value in values.items()},
        'closed': gap.closed,
        'findings': [f'{each["flight"]}: {each["where"]}: {each["message"]}'
                     for each in found.findings],
        'diagnosis': json.dumps(finite(found.as_data()), allow_nan=False)}
