# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The page of a fleet: what to look at first, vehicles by effects, the time, the gap."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from quad_ident_ros import __version__
from quad_ident_ros.data.counted import counted
from quad_ident_ros.effects.registry import titled
from quad_ident_ros.fleet.history import History, SURE
from quad_ident_ros.fleet.insight import Insight
from quad_ident_ros.fleet.sisters import Sister, Sisters
from quad_ident_ros.report.fleet import effect_rows, EFFECTS_HEAD
from quad_ident_ros.report.fleet_charts import gap_bar, shown_first, small_multiple
from quad_ident_ros.report.fleet_words import (
    CHANGED,
    DIFFERS,
    known_effect,
    nothing_line,
    null_of,
    Point,
    points,
    summary_line,
    whole_gap_line,
    with_configuration,
    WORSE,
)
from quad_ident_ros.report.html import details, heard, join, Markup, markup, table, tag, write_page
from quad_ident_ros.report.sizes import handy, sized, with_error

MOST = 600          # small pictures: a page with more takes seconds to open
FAR, FARTHER = 2.0, 4.0     # spreads from the sisters from which on a cell is coloured
GAP = 'velocity'


def write(path: str | Path, found: Insight) -> None:
    """Write the page of an Insight; raises InputError where the file cannot be written."""
    body = [tag('p', summary_line(found) + '.', 'lead'), *_first(found), *_heat(found),
            *_effects(found), *_time(found), *_gap(found), *_logs(found),
            tag('p', f'Made by quad_ident_ros {__version__}.', 'second')]
    title = f'Fleet of {counted(len(found.vehicles), "vehicle")}'
    write_page(path, title, join(body), also='fleet')


def _first(found: Insight) -> list:
    some, head = points(found), tag('h2', 'What to look at first')
    if not some:
        return [head, tag('p', f'{nothing_line(found)}.')]
    items = join(Markup(
        f'<li data-vehicle="{escape(one.where)}">' + join(
            [tag('strong', one.where),
             join([tag('span', one.why, f'tag {_kind(one)}'), ':'], ''), one.text], ' ')
        + '</li>') for one in some)
    return [head, tag('p', 'The most urgent first: what gets worse, what changed, which vehicles '
                           'differ from their sisters, what the model does not have, and logs '
                           'that are refused or look wrong.'),
            Markup(f'<ol class="first">{items}</ol>')]


def _kind(one: Point) -> str:
    return 'no' if one.why == WORSE else 'part' if one.why in (CHANGED, DIFFERS) else ''


def _heat(found: Insight) -> list:
    """Return a table of vehicles by parameters, for each configuration."""
    parts = [tag('h2', 'Vehicles and effects'),
             tag('p', 'Each cell is the value at the last flight with its standard error. '
                      f'Coloured cells differ from the other vehicles by {FAR:g}, or '
                      f'{FARTHER:g} and more, times the spread between vehicles; a star marks '
                      f'those that surely differ (probability over {SURE:g}).')]
    for name in dict.fromkeys(one.configuration for one in found.sisters):
        some = sorted((one for one in found.sisters if one.configuration == name),
                      key=lambda one: (-len(one.vehicles), one.effect, one.parameter))
        parts.append(_heat_of(name, some))
    return parts if found.sisters else []


def _heat_of(configuration: str, some: Sequence[Sisters]) -> Markup:
    columns, names = [], sorted({one.vehicle for each in some for one in each.vehicles})
    units = []
    for each in some:
        unit, factor = handy(each.unit, _usual([one.value for one in each.vehicles]))
        units.append(unit)
        columns.append({one.vehicle: _cell(one, factor, len(each.vehicles) > 1)
                        for one in each.vehicles})
    head = ['vehicle', *(Markup(f'{escape(known_effect(each.effect))}<br>'
                                f'({escape(each.effect)})<br>{escape(each.parameter)}'
                                + (f', {escape(unit)}' if unit not in ('1', '') else ''))
                         for each, unit in zip(some, units, strict=True))]
    rows = [[name, *(column.get(name, tag('td', '')) for column in columns)] for name in names]
    caption = 'Parameters of vehicles' + (f' with {configuration}' if configuration else '')
    return _live(table(head, rows, caption=caption))


def _cell(one: Sister, factor: float, has_sisters: bool) -> Markup:
    away = abs(one.spreads)
    kind = 'no' if away >= FARTHER else 'part' if away >= FAR else ''
    star = ' *' if one.odd >= SURE else ''
    attribute = f' class="{kind}"' if kind else ''
    away_by = f'{one.spreads:+.1f} spreads from its sisters'
    if has_sisters:
        attribute += f' title="{away_by}"'
    return Markup(f'<td{attribute} data-value="{one.value:.6g}">'
                  f'{with_error(factor * one.value, factor * one.std)}{star}'
                  f'{heard(f", {away_by}") if kind else ""}</td>')


