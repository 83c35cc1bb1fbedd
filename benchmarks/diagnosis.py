# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The time of a diagnosis: four flights of 30 s at 100 Hz, seven real ones, all effects."""

from pathlib import Path

import numpy as np

from benchmarks.machine import timed
from benchmarks.tables import markdown, number, targets
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.effects.registry import bounds, EFFECTS, SLICES
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle

TRAJECTORIES = ('lissajous', 'steps', 'low_passes', 'circle')
DURATION, RATE = 30.0, 100.0    # s, Hz
MOST = 3.0                      # s
# Those of docs/real_flights.md, if they lie beside the checkout; the last one is held out.
PLACE = Path('shared') / 'flights' / 'nanobench'
REAL = ('star_fast', 'oval_fast', 'helix_fast', 'lissajous_fast', 'figure8_fast', 'circle_slow',
        'trefoil_medium')
MOST_REAL = 15.0                # s
TOGETHER = ('motor_lag', 'rotor_drag', 'battery_sag')   # what real vehicles have at once
DRAG = 'rotor_drag'             # without which air does nothing to the vehicle, which has none


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    vehicle = load_vehicle('hummingbird')
    sets = [*((DRAG, name) if effect.needs_air else (name,) for name, effect in EFFECTS.items()),
            TOGETHER]
    cases = {'none': {}, **{' + '.join(names): usual(vehicle, *names) for names in sets}}
    names = list(cases)[:size.diagnoses]
    rows, seconds = [], []
    with bar('Diagnosis', len(names) + 2) as advance:
        for name in [names[0], *names]:     # the first call loads the program
            flights = flown(vehicle, cases[name])
            found, spent = timed(diagnose, flights, vehicle)
            rows.append((name, number(spent), ', '.join(found.verdict)))
            seconds.append(spent)
            advance()
        real = on_real_flights(found_beside(Path(__file__)), REAL[:size.real_flights])
        advance()
    rows, seconds = rows[1:], seconds[1:]
    goals = [('CPU time, the slowest', f'≤ {MOST:g} s', f'{number(max(seconds))} s',
              max(seconds) <= MOST),
             ('CPU time, median', f'≤ {MOST:g} s', f'{number(float(np.median(seconds)))} s',
              np.median(seconds) <= MOST), real]
    return f'{targets(goals)}\n\n{markdown(("what the vehicle has", "CPU, s", "verdict"), rows)}'


def found_beside(path: Path) -> Path | None:
    """Return the folder of real flights in a folder above a path, or None."""
    return next((folder / PLACE for folder in path.resolve().parents
                 if (folder / PLACE).is_dir()), None)


def on_real_flights(folder: Path | None, names: tuple[str, ...]) -> tuple:
    """Return the row of targets for real flights; folder: where they are, None where nowhere."""
    what, most = f'CPU time, {len(names)} real flights', f'≤ {MOST_REAL:g} s'
    if folder is None:
        return what, most, f'not there: {PLACE}', None
    flights = [read_csv(folder / f'{name}.csv.gz') for name in names]
    _, spent = timed(diagnose, flights, load_vehicle(folder / 'vehicle.yaml'))
    return what, most, f'{number(spent)} s', spent <= MOST_REAL


def usual(vehicle, *names):
    """Return {effect: {parameter: value}} of effects at their usual size; of one rotor alone."""
    sizes = bounds(vehicle)[2]
    effects = {}
    for name in names:
        known = zip(EFFECTS[name].forms[0].parameters, sizes[SLICES[name]], strict=True)
        values = {parameter.name: parameter.null + size for parameter, size in known}
        effects[name] = dict(list(values.items())[:1]) if EFFECTS[name].per_rotor else values
    return effects


def flown(vehicle, effects):
    """Return four flights of a vehicle with effects, measured by motion capture and IMU."""
    return [fly_closed_loop(vehicle, effects, name, duration=DURATION, rate=RATE, seed=seed,
                            noise=SENSORS['mocap_imu'])
            for seed, name in enumerate(TRAJECTORIES)]
