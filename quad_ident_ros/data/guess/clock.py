# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The time of a table, and its unit."""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.data.guess.draft import Draft, together
from quad_ident_ros.data.guess.names import TIME
from quad_ident_ros.data.mapping import Column, factor_of, UNITS

RATES = 1.0, 10_000.0   # Hz: no log of a flight is slower, or faster, by a factor of two
CLOCK = 1e9, 4.1e9      # s since 1970: 2001 to 2100
USUAL = 10.0, 4000.0    # Hz, of nearly all logs: under three decades, by which the units differ
MOSTLY = 0.9            # share of the steps: a time may repeat or fall where recordings join
EVEN = 0.5              # of the usual step that nearly all steps differ by at most, jitter and all


def time(draft: Draft) -> None:
    """Take the column of the time."""
    found = [name for name in draft.free if TIME.search(draft.names[name])]
    rising = [name for name in found if _rises(draft.table.columns[name])]
    first = next(iter(draft.table.columns))
    if not found and _is_clock(draft.table.columns[first]):
        rising = [first]        # in any language
    if not rising and _by_count(draft):
        return
    if not rising:
        draft.guess.doubts.append(
            f't: no column of a time that rises{_but(found)}; add one in s to the file')
        return
    name = min(rising, key=lambda name: len(draft.names[name]))
    values, unit = draft.table.columns[name], ''
    if ':' not in draft.units[name]:     # else how a time of day is written, as hh:mm:ss
        unit = draft.said_unit('t', [name], UNITS['s'])
    unit = unit or time_unit(values)
    if not unit:
        draft.guess.doubts.append(f't: the unit of {name!r}')
        unit = 's'
    draft.columns['t'] = Column((name,), unit)
    draft.t = values * factor_of('t', unit)
    draft.taken([name], '')
    draft.guess.said.append(f'{name}: time in {unit}')


def _by_count(draft: Draft) -> bool:
    """Take a count of frames as the time, or doubt its rate; return whether there is one."""
    counts = [name for name in draft.free if draft.names[name] in ('frame', 'frames')
              and _is_count(draft.table.columns[name])]
    if len(counts) != 1:
        return False
    rate = draft.table.rate
    if not rate:
        draft.guess.doubts.append(
            f't: {counts[0]!r} counts at a rate that the table does not say; write it, such as '
            f't: {{column: {counts[0]}, unit: 100 Hz}}')
        return True
    draft.columns['t'] = Column((counts[0],), f'{rate:.10g} Hz')
    draft.t = draft.table.columns[counts[0]] / rate
    draft.taken(counts, '')
    draft.guess.said.append(f'{counts[0]}: time, frames at {rate:g} Hz')
    return True


def _is_count(values: np.ndarray) -> bool:
    """Return whether values rise by one from each row to the next, but for rows left out."""
    steps = np.diff(values)
    return bool(len(steps) and (steps >= 1).all() and (steps % 1 == 0).all()
                and np.median(steps) == 1)


def time_unit(values: np.ndarray) -> str:
    """Return the unit of times by their size and steps: s, ms, us, ns, or ''."""
    finite = values[np.isfinite(values)]
    steps = np.diff(finite)
    steps = steps[steps > 0]
    if not len(steps):
        return ''
    start, step = abs(float(finite[0])), float(np.median(steps))
    for unit, factor in (('s', 1.0), ('ms', 1e3), ('us', 1e6), ('ns', 1e9)):
        if CLOCK[0] * factor <= start <= CLOCK[1] * factor:
            return unit if RATES[0] <= factor / step <= RATES[1] else ''
    fits = [unit for unit, factor in (('s', 1.0), ('ms', 1e3), ('us', 1e6), ('ns', 1e9))
            if USUAL[0] <= factor / step <= USUAL[1]]
    if len(fits) > 1:       # steps of 0.25 to 0.4 of one, 250 to 400 of the other
        fits = [unit for unit in fits if unit != 's']
    return fits[0] if fits else ('s' if RATES[0] <= 1 / step else '')


def _rises(values: np.ndarray) -> bool:
    finite = values[np.isfinite(values)]
    steps = np.diff(finite)
    return len(steps) > 0 and (steps >= 0).mean() > MOSTLY and finite[-1] > finite[0]


def _is_clock(values: np.ndarray) -> bool:
    """Return whether values rise in steps of one size as a time does, and are no counts."""
    steps = np.diff(values[np.isfinite(values)])
    if len(steps) < 10 or (steps <= 0).any() or (steps == 1).all():
        return False
    usual = float(np.median(steps))
    return bool(np.mean(np.abs(steps - usual) < EVEN * usual) > MOSTLY) and bool(time_unit(values))


def _but(found: Sequence[str]) -> str:
    """Return which columns have the name of a time, and do not rise."""
    return f' ({together(found)} does not)' if found else ''
