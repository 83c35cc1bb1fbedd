# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Records cut where an estimator was reset, and how resets are seen in the data."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from quad_ident_ros.data.attitudes import attitudes_of
from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.record import FlightRecord, NOTED
from quad_ident_ros.model.attitude import conjugate, continuous, product, rotate

Reset: TypeAlias = tuple[float, float, str]

SHORTEST = 4.0      # s, of a piece: a diagnosis needs that much
POSITION = 1.0      # m; estimators drift by less, and errors of measurement are smaller
HEADING = np.radians(20.0)     # rad; the compass of an estimator in flight is off by less
WITHIN = 0.2        # s in which a jump is over: streams of 5 Hz and more, interpolated
RETURNS = 1.0       # s; what has come back by then was a glitch, and no reset
CLEAR = 5.0         # times the usual disagreement of the streams
FASTEST = 60.0, 20.0    # m/s, rad/s about the vertical, which no multirotor exceeds
ALONE = 0.5         # of a jump, that is more than all else that is too fast around it
GAP = 5.0           # periods; what happens in a longer silence is no jump
APART = 0.1         # s between two parts: a fit does not bridge a gap of that length


def split(record: FlightRecord, resets: Sequence[Reset],
          shortest: float = SHORTEST) -> list[FlightRecord]:
    """
    Return the pieces of a record between resets, each with a note.

    Args: record FlightRecord; resets: (last time before, first time after, what happened) of
    each, s as in record.t; samples strictly between the two are left out; shortest: s, of a piece.
    Pieces that are shorter are left out; where all are, the longest stays.
    """
    resets = sorted((before, max(before, after), why) for before, after, why in resets
                    if before < record.t[-1] and after > record.t[0])
    if not resets:
        return [record]
    bounds, first = [], 0
    for before, after, _ in resets:
        bounds.append((first, int(np.searchsorted(record.t, before, side='right'))))
        first = max(first, int(np.searchsorted(record.t, max(after, np.nextafter(before, np.inf)),
                                               side='left')))
    bounds.append((first, len(record)))
    pieces = [(begin, end) for begin, end in bounds if end - begin >= 2]
    if not pieces:
        return [record]
    kept = [piece for piece in pieces if _length(record, piece) >= shortest]
    kept = kept or [max(pieces, key=lambda piece: _length(record, piece))]
    return _noted(record, kept, len(pieces), resets, shortest)


def part(record: FlightRecord, begin: int, end: int) -> FlightRecord:
    """
    Return the record of samples begin to end - 1.

    Its info says when the recording began (`began`, s), for the battery has been emptying since,
    and of which recording it is a part (`whole`: name and source), see joined.
    """
    piece = record.slice(0, end).starting(begin)
    info = {**piece.info, 'whole': record.info.get('whole', [record.info.get('name'),
                                                             record.info.get('source')])}
    if begin > 0:
        info['began'] = record.info.get('began', record.t[0])
    return replace(piece, info=info)


def joined(records: Sequence[FlightRecord]) -> list[FlightRecord]:
    """
    Return records in which the parts of one recording are one, with gaps between them.

    They are in the order in which the recordings come first. What is between the parts is reported
    in the info: `cuts`, the times (s) at which a part begins.
    """
    groups: dict[str, list[FlightRecord]] = {}
    for number, record in enumerate(records):
        whole = record.info.get('whole')
        key = f'{number}' if whole is None or whole[1] is None else f'of {whole[1]}'
        groups.setdefault(key, []).append(record)
    return [rejoined(group) for group in groups.values()]


def spans(record: FlightRecord) -> list[tuple[float, float]]:
    """Return the first and last time (s) of each part that a record was joined from."""
    firsts = np.searchsorted(record.t, [record.t[0], *record.info.get('cuts', ())])
    edges = [*np.unique(firsts[firsts < len(record)]), len(record)]
    return [(float(record.t[begin]), float(record.t[end - 1]))
            for begin, end in zip(edges[:-1], edges[1:], strict=True)]