def _effects(found: Insight) -> list:
    rows = effect_rows(found)
    shared = [[with_configuration(titled(each.effect), each.configuration), each.parameter,
               sized(each.mean, each.mean_std, each.unit), sized(each.spread, 0.0, each.unit),
               str(len(each.vehicles)), str(len(each.odd))] for each in found.sisters
              if len(each.vehicles) > 1
              and abs(each.mean - null_of(each.effect, each.parameter)) > 2.0 * each.mean_std]
    parts = [tag('h2', 'What all share')]
    if rows:
        parts.append(_live(table(EFFECTS_HEAD, rows, ('text', '', '', '', 'text'),
                                 caption='Effects in the verdicts of the fleet')))
    if shared:
        parts.append(_live(table(
            ['effect', 'parameter', 'mean', 'spread', 'vehicles', 'odd'], shared,
            ('text', 'text', '', '', '', ''),
            caption='Mean and spread of the parameters that differ from no effect, without the '
                    'odd vehicles')))
    return parts if rows or shared else []


def _time(found: Insight) -> list:
    some = shown_first(one for one in found.histories if len(one.series.values) > 1)
    if not some:
        return []
    left = len(some) - MOST
    said = ('Values with two standard errors; the line is the level with its drifts and changes, '
            'vertical lines are changes, crosses are single flights that stand out.')
    if left > 0:
        said += f' The {left} others, in which nothing happens, are left out.'
    values: dict[tuple[str, str], list[float]] = {}
    for one in some:
        values.setdefault((one.series.effect, one.series.parameter), []).append(one.level)
    figures = join(_figure(one, *handy(one.series.unit, _usual(values[
        one.series.effect, one.series.parameter]))) for one in some[:MOST])
    return [tag('h2', 'Over time'), tag('p', said),
            Markup(f'<div class="multiples">{figures}</div>')]


def _usual(values: Sequence[float]) -> tuple[float]:
    """Return the usual size of values: the unit of all vehicles is that of most."""
    return (float(np.median(np.abs(values))),)


def _figure(one: History, unit: str, factor: float) -> Markup:
    series = one.series
    told = ' and '.join([*(['changed'] * bool(one.changes)), *(['drifts'] * bool(one.drift))])
    sign = tag('span', told, 'tag part') if told else ''
    caption = join([tag('strong', with_configuration(series.vehicle, series.configuration)),
                    f'{titled(series.effect)} {series.parameter}'
                    + (f', {unit}' if unit not in ('1', '') else ''), sign], ' ')
    return Markup(f'<figure data-vehicle="{escape(series.vehicle)}" data-effect="'
                  f'{escape(series.effect)}" data-title="{escape(titled(series.effect))}" '
                  f'data-event="{int(bool(told))}">'
                  f'<figcaption>{caption}</figcaption>{small_multiple(one, unit, factor)}'
                  '</figure>')


def _gap(found: Insight) -> list:
    known = [one for one in found.gaps if one.before[GAP] is not None]
    if not known:
        return []
    most = max(one.before[GAP][0] for one in known)
    rows = []
    for one in known:
        before, after, noise = (stage[GAP][0] for stage in (one.before, one.after, one.noise))
        rows.append([with_configuration(one.vehicle, one.configuration), str(one.groups),
                     f'{before:.3g}', f'{after:.3g}',
                     f'{noise:.3g}', gap_bar(before, after, noise, most)])
    return [tag('h2', 'The gap'),
            tag('p', markup('Error of the velocity half a second ahead, median of the groups of '
                            'each vehicle. The light part of a bar is what the effects named '
                            'close, the dark part remains; the mark is the noise.')),
            tag('p', markup(f'Median {whole_gap_line(found)}.')),
            _live(table(['vehicle', 'groups', 'before, m/s', 'after, m/s', 'noise, m/s', ''],
                        rows, ('text', '', '', '', '', 'text'),
                        caption='Gap before and after, over the whole fleet'))]


def _logs(found: Insight) -> list:
    parts = []
    for some, said, caption in (
            (found.failed, 'not diagnosed', 'Flights that the next run tries again'),
            (found.refused, 'refused', 'Flights that are refused'),
            (found.suspect, 'to check', 'Flights that stand apart from others of the vehicle')):
        if some:
            rows = [[vehicle, name, tag('td', reason, 'prose')] for vehicle, name, reason in some]
            verb = 'is' if len(some) == 1 else 'are'
            parts.append(details(f'{len(some)} of {found.flights} flights {verb} {said}', _live(
                table(['vehicle', 'flight', 'reason'], rows, ('text', 'text', 'text'),
                      caption=caption))))
    return [tag('h2', 'Logs'), *parts] if parts else []


def _live(content: Markup) -> Markup:
    """Return a table that web/fleet.js lets a reader sort and filter."""
    return Markup(f'<div class="sortable">{content}</div>')
