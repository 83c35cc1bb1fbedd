# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagnosis as a table that a person reads in ten seconds."""

from collections import Counter
from collections.abc import Iterable
import re
from typing import TextIO

from rich import box
from rich.console import Console
from rich.table import Table

from quad_ident_ros.diagnose.result import (
    BLOCKS,
    Channel,
    Diagnosis,
    Gap,
    GapGivenAttitude,
    GapInSimulator,
    Ranked,
    Unexplained,
    Value,
)
from quad_ident_ros.diagnose.rules import RULES

WIDTH = 118     # columns that the widest row needs
WORTH = 0.02        # probability or share from which on a row is shown

NOTHING_TO_CLOSE = "the velocity gap is not above the noise's, so that there is nothing to close"

NUMBER = re.compile(r'[-+]?\d+(\.\d+)?(e[-+]?\d+)?')

WHERE = ('channel', 'share', 'rms', 'noise alone', 'where most of it is', 'Hz')
"""What where_row says of a channel."""

FAR = ('', 'nominal', 'with nuisances', 'after', 'noise', 'unit')
"""What far_rows say of a group of outputs."""

IN_SIMULATOR = ('', 'as it is', 'with nuisances', 'with the effects', 'our model after',
                'noise', 'off nominal', 'unit')
"""What simulator_rows say of a group of outputs in a simulator of the user."""

NEXT = ('manoeuvre', 'to', 'standard errors now', 'with it', 'size', 'height', 'speed up to')
"""What next_row says of a manoeuvre."""


def show(found: Diagnosis, stream: TextIO) -> None:
    """Print a Diagnosis to a stream: the verdict first."""
    screen = Console(file=stream, width=WIDTH, markup=False, emoji=False)

    def say(text: str, style: str | None = None) -> None:
        screen.print(text, style=style, markup=False, highlight=False, soft_wrap=True)

    say(f'verdict: {verdict_line(found)}', 'bold')
    say(size_line(found))
    say('')
    say('where: force and moment that the nominal vehicle does not explain')
    screen.print(_table(WHERE, [where_row(row) for row in shown(found.where)]))
    say('which')
    screen.print(_which(found))
    for line in (*minor_lines(found), *one_finding_lines(found)):
        say(line)
    say('')
    say(far_line(found))
    screen.print(_table(FAR, far_rows(found)))
    if found.in_simulator:
        say(simulator_line(found.in_simulator, found))
        screen.print(_table(IN_SIMULATOR, simulator_rows(found)))
        say('where: force and moment that the simulator does not explain')
        screen.print(_table(WHERE, [where_row(row) for row in shown(found.in_simulator.where)]))
    for line in (*open_lines(found), *nuisance_lines(found)):
        say(line)
    if found.fly_next:
        say('what to fly next')
        screen.print(_table(NEXT, [next_row(one) for one in found.fly_next]))


def verdict_line(found: Diagnosis) -> str:
    """Return the verdict in words."""
    said = ', '.join(found.verdict)
    if found.verdict == ('none',):
        said += ': the nominal vehicle explains the flights to within noise and tolerance'
    if 'unknown' in found.verdict:
        said += ': no known effect explains all of the gap'
    if found.undetermined:
        said += f': the flights cannot tell between {", ".join(found.undetermined)}'
        if found.verdict == ('undetermined',) and found.sure:
            said += f'; sure beside them: {", ".join(found.sure)}'
    return said


def size_line(found: Diagnosis) -> str:
    """Return how large the gap of the velocity is before and after, as a sentence."""
    gap = found.gap
    before, after, noise = (stage['velocity'] for stage in (gap.before, gap.after, gap.noise))
    said = (f'On {found.held_out}, which took no part, the velocity {gap.horizon:g} s ahead is '
            f'off by {before:.3g} m/s with the nominal vehicle')
    if gap.without:
        said += f', by {after:.3g} m/s with the effects named'
    said += f'; noise alone makes {noise:.3g} m/s.'
    if gap.without and not above_noise(gap):
        return f'{said} {NOTHING_TO_CLOSE[0].upper()}{NOTHING_TO_CLOSE[1:]}.'
    return said if not gap.without else (
        f'{said} {100 * gap.closed:.0f} % of the gap above the noise is closed.')


