# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagnosis as a table that a person reads in ten seconds."""

from rich import box
from rich.console import Console
from rich.table import Table

WIDTH = 118     # columns that the widest row needs
WORTH = 0.02        # probability or share from which on a row is shown


def show(data, stream):
    """Print a diagnosis (the project's JSON as data) to a stream: the verdict first."""
    screen = Console(file=stream, width=WIDTH)

    def say(text, style=None):
        screen.print(text, style=style, markup=False, highlight=False, soft_wrap=True)

    say(f'verdict: {verdict_line(data)}', 'bold')
    gap = data['gap']
    say('')
    say('where: what the nominal vehicle lacks')
    screen.print(_where(data['where']))
    say('which')
    screen.print(_which(data['ranking']))
    say(f'how far, on {data["held_out"]} (held out), {gap["horizon"]:g} s ahead: '
        f'{100 * gap["closed"]:.0f} % of the velocity gap above the noise is closed')
    screen.print(_far(gap))
    for line in own_lines(data):
        say(line)
    for row in data['unknown'] or ():
        say(f'unexplained: {row["channel"]} depends on {row["depends_on"]} '
            f'({100 * row["share"]:.0f} % of what is left there)')
    if data['not_shown']:
        say(not_shown_line(data))
    for line in caution_lines(data):
        say(line)
    if data['fly_next']:
        say('what to fly next')
        screen.print(_next(data['fly_next']))


def verdict_line(data):
    """Return the verdict in words."""
    verdict = data['verdict']
    if verdict == ['none']:
        return 'none: nothing but measurement noise is left'
    said = ', '.join(verdict)
    if data['undetermined']:
        said += f': the flights cannot tell between {", ".join(data["undetermined"])}'
        if verdict == ['undetermined'] and data['sure']:
            said += f'; sure beside them: {", ".join(data["sure"])}'
    return said


def own_lines(data):
    """Return what each flight has of its own, in words."""
    lines = []
    for name, own in (data['nuisances'] or {}).items():
        lines.append(f"each flight's own {name} ({own['what']}) is no effect: {_own(own)}")
        if own.get('hidden_delay'):
            lines.append(f'a delay of all flights of up to {1e3 * own["hidden_delay"]:.0f} ms '
                         'cannot be told from the clocks')
    return lines


def not_shown_line(data):
    """Return what the flights could not show, in words."""
    return f'would not show at their usual size: {", ".join(data["not_shown"])}'


def caution_lines(data):
    """
    Return what to be wary of, a line for each kind of it.

    A held-out flight that the effects found lead away from, and what was found in the records, if
    they were looked at.
    """
    farther = [f'be wary of {data["held_out"]} (held out): it is farther from the model with the '
               'effects found than without: it was flown otherwise, or by another vehicle']
    alike = {}
    for one in data.get('findings', ()):
        alike.setdefault((one['code'], one['where'].partition(', t =')[0]), []).append(one)
    found = [f'be wary of {first["flight"]}'
             + (f' ({", ".join(one["flight"] for one in others)} alike)' if others else '')
             + f': {first["where"]}: {first["message"]}' for first, *others in alike.values()]
    return [*(farther if data['gap']['closed'] < 0.0 else []), *found]


NEXT = ('manoeuvre', 'to', 'standard errors now', 'with it', 'size', 'height', 'speed up to')
"""What next_row says of a manoeuvre."""


def next_row(one):
    """Return the cells of a proposal of what to fly next."""
    low, high = one['height']
    names = ', '.join(one['effects'])
    return [f'{one["trajectory"]}, {one["duration"]:g} s',
            f'tell apart {names}' if one['purpose'] == 'separate' else f'see {names}',
            *(f'{value:.1f}' if value < 10 else f'{value:.0f}' for value in (one['now'],
                                                                             one['after'])),
            f'{max(one["span"][:2]):.1f} m', f'{low:.1f} to {high:.1f} m',
            f'{one["speed"]:.1f} m/s']


def _next(proposals):
    table = _table(*NEXT)
    for one in proposals:
        table.add_row(*next_row(one))
    return table


def _own(own):
    """Return the values of each flight, the held-out one last."""
    *flights, held_out = (' '.join(f'{value:.2g}' for value in values)
                          for values in (*own['values'], own['held_out']))
    return f'{"; ".join(flights)}; held out {held_out} {own["unit"]}'


def _far(gap):
    table = _table('', 'before', 'after', 'noise alone', 'unit')
    for name, unit in gap['units'].items():
        table.add_row(name, *(_interval(gap, key, name) for key in ('before', 'after')),
                      f'{gap["noise"][name]:.3g}', unit)
    for name, values in gap['without'].items():
        table.add_row(f'velocity, all but {name}', '', f'{values["velocity"]:.3g}', '', 'm/s')
    return table


def _interval(gap, key, name):
    low, high = gap[f'{key}_interval'][name]
    return f'{gap[key][name]:.3g} ({low:.3g} to {high:.3g})'


def _which(ranking):
    table = _table('effect', 'probability', 'parameters', 'velocity gap with it alone, m/s')
    for row in ranking:
        if row['probability'] >= WORTH:
            values = ', '.join(f'{name} {one["value"]:.4g} ± {one["std"]:.2g} {one["unit"]}'
                               .removesuffix(' 1') for name, one in row['parameters'].items())
            alone = row['gap_after']
            table.add_row(row['effect'], f'{row["probability"]:.2f}', values,
                          f'{alone["velocity"]:.3g}' if values else '')
    if not table.row_count:
        table.add_row('none', '', '', '')
    return table


def _where(rows):
    table = _table('channel', 'share', 'rms', 'noise alone', 'where most of it is', 'Hz')
    for row in rows:
        if row['share'] >= WORTH:
            table.add_row(row['channel'], f'{100 * row["share"]:.0f} %',
                          f'{row["rms"]:.3g} {row["unit"]}', f'{row["noise_rms"]:.3g}',
                          row['regime'], band_of(row))
    return table


def band_of(row):
    """Return the frequency band of a channel, Hz, in words."""
    low, high = row['band']
    return f'{low:.2g} to {high:.2g}' if high > 0.0 else 'constant'


def _table(*names):
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), header_style='bold')
    for name in names:
        table.add_column(name, overflow='fold')
    return table
