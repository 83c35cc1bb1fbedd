# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether the unit that the time of a table is read in is that of its other columns."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np

from quad_ident_ros.data.columns import FORCE, POSITION, RATE, VELOCITY
from quad_ident_ros.data.guess.attitude import FAST, SLOW
from quad_ident_ros.data.guess.clock import RATES, USUAL
from quad_ident_ros.data.guess.draft import Draft
from quad_ident_ros.data.guess.motion import QUICK
from quad_ident_ros.data.guess.series import unit_length
from quad_ident_ros.data.mapping import Column, factor_of, UNITS
from quad_ident_ros.data.mapping_text import columns_text
from quad_ident_ros.data.time_scale import ALIKE, clues, is_wrong, Motion, UNIT, unit_of

RIGHT = 1.1     # times 1 ms, within which a count is one of ms: real flights tell it within 1.1
LENGTHS = {'m': 1.0, 'cm': 1e-2, 'mm': 1e-3}
TURNS = {'rad/s': 1.0, 'deg/s': np.pi / 180}


@dataclass(frozen=True)
class Doubt:
    """A doubt about the time of a table: its column, its unit by the others or '', and why."""

    name: str
    unit: str
    why: str

    def enter(self, draft: Draft) -> None:
        """Put this before the doubts of a Draft, whose time gets the unit, or none."""
        draft.guess.doubts.insert(0, self.why)
        draft.columns.pop('t', None)
        if self.unit:
            draft.columns = {'t': Column((self.name,), self.unit), **draft.columns}


def doubt_of(draft: Draft) -> Doubt | None:
    """
    Return the Doubt about the time of a Draft whose name does not say its unit, or None.

    A count in which each row is one more may be of samples or of ms: it is read where the other
    columns show that it is in ms. Any other time is read unless they contradict its unit in each
    unit of their own that their names leave open.
    """
    if draft.stamps is None:
        return None
    time = draft.columns['t']
    name, found, streams = time.names[0], *_scales(draft)
    likely = [scale for same, scale in found if same]
    sure = bool(likely) and max(likely) < ALIKE * min(likely)
    if draft.counted:
        if sure and 1.0 / RIGHT < likely[0] < RIGHT:
            return None
        return _of_count(name, likely[0] if sure else None)
    if not found or any(not is_wrong(scale) for _, scale in found):
        return None
    scale = next((scale for _, scale in sorted(found, reverse=True) if unit_of(scale)), None)
    if scale is None:
        if streams == 1 or not sure:
            return None     # it may be the scale of one of these that is wrong
        scale = likely[0]
    seconds = scale * factor_of('t', time.unit)
    unit = next((unit for unit, size in UNITS['s'].items()
                 if size / UNIT < seconds < size * UNIT), '')
    return Doubt(name, unit, (
        f't: the unit of {name!r}: read in {time.unit}, {scale:.3g} times as much time passes by '
        'the other columns' + (f', as if it were in {unit}' if unit else '')
        + f'; write it, such as {_line(name, unit or "ms")}'))


def _of_count(name: str, scale: float | None) -> Doubt:
    """Return the Doubt about a count, of which one is so many ms by the other columns, or None."""
    counts = f't: {name!r} counts at a rate that the table does not say'
    if scale is None:
        return Doubt(name, '', f'{counts}, or is in ms; write it, such as '
                               f'{_line(name, "100 Hz")}, or unit: ms')
    rate = f'{float(f"{1e3 / scale:.3g}"):g} Hz'
    return Doubt(name, rate, f'{counts}, about {rate} by the other columns; write the exact one, '
                             f'such as {_line(name, rate)}')


def _line(name: str, unit: str) -> str:
    """Return the line of a mapping for the time."""
    return f't: {columns_text({"t": Column((name,), unit)})["t"]}'


def _scales(draft: Draft) -> tuple[list[tuple[bool, float]], int]:
    """
    Return how many s pass in one of the time, in all units that the columns may have.

    Each with whether position and velocity have one unit of length; behind them, how many pairs
    of streams say so. Units in which these disagree are left out, and rates that no log has.
    """
    assert draft.stamps is not None
    known, q = np.isfinite(draft.stamps), draft.attitude
    t = draft.stamps[known]
    raw: dict[tuple[str, ...], np.ndarray | None] = {
        group: _as_written(draft, group, known) for group in (POSITION, VELOCITY, RATE)}
    lone = raw[POSITION] is None or raw[VELOCITY] is None
    said = clues(Motion(
        t, raw[POSITION], raw[VELOCITY], None if q is None else unit_length(q)[known], raw[RATE],
        draft.scaled(FORCE)[known] if FORCE[0] in draft.columns else None))
    steps = np.diff(t)
    period = float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0
    found = []
    for place, speed, rate in product(*_open_units(draft, raw)):
        factors = {'position and velocity': place / speed, 'attitude and rate': 1.0 / rate}
        for other in ('attitude', 'specific force'):
            factors |= {f'velocity and {other}': speed, f'position and {other}': place ** 0.5}
        scales = [one.scale * factors[one.streams] for one in said]
        scale = float(np.exp(np.mean(np.log(scales)))) if scales else 0.0
        if not scales or any(not scale / ALIKE < one < ALIKE * scale for one in scales):
            continue
        if not is_wrong(scale) or 1.0 / USUAL[1] <= scale * period <= 1.0 / RATES[0]:
            found.append((lone or place == speed, scale))
    return found, len(said)


def _as_written(draft: Draft, group: tuple[str, ...], known: np.ndarray) -> np.ndarray | None:
    """Return the columns of a group in their own unit, (n, 3) where known, or None."""
    if group[0] not in draft.columns:
        return None
    taken = [draft.columns[name] for name in group]
    signs = [np.sign(factor_of(name, one.unit)) for name, one in zip(group, taken, strict=True)]
    return draft.values([one.names[0] for one in taken])[known] * signs


def _open_units(draft: Draft, raw: Mapping[tuple[str, ...], np.ndarray | None]
                ) -> Iterator[list[float]]:
    """Yield the factors of position, velocity and rate to SI units that names and sizes leave."""
    for group, known, units in ((POSITION, UNITS['m'], LENGTHS), (VELOCITY, UNITS['m/s'], LENGTHS),
                                (RATE, UNITS['rad/s'], TURNS)):
        values = raw[group]
        if values is None:
            yield [1.0]
            continue
        names = [draft.columns[name].names[0] for name in group]
        if said := draft.unit_of(names, known):
            yield [abs(factor_of(group[0], said))]
        elif group == VELOCITY and np.nanquantile(np.abs(values), 0.9) > QUICK:
            yield [LENGTHS['cm'], LENGTHS['mm']]
        elif group == RATE and (fast := np.nanquantile(np.abs(values), 0.99)) > FAST:
            yield [TURNS['deg/s']]
        elif group == RATE and fast < SLOW:
            yield [TURNS['rad/s']]
        else:
            yield list(units.values())