def above_noise(gap: Gap | GapGivenAttitude | GapInSimulator) -> bool:
    """Whether the nominal vehicle, nuisances taken out, is farther off than the noise is."""
    return gap.before_own['velocity'] > gap.noise['velocity']


def closed_of(gap: Gap | GapGivenAttitude | GapInSimulator) -> str:
    """Return how much of a velocity gap is closed, in words."""
    return (f'{100 * gap.closed:.0f} % of the velocity gap above the noise is closed'
            if above_noise(gap) else NOTHING_TO_CLOSE)


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
    """Return the effects that are named, or probable enough for a row."""
    named = {*found.verdict, *(one.effect for one in found.minor)}
    return [row for row in found.ranking if row.probability >= WORTH or row.effect in named]


def form_of(row: Ranked) -> str:
    """Return the form of an effect and how much of the effect it explains, in words."""
    if row.form is None:
        return ''
    return row.form if row.explained is None else f'{row.form}, {100 * row.explained:.0f} %'


def contribution_of(row: Ranked) -> str:
    """Return in words the share of the closable gap that is lost without an effect."""
    return '' if row.contribution is None else f'{100 * row.contribution:.0f} %'


def without_it(found: Diagnosis, row: Ranked) -> str:
    """Return in words the velocity gap (m/s) of the flight held out without an effect."""
    gap = found.gap.without.get(row.effect)
    return '' if gap is None else f'{gap["velocity"]:.3g}'


def minor_lines(found: Diagnosis) -> list[str]:
    """Return what is there and does not matter, in words."""
    alike = [(f'closing less than {100 * RULES.material:.0f} %',
              [one for one in found.minor if one.contribution < RULES.material]),
             ('closing no more than the error of form of the other effects may be',
              [one for one in found.minor if one.contribution >= RULES.material])]
    return [f'also there, but {why}: ' + ', '.join(
        f'{one.effect} ({100 * max(one.contribution, 0.0):.1f} %, probability '
        f'{one.probability:.2f})' for one in some) for why, some in alike if some]


def one_finding_lines(found: Diagnosis) -> list[str]:
    """Return what motion cannot tell apart from an effect that is named, and what tells it."""
    lines = []
    for row in found.one_finding:
        may_be = ', '.join(' or '.join(names) for names in row['may_be'])
        lines.append(f'{row["effect"]} may as well be another cause of the same motion'
                     + (f' ({may_be})' if may_be else '') + f'; what tells: {row["tells"]}')
    return lines


def far_line(found: Diagnosis) -> str:
    """Return how much of the velocity gap is closed, open loop and given the attitude."""
    gap, given = found.gap, found.gap_given_attitude
    said = f'how far, on {found.held_out} (held out), {gap.horizon:g} s ahead: '
    if above_noise(gap) and above_noise(given):
        return (f'{said}of the velocity gap above the noise {100 * gap.closed:.0f} % is closed, '
                f'given the recorded attitude {100 * given.closed:.0f} %')
    return f'{said}{closed_of(gap)}; given the recorded attitude, {closed_of(given)}'


def far_rows(found: Diagnosis) -> list[list[str]]:
    """Return the cells of every group of outputs: open loop, then given the attitude."""
    gap, given = found.gap, found.gap_given_attitude
    rows = [[name, _between(gap.before, gap.before_interval, name), f'{gap.before_own[name]:.3g}',
             _between(gap.after, gap.after_interval, name), f'{gap.noise[name]:.3g}', unit]
            for name, unit in gap.units.items()]
    return rows + [[f'{name} given attitude',
                    *(f'{stage[name]:.3g}' for stage in (given.before, given.before_own,
                                                         given.after, given.noise)),
                    gap.units[name]] for name in given.before]


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
    """Return what the verdict does not explain, what did not show and what to be wary of."""
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
        lines.append(f'would not show at their usual size: {", ".join(found.not_shown)}')
    return lines + caution_lines(found)