def rejoined(pieces: Sequence[FlightRecord]) -> FlightRecord:
    """Return parts of one recording, at least one, as one record; see joined."""
    if len(pieces) == 1:
        return pieces[0]
    pieces = sorted(pieces, key=lambda piece: piece.t[0])
    name, source = pieces[0].info['whole']
    kept = [pieces[0]]
    for piece in pieces[1:]:
        # Nothing is to be taken from between two parts, however soon the next one begins.
        least = kept[-1].t[-1] + max(APART, GAP * piece.period())
        first = int(np.searchsorted(piece.t, least))
        if len(piece) - first >= 2:
            kept.append(piece.slice(first))
    columns = [column for column in kept[0].columns if all(one.has(column) for one in kept)]
    notes = _of_all(kept, 'notes')
    said: dict[str, object] = {code: _of_all(kept, code) for code in NOTED
                               if any(code in one.info for one in kept)}
    resets = list(dict.fromkeys(one.info['resets'] for one in kept if 'resets' in one.info))
    said |= {'resets': '; '.join(resets)} if resets else {}
    cuts = sorted({*(float(piece.t[0]) for piece in kept[1:]),
                   *(cut for piece in kept for cut in piece.info.get('cuts', ()))})
    spans = ', '.join(f't = {piece.t[0]:.2f} to {piece.t[-1]:.2f} s' for piece in kept)
    return FlightRecord(
        np.concatenate([piece.t for piece in kept]),
        {column: np.concatenate([piece.columns[column] for piece in kept]) for column in columns},
        {**kept[0].info, **said, 'name': f'{name} ({len(kept)} parts)', 'source': source,
         'cuts': cuts,
         'notes': [*notes, f'{len(kept)} parts of one recording are one flight: {spans}']})


def _of_all(records: Sequence[FlightRecord], key: str) -> list[str]:
    """Return the notes that the info of records has under a key, each once."""
    return list(dict.fromkeys(note for one in records for note in one.info.get(key, ())))


def jumps(record: FlightRecord) -> list[Reset]:
    """
    Return the jumps of position and heading in a record, as split takes them.

    A position jumps where it changes by more than POSITION within WITHIN, beyond what the
    velocity explains, a heading by more than HEADING beyond what the rate explains; by far more
    than the streams usually disagree, and not to come back. Without velocity or rate they jump
    where they are alone in being faster than any vehicle.
    """
    found = []
    rest = _unexplained_position(record)
    if rest is not None:
        steps = _steps(record, rest, POSITION, record.stack('px', 'py', 'pz'),
                       lambda size: f'the position jumps by {size:.2g} m')
        found += steps if record.has('vx', 'vy', 'vz') else _alone(record, rest, steps)
    turn = _unexplained_heading(record)
    if turn is not None:
        steps = _steps(record, turn[0][:, None], HEADING, turn[1][:, None],
                       lambda size: f'the heading jumps by {np.degrees(size):.0f} deg')
        found += steps if record.has('wx', 'wy', 'wz') else _alone(
            record, turn[0][:, None], steps)
    return _merged(found)


def split_at_jumps(record: FlightRecord) -> list[FlightRecord]:
    """Return the pieces of a record between the jumps that are seen in it."""
    with np.errstate(all='ignore'):
        return split(record, jumps(record))


def _noted(record: FlightRecord, kept: list[tuple[int, int]], count: int, resets: Sequence[Reset],
           shortest: float) -> list[FlightRecord]:
    """Return the kept pieces with names and notes."""
    shown = '; '.join(f'{why} at t = {before:.2f} s' for before, _, why in resets[:4])
    more = f' and {len(resets) - 4} more' if len(resets) > 4 else ''
    dropped = count - len(kept)
    name, source = record.info.get('name'), record.info.get('source')
    made = []
    for number, (begin, end) in enumerate(kept, 1):
        piece = part(record, begin, end)
        note = (f'part {number} of {len(kept)}, t = {piece.t[0]:.2f} to {piece.t[-1]:.2f} s, '
                f'split where the estimator was reset: {shown}{more}')
        if dropped:
            note += f'; left out: {counted(dropped, "part")} shorter than {shortest:g} s'
        info = {**piece.info, 'notes': [*piece.info.get('notes', ()), note],
                'resets': f'{shown}{more}'}
        if len(kept) > 1:
            info |= {'name': f'{name}_{number}'} if name else {}
            info |= {'source': f'{source}, part {number}'} if source else {}
        made.append(replace(piece, info=info))
    return made


def _length(record: FlightRecord, piece: tuple[int, int]) -> float:
    begin, end = piece
    return float(record.t[end - 1] - record.t[begin]) + record.period()


def _unexplained_position(record: FlightRecord) -> np.ndarray | None:
    """Return the path less the integral of the velocity, (N, 3) m, or None without a position."""
    if not record.has('px', 'py', 'pz'):
        return None
    steps = np.diff(record.stack('px', 'py', 'pz'), axis=0)
    if not record.has('vx', 'vy', 'vz'):
        return _summed(record, _too_fast(record, steps, FASTEST[0]))
    velocity = record.stack('vx', 'vy', 'vz')
    dt = np.diff(record.t)[:, None]
    return _summed(record, steps - 0.5 * (velocity[1:] + velocity[:-1]) * dt)


