# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fly a made fleet and write its logs; its truth goes to the caller and nowhere else."""

import argparse
import csv
from dataclasses import replace
import io
import os
from pathlib import Path
import secrets
import sys

import numpy as np

from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle, Vehicle, write_vehicle
from withheld.fleet.truth import Flown, TOGETHER, Truth, truth_of
from withheld.seal import seal

NOMINAL = 'hummingbird'
TRAJECTORIES = ('lissajous', 'figure8', 'circle')
SECONDS, RATE = 10.0, 100.0
FREEZE = 0.4            # of a flight, from which on its states stay as they are
LATE = 0.25             # s
CUT = 1.0               # s that a log has which is cut


def make(truth: Truth, folder: Path) -> None:
    """Write the logs of a fleet, its manifest and the nominal vehicle into a folder."""
    nominal = load_vehicle(NOMINAL)
    folder.mkdir(parents=True, exist_ok=True)
    write_vehicle(folder / 'vehicle.yaml', nominal)
    rows = []
    for done, one in enumerate(truth.flights, 1):
        place = Path(one.vehicle) / f'flight_{one.number:02d}.csv'
        (folder / place.parent).mkdir(exist_ok=True)
        write_log(folder / place, one, nominal)
        rows.append((str(place), one.vehicle, one.date.isoformat(), f'{one.temperature:.1f}',
                     f'{one.number // TOGETHER:02d}'))
        print(done, len(truth.flights), flush=True)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow(('path', 'vehicle', 'date', 'temperature_c', 'group'))
    writer.writerows(rows)
    (folder / 'manifest.csv').write_text(text.getvalue(), encoding='utf-8')


def write_log(path: Path, one: Flown, nominal: Vehicle) -> None:
    """Write the log of a flight, as it was flown or spoilt, without a word on what it is."""
    record = fly_closed_loop(nominal, one.effects, TRAJECTORIES[one.number % len(TRAJECTORIES)],
                             duration=SECONDS, rate=RATE, seed=one.seed,
                             noise=SENSORS['mocap_imu'])
    write_csv(path, spoilt(replace(record, info={'vehicle': nominal.name}), one.spoilt))
    if one.spoilt == 'rubbish':
        text = path.read_bytes()
        path.write_bytes(text[:len(text) // 3] + np.random.default_rng(one.seed).bytes(2000))


def spoilt(record: FlightRecord, kind: str) -> FlightRecord:
    """
    Return a record with what is wrong with it.

    cut: all but its first second is missing; swapped: two motors have each other's commands;
    frozen: its states stay as they are from some time on; degrees: rates are in degrees per
    second; late: the states come later than the commands.
    """
    t, columns = record.t, dict(record.columns)
    states = [name for name in columns if name[0] in 'pvqw' and name != 'vbat']
    if kind == 'cut':
        kept = t <= CUT
        return FlightRecord(t[kept], {name: values[kept] for name, values in columns.items()},
                            record.info)
    if kind == 'swapped':
        columns['cmd1'], columns['cmd2'] = columns['cmd2'], columns['cmd1']
    elif kind == 'frozen':
        last = int(FREEZE * len(t))
        for name in states:
            columns[name] = np.append(columns[name][:last],
                                      np.full(len(t) - last, columns[name][last]))
    elif kind == 'degrees':
        for name in ('wx', 'wy', 'wz'):
            columns[name] = np.degrees(columns[name])
    elif kind == 'late':
        for name in states:
            columns[name] = np.interp(t - LATE, t, columns[name])
    return FlightRecord(t, columns, record.info)


def main() -> int:
    """Make a fleet; seal its truth, whose key goes to a pipe."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--folder', type=Path, required=True)
    parser.add_argument('--sealed', type=Path, required=True)
    parser.add_argument('--key', type=int, required=True)
    parser.add_argument('--vehicles', type=int, required=True)
    parser.add_argument('--flights', type=int, required=True)
    parser.add_argument('--seed', type=int)
    options = parser.parse_args()
    seed = secrets.randbits(31) if options.seed is None else options.seed
    truth = truth_of(options.vehicles, options.flights, np.random.default_rng(seed))
    make(truth, options.folder)
    sealed, key = seal(truth.as_data() | {'seed': seed})
    options.sealed.write_bytes(sealed)
    with os.fdopen(options.key, 'wb') as pipe:
        pipe.write(key)
    return 0


if __name__ == '__main__':
    sys.exit(main())