def nuisance_lines(found: Diagnosis) -> list[str]:
    """Return what was estimated for each flight apart, in words."""
    lines = []
    for name, one in (found.nuisances or {}).items():
        lines.append(f'{name} ({one["what"]}), {one["unit"]}: {_values(one)}')
        if one.get('hidden_delay'):
            lines.append(f'a delay of all flights of up to {1e3 * one["hidden_delay"]:.0f} ms '
                         'cannot be told from the clocks')
    return ['estimated per flight, not reported as effects:',
            *(f'  {line}' for line in lines)] if lines else []


def _values(one: dict) -> str:
    """Return the values of each flight, the held-out one last."""
    *flights, held_out = (' '.join(f'{value:.2g}' for value in values)
                          for values in (*one['values'], one['held_out']))
    return f'{"; ".join(flights)}; held out {held_out}'


def caution_lines(found: Diagnosis) -> list[str]:
    """
    Return what to be wary of, a line for each kind of it.

    A held-out flight that the effects found lead away from, and what was found in the records:
    what is said of several flights in the same words, whatever the numbers, is one line.
    """
    farther = [f'be wary of {found.held_out} (held out): it is farther from the model with the '
               'effects named than without: it was flown otherwise, or by another vehicle']
    alike: dict = {}
    said: Counter = Counter()
    for one in found.findings:
        words = (one['code'], one['where'].partition(', t =')[0],
                 NUMBER.sub('#', one['message']))
        said[one['flight'], words] += 1
        alike.setdefault((words, said[one['flight'], words]), []).append(one)
    lines = [f'{"" if first.get("severity") == "info" else "be wary of "}{first["flight"]}'
             + (f' ({", ".join(one["flight"] for one in others)} alike)' if others else '')
             + f': {first["where"]}: {first["message"]}' for first, *others in alike.values()]
    return [*(farther if found.gap.closed < 0.0 else []), *_of_simulator(found), *lines]


def _of_simulator(found: Diagnosis) -> list[str]:
    """Return that a simulator flies otherwise than the vehicle file says, where that matters."""
    one = found.in_simulator
    far = [] if one is None else [
        f'{name} by {value:.3g} {found.gap.units[name]}'
        for name, value in one.from_nominal.items() if value > found.tolerance[name]]
    return [f'be wary of {one.simulator}: {one.horizon:g} s ahead it is apart from the nominal '
            f'vehicle ({", ".join(far)}), to which the effects were fitted: make the vehicle file '
            'that of the simulator'] if one and far else []


def next_row(one: dict) -> list[str]:
    """Return the cells of a proposal of what to fly next."""
    low, high = one['height']
    names = ', '.join(one['effects'])
    return [f'{one["trajectory"]}, {one["duration"]:g} s',
            f'tell apart {names}' if one['purpose'] == 'separate' else f'see {names}',
            *(f'{value:.1f}' if value < 10 else f'{value:.0f}' for value in (one['now'],
                                                                             one['after'])),
            f'{max(one["span"][:2]):.1f} m', f'{low:.1f} to {high:.1f} m',
            f'{one["speed"]:.1f} m/s']


def change_of(parameter: Value) -> str:
    """Return what a parameter is more than in the vehicle file, where that has the effect."""
    return '' if parameter.change is None else f' ({parameter.change:+.3g} to the file)'


def _which(found: Diagnosis) -> Table:
    rows = []
    for row in shown_effects(found):
        values = ', '.join(f'{name} {one.value:.4g} ± {one.std:.2g} {one.unit}'.removesuffix(' 1')
                           + change_of(one) for name, one in row.parameters.items())
        rows.append([row.effect, form_of(row), f'{row.probability:.2f}', contribution_of(row),
                     values, without_it(found, row)])
    return _table(('effect', 'form, explains', 'probability', 'contribution', 'parameters',
                   'velocity gap\nwithout it, m/s'), rows or [['none', *[''] * 5]])


def _table(names: tuple, rows: list) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    for name in names:
        table.add_column(name, overflow='fold')
    for row in rows:
        table.add_row(*row)
    return table
