# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The nodes under load: 1 kHz, ten vehicles, and continuous identification."""

from pathlib import Path
import tempfile

import numpy as np

from benchmarks import load
from benchmarks.tables import markdown, number, targets
from quad_ident_ros.nodes.launched import Launched

VEHICLES = tuple(f'/uav{index}' for index in range(1, 11))
WINDOW, OVERLAP = 500, 0.99
PERIOD, FAST = 0.01, 0.001      # s
PLAIN = {'identifier': {'method': 'vp'}, 'recorder': {}}    # the slowest to start is the first
UPDATES = 20.0      # results per second
CALL = 2.0          # ms, median


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    cases = {'1 kHz, to disk': _fast, '10 vehicles, 30 processes': _apart,
             '10 vehicles, 3 processes': _together, 'continuous, 100 Hz': _continuous}
    rows, goals, times = [], [], ''
    with bar(f'flights of {size.flight:g} s', len(cases)) as advance:
        for case, measure in cases.items():
            with tempfile.TemporaryDirectory() as folder:
                found, more, times = measure(Path(folder), size.flight)
            rows += _rows(case, found)
            goals += [_loss(case, found), *more]
            advance()
    head = ('case', 'processes', 'CPU, % of a core', 'messages/s', 'samples sent', 'recorded',
            'messages lost')
    return f'{targets(goals)}\n\n{markdown(head, rows)}\n\n{times}'


def _fast(folder, seconds):
    with Launched(folder) as launched:
        launched.start('recorder', {'output': str(folder), 'window_samples': 10_000_000})
        launched.start('identifier', {'method': 'vp'})
        launched.start('simulator', load.simulator(folder, FAST, seconds))
        found = load.fly(launched, [''], seconds)
    whole = load.is_whole(folder / 'recording_1' / 'bag', found.vehicles[0].run)
    return found, [('the bag: each stamp of each topic', 'once, in order',
                    'yes' if whole else 'no', whole)], ''


def _apart(folder, seconds):
    with Launched(folder) as launched:
        parameters = {**PLAIN, 'simulator': load.simulator(folder, PERIOD, seconds)}
        for node, values in parameters.items():
            for name in VEHICLES:
                launched.start(node, values, name=f'{node}_{name[1:]}',
                               arguments=['-r', f'__ns:={name}'])
        return load.fly(launched, VEHICLES, seconds), [], ''


def _together(folder, seconds):
    with Launched(folder) as launched:
        parameters = {**PLAIN, 'simulator': load.simulator(folder, PERIOD, seconds)}
        for node, values in parameters.items():
            launched.start(node, values, name=f'{len(VEHICLES)} {node}s',
                           module='benchmarks.host', arguments=['--', node, *VEHICLES])
        return load.fly(launched, VEHICLES, seconds), [], ''


def _continuous(folder, seconds):
    answers = load.Answers()
    with Launched(folder) as launched:
        launched.start('recorder', {'window_samples': WINDOW, 'overlap': OVERLAP})
        launched.start('identifier', {'method': 'vp', 'mode': 'continuous'})
        launched.start('simulator', load.simulator(folder, PERIOD, seconds))
        found = load.fly(launched, [''], seconds, answers)
    updates = answers.rate()
    delays = 1e3 * np.array(answers.delays())
    busy = 1e3 * np.array(answers.calls(found.begin + WINDOW * PERIOD, found.end))
    idle = 1e3 * np.array(answers.calls(found.end + 0.5, np.inf))
    times = markdown(('continuous, ms', 'count', 'median', '95 %', 'largest'), [
        (name, len(values), *(number(np.quantile(values, share)) for share in (0.5, 0.95, 1)))
        for name, values in (('from the newest sample to the result', delays),
                             ('a call of a service, while it identifies', busy),
                             ('a call of a service, idle', idle))])
    return found, [
        ('updates per second', f'≥ {UPDATES:g}', number(updates), round(updates, 1) >= UPDATES),
        ('a call of a service of the identifier, median', f'< {CALL:g} ms',
         f'{number(np.median(busy))} ms', np.median(busy) < CALL)], times


def _loss(case, found):
    lost = sum(vehicle.lost for vehicle in found.vehicles)
    lacking = sum(vehicle.lacking for vehicle in found.vehicles)
    return (f'{case}: messages lost; samples lacking', '0; 0', f'{lost:,}; {lacking:,}',
            lost == lacking == 0)


def _rows(case, found):
    """Return a row for each kind of process; the first has the counts."""
    samples = sum(vehicle.run.samples for vehicle in found.vehicles)
    recorded = sum(vehicle.account['joined'] for vehicle in found.vehicles)
    rate = sum(vehicle.rate for vehicle in found.vehicles)
    counts = (f'{rate:,.0f}', f'{samples:,}', f'{recorded:,}',
              sum(vehicle.lost for vehicle in found.vehicles))
    shares = {}
    for name, share in found.shares.items():
        shares.setdefault(name.partition('_')[0], []).append(share)
    rows = []
    for kind, all_shares in shares.items():
        label = f'{len(all_shares)} × {kind}' if len(all_shares) > 1 else kind
        rows.append((case, label, number(100 * sum(all_shares)), *counts))
        case, counts = '', [''] * len(counts)
    return rows
