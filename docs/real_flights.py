# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Write the tables and pictures of docs/real_flights.md.

`.venv/bin/python -m docs.real_flights FOLDER`, with the flights of NanoBench in FOLDER.
"""

from dataclasses import replace
from pathlib import Path
import shutil
import sys
import tempfile

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from benchmarks.tables import DOCUMENTS, keep, markdown, number
from quad_ident_ros.data.load import load
from quad_ident_ros.data.quality import refuse_unfit
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_nominal
from quad_ident_ros.report import gap_page
from quad_ident_ros.report.diagnosis import WORTH

DOCUMENT = 'real_flights.md'
TRAINING = ('star_fast', 'oval_fast', 'helix_fast', 'lissajous_fast')
HELD_OUT = ('figure8_fast', 'trefoil_medium', 'circle_slow')
EARLIER = 0.03      # s by which commands are stamped earlier
MOMENT = 3e-4       # N m about x that is added in software: 2 % of weight times arm
PICTURES = ('horizons', 'map')


def main(folder):
    """Diagnose the flights as they are and tampered with, and write what was found."""
    folder = Path(folder)
    vehicle = load_nominal(folder / 'vehicle.yaml')
    flights = {name: load(folder / f'{name}.csv.gz') for name in (*TRAINING, *HELD_OUT)}
    cases = {**{f'as flown, held out: {name}': (same, name) for name in HELD_OUT},
             'without `vbat`': (without_voltage, HELD_OUT[0]),
             f'commands stamped {1e3 * EARLIER:.0f} ms earlier': (earlier, HELD_OUT[0]),
             'rotors 1 and 2 swapped': (swapped, HELD_OUT[0]),
             f'a moment of {1e3 * MOMENT:.1f} mN m about x added': (pushed, HELD_OUT[0])}
    found = {}
    with Progress(TextColumn('{task.description}'), BarColumn(), TimeElapsedColumn(),
                  console=Console(stderr=True)) as bar:
        task = bar.add_task('Diagnosing', total=len(cases))
        for label, (change, held) in cases.items():
            bar.update(task, description=label)
            records = [change(flights[name], vehicle) for name in (*TRAINING, held)]
            found[label] = attempt(records, vehicle)
            if label == list(cases)[0]:
                save(found[label], records)
            bar.advance(task)
    usual = found[list(cases)[0]].data
    keep(DOCUMENT, 'gap', gap_table({label: one.data for label, one in found.items()
                                     if label.startswith('as flown')}))
    keep(DOCUMENT, 'effects', effects_table(usual))
    keep(DOCUMENT, 'own', own_table(usual))
    keep(DOCUMENT, 'tampered', tampered_table(found))


def save(found, records):
    """Save the pictures of a diagnosis beside the document."""
    with tempfile.TemporaryDirectory() as folder:
        gap_page.save_pictures(found, Path(folder))
        for name in PICTURES:
            shutil.copy(Path(folder) / f'{name}.png', DOCUMENTS / f'real_flights_{name}.png')


def attempt(records, vehicle):
    """Return the Diagnosis, or the InputError that refuses it."""
    try:
        for record in records:
            refuse_unfit(record, vehicle)
        return diagnose(records, vehicle)
    except InputError as error:
        return error


def same(record, vehicle):
    """Return a record as it is."""
    return record


def without_voltage(record, vehicle):
    """Return a record without the voltage of the battery."""
    return changed(record, vbat=None)


def earlier(record, vehicle):
    """Return a record whose commands are stamped earlier than they were given."""
    return changed(record, **{name: np.interp(record.t + EARLIER, record.t, record.columns[name])
                              for name in record.numbered('cmd')})


def swapped(record, vehicle):
    """Return a record whose first two rotors have each other's commands."""
    return changed(record, cmd1=record.columns['cmd2'], cmd2=record.columns['cmd1'])


def pushed(record, vehicle):
    """Return a record of a vehicle on which a moment acts of which its commands say nothing."""
    y = np.array([rotor.position[1] for rotor in vehicle.rotors])
    names = record.numbered('cmd')
    thrust = vehicle.thrust_coefficient * record.stack(*names) ** 2 - MOMENT * y / np.sum(y ** 2)
    commands = np.sqrt(np.maximum(thrust, 0.0) / vehicle.thrust_coefficient)
    return changed(record, **dict(zip(names, commands.T, strict=True)))


def changed(record, **columns):
    """Return a record with other columns; None leaves one out."""
    values = {**record.columns, **columns}
    return replace(record, columns={name: column for name, column in values.items()
                                    if column is not None})


