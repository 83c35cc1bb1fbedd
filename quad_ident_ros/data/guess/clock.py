# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The time of a table, and its unit."""

from collections.abc import Sequence
import re

import numpy as np

from quad_ident_ros.data.guess.draft import Draft, together
from quad_ident_ros.data.guess.names import ROW_LABEL, TIME
from quad_ident_ros.data.mapping import Column, factor_of, UNITS

RATES = 1.0, 10_000.0   # Hz: no log of a flight is slower, or faster, by a factor of two
CLOCK = 1e9, 4.1e9      # s since 1970: 2001 to 2100
USUAL = 10.0, 4000.0    # Hz, of nearly all logs: under three decades, by which the units differ
MOSTLY = 0.9            # share of the steps: a time may repeat or fall where recordings join
EVEN = 0.5              # of the usual step that nearly all steps differ by at most, jitter and all
COUNT = re.compile(r'(frame|sample|row|step|tick)s?(_?(no|nr|num|number|id|idx|index|count))?|'
                   r'index|idx|count|counter|seq|time_?step|time_?index')
"""Names of columns that count what is recorded."""


def time(draft: Draft) -> None:
    """Take the column of the time."""
    found = [name for name in draft.free if TIME.search(draft.names[name])]
    rising = [name for name in found if _rises(draft.table.columns[name])]
    first = next((name for name, values in draft.table.columns.items() if not _is_count(values)
                  or not ROW_LABEL.fullmatch(draft.names[name])), '')
    if not found and first and _is_clock(draft.table.columns[first]):
        rising = [first]        # in any language
    if not rising and _by_count(draft):
        return
    if not rising:
        draft.guess.doubts.append(
            f't: no column of a time that rises{_but(found)}; add one in s to the file')
        return
    rising = [name for name in rising if not _is_count(draft.table.columns[name])] or rising
    name = min(rising, key=lambda name: len(draft.names[name]))
    values, unit = draft.table.columns[name], ''
    if ':' not in draft.units[name]:     # else how a time of day is written, as hh:mm:ss
        unit = draft.said_unit('t', [name], UNITS['s'])
    draft.unsure = not unit
    unit = unit or time_unit(values)
    draft.counted = draft.unsure and unit == 'ms' and _is_count(values) and abs(
        float(values[np.isfinite(values)][0])) < CLOCK[0]
    if draft.counted and draft.table.rate:
        unit, draft.unsure = f'{draft.table.rate:.10g} Hz', False
    if not unit:
        draft.guess.doubts.append(f't: the unit of {name!r}')
        unit = 's'
    draft.columns['t'] = Column((name,), unit)
    draft.stamps = values * factor_of('t', unit)
    draft.t = None if draft.blind else draft.stamps
    draft.taken([name], '')
    draft.guess.said.append(f'{name}: time in {unit}')


def _by_count(draft: Draft) -> bool:
    """Take a count of frames as the time, or doubt its rate; return whether there is one."""
    counts = [name for name in draft.free if COUNT.fullmatch(draft.names[name])
              and _is_count(draft.table.columns[name])]
    if not counts:
        return False
    name, rate = counts[0], draft.table.rate
    draft.taken([name], '')
    if not rate:
        draft.columns['t'] = Column((name,), 'ms')      # unless the other columns say more
        draft.stamps, draft.unsure, draft.counted = 1e-3 * draft.table.columns[name], True, True
        draft.t = None if draft.blind else draft.stamps
        draft.guess.said.append(f'{name}: time, counts at 1000 Hz')
        return True
    draft.columns['t'] = Column((name,), f'{rate:.10g} Hz')
    draft.t = draft.table.columns[name] / rate
    draft.guess.said.append(f'{name}: time, frames at {rate:g} Hz')
    return True


def _is_count(values: np.ndarray) -> bool:
    """
    Return whether whole values rise by one from each row to the next as a rule.

    Rows may be left out, be of several streams, or begin another recording.
    """
    finite = values[np.isfinite(values)]
    steps = np.diff(finite)
    rising = steps[steps > 0]
    return bool(len(rising) > MOSTLY * len(steps) / 2 and (finite % 1 == 0).all()
                and np.median(rising) == 1)


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
            mean = float(steps.mean())      # rows of several streams may come in bursts
            likely = any(RATES[0] <= factor / one <= RATES[1] for one in (step, mean))
            return unit if likely else ''
    fits = [unit for unit, factor in (('s', 1.0), ('ms', 1e3), ('us', 1e6), ('ns', 1e9))
            if USUAL[0] <= factor / step <= USUAL[1]]
    if len(fits) > 1:       # steps of 0.25 to 0.4 of one, 250 to 400 of the other
        fits = [unit for unit in fits if unit != 's']
    return fits[0] if fits else ('s' if RATES[0] <= 1 / step <= RATES[1] else '')


def _rises(values: np.ndarray) -> bool:
    finite = values[np.isfinite(values)]
    steps = np.diff(finite)
    return len(steps) > 0 and (steps >= 0).mean() > MOSTLY and finite[-1] > finite[0]


def _is_clock(values: np.ndarray) -> bool:
    """Return whether values rise in steps of one size as a time does, and are no counts."""
    steps = np.diff(values[np.isfinite(values)])
    if len(steps) < 10 or (steps <= 0).any() or _is_count(values):
        return False
    usual = float(np.median(steps))
    return bool(np.mean(np.abs(steps - usual) < EVEN * usual) > MOSTLY) and bool(time_unit(values))


def _but(found: Sequence[str]) -> str:
    """Return which columns have the name of a time, and do not rise."""
    return f' ({together(found)} does not)' if found else ''
