# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The score as tables in Markdown, for the screen and for docs/withheld.md."""

from withheld.goals import goals
from withheld.score import BINS, TITLES

STRENGTHS = ('0.3', '1', '3', '10')
MET = {True: 'met', False: '**missed**', None: '-'}


def percent(part):
    """Return 'rate (count)' of a measure."""
    if not part or part['rate'] is None:
        return '-'
    return f'{100 * part["rate"]:.0f} % ({part["count"]})'


def closed(part):
    """Return median and worst tenth of the share closed."""
    return '-' if not part else f'{part["median"]:.2f} / {part["tenth"]:.2f} ({part["count"]})'


def markdown(found):
    """Return all tables of a score."""
    return '\n\n'.join([
        *_goals(found), *_not_flown(found), _groups(found), _claims(found), _effects(found),
        _coverage(found), *_calibration(found), *_hybrids(found)])


def _goals(found):
    """Return the table of goals, and below it each that was missed with its cases."""
    rows = goals(found)
    table = _rows(('goal', 'column', 'reached', 'target', ''),
                  [(row.what, TITLES[row.column], row.figure, row.target or '-', MET[row.met])
                   for row in rows])
    lines = []
    for row in rows:
        if row.missed or row.met is False:
            lines += [f'- {row.what}, {TITLES[row.column]}: {row.figure}'
                      + (f' ({row.target})' if row.target else ''),
                      *(f'  - {case}' for case in row.missed)]
    return [table] + (['Missed, with the cases:\n\n' + '\n'.join(lines)] if lines else [])


def _not_flown(found):
    """Return what was asked for and could not be flown, in a list."""
    some = found.get('not_flown')
    return ['Not flown:\n\n' + '\n'.join(f'- {line}' for line in some)] if some else []


def _rows(head, rows):
    lines = [head, ['---'] * len(head), *rows]
    return '\n'.join('| ' + ' | '.join(str(cell) for cell in line) + ' |' for line in lines)


def _groups(found):
    rows = [(name, one['count'], percent(one['first']), percent(one['exact']),
             percent(one['alarm']), percent(one['unknown']), percent(one['instead']),
             f'{one["undetermined"]} ({one["undetermined_right"]})', percent(one['refused']),
             percent(one['f1']), closed(one['closed'])) for name, one in found['groups'].items()]
    chance = found['chance']
    rows.append(('chance', found['count'], *(
        '-' if chance[key] is None else f'{100 * chance[key]:.0f} %'
        for key in ('first', 'exact')), *['-'] * 7))
    return _rows(('cases (strength)', 'count', 'first', 'exact set', 'false alarm', 'unknown said',
                  'instead of the effect',
                  'undetermined (with the truth)', 'refused', 'F1',
                  'closed: median / worst tenth'), rows)


def _claims(found):
    seconds = found['seconds'] or {'median': 0.0, 'most': 0.0}
    agrees = found['gap_agrees']
    return (f'A diagnosis took {seconds["median"]:.1f} s of a core (most: '
            f'{seconds["most"]:.1f} s). The gap before any effect, as the diagnosis and as the '
            f'check reckon it, differs by at most '
            f'{"-" if agrees is None else f"{100 * agrees:.1f} %"}.')


def _effects(found):
    rows = []
    for name, by in found['effects'].items():
        rows.append((f'`{name}`', *(percent(by[s]['first']) if s in by else '-'
                                    for s in STRENGTHS),
                     *(percent(by[s]['exact']) if s in by else '-' for s in STRENGTHS),
                     *(closed(by[s]['closed']) if s in by else '-' for s in STRENGTHS[1:])))
    return _rows(('effect', *(f'first, {s}' for s in STRENGTHS),
                  *(f'exact, {s}' for s in STRENGTHS),
                  *(f'closed, {s}' for s in STRENGTHS[1:])), rows)


def _coverage(found):
    columns = {name: one['coverage'] for name, one in found['columns'].items()}
    names = list(dict.fromkeys(effect for one in columns.values() for effect in one))
    return _rows(('95 % intervals that hold the truth', *(TITLES[name] for name in columns)),
                 [(name, *(percent(one.get(name)) for one in columns.values()))
                  for name in names])


def _calibration(found):
    """Return the reliability table by group, with its errors, in a list, empty without any."""
    parts = {'all': found['calibration']} | {
        TITLES[name]: column['calibration'] for name, column in found['columns'].items()}
    parts = {title: one for title, one in parts.items() if one}
    bins = sorted({(row['from'], row['to']) for one in parts.values() for row in one['table']})
    rows = [(f'{low:g} to {high:g}', *(_bin(one, low) for one in parts.values()))
            for low, high in bins]
    rows += [
        (f'error, {BINS[1]:g} to {BINS[-2]:g}', *(
            '-' if one['middle'] is None else f'{one["middle"]:.3f} ({one["middle_count"]})'
            for one in parts.values())),
        ('error', *(f'{one["error"]:.3f} ({one["count"]})' for one in parts.values())),
        ('Brier score / of always the share present', *(
            f'{one["brier"]:.4f} / {one["brier_of_base_rate"]:.4f}' for one in parts.values()))]
    return [_rows(('probability: mean given / present (count)', *parts), rows)] if parts else []


def _bin(one, low):
    """Return 'mean given / present (count)' of the bin that begins at low."""
    return next((f'{row["given"]:.3f} / {row["present"]:.3f} ({row["count"]})'
                 for row in one['table'] if row['from'] == low), '-')


def _hybrids(found):
    """Return the table of the changes to real flights, in a list, empty where there are none."""
    words = {True: 'yes', False: 'no', None: '-'}
    rows = [(f'`{row["change"]}`', words[row['right']], words[row['gained']],
             words[row['moved']], ', '.join(row['added']) or '-', ', '.join(row['lost']) or '-')
            for row in found['hybrids']]
    return [_rows((TITLES['hybrids'], 'right', 'newly named', 'moved as much', 'also named',
                   'no longer'), rows)] if rows else []
