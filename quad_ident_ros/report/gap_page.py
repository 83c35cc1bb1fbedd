# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The page of a diagnosis: the verdict first, then pictures and numbers."""

from collections import Counter
from pathlib import Path
import tempfile

import yaml

from quad_ident_ros import __version__
from quad_ident_ros.diagnose.residual_wrench import CHANNELS
from quad_ident_ros.diagnose.result import Diagnosis
from quad_ident_ros.effects.registry import titled
from quad_ident_ros.model.vehicle import vehicle_to_mapping
from quad_ident_ros.report.ceiling import ceiling_line
from quad_ident_ros.report.closed_loop import (
    COST_LINE,
    cost_rows,
    COSTS,
    loop_line,
    loop_rows,
    TITLES,
)
from quad_ident_ros.report.diagnosis import (
    AHEAD,
    ahead_rows,
    FAR,
    far_line,
    far_rows,
    IN_SIMULATOR,
    minor_lines,
    NEXT,
    next_row,
    nuisance_lines,
    one_finding_lines,
    open_lines,
    shown,
    shown_effects,
    simulator_line,
    simulator_rows,
    WHERE,
    where_row,
    without_it,
)
from quad_ident_ros.report.gap_figures import figures
from quad_ident_ros.report.gap_pictures import map_rows, regimes
from quad_ident_ros.report.html import (
    bar,
    details,
    join,
    Markup,
    markup,
    table,
    tag,
    write_page,
)
from quad_ident_ros.report.svg import drawings
from quad_ident_ros.report.verdict import (
    change_of,
    contribution_of,
    form_of,
    next_step,
    sentence,
    size_line,
    verdict_line,
)

WIDE = 1.96     # standard errors to the ends of a 95 % interval
KINDS = {'none': 'yes', 'unknown': 'no', 'undetermined': 'part'}


def write(path: str | Path, found: Diagnosis, written: str | None = None) -> None:
    """
    Write the page of a Diagnosis; raises InputError where the file cannot be written.

    written: the file of --out-vehicle.
    """
    with tempfile.TemporaryDirectory() as folder:
        pictures = drawings(figures(found), folder)
    body = [*_verdict(found, written), *_where(found, pictures), *_which(found),
            *_far(found, pictures), *_in_simulator(found), *_closed_loop(found), *_open(found),
            *_provenance(found)]
    write_page(path, f'Sim-to-real gap of {found.vehicle.name}', join(body))


def _verdict(found: Diagnosis, written: str | None) -> list:
    words = join((tag('span', titled(name),
                      f'tag {KINDS.get(name, "part")}') for name in found.verdict), ' ')
    return [tag('p', sentence(verdict_line(found)), 'lead'),
            tag('p', size_line(found)), tag('p', next_step(found, written)),
            tag('p', join([tag('strong', 'Verdict: '), words], ''))]


def _where(found: Diagnosis, pictures: dict) -> list:
    rows = [where_row(row) for row in shown(found.where)]
    return [tag('h2', 'Where'), pictures['map'], _map_in_numbers(found), pictures['spectrum'],
            table(WHERE, rows, kinds=('text', '', '', '', 'text', ''),
                  caption='Force and moment that the nominal vehicle does not explain')]


def _map_in_numbers(found: Diagnosis) -> Markup:
    """Return every cell of the map in a table, for readers who cannot see its colours."""
    pictures, head = found.pictures, ['regime, third', *(f'{name}, m/s' for name in CHANNELS)]
    names = regimes(pictures.wrench_before)
    return details('The map in numbers', join(table(
        head, map_rows(flights, names, found.vehicle),
        caption='Velocity that the unexplained force and moment cause in half a second, '
                f'{stage} the diagnosis, by channel and regime')
        for stage, flights in (('before', pictures.wrench_before),
                               ('after', pictures.wrench_after))))


def _which(found: Diagnosis) -> list:
    rows = []
    for row in shown_effects(found):
        first = [titled(row.effect), form_of(found, row), f'{row.probability:.2f}',
                 contribution_of(row), without_it(found, row)]
        for name, one in row.parameters.items():
            spread = WIDE * one.std
            rows.append([*first, name, f'{one.value:.4g}{change_of(one)}',
                         f'{one.value - spread:.4g} to {one.value + spread:.4g}', one.unit])
            first = [''] * len(first)
        if not row.parameters:
            rows.append([*first, '', '', '', ''])
    estimates = ([table(['effect', 'form, explains', 'probability', 'contribution',
                         'velocity gap without it, m/s', 'parameter', 'estimate',
                         '95 % interval', 'unit'], rows,
                        kinds=('text', 'text', '', '', '', 'text', '', '', 'text'),
                        caption='Effects of the model that explains the flights best')]
                 if rows else [tag('p', 'No effect is probable.')])
    return [tag('h2', 'Which effects'), *estimates, _probabilities(found),
            *_listed([*minor_lines(found), *one_finding_lines(found)])]


