# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the check is to reach, and what a score reached of it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Goal:
    """
    What one column is to reach, as shares; None where nothing is asked.

    first; exact sets of singles, pairs, mixtures; alarm on `none`; unknown recognised, and said
    instead of the effect; coverage (least, most); calibration error of the middle; closed
    (median, worst tenth).
    """

    first: float
    exact: tuple
    alarm: float | None
    unknown: float | None
    instead: float
    coverage: tuple
    calibration: float
    closed: tuple


_OTHER = Goal(0.95, (0.88, 0.80, 0.60), None, None, 0.05, (0.85, 0.99), 0.15, (0.90, 0.70))
_STATES = Goal(0.95, (0.88, 0.80, 0.60), 0.05, 0.80, 0.05, (0.85, 0.99), 0.15, (0.90, 0.70))
GOALS = {
    'ours': Goal(0.99, (0.97, 0.95, 0.80), 0.02, 0.90, 0.02, (0.93, 0.97), 0.10, (0.99, 0.95)),
    'forms': _OTHER,
    # Files and logs are held to what other forms and estimator states are.
    'files': _STATES, 'logs': _STATES, 'estimator': _STATES,
    'faulty': Goal(0.95, (0.88, 0.80, 0.60), 0.05, 0.80, 0.05, (0.90, 0.99), 0.15, (0.95, 0.80)),
}
SIDES = {'single': 'single', 'pair': 'pairs', 'mixture': 'mixtures'}
CLEAR = 0.5     # from what is true: a probability in the middle that is further off


@dataclass(frozen=True)
class Reached:
    """
    One goal of one column.

    what; column; figure as text; target as text, '' where nothing is asked; met, None where there
    is no figure or no target; missed: the cases that it was missed in, as text.
    """

    what: str
    column: str
    figure: str
    target: str = ''
    met: bool | None = None
    missed: tuple[str, ...] = ()


def goals(found: dict) -> list[Reached]:
    """Return the Reached of a score, goal by goal and within each column by column."""
    columns = [_Column(name, found) for name in GOALS if name in found['columns']]
    rows = [(_Column.first,), *((_Column.exact, kind) for kind in SIDES), (_Column.alarm,),
            (_Column.unknown,), (_Column.instead,), (_Column.coverage,), (_Column.calibration,),
            (_Column.closed, 'median'), (_Column.closed, 'tenth'), (_Column.refused,)]
    return [make(column, *which) for make, *which in rows for column in columns] + _changes(found)


class _Column:
    """The goals of one column."""

    def __init__(self, name, found):
        self.name, self.goal, self.all = name, GOALS[name], found['columns'][name]
        self.groups = {key.split(': ')[1]: one for key, one in found['groups'].items()
                       if key.startswith(f'{name}: ')}
        self.cases = [case for case in found['cases'] if case['column'] == name]

    def _rate(self, key, *kinds):
        """Return (rate, count) of a measure over groups."""
        some = [self.groups[kind][key] for kind in kinds if kind in self.groups]
        count = sum(one['count'] for one in some)
        total = sum(one['rate'] * one['count'] for one in some if one['count'])
        return (total / count if count else None), count

    def _reached(self, what, rate, count, least=None, most=None, wrong=lambda case: False):
        """Return the Reached of a rate; wrong(case) says whether a case counts against it."""
        if rate is None:
            return Reached(what, self.name, '-', _target(least, most))
        figure = f'{100 * rate:.0f} %' + ('' if count is None else f' of {count}')
        if least is None and most is None:
            return Reached(what, self.name, figure, missed=self._texts_of(wrong))
        met = (least is None or rate >= least - 1e-9) and (most is None or rate <= most + 1e-9)
        return Reached(what, self.name, figure, _target(least, most), met,
                       () if met else self._texts_of(wrong))

    def _texts_of(self, wrong):
        return tuple(case['text'] for case in self.cases if wrong(case))

    def first(self):
        kinds = ('single 1', 'single 3')
        return self._reached(
            'right effect first, strength 1 and 3', *self._rate('first', *kinds),
            least=self.goal.first,
            wrong=lambda case: case['group'] in kinds and case['first'] is False)

    def exact(self, kind):
        least = dict(zip(('single', 'pair', 'mixture'), self.goal.exact, strict=True))[kind]
        return self._reached(
            f'exact set, {SIDES[kind]}', *self._rate('exact', kind), least=least,
            wrong=lambda case: case['kind'] == kind and case['exact'] is False)

    def alarm(self):
        return self._reached('false alarms on `none`', *self._rate('alarm', 'none'),
                             most=self.goal.alarm, wrong=lambda case: case['alarm'])

    def unknown(self):
        return self._reached(
            '`unknown` recognised', *self._rate('unknown', 'unknown'), least=self.goal.unknown,
            wrong=lambda case: case['kind'] == 'unknown' and case['unknown'] is False)

    def instead(self):
        one = self.all['instead']
        return self._reached('`unknown` instead of the effect', one['rate'], one['count'],
                             most=self.goal.instead, wrong=lambda case: case['instead'])

    def coverage(self):
        one = self.all['coverage'].get('all', {'rate': None, 'count': 0})
        few = one['rate'] is not None and one['rate'] < self.goal.coverage[0]
        return self._reached('coverage of 95 % intervals', one['rate'], one['count'],
                             *self.goal.coverage, wrong=lambda case: few and case['outside'])

    def calibration(self):
        what, most = 'calibration error over 0.05 to 0.95', self.goal.calibration
        one = self.all['calibration']
        if one is None or one['middle'] is None:
            return Reached(what, self.name, '-', f'≤ {most:g}')
        met = one['middle'] <= most
        return Reached(what, self.name, f'{one["middle"]:.2f} of {one["middle_count"]}',
                       f'≤ {most:g}', met,
                       () if met else self._texts_of(lambda case: case['misjudged'] > CLEAR))

    def closed(self, key):
        least = dict(zip(('median', 'tenth'), self.goal.closed, strict=True))[key]
        one = self.all['closed']
        what = f'share of the gap closed, {"median" if key == "median" else "worst tenth"}'
        return self._reached(
            what, one and one[key], None, least=least,
            wrong=lambda case: case['closed'] is not None and case['closed'] < least)

    def refused(self):
        one = self.all['refused']
        return self._reached('refused', one['rate'], one['count'],
                             wrong=lambda case: case['refused'])


def _changes(found: dict) -> list[Reached]:
    """Return the Reached of the changes to real flights, of which no share is asked."""
    rows = found['hybrids']
    if not rows:
        return []
    wrong, refused = ([row['text'] for row in rows if row[key] is value]
                      for key, value in (('right', False), ('refused', True)))
    told = sum(row['right'] is not None for row in rows)
    return [Reached('the change named, and nothing else', 'hybrids',
                    _share(told - len(wrong), told), missed=tuple(wrong)),
            Reached('refused', 'hybrids', _share(len(refused), len(rows)),
                    missed=tuple(refused))]


def _share(count: int, whole: int) -> str:
    return f'{100 * count / whole:.0f} % of {whole}' if whole else '-'


def _target(least: float | None, most: float | None) -> str:
    if least is not None and most is not None:
        return f'{100 * least:.0f} to {100 * most:.0f} %'
    if least is not None:
        return f'≥ {100 * least:.0f} %'
    return '' if most is None else f'≤ {100 * most:.0f} %'