def gap_table(found):
    """Return the gap on each held-out flight, before, after and of noise."""
    rows = []
    for data in found.values():
        gap = data['gap']
        for name, unit in gap['units'].items():
            rows.append((data['held_out'] if name == 'position' else '', f'{name}, {unit}',
                         *(number(gap[stage][name]) for stage in ('before', 'after', 'noise')),
                         f'{100 * (1 - gap["after"][name] / gap["before"][name]):.0f} %'))
    return markdown(('held out', '0.5 s ahead', 'before', 'after', 'noise', 'smaller by'), rows)


def effects_table(data):
    """Return the effects that were found, and what each is worth on the held-out flight."""
    rows = []
    for row in data['ranking']:
        if not row['parameters'] and row['probability'] < WORTH:
            continue
        values = ', '.join(f'{name} {one["value"]:.3g} ± {one["std"]:.1g} {one["unit"]}'
                           .removesuffix(' 1') for name, one in row['parameters'].items())
        without = data['gap']['without'].get(row['effect'])
        rows.append((f'`{row["effect"]}`', 'yes' if without else 'no',
                     f'{row["probability"]:.2f}', values,
                     number(without['velocity']) if without else '–'))
    return (f'Verdict: {", ".join(data["verdict"])}; velocity gap with all that is named: '
            f'{number(data["gap"]["after"]["velocity"])} m/s.\n\n'
            + markdown(('effect', 'named', 'probability', 'parameters',
                        'velocity gap without it, m/s'), rows))


def own_table(data):
    """Return what each flight has of its own."""
    own = data['nuisances'] or {}
    if not own:
        return 'None: what there is of it is alike in all flights.'
    head = ('flight', *(f'{name}, {one["unit"]}' for name, one in own.items()))
    columns = [[*one['values'], one['held_out']] for one in own.values()]
    return markdown(head, [
        (name, *(' '.join(f'{value:.2g}' for value in column[k]) for column in columns))
        for k, name in enumerate([*data['flights'], data['held_out']])])


def tampered_table(found):
    """Return what is said of records that were tampered with, beside them as they were flown."""
    rows = []
    for label, one in found.items():
        if isinstance(one, InputError):
            rows.append((label, f'refused: {str(one).rpartition("/")[2]}', *[''] * 4))
            continue
        data = one.data
        rows.append((label, ', '.join(data['verdict']), _sag(data),
                     f'{1e3 * _delay(data):.0f} ms', f'{1e3 * _moment(one):.2f} mN m',
                     number(data['gap']['after']['velocity'])))
    return markdown(('flights', 'verdict', 'fall of the thrust (probability)',
                     'commands act after', 'moment about x in hover', 'velocity gap after, m/s'),
                    rows)


def _parameters(data, effect):
    """Return {parameter: value} that was found of an effect, named or not."""
    [row] = [row for row in data['ranking'] if row['effect'] == effect]
    return {name: one['value'] for name, one in row['parameters'].items()}


def _own(data, name):
    """Return the mean over the flights of what each has of its own, (K,), or zeros."""
    return (np.mean(data['nuisances'][name]['values'], axis=0)
            if name in (data['nuisances'] or {}) else np.zeros(3))


def _sag(data):
    """Return the fall of thrust that was found, in words."""
    found = _parameters(data, 'battery_sag')
    kinds = {'per_volt': (1.0, 'a volt'), 'per_second': (60.0, 'a minute')}
    [row] = [row for row in data['ranking'] if row['effect'] == 'battery_sag']
    return ' and '.join(f'{100 * kinds[name][0] * value:.0f} % {kinds[name][1]} '
                        f'({row["probability"]:.2f})' for name, value in found.items()) or 'none'


def _delay(data):
    """Return how long after the commands the vehicle acts, s: by clock or delay."""
    return _own(data, 'clock_offset')[0] + _parameters(data, 'actuation_delay').get('delay', 0.0)


def _moment(found):
    """Return the moment about x in hover, N m: each flight's own, and the weight's lever."""
    vehicle = found.training.vehicle
    lever = _parameters(found.data, 'com_offset').get('y', 0.0)
    return _own(found.data, 'trim_moment')[0] - vehicle.mass * vehicle.gravity * lever


if __name__ == '__main__':
    if len(sys.argv) != 2:
        sys.exit('usage: python -m docs.real_flights FOLDER')
    main(sys.argv[1])