def _probabilities(found: Diagnosis) -> Markup:
    return table(['effect', 'probability'], [
        [titled(row.effect), join([f'{row.probability:.2f}', bar(row.probability)], ' ')]
        for row in found.ranking], ('text', 'text'),
        caption='Probability of each effect of being present')


def _far(found: Diagnosis, pictures: dict) -> list:
    return [tag('h2', 'How far'), tag('p', sentence(far_line(found))),
            tag('p', sentence(ceiling_line(found))),
            table(FAR, far_rows(found), kinds=('text', *[''] * 5, 'text'),
                  caption=f'Error of predictions {found.gap.horizon:g} s ahead'),
            table(['s ahead', *AHEAD], ahead_rows(found),
                  caption='Velocity error by horizon, m/s'),
            pictures['horizons'], pictures['predictions'],
            *([pictures['path']] if 'path' in pictures else [])]


def _in_simulator(found: Diagnosis) -> list:
    one = found.in_simulator
    if one is None:
        return []
    rows = [where_row(row) for row in shown(one.where)]
    return [tag('h2', 'In the simulator'), tag('p', sentence(simulator_line(one, found))),
            table(IN_SIMULATOR, simulator_rows(found), kinds=('text', *[''] * 6, 'text'),
                  caption=f'Error of predictions {one.horizon:g} s ahead in {one.simulator}'),
            table(WHERE, rows, kinds=('text', '', '', '', 'text', ''),
                  caption='Force and moment that the simulator does not explain')]


def _closed_loop(found: Diagnosis) -> list:
    one = found.closed_loop
    if one is None:
        return []
    costs = ([table(COSTS, cost_rows(one), kinds=('text', 'text', '', '', '', 'text'),
                    caption=sentence(COST_LINE))] if one.without else [])
    return [tag('h2', 'In closed loop'), tag('p', sentence(loop_line(one, found.held_out))),
            table(TITLES, loop_rows(one), kinds=('text', '', '', '', 'text'),
                  caption=f'Tracking error and bandwidth with {one.controller}'), *costs]


def _open(found: Diagnosis) -> list:
    """Return what the flights leave open, and which flights would settle it."""
    lines = [*open_lines(found), *nuisance_lines(found)]
    parts = [tag('h2', 'What remains open'), *_listed(lines)] if lines else []
    if found.fly_next:
        parts += [tag('h2', 'What to fly next'),
                  table(NEXT, [next_row(one) for one in found.fly_next],
                        kinds=('text', 'text', '', '', '', '', ''),
                        caption='Manoeuvres that would decide what is open')]
    return parts


def _listed(lines: list[str]) -> list:
    """Return lines as sentences of a list; nothing where there are none."""
    items = join(tag('li', sentence(line.strip())) for line in lines)
    return [Markup(f'<ul>{items}</ul>')] if lines else []


def _provenance(found: Diagnosis) -> list:
    """Return what the diagnosis comes from: run, files, flights, vehicle."""
    run = found.run
    made = f'Made by quad_ident_ros {__version__}' + (f' on {run.date} with' if run else '.')
    parts = [tag('h2', 'Provenance'),
             tag('p', f'Fitted to {", ".join(found.flights)}; held out: {found.held_out}.'),
             tag('p', join([made, tag('code', run.command)], ' ') if run else made)]
    findings = Counter(one['flight'] for one in found.findings)
    rows = [[one.flight, f'{one.duration:.2f}', f'{one.rate:.4g}', str(one.samples),
             str(findings[one.flight])] for one in found.recorded]
    if rows:
        parts.append(table(['flight', 'duration, s', 'rate, Hz', 'samples', 'findings'], rows,
                           caption='Flights as recorded'))
    if found.findings:
        parts.append(table(['flight', 'where', 'finding', 'what to do'], [
            [one['flight'], *map(_prose, (titled(one['where']), one['message'], one['remedy']))]
            for one in found.findings], ('text',) * 4, caption='Findings'))
    if run:
        parts.append(table(['file', 'SHA-256'], [
            [path, Markup(f'<td class="prose"><code>{whole}</code></td>')]
            for path, whole in run.files.items()], ('text', 'text'), caption='Files'))
    text = yaml.safe_dump(vehicle_to_mapping(found.vehicle), sort_keys=False,
                          default_flow_style=None)
    return [*parts, details('Vehicle file in full', Markup(
        f'<pre tabindex="0">{markup(text)}</pre>'))]


def _prose(text: str) -> Markup:
    return tag('td', text, 'prose')
