# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the check is to reach, and what a score reached of it."""

from dataclasses import dataclass

TITLES = {'ours': 'forms as ours', 'forms': 'other forms', 'files': 'wrong files',
          'logs': 'logs', 'estimator': 'estimator states', 'faulty': 'faulty records'}


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
EXACT = ('single', 'pair', 'mixture')


def goals(found):
    """
    Return the lines of a table: head, then a line per goal with a cell per column.

    A cell has what was reached and, in brackets, the target; in bold what was not reached.
    """
    names = [name for name in GOALS if name in found['columns']]
    columns = [_Column(name, found) for name in names]
    rows = [('right effect first, strength 1 and 3', _Column.first),
            ('exact set, single / pairs / mixtures', _Column.exact),
            ('false alarms on `none`', _Column.alarm),
            ('`unknown` recognised / said instead of the effect', _Column.unknown),
            ('coverage of 95 % intervals', _Column.coverage),
            ('calibration error over 0.05 to 0.95', _Column.calibration),
            ('share of the gap closed, median / worst tenth', _Column.closed),
            ('refused', _Column.refused)]
    return [('what', *(TITLES[name] for name in names)),
            *((title, *(cell(column) for column in columns)) for title, cell in rows)]


class _Column:
    """The cells of one column."""

    def __init__(self, name, found):
        self.goal, self.all = GOALS[name], found['columns'][name]
        self.groups = {key.split(': ')[1]: one for key, one in found['groups'].items()
                       if key.startswith(f'{name}: ')}

    def _rate(self, key, *kinds):
        """Return (rate, count) of a measure over groups."""
        some = [self.groups[kind][key] for kind in kinds if kind in self.groups]
        count = sum(one['count'] for one in some)
        total = sum(one['rate'] * one['count'] for one in some if one['count'])
        return (total / count if count else None), count

    def first(self):
        rate, count = self._rate('first', 'single 1', 'single 3')
        return _cell(rate, count, least=self.goal.first)

    def exact(self):
        return ' / '.join(_cell(*self._rate('exact', kind), least=least)
                          for kind, least in zip(EXACT, self.goal.exact, strict=True))

    def alarm(self):
        return _cell(*self._rate('alarm', 'none'), most=self.goal.alarm)

    def unknown(self):
        instead = self.all['instead']
        return (f'{_cell(*self._rate("unknown", "unknown"), least=self.goal.unknown)} / '
                f'{_cell(instead["rate"], instead["count"], most=self.goal.instead)}')

    def coverage(self):
        one = self.all['coverage'].get('all', {'rate': None, 'count': 0})
        return _cell(one['rate'], one['count'], *self.goal.coverage)

    def calibration(self):
        one = self.all['calibration']
        if one is None or one['middle'] is None:
            return '-'
        met = one['middle'] <= self.goal.calibration
        return _bold(f'{one["middle"]:.2f} of {one["middle_count"]}', met) + (
            f' (≤ {self.goal.calibration:g})')

    def closed(self):
        one = self.all['closed']
        if one is None:
            return '-'
        return ' / '.join(_cell(one[key], None, least=least) for key, least in zip(
            ('median', 'tenth'), self.goal.closed, strict=True))

    def refused(self):
        return _cell(self.all['refused']['rate'], self.all['refused']['count'])


def _bold(text, met):
    return text if met else f'**{text}**'


def _cell(rate, count=None, least=None, most=None):
    """Return a rate as text with its count and target; bold where the target is missed."""
    if rate is None:
        return '-'
    met = ((least is None or rate >= least - 1e-9) and (most is None or rate <= most + 1e-9))
    text = _bold(f'{100 * rate:.0f} %' + (f' of {count}' if count is not None else ''), met)
    if least is not None and most is not None:
        return f'{text} ({100 * least:.0f} to {100 * most:.0f})'
    if least is not None:
        return f'{text} (≥ {100 * least:.0f})'
    return text if most is None else f'{text} (≤ {100 * most:.0f})'
