# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagnosis as a table that a person reads in ten seconds."""

from collections import Counter
from collections.abc import Iterable
import re
from typing import TextIO

from rich.table import Table

from quad_ident_ros.diagnose.result import (
    BLOCKS,
    Channel,
    Diagnosis,
    GapInSimulator,
    Ranked,
    Unexplained,
)
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import EFFECTS, titled
from quad_ident_ros.report.ceiling import ceiling_line
from quad_ident_ros.report.closed_loop import (
    COST_LINE,
    cost_rows,
    COSTS,
    loop_line,
    loop_rows,
    TITLES,
)
from quad_ident_ros.report.screen import console, say, table_of
from quad_ident_ros.report.verdict import (
    above_noise,
    closed_of,
    contribution_of,
    form_of,
    next_step,
    size_line,
    values_of,
    verdict_line,
)

VERDICT, USUAL, ALL = 'verdict', 'usual', 'all'
"""How much of a Diagnosis `show` prints."""

WORTH = 0.02    # share from which on a channel has a row, probability from which on it is printed

NUMBER = re.compile(r'[-+]?\d+(\.\d+)?(e[-+]?\d+)?')

WHERE = ('channel', 'share', 'rms', 'noise alone', 'where most of it is', 'Hz')
"""What where_row says of a channel."""

FAR = ('', 'nominal', 'with\nnuisances', 'after', 'ceiling', 'noise', 'unit')
"""What far_rows say of a group of outputs."""

AHEAD = {'nominal': 'before', 'with nuisances': 'before_own', 'after': 'after', 'noise': 'noise'}
"""What ahead_rows say of a horizon, and which stage of the gap that is."""

IN_SIMULATOR = ('', 'as it is', 'with nuisances', 'with the effects', 'our model after',
                'noise', 'off nominal', 'unit')
"""What simulator_rows say of a group of outputs in a simulator of the user."""

NEXT = ('manoeuvre', 'to', 'standard errors now', 'with it', 'size', 'height', 'speed up to')
"""What next_row says of a manoeuvre."""

BELOW = ('what to fly next', 'unexplained', 'would not show', 'vehicle file')
"""What a sentence of the verdict may point to that comes below it."""


def show(found: Diagnosis, stream: TextIO, detail: str = USUAL,
         written: str | None = None) -> None:
    """
    Print a Diagnosis to a stream, the verdict first.

    detail: VERDICT, USUAL or ALL of it; written: the file of --out-vehicle.
    """
    screen = console(stream)
    say(screen, f'verdict: {verdict_line(found)}', 'bold')
    say(screen, size_line(found))
    following = next_step(found, written)
    say(screen, following)
    if detail == VERDICT:
        if any(f'"{name}"' in following for name in BELOW):
            say(screen, 'Without --quiet these are printed.')
        return
    say(screen, '')
    say(screen, 'where: force and moment that the nominal vehicle does not explain')
    screen.print(table_of(WHERE, [where_row(row) for row in shown(found.where)]))
    say(screen, 'which effects cause it')
    screen.print(_which(found))
    for line in (*improbable_lines(found), *minor_lines(found), *one_finding_lines(found)):
        say(screen, line)
    say(screen, '')
    say(screen, far_line(found))
    say(screen, ceiling_line(found))
    screen.print(table_of(FAR, far_rows(found)))
    if detail == ALL:
        say(screen, f'velocity gap on {found.held_out} (held out) by how far ahead, m/s')
        screen.print(table_of(('s ahead', *AHEAD), ahead_rows(found)))
    if found.in_simulator:
        say(screen, simulator_line(found.in_simulator, found))
        screen.print(table_of(IN_SIMULATOR, simulator_rows(found)))
        say(screen, 'where: force and moment that the simulator does not explain')
        screen.print(table_of(WHERE, [where_row(row) for row in shown(found.in_simulator.where)]))
    if found.closed_loop:
        say(screen, loop_line(found.closed_loop, found.held_out))
        screen.print(table_of(TITLES, loop_rows(found.closed_loop)))
        if found.closed_loop.without:
            say(screen, COST_LINE)
            screen.print(table_of(COSTS, cost_rows(found.closed_loop)))
    for line in (*open_lines(found), *(nuisance_lines(found) if detail == ALL else ())):
        say(screen, line)
    if found.fly_next:
        say(screen, 'what to fly next')
        screen.print(table_of(NEXT, [next_row(one) for one in found.fly_next]))


def shown(channels: Iterable[Channel]) -> list[Channel]:
    """Return the Channels that have a share worth a row."""
    return [row for row in channels if row.share >= WORTH]


def where_row(row: Channel) -> list[str]:
    """Return the cells of a Channel."""
    return [row.channel, f'{100 * row.share:.0f} %', f'{row.rms:.3g} {row.unit}',
            f'{row.noise_rms:.3g}', row.regime, band_of(row)]


