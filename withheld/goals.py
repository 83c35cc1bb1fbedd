# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the check is to reach, and what a score reached of it."""

WORSE = 0.10    # by which rates may be lower with faults


def goals(found):
    """Return [(what, target, reached)] of a score, in words; in bold what was not reached."""
    groups = found['groups']

    def part(key, *names):
        """Return (rate, count) of a measure over groups."""
        some = [groups[name][key] for name in names if name in groups]
        count = sum(one['count'] for one in some)
        total = sum(one['rate'] * one['count'] for one in some if one['count'])
        return (total / count if count else None), count

    def faulty(key, *names):
        """Return the cell of a rate with faults, held against that without."""
        clean, _ = part(key, *names)
        rate, count = part(key, *(f'faulty {name}' for name in names))
        met = None in (rate, clean) or rate >= clean - WORSE - 1e-9
        return _cell(rate, met, count)

    def at_least(limit, key, *names):
        rate, _ = part(key, *names)
        return _cell(rate, rate is None or rate >= limit)

    alarm, nones = part('alarm', 'none')
    false = found['unknown_falsely_claimed']['rate']
    closed = [(name, groups[name]['closed']) for name in ('single', 'pair', 'mixture')
              if name in groups and groups[name]['closed']]
    shares = [_closed(one, name) for name, one in closed] + [
        _closed(groups[f'faulty {name}']['closed'], f'{name} with faults')
        for name, _ in closed if groups.get(f'faulty {name}', {}).get('closed')]
    coverage = {kind: found['coverage'][kind].get('all') for kind in ('clean', 'faulty')}
    errors = {kind: (found['calibration'][kind] or {}).get('error')
              for kind in ('clean', 'faulty')}
    return [
        ('right effect first: single, strength 1 and 3 / 0.3', '98 % / 85 %',
         f'{at_least(0.98, "first", "single 1", "single 3")} / '
         f'{at_least(0.85, "first", "single 0.3")}'),
        ('exact set: single and `none` / pairs / mixtures', '92 % / 85 % / 60 %',
         f'{at_least(0.92, "exact", "single", "none")} / {at_least(0.85, "exact", "pair")} / '
         f'{at_least(0.6, "exact", "mixture")}'),
        ('F1 of mixtures', '90 %', at_least(0.9, 'f1', 'mixture')),
        ('false alarms on `none`', '≤ 3 %', _cell(alarm, alarm is None or alarm <= 0.03, nones)),
        ('`unknown` recognised / falsely claimed', '85 % / ≤ 3 %',
         f'{at_least(0.85, "unknown", "unknown")} / '
         f'{_cell(false, false is None or false <= 0.03)}'),
        ('with faults: right effect first, single', '10 points less',
         faulty('first', 'single 1', 'single 3')),
        ('with faults: exact set, single and `none` / pairs / mixtures', '10 points less',
         f'{faulty("exact", "single 1", "single 3", "none")} / {faulty("exact", "pair")} / '
         f'{faulty("exact", "mixture")}'),
        ('with faults: `unknown` recognised', '10 points less', faulty('unknown', 'unknown 3')),
        ('share of the gap closed, median / worst tenth', '97 % / 85 %', '; '.join(shares) or '-'),
        ('coverage of 95 % intervals, clean / with faults', '90 to 99 %', ' / '.join(
            _cell(one['rate'], 0.9 <= one['rate'] <= 0.99, one['count'])
            if one and one['rate'] is not None else '-' for one in coverage.values())),
        ('calibration error, clean / with faults', '≤ 0.05', ' / '.join(
            '-' if one is None else _bold(f'{one:.3f}', one <= 0.05)
            for one in errors.values()))]


def _bold(text, met):
    return text if met else f'**{text}**'


def _cell(rate, met, count=None):
    """Return a rate as text, with the count of cases where they are few."""
    if rate is None:
        return '-'
    return _bold(f'{100 * rate:.0f} %' + (f' of {count}' if count is not None else ''), met)


def _closed(one, name):
    """Return median and worst tenth of the share closed as text."""
    median, tenth = (_cell(one[key], one[key] >= limit)
                     for key, limit in (('median', 0.97), ('tenth', 0.85)))
    return f'{name} {median} / {tenth}'
