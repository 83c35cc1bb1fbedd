# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Small pictures of a fleet, drawn as SVG: a parameter along its flights, a gap that shrinks."""

from collections.abc import Callable, Iterable
from html import escape
import math

import numpy as np

from quad_ident_ros.data.counted import counted
from quad_ident_ros.effects.registry import titled
from quad_ident_ros.fleet.history import History, Series
from quad_ident_ros.report.fleet_words import with_configuration
from quad_ident_ros.report.html import Markup
from quad_ident_ros.report.sizes import with_error

WIDE, HIGH = 260.0, 104.0       # px of a small picture
LEFT, RIGHT, TOP, FOOT = 46.0, 6.0, 6.0, 18.0
FAR = 6.0           # times the usual distance from the course, beyond which a value is at the edge
BAR = 160.0         # px of a bar of gaps


def small_multiple(one: History, unit: str, factor: float) -> Markup:
    """
    Return the picture of a History: values with two standard errors, course, changes, odd flights.

    Values that are far off are drawn at the edge. Args: unit that is shown, and what values (SI)
    are multiplied by for it.
    """
    series = one.series
    low, high = _limits(one)
    x, y = _along(series), _scale(low, high)
    values = np.clip(series.values, low, high)
    ends = [np.clip(series.values + side * 2.0 * series.errors, low, high) for side in (-1, 1)]
    odd = set(one.odd)
    usual = [k for k in range(len(values)) if k not in odd]
    parts = [_line('grid', f'M{LEFT} {y(low):.1f}H{WIDE - RIGHT}M{LEFT} {y(high):.1f}'
                   f'H{WIDE - RIGHT}'),
             _line('whisker', ''.join(f'M{x[k]:.1f} {y(a):.1f}V{y(b):.1f}' for k, (a, b) in
                                      enumerate(zip(*ends, strict=True)) if b > a)),
             _line('course', _course(one, x, y)),
             _line('dots', ''.join(f'M{x[k]:.1f} {y(values[k]):.1f}h0' for k in usual)),
             _line('odd', ''.join(f'M{x[k] - 3:.1f} {y(values[k]) - 3:.1f}l6 6m0 -6l-6 6'
                                  for k in sorted(odd)))]
    for change in one.changes:
        at = 0.5 * (x[change.place - 1] + x[change.place])
        parts.append(_line('change', f'M{at:.1f} {TOP}V{HIGH - FOOT}'))
    # As many digits as tell the two apart: thrust of 1.0195 from one of 1.0205.
    digits = max(3, 2 + math.ceil(math.log10(max(abs(low), abs(high)) / (high - low))))
    marks = [_text(LEFT - 4, y(high) + 8, 'end', f'{factor * high:.{digits}g}'),
             _text(LEFT - 4, y(low), 'end', f'{factor * low:.{digits}g}'),
             _text(LEFT, HIGH - 4, 'start', _day(series.t[0])),
             _text(WIDE - RIGHT, HIGH - 4, 'end', _day(series.t[-1]))]
    return Markup(f'<svg class="small" viewBox="0 0 {WIDE:g} {HIGH:g}" role="img" aria-label="'
                  f'{escape(in_words(one, unit, factor))}"><g aria-hidden="true">'
                  f'{"".join(parts + marks)}</g></svg>')


def in_words(one: History, unit: str, factor: float) -> str:
    """Return what a picture shows, for readers who cannot see it."""
    series, in_unit = one.series, f' in {unit}' if unit not in ('1', '') else ''
    told = [f'{with_configuration(series.vehicle, series.configuration)}, '
            f'{titled(series.effect)} {series.parameter}{in_unit} over '
            f'{counted(len(series.values), "flight")}: '
            f'{with_error(factor * one.level, factor * one.std)} at the last']
    told += [f'it changes before flight {change.place + 1} by {factor * change.size:.3g}'
             for change in one.changes]
    if one.drift:
        told.append(f'it drifts by {factor * one.drift.per_week:.3g} a week')
    if one.odd:
        told.append(f'{counted(len(one.odd), "flight")} off by '
                    f'{"itself" if len(one.odd) == 1 else "themselves"}')
    return '; '.join(told)


def gap_bar(before: float, after: float, noise: float, most: float) -> Markup:
    """Return a bar from the gap after to that before, with a mark at that of the noise."""
    def at(value: float) -> float:
        return BAR * min(value / most, 1.0)

    return Markup(
        f'<td class="text"><svg class="gapbar" viewBox="0 0 {BAR:g} 12" aria-hidden="true">'
        + _line('closed', f'M{at(after):.1f} 6H{at(before):.1f}')
        + _line('open', f'M0 6H{at(after):.1f}') + _line('noise', f'M{at(noise):.1f} 0v12')
        + '</svg></td>')


def _limits(one: History) -> tuple[float, float]:
    """Return what a picture spans: what is usual about the course, not what is far off."""
    series = one.series
    away = np.abs(series.values - one.course)
    usual = max(float(np.median(away)), float(np.median(series.errors)), 1e-300)
    near = away <= FAR * usual
    reach = np.minimum(2.0 * series.errors, FAR * usual)
    low = min(float(np.min((series.values - reach)[near], initial=np.inf)), one.course.min())
    high = max(float(np.max((series.values + reach)[near], initial=-np.inf)), one.course.max())
    margin = 0.05 * (high - low) or usual
    return low - margin, high + margin


def _course(one: History, x: np.ndarray, y: Callable[[float], float]) -> str:
    """Return the path of the course, which is broken at each change."""
    first = {change.place for change in one.changes}
    return ''.join(f'{"M" if k == 0 or k in first else "L"}{x[k]:.1f} {y(value):.1f}'
                   for k, value in enumerate(one.course))


def _along(series: Series) -> np.ndarray:
    """Return where flights are (px), by time, or one beside the other where dates are equal."""
    t = series.t if np.all(np.diff(series.t) > 0.0) else np.arange(len(series.t), dtype=float)
    return _place(t, (t[0], t[-1]), LEFT, WIDE - RIGHT)


def _place(values: np.ndarray, span: tuple[float, float], first: float, last: float
           ) -> np.ndarray:
    return first + (values - span[0]) / max(span[1] - span[0], 1e-9) * (last - first)


def _scale(low: float, high: float) -> Callable[[float], float]:
    return lambda value: TOP + (high - value) / (high - low) * (HIGH - FOOT - TOP)


def _day(seconds: float) -> str:
    return str(np.datetime64(int(seconds), 's').astype('datetime64[D]'))


def _line(kind: str, path: str) -> str:
    return f'<path class="{kind}" d="{path}"/>' if path else ''


def _text(x: float, y: float, anchor: str, text: str) -> str:
    return f'<text x="{x:g}" y="{y:.1f}" text-anchor="{anchor}">{escape(text)}</text>'


def shown_first(found: Iterable[History]) -> list[History]:
    """Return histories, first those in which something happens, then by parameter and vehicle."""
    def order(one: History) -> tuple:
        series: Series = one.series
        return (not (one.changes or one.drift), series.effect, series.parameter, series.vehicle)

    return sorted(found, key=order)