def band_of(row: Channel | Unexplained) -> str:
    """Return the frequency band of a channel, Hz, in words."""
    low, high = row.band
    return f'{low:.2g} to {high:.2g}' if high > 0.0 else 'constant'


def shown_effects(found: Diagnosis) -> list[Ranked]:
    """Return the effects that are named, and those that the model has beside them."""
    named = {*found.verdict, *found.undetermined, *(one.effect for one in found.minor)}
    return [row for row in found.ranking if row.form is not None or row.effect in named]


def improbable_lines(found: Diagnosis) -> list[str]:
    """Return the probabilities of the effects without a row as a line, if there are any."""
    rows = {row.effect for row in shown_effects(found)}
    others = [row for row in found.ranking if row.effect not in rows]
    told = [f'{titled(row.effect)} {row.probability:.2f}' for row in others
            if row.probability >= WORTH]
    below = len(others) - len(told)
    if below:
        told.append(f'{below}{" other" if told else ""} effect{"s" * (below != 1)} below {WORTH}')
    return [f'probability of effects not in the table: {", ".join(told)}'] if told else []


def without_it(found: Diagnosis, row: Ranked) -> str:
    """Return in words the velocity gap (m/s) of the flight held out without an effect."""
    gap = found.gap.without.get(row.effect)
    return '' if gap is None else f'{gap["velocity"]:.3g}'


def minor_lines(found: Diagnosis) -> list[str]:
    """Return the effects that are present and do not matter, in words."""
    alike = [(f'closing less than {100 * RULES.material:.0f} %',
              [one for one in found.minor if one.contribution < RULES.material]),
             ("closing no more than the other effects' errors of form could",
              [one for one in found.minor if one.contribution >= RULES.material])]
    return [f'also present, but {why}: ' + '; '.join(
        f'{titled(one.effect)}, {100 * max(one.contribution, 0.0):.1f} %, probability '
        f'{one.probability:.2f}' for one in some) for why, some in alike if some]


def one_finding_lines(found: Diagnosis) -> list[str]:
    """Return what motion cannot separate from an effect that is named, and what does."""
    lines = []
    for row in found.one_finding:
        may_be = ', '.join(' or '.join(names) for names in row['may_be'])
        lines.append(f'{titled(row["effect"])}: the same motion comes of '
                     + (may_be or 'another cause')
                     + f'; what distinguishes them: {row["tells"]}')
    return lines


def far_line(found: Diagnosis) -> str:
    """Return what the errors of predictions are, and how much of the velocity gap is closed."""
    gap, given = found.gap, found.gap_given_attitude
    closed = (f'{closed_of(gap)}, {100 * given.closed:.0f} % given the recorded attitude'
              if above_noise(gap) and above_noise(given)
              else f'{closed_of(gap)}; given the recorded attitude, {closed_of(given)}')
    return (f'how far: error of predictions {gap.horizon:g} s ahead on {found.held_out} (held '
            f'out), root mean square with 95 % interval; {closed}')


def far_rows(found: Diagnosis) -> list[list[str]]:
    """Return the cells of every group of outputs: open loop, then given the attitude."""
    gap, given, ceiling = found.gap, found.gap_given_attitude, found.ceiling
    rows = [[name, _between(gap.before, gap.before_interval, name), f'{gap.before_own[name]:.3g}',
             _between(gap.after, gap.after_interval, name),
             f'{ceiling.open_loop.after[name]:.3g}', f'{gap.noise[name]:.3g}', unit]
            for name, unit in gap.units.items()]
    return rows + [[f'{name} given attitude',
                    *(f'{stage[name]:.3g}' for stage in (
                        given.before, given.before_own, given.after,
                        ceiling.given_attitude.after, given.noise)),
                    gap.units[name]] for name in given.before]


def ahead_rows(found: Diagnosis) -> list[list[str]]:
    """Return the cells of every horizon: the velocity gap at each stage."""
    return [[f'{float(seconds):g}', *(f'{one[stage]["velocity"]:.3g}' for stage in AHEAD.values())]
            for seconds, one in found.gap.horizons.items()]


def simulator_line(one: GapInSimulator, found: Diagnosis) -> str:
    """Return how much of the velocity gap of a simulator the effects close around it."""
    return (f'in {one.simulator}, on {found.held_out} (held out), {one.horizon:g} s ahead, with '
            f'the effects added around it: {closed_of(one)}')


def simulator_rows(found: Diagnosis) -> list[list[str]]:
    """Return the cells of every group of outputs in a simulator of the user."""
    one = found.in_simulator
    assert one is not None
    return [[name, *(f'{stage[name]:.3g}' for stage in (
        one.before, one.before_own, one.after, found.gap.after, one.noise, one.from_nominal)),
        unit] for name, unit in found.gap.units.items()]


def _between(gap: dict, interval: dict, name: str) -> str:
    low, high = interval[name]
    return f'{gap[name]:.3g} ({low:.3g} to {high:.3g})'