def _unexplained_heading(record: FlightRecord) -> tuple[np.ndarray, np.ndarray] | None:
    """Return (turn about the vertical less that of the rate, turn itself), (N,) rad, or None."""
    attitudes = attitudes_of(record)
    if attitudes is None:
        return None
    q = continuous(attitudes)
    turn = product(conjugate(q[:-1]), q[1:])
    turn *= np.where(turn[:, :1] < 0, -1.0, 1.0)
    sine = np.linalg.norm(turn[:, 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, turn[:, :1])
    vector = turn[:, 1:] * np.where(sine > 1e-9, angle / np.maximum(sine, 1e-9), 2.0)
    whole = rotate(q[:-1], vector)[:, 2]
    if record.has('wx', 'wy', 'wz'):
        rate = record.stack('wx', 'wy', 'wz')
        explained = 0.5 * (rate[1:] + rate[:-1]) * np.diff(record.t)[:, None]
        rest = rotate(q[:-1], vector - explained)[:, 2]
    else:
        rest = _too_fast(record, whole[:, None], FASTEST[1])[:, 0]
    return _summed(record, rest[:, None])[:, 0], _summed(record, whole[:, None])[:, 0]


def _too_fast(record: FlightRecord, steps: np.ndarray, fastest: float) -> np.ndarray:
    """Return the steps (N - 1, k) that are faster than a vehicle moves, 0 for the others."""
    fast = np.linalg.norm(steps, axis=1) > fastest * np.diff(record.t)
    return np.where(fast[:, None], steps, 0.0)


def _alone(record: FlightRecord, rest: np.ndarray, found: Sequence[Reset]) -> list[Reset]:
    """
    Return the jumps beside which little else is too fast, as samples are that are held.

    Args: rest: the sum (N, k) of what is too fast; found: jumps, as split takes them.
    """
    size = np.linalg.norm(np.diff(rest, axis=0), axis=1)
    kept = []
    for before, after, why in found:
        inside = (record.t[:-1] >= before) & (record.t[1:] <= after)
        near = (record.t[:-1] >= before - RETURNS) & (record.t[1:] <= after + RETURNS)
        if size[near & ~inside].sum() < ALONE * size[inside].sum():
            kept.append((before, after, why))
    return kept


def _summed(record: FlightRecord, steps: np.ndarray) -> np.ndarray:
    """Return the running sum (N, k) of steps (N - 1, k), those over gaps left out."""
    steps = np.where(np.diff(record.t)[:, None] > GAP * record.period(), 0.0, steps)
    return np.vstack([np.zeros((1, steps.shape[1])), np.cumsum(steps, axis=0)])


def _steps(record: FlightRecord, rest: np.ndarray, least: float, value: np.ndarray,
           say: Callable[[float], str]) -> list[Reset]:
    """Return the steps in the sum of what is unexplained, (N, k), as split takes them."""
    period = record.period()
    width = max(1, round(WITHIN / period))
    if len(record) <= 2 * width or not np.isfinite(rest).all():
        return []
    change = np.linalg.norm(rest[width:] - rest[:-width], axis=-1)
    if not np.isfinite(change).all():   # values of no unit: the quality of the record says so
        return []
    # Nine tenths of a record with a few resets have none of them.
    limit = max(least, CLEAR * float(np.quantile(change, 0.9)))
    after, found, at = max(1, round(RETURNS / period)), [], 0
    while at < len(change):
        if not change[at] > limit:
            at += 1
            continue
        k = at + int(np.argmax(change[at:at + width + 1]))
        size = change[k]
        along = (rest[k:k + width + 1] - rest[k]) @ ((rest[k + width] - rest[k]) / size)
        begin = k + int(np.flatnonzero(along < 0.05 * size)[-1])
        end = k + int(np.flatnonzero(along > 0.95 * size)[0])
        later = (np.median(rest[end:end + after], axis=0)
                 - np.median(rest[max(begin - after, 0):begin + 1], axis=0))
        moved = np.linalg.norm(value[min(end, len(value) - 1)] - value[min(begin, end)])
        if begin < end and np.linalg.norm(later) > 0.5 * size and moved > least:
            found.append((float(record.t[begin]), float(record.t[end]), say(float(size))))
        at = k + width + 1
    return found


def _merged(found: list[Reset]) -> list[Reset]:
    """Return jumps in order of time, those at one time as one."""
    merged: list[Reset] = []
    for before, after, why in sorted(found):
        if merged and before <= merged[-1][1]:
            last = merged[-1]
            merged[-1] = last[0], max(last[1], after), f'{last[2]} and {why}'
        else:
            merged.append((before, after, why))
    return merged
