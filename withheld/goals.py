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

# Names of goals, as the tables have them.
FIRST = 'right effect first, strength 1 and 3'
EXACT = {kind: f'exact set, {side}' for kind, side in SIDES.items()}
ALARM = 'false alarms on `none`'
UNKNOWN = '`unknown` recognised'
INSTEAD = '`unknown` instead of the effect'
COVERAGE = 'coverage of 95 % intervals'
CALIBRATION = 'calibration error over 0.05 to 0.95'
CLOSED = {'median': 'share of the gap closed, median',
          'tenth': 'share of the gap closed, worst tenth'}
REFUSED = 'refused'
CHANGE = 'the change named, and nothing else'


def _limits(goal: Goal) -> dict[str, tuple]:
    """Return the (least, most) of each goal of a column by its name, in the order of tables."""
    return {FIRST: (goal.first, None),
            **{what: (least, None)
               for what, least in zip(EXACT.values(), goal.exact, strict=True)},
            ALARM: (None, goal.alarm), UNKNOWN: (goal.unknown, None),
            INSTEAD: (None, goal.instead), COVERAGE: goal.coverage,
            CALIBRATION: (None, goal.calibration),
            **{what: (least, None)
               for what, least in zip(CLOSED.values(), goal.closed, strict=True)},
            REFUSED: (None, None)}


# {(name of the goal, column): (least, most)}, each None where nothing is asked, in the order of
# tables.
LIMITS = {(what, column): _limits(goal)[what]
          for what in _limits(_OTHER) for column, goal in GOALS.items()}
LIMITS |= {(what, 'hybrids'): (None, None) for what in (CHANGE, REFUSED)}


def met(what: str, column: str, reached: float) -> bool | None:
    """Return whether a column meets a goal with what it reached, None where nothing is asked."""
    least, most = LIMITS[what, column]
    if least is None and most is None:
        return None
    return (least is None or reached >= least - 1e-9) and (most is None or reached <= most + 1e-9)


def target(what: str, column: str) -> str:
    """Return what a goal asks of a column as text, '' where nothing is asked."""
    least, most = LIMITS[what, column]
    if what == CALIBRATION:
        return f'≤ {most:g}'
    if least is not None and most is not None:
        return f'{100 * least:.0f} to {100 * most:.0f} %'
    if least is not None:
        return f'≥ {100 * least:.0f} %'
    return '' if most is None else f'≤ {100 * most:.0f} %'


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
    rows = [(_Column.first,), *((_Column.exact, kind) for kind in EXACT), (_Column.alarm,),
            (_Column.unknown,), (_Column.instead,), (_Column.coverage,), (_Column.calibration,),
            *((_Column.closed, key) for key in CLOSED), (_Column.refused,)]
    return [make(column, *which) for make, *which in rows for column in columns] + _changes(found)


class _Column:
    """The goals of one column."""

    def __init__(self, name, found):
        self.name, self.all = name, found['columns'][name]
        self.groups = {key.split(': ')[1]: one for key, one in found['groups'].items()
                       if key.startswith(f'{name}: ')}
        self.cases = [case for case in found['cases'] if case['column'] == name]

    def _rate(self, key, *kinds):
        """Return (rate, count) of a measure over groups."""
        some = [self.groups[kind][key] for kind in kinds if kind in self.groups]
        count = sum(one['count'] for one in some)
        total = sum(one['rate'] * one['count'] for one in some if one['count'])
        return (total / count if count else None), count

    def _reached(self, what, rate, count, wrong):
        """Return the Reached of a rate; wrong(case) says whether a case counts against it."""
        if rate is None:
            return Reached(what, self.name, '-', target(what, self.name))
        figure = f'{100 * rate:.0f} %' + ('' if count is None else f' of {count}')
        reached = met(what, self.name, rate)
        return Reached(what, self.name, figure, target(what, self.name), reached,
                       () if reached else self._texts_of(wrong))

    def _texts_of(self, wrong):
        return tuple(case['text'] for case in self.cases if wrong(case))

    def first(self):
        kinds = ('single 1', 'single 3')
        return self._reached(
            FIRST, *self._rate('first', *kinds),
            lambda case: case['group'] in kinds and case['first'] is False)

    def exact(self, kind):
        return self._reached(EXACT[kind], *self._rate('exact', kind),
                             lambda case: case['kind'] == kind and case['exact'] is False)

    def alarm(self):
        return self._reached(ALARM, *self._rate('alarm', 'none'), lambda case: case['alarm'])

    def unknown(self):
        return self._reached(
            UNKNOWN, *self._rate('unknown', 'unknown'),
            lambda case: case['kind'] == 'unknown' and case['unknown'] is False)

    def instead(self):
        one = self.all['instead']
        return self._reached(INSTEAD, one['rate'], one['count'], lambda case: case['instead'])

    def coverage(self):
        one = self.all['coverage'].get('all', {'rate': None, 'count': 0})
        least, _ = LIMITS[COVERAGE, self.name]
        few = one['rate'] is not None and one['rate'] < least
        return self._reached(COVERAGE, one['rate'], one['count'],
                             lambda case: few and case['outside'])

    def calibration(self):
        one, asked = self.all['calibration'], target(CALIBRATION, self.name)
        if one is None or one['middle'] is None:
            return Reached(CALIBRATION, self.name, '-', asked)
        reached = met(CALIBRATION, self.name, one['middle'])
        return Reached(CALIBRATION, self.name, f'{one["middle"]:.2f} of {one["middle_count"]}',
                       asked, reached,
                       () if reached else self._texts_of(lambda case: case['misjudged'] > CLEAR))

    def closed(self, key):
        one = self.all['closed']
        least, _ = LIMITS[CLOSED[key], self.name]
        return self._reached(
            CLOSED[key], one and one[key], None,
            lambda case: case['closed'] is not None and case['closed'] < least)

    def refused(self):
        one = self.all['refused']
        return self._reached(REFUSED, one['rate'], one['count'], lambda case: case['refused'])


def _changes(found: dict) -> list[Reached]:
    """Return the Reached of the changes to real flights, of which no share is asked."""
    rows = found['hybrids']
    if not rows:
        return []
    wrong, refused = ([row['text'] for row in rows if row[key] is value]
                      for key, value in (('right', False), ('refused', True)))
    told = sum(row['right'] is not None for row in rows)
    return [Reached(CHANGE, 'hybrids',
                    _share(told - len(wrong), told), missed=tuple(wrong)),
            Reached(REFUSED, 'hybrids', _share(len(refused), len(rows)),
                    missed=tuple(refused))]


def _share(count: int, whole: int) -> str:
    return f'{100 * count / whole:.0f} % of {whole}' if whole else '-'
