# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Write the tables and pictures of docs/real_flights.md.

`.venv/bin/python -m docs.real_flights FOLDER [SOURCE ...]`: FOLDER has a folder for each source;
without a SOURCE all of SOURCES are taken.
"""

from dataclasses import replace
from pathlib import Path
import shutil
import sys
import tempfile
import time

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from benchmarks.tables import DOCUMENTS, keep, markdown, number
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.result import Diagnosis, Ranked
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle, Vehicle
from quad_ident_ros.report import gap_figures
from quad_ident_ros.report.diagnosis import contribution_of, WORTH

DOCUMENT = 'real_flights.md'
TRAINING = ('star_fast', 'oval_fast', 'helix_fast', 'lissajous_fast')
HELD_OUT = ('figure8_fast', 'trefoil_medium', 'circle_slow')
EARLIER = 0.03      # s that the stamps of commands are moved earlier
MOMENT = 3e-4       # N m about x that is added in software: 2 % of weight times arm
PICTURES = ('horizons', 'map')


VEHICLES = Path(__file__).parent / 'real_vehicles'
SINGLE = {'crazyflie_usd': ('log10', 'crazyflie_27g.yaml'),
          'px4_sitl_iris': ('quadrotor_model.csv.gz', 'iris_gazebo.yaml')}
"""Sources of one flight: its file and the vehicle file."""
LOGS = ('sample.ulg', 'sample_px4_events.ulg', 'sample_logging_tagged_and_default_params.ulg')
SOURCES = ('nanobench', *SINGLE, 'px4_logs')


def main(folder: str, *sources: str) -> None:
    """Diagnose the flights of sources, and write what was found."""
    for source in sources or SOURCES:
        if source == 'nanobench':
            nanobench(Path(folder) / source)
        elif source in SINGLE:
            single(source, Path(folder) / source)
        else:
            keep(DOCUMENT, source, logs_table(Path(folder) / source))


def single(source: str, folder: Path) -> None:
    """Diagnose the one flight of a source, and write the verdict and its parameters."""
    name, described = SINGLE[source]
    vehicle, begin = load_vehicle(VEHICLES / described), time.perf_counter()
    told = diagnose(load_all(folder / name, None, vehicle), vehicle)
    taken = time.perf_counter() - begin
    after, before = told.gap.after['velocity'], told.gap.before['velocity']
    keep(DOCUMENT, source, f'Verdict: {", ".join(told.verdict)}; velocity gap '
         f'{1e3 * told.gap.horizon:.0f} ms ahead {number(before)} m/s, with the effects named '
         f'{number(after)} m/s; {taken:.0f} s.\n\n' + effects_rows(told))


def effects_rows(told: Diagnosis) -> str:
    """Return the effects that are probable, with their parameters."""
    return markdown(('effect', 'form', 'probability', 'contribution', 'parameters'), [
        (f'`{row.effect}`', row.form or '', f'{row.probability:.2f}', contribution_of(row),
         ', '.join(f'{name} {number(one.value)} ± {one.std:.1g}'
                   + (f' {one.unit}' if one.unit != '1' else '')
                   for name, one in row.parameters.items()))
        for row in told.ranking if row.parameters and row.probability >= WORTH])


def logs_table(folder: Path) -> str:
    """Return what each PX4 log holds, and what `info` reports of it without a vehicle file."""
    rows = []
    for name in LOGS:
        try:
            found = load_all(folder / name)
            said = '; '.join(f'{one.t[-1] - one.t[0]:.1f} s at {1.0 / one.period():.0f} Hz'
                             for one in found)
        except InputError as error:
            said = str(error).partition(': ')[2]
        rows.append((f'`{name}`', said))
    return markdown(('log', 'flights in it'), rows)


def nanobench(folder: Path) -> None:
    """Diagnose the flights of NanoBench as they are and tampered with."""
    vehicle = load_vehicle(folder / 'vehicle.yaml')
    flights = {name: load(folder / f'{name}.csv.gz') for name in (*TRAINING, *HELD_OUT)}
    cases = {**{f'as flown, held out: {name}': (same, name) for name in HELD_OUT},
             'without `vbat`': (without_voltage, HELD_OUT[0]),
             f'commands stamped {1e3 * EARLIER:.0f} ms earlier': (earlier, HELD_OUT[0]),
             'rotors 1 and 2 swapped': (swapped, HELD_OUT[0]),
             f'a moment of {1e3 * MOMENT:.1f} mN m about x added': (pushed, HELD_OUT[0])}
    found, taken = {}, {}
    with Progress(TextColumn('{task.description}'), BarColumn(), TimeElapsedColumn(),
                  console=Console(stderr=True)) as bar:
        task = bar.add_task('Diagnosing', total=len(cases))
        for label, (change, held) in cases.items():
            bar.update(task, description=label)
            records = [change(flights[name], vehicle) for name in (*TRAINING, held)]
            begin = time.perf_counter()
            found[label] = attempt(records, vehicle)
            taken[label] = time.perf_counter() - begin
            if label == list(cases)[0]:
                save(found[label])
            bar.advance(task)
    usual = found[list(cases)[0]]
    keep(DOCUMENT, 'gap', gap_table([one for label, one in found.items()
                                     if label.startswith('as flown')]))
    keep(DOCUMENT, 'effects', effects_table(usual, taken[list(cases)[0]]))
    keep(DOCUMENT, 'nuisances', nuisances_table(usual))
    keep(DOCUMENT, 'tampered', tampered_table(found))


def save(found: Diagnosis) -> None:
    """Save the pictures of a diagnosis beside the document."""
    with tempfile.TemporaryDirectory() as folder:
        gap_figures.save_figures(found, Path(folder), '.png')
        for name in PICTURES:
            shutil.copy(Path(folder) / f'{name}.png', DOCUMENTS / f'real_flights_{name}.png')


def attempt(records: list[FlightRecord], vehicle: Vehicle) -> Diagnosis | InputError:
    """Return the Diagnosis, or the InputError that refuses it."""
    try:
        return diagnose(records, vehicle)
    except InputError as error:
        return error


def same(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return a record as it is."""
    return record


