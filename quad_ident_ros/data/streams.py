# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Streams of different rates and stamps, joined on one time base."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from quad_ident_ros.data.counted import counted
from quad_ident_ros.data.record import QUATERNION
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import continuous

BRIDGED = 5.0   # sample periods of a stream that interpolation may bridge

INTERPOLATED, HELD, SLOW = 'interpolated', 'held', 'slow'


@dataclass(frozen=True, eq=False)
class Stream:
    """
    The samples of one source.

    Args: source what messages call it, such as a topic; stamps (n,) ns, integers in any order;
    columns name -> (n,) in the unit of the name; between its samples a stream is INTERPOLATED,
    HELD (a command stays until the next), or SLOW (held, and good beyond its ends: a battery).
    """

    source: str
    stamps: np.ndarray
    columns: Mapping[str, np.ndarray]
    between: str = INTERPOLATED


def join(where: str | Path, streams: Sequence[Stream]
         ) -> tuple[int, np.ndarray, dict[str, np.ndarray], tuple[str, ...]]:
    """
    Return (start in ns, t (N,) s from there, columns, notes) of streams on one time base.

    The base are the stamps of the first stream that is HELD, for a row of a flight record is a
    command and the state when it was given; without one, those of the first stream. States are
    interpolated, attitudes along the shortest turn; commands are held. Rows where a stream has
    not begun, has ended, or was silent for more than 5 of its periods are left out.
    Args: where the file, for messages.
    Raises InputError where the streams share no time.
    """
    notes: list[str] = []
    clean = [_in_order(where, stream, notes) for stream in streams if _measured(stream, notes)]
    base = next((s for s in clean if s.between == HELD), clean[0])
    stamps = base.stamps
    known = np.ones(len(stamps), bool)
    for stream in clean:
        if stream is not base and stream.between != SLOW:
            known &= covered(stream, stamps)
    if known.sum() < 2:
        spans = ', '.join(f'{s.source} {s.stamps[0] * 1e-9:.3f} to {s.stamps[-1] * 1e-9:.3f} s'
                          for s in clean)
        raise InputError(f'{where}: the streams share no time ({spans}); record them together '
                         'and by one clock')
    left_out = int(len(known) - known.sum())
    if left_out:
        notes.append(f'{left_out} of {len(known)} samples of {base.source} are left out: another '
                     'stream had not begun, had ended or was silent')
    stamps = stamps[known]
    columns = {}
    for stream in clean:
        columns.update(at_stamps(stream, stamps, base.stamps[0]))
    return int(stamps[0]), (stamps - stamps[0]) * 1e-9, columns, tuple(notes)


def _measured(stream: Stream, notes: list[str]) -> bool:
    """Return whether a stream was measured, and note it where it was not: a battery at 0 V."""
    if stream.between != SLOW:
        return True
    voltage = np.concatenate(list(stream.columns.values()))
    with np.errstate(invalid='ignore'):     # nan of a kind that signals
        usual = np.median(voltage[np.isfinite(voltage)]) if np.isfinite(voltage).any() else 0.0
    if usual > 0.0:
        return True
    notes.append(f'{stream.source}: the voltage is not above zero, as without a sensor, and is '
                 'left out')
    return False


def _in_order(where: str | Path, stream: Stream, notes: list[str]) -> Stream:
    """Return a stream with rising stamps and finite values, and note what was left out."""
    stamps = np.asarray(stream.stamps, np.int64)
    finite = np.all([np.isfinite(values) for values in stream.columns.values()], axis=0)
    order = np.argsort(stamps[finite], kind='stable')
    index = np.flatnonzero(finite)[order]
    new = np.concatenate([[True], np.diff(stamps[index]) > 0]) if len(index) else index
    problems = {'without a finite value': len(stamps) - len(index),
                'out of order': int((np.diff(stamps[finite]) < 0).sum()),
                'with the stamp of another': len(index) - int(np.sum(new))}
    notes += [f'{stream.source}: {counted(count, "sample")} {what}'
              for what, count in problems.items() if count]
    index = index[new]
    if len(index) < 2:
        raise InputError(f'{where}, {stream.source}: {counted(len(index), "sample")} with a '
                         'stamp and finite values; at least 2 are needed')
    return Stream(stream.source, stamps[index],
                  {name: np.asarray(values, float)[index]
                   for name, values in stream.columns.items()}, stream.between)


def covered(stream: Stream, stamps: np.ndarray) -> np.ndarray:
    """Return where a Stream in order has samples around stamps (N,) ns, bool."""
    after = np.searchsorted(stream.stamps, stamps, side='left')
    inside = (stamps >= stream.stamps[0]) & (after < len(stream.stamps))
    after = np.clip(after, 1, len(stream.stamps) - 1)
    gap = stream.stamps[after] - stream.stamps[after - 1]
    exact = stream.stamps[np.clip(np.searchsorted(stream.stamps, stamps), 0,
                                  len(stream.stamps) - 1)] == stamps
    short = gap <= BRIDGED * np.median(np.diff(stream.stamps))
    return inside & (short | exact)


def at_stamps(stream: Stream, stamps: np.ndarray, origin: int) -> dict[str, np.ndarray]:
    """
    Return the columns of a Stream in order at stamps (N,) ns, rising, that it covers.

    Args: origin: the stamp, ns, from which differences are taken.
    """
    if stream.between != INTERPOLATED:
        index = np.searchsorted(stream.stamps, stamps, side='right') - 1
        return {name: values[np.maximum(index, 0)] for name, values in stream.columns.items()}
    if np.isin(stamps, stream.stamps, assume_unique=True).all():
        # Its own stamps: as they are, to the last bit.
        index = np.searchsorted(stream.stamps, stamps)
        return {name: values[index] for name, values in stream.columns.items()}
    # Differences of integers are exact where floats of an epoch in ns are not.
    x, xp = (stamps - origin) * 1e-9, (stream.stamps - origin) * 1e-9
    columns = {name: np.interp(x, xp, values) for name, values in stream.columns.items()
               if name not in QUATERNION}
    if QUATERNION[0] in stream.columns:
        q = continuous(np.stack([stream.columns[name] for name in QUATERNION], axis=-1))
        columns.update(zip(QUATERNION, slerp(xp, q, x).T, strict=True))
    return columns


def slerp(t: np.ndarray, quaternion: np.ndarray, at: np.ndarray) -> np.ndarray:
    """
    Return the attitudes between samples, by turning at a constant rate from each to the next.

    Args: t (n,) s rising; quaternion (n, 4) unit, without jumps of sign; at (N,) s within t.
    Returns (N, 4). Source: Shoemake 1985, Animating rotation with quaternion curves.
    """
    after = np.clip(np.searchsorted(t, at), 1, len(t) - 1)
    share = ((at - t[after - 1]) / (t[after] - t[after - 1]))[:, None]
    one, other = quaternion[after - 1], quaternion[after]
    angle = np.arccos(np.clip(np.sum(one * other, axis=-1), -1.0, 1.0))[:, None]
    # sinc keeps the small angle exact: sin(s a) / sin(a) = s sinc(s a) / sinc(a).
    weight = share * np.sinc(share * angle / np.pi)
    rest = (1.0 - share) * np.sinc((1.0 - share) * angle / np.pi)
    turned = (rest * one + weight * other) / np.sinc(angle / np.pi)
    return turned / np.linalg.norm(turned, axis=-1, keepdims=True)