def open_lines(found: Diagnosis) -> list[str]:
    """Return what the verdict does not explain, what did not show, and warnings."""
    lines = [f'unexplained: {row.channel}, {row.depends_on}, {row.rms:.2g} {row.unit} rms, '
             + (f'{band_of(row)} Hz' if row.band[1] > 0.0 else 'constant')
             for row in found.unknown]
    single = any(one['code'] == BLOCKS for one in found.findings)
    others = 'half of this flight' if single else 'flights'
    for one in found.flight_checks:
        if one.differs:
            times = ', '.join(f'{name} {value:.3g}' for name, value in one.gap_over_noise.items())
            lines.append(f'{one.flight} differs from the other {others}; gap over that of the '
                         f'noise: {times}')
    if found.not_shown:
        names = ', '.join(map(titled, found.not_shown))
        lines.append(f'would not show at their usual size: {names}')
    return lines + caution_lines(found)


def nuisance_lines(found: Diagnosis) -> list[str]:
    """Return what was estimated for each flight apart, in words."""
    lines = []
    for name, one in (found.nuisances or {}).items():
        lines.append(f'{name} ({one["what"]}), {one["unit"]}: {_values(one)}')
        if one.get('hidden_delay'):
            most = 1e3 * one['hidden_delay']
            lines.append(f'a delay common to all flights of up to {most:.0f} ms cannot be '
                         'distinguished from clock offsets')
    return ['estimated per flight, not reported as effects:',
            *(f'  {line}' for line in lines)] if lines else []


def _values(one: dict) -> str:
    """Return the values of each flight, the held-out one last."""
    *flights, held_out = (' '.join(f'{value:.2g}' for value in values)
                          for values in (*one['values'], one['held_out']))
    return f'{"; ".join(flights)}; held out {held_out}'


def caution_lines(found: Diagnosis) -> list[str]:
    """
    Return the warnings of a diagnosis, a line for each kind.

    They concern a held-out flight that the effects predict worse, a simulator that differs from
    the vehicle file, and the records. Warnings on several flights that differ only in their
    numbers are one line.
    """
    farther = [f'warning: {found.held_out} (held out): the model with the effects named predicts '
               'it worse than the nominal one: it was flown differently or by another vehicle']
    alike: dict = {}
    said: Counter = Counter()
    for one in found.findings:
        words = (one['code'], one['where'].partition(', t =')[0],
                 NUMBER.sub('#', one['message']))
        said[one['flight'], words] += 1
        alike.setdefault((words, said[one['flight'], words]), []).append(one)
    lines = [_said(first, [one['flight'] for one in others])
             for first, *others in alike.values()]
    return [*(farther if found.gap.closed < 0.0 else []), *_of_simulator(found), *lines]


def _said(finding: dict, alike: list[str]) -> str:
    """Return a finding as a line, a warning with its remedy; alike: flights that have it, too."""
    others = f' ({", ".join(alike)} alike)' if alike else ''
    said = f'{finding["flight"]}{others}: {titled(finding["where"])}: {finding["message"]}'
    remedy = f'; {finding["remedy"]}' if finding['remedy'] else ''
    return said if finding['severity'] == 'info' else f'warning: {said}{remedy}'


def _of_simulator(found: Diagnosis) -> list[str]:
    """Return a warning where a simulator differs from the vehicle file by more than matters."""
    one = found.in_simulator
    far = [] if one is None else [
        f'{name} by {value:.3g} {found.gap.units[name]}'
        for name, value in one.from_nominal.items() if value > found.tolerance[name]]
    return [f'warning: {one.simulator}: {one.horizon:g} s ahead it differs from the nominal '
            f'vehicle ({", ".join(far)}), to which the effects were fitted: give the vehicle file '
            'the constants of the simulator'] if one and far else []


def next_row(one: dict) -> list[str]:
    """Return the cells of a proposal of what to fly next."""
    low, high = one['height']
    names = ', '.join(map(titled, one['effects']))
    return [f'{one["trajectory"]}, {one["duration"]:g} s',
            f'tell apart {names}' if one['purpose'] == 'separate' else f'see {names}',
            *(f'{value:.1f}' if value < 10 else f'{value:.0f}' for value in (one['now'],
                                                                             one['after'])),
            f'{max(one["span"][:2]):.1f} m', f'{low:.1f} to {high:.1f} m',
            f'{one["speed"]:.1f} m/s']


def _which(found: Diagnosis) -> Table:
    rows = []
    for row in shown_effects(found):
        rows.append([f'{row.effect}\n{EFFECTS[row.effect].title}', form_of(found, row),
                     f'{row.probability:.2f}', contribution_of(row), values_of(row),
                     without_it(found, row)])
    return table_of(('effect', 'form, explains', 'probability', 'contribution', 'parameters',
                     'velocity gap\nwithout it, m/s'), rows or [['none', *[''] * 5]])