def without_voltage(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return a record without the voltage of the battery."""
    return changed(record, vbat=None)


def earlier(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return a record whose commands are stamped earlier than they were given."""
    return changed(record, **{name: np.interp(record.t + EARLIER, record.t, record.columns[name])
                              for name in record.numbered('cmd')})


def swapped(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return a record whose first two rotors have each other's commands."""
    return changed(record, cmd1=record.columns['cmd2'], cmd2=record.columns['cmd1'])


def pushed(record: FlightRecord, vehicle: Vehicle) -> FlightRecord:
    """Return a record of a vehicle with a moment that its commands do not have."""
    y = np.array([rotor.position[1] for rotor in vehicle.rotors])
    names = record.numbered('cmd')
    thrust = vehicle.thrust_coefficient * record.stack(*names) ** 2 - MOMENT * y / np.sum(y ** 2)
    commands = np.sqrt(np.maximum(thrust, 0.0) / vehicle.thrust_coefficient)
    return changed(record, **dict(zip(names, commands.T, strict=True)))


def changed(record: FlightRecord, **columns: np.ndarray | None) -> FlightRecord:
    """Return a record with other columns; None leaves one out."""
    values = {**record.columns, **columns}
    return replace(record, columns={name: column for name, column in values.items()
                                    if column is not None})


def gap_table(found: list[Diagnosis]) -> str:
    """Return both gaps on each flight held out: nominal, with nuisances, after, of noise."""
    rows = []
    for one in found:
        full, given = one.gap, one.gap_given_attitude
        for title, gap, names in (('', full, full.units), (', given attitude', given,
                                                           given.before)):
            for name in names:
                stages = (gap.before, gap.before_own, gap.after, gap.noise)
                rows.append((one.held_out if not title and name == 'position' else '',
                             f'{name}{title}, {full.units[name]}',
                             *(number(stage[name]) for stage in stages),
                             f'{100 * (1 - gap.after[name] / gap.before[name]):.0f} %'))
    return markdown(('held out', '0.5 s ahead', 'nominal', 'with nuisances', 'after', 'noise',
                     'smaller by'), rows)


def effects_table(found: Diagnosis, taken: float) -> str:
    """
    Return the effects with their parameters, and what each is worth on the held-out flight.

    Args: found; taken: s, how long the diagnosis took.
    """
    rows = []
    for row in found.ranking:
        if not row.parameters and row.probability < WORTH:
            continue
        values = ', '.join(f'{name} {one.value:.3g} ± {one.std:.1g} {one.unit}'
                           .removesuffix(' 1') for name, one in row.parameters.items())
        without = found.gap.without.get(row.effect)
        rows.append((f'`{row.effect}`', row.form or '–', 'yes' if without else 'no',
                     f'{row.probability:.2f}', contribution_of(row) or '–', values,
                     number(without['velocity']) if without else '–'))
    return (f'Verdict: {", ".join(found.verdict)}; velocity gap with all that is named: '
            f'{number(found.gap.after["velocity"])} m/s; {taken:.0f} s.\n\n'
            + markdown(('effect', 'form', 'named', 'probability', 'contribution', 'parameters',
                        'velocity gap without it, m/s'), rows))


def nuisances_table(found: Diagnosis) -> str:
    """Return what was estimated for each flight apart."""
    nuisances = found.nuisances or {}
    if not nuisances:
        return 'None: the flights do not differ in any of them.'
    head = ('flight', *(f'{name}, {one["unit"]}' for name, one in nuisances.items()))
    columns = [[*one['values'], one['held_out']] for one in nuisances.values()]
    return markdown(head, [
        (name, *(' '.join(f'{value:.2g}' for value in column[k]) for column in columns))
        for k, name in enumerate([*found.flights, found.held_out])])


def tampered_table(found: dict) -> str:
    """Return the verdicts on changed records, beside those on the same flights unchanged."""
    rows = []
    for label, one in found.items():
        if isinstance(one, InputError):
            rows.append((label, f'refused: {str(one).rpartition("/")[2]}', *[''] * 4))
            continue
        rows.append((label, ', '.join(one.verdict), _sag(one), f'{1e3 * _delay(one):.0f} ms',
                     f'{1e3 * _moment(one):.2f} mN m', number(one.gap.after['velocity'])))
    return markdown(('flights', 'verdict', 'fall of the thrust (probability)',
                     'commands act after', 'moment about x in hover', 'velocity gap after, m/s'),
                    rows)


def _row(found: Diagnosis, effect: str) -> Ranked:
    [row] = [row for row in found.ranking if row.effect == effect]
    return row


def _parameter(found: Diagnosis, effect: str, name: str) -> float:
    """Return the value of an effect's parameter, named or not, or 0."""
    known = _row(found, effect).parameters.get(name)
    return known.value if known else 0.0


def _mean(found: Diagnosis, nuisance: str) -> np.ndarray:
    """Return the mean of a nuisance over the flights, (K,), or zeros."""
    nuisances = found.nuisances or {}
    return (np.mean(nuisances[nuisance]['values'], axis=0) if nuisance in nuisances
            else np.zeros(3))


def _sag(found: Diagnosis) -> str:
    """Return the fall of thrust with its probability, in words."""
    row = _row(found, 'battery_sag')
    values = ' and '.join(f'{name} {one.value:.3g} {one.unit}'.removesuffix(' 1')
                          for name, one in row.parameters.items())
    return f'{values} ({row.probability:.2f})' if values else 'none'


def _delay(found: Diagnosis) -> float:
    """Return how long after the commands the vehicle acts, s: by clock or delay."""
    return _mean(found, 'clock_offset')[0] + _parameter(found, 'actuation_delay', 'delay')


def _moment(found: Diagnosis) -> float:
    """Return the moment about x in hover, N m: each flight's trim, and the weight's lever."""
    vehicle = found.vehicle
    return (_mean(found, 'trim_moment')[0]
            - vehicle.mass * vehicle.gravity * _parameter(found, 'com_offset', 'y'))


if __name__ == '__main__':
    if len(sys.argv) < 2 or not set(sys.argv[2:]) <= set(SOURCES):
        sys.exit(f'usage: python -m docs.real_flights FOLDER [{" | ".join(SOURCES)}] ...')
    main(*sys.argv[1:])
