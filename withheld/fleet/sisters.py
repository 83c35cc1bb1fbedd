# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Vehicles of one make: some effects are usual in it, others are seldom or never there.

What a fleet teaches of the effects is learnt from some of them and tried on others.
"""

import argparse
from dataclasses import replace
import os
from pathlib import Path
import secrets
import sys

import numpy as np

from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle, Vehicle, write_vehicle
from withheld.fleet.make import NOMINAL, TRAJECTORIES
from withheld.seal import seal

POOL = ('motor_lag', 'actuation_delay', 'rotor_drag', 'body_drag', 'inflow', 'thrust_scale',
        'inertia_mismatch', 'com_offset', 'rotor_gyro', 'blade_flapping')
"""Effects that a make may have; any other may be named by mistake."""
OFTEN = (0.9, 0.9, 0.4, 0.1)
"""Shares of the vehicles of a make that have each of its four effects; the others none has."""
SIZES = 0.3, 1.0        # of the usual size of a parameter: two short flights show some hardly
SPREAD = 0.15           # from vehicle to vehicle, share of it
FLIGHTS, SECONDS, RATE = 2, 8.0, 100.0


def make_of(nominal: Vehicle, rng: np.random.Generator) -> dict:
    """Return {effect: (share of the vehicles, {parameter: usual value})} of a make."""
    made = {}
    for name, share in zip(rng.permutation(POOL)[:len(OFTEN)].tolist(), OFTEN, strict=True):
        parts = {}
        for one in EFFECTS[name].forms[0].parameters:
            lower, _, size = one.bounds(nominal)
            step = size * np.exp(rng.uniform(*np.log(SIZES)))
            both = lower < one.null - step
            parts[one.name] = one.null + step * (rng.choice([-1.0, 1.0]) if both else 1.0)
        made[name] = share, parts
    return made


def vehicle_of(make: dict, rng: np.random.Generator) -> dict:
    """Return {effect: {parameter: value}} of a vehicle of a make."""
    found = {}
    for name, (share, parts) in make.items():
        if rng.random() < share:
            null = {one.name: one.null for one in EFFECTS[name].forms[0].parameters}
            found[name] = {key: null[key] + (value - null[key])
                           * float(np.exp(SPREAD * rng.standard_normal()))
                           for key, value in parts.items()}
    return found


def fly(folder: Path, names: list[str], make: dict, nominal: Vehicle, rng: np.random.Generator
        ) -> dict[str, list[str]]:
    """Write the logs of vehicles into a folder and return {vehicle: its effects}."""
    truth = {}
    for done, name in enumerate(names, 1):
        (folder / name).mkdir(parents=True)
        while True:
            effects = vehicle_of(make, rng)
            try:
                flown = [fly_closed_loop(nominal, effects, TRAJECTORIES[k], duration=SECONDS,
                                         rate=RATE, seed=int(rng.integers(2 ** 31)),
                                         noise=SENSORS['mocap_imu']) for k in range(FLIGHTS)]
                break
            except InputError:      # it leaves its course: another one
                continue
        for k, record in enumerate(flown):
            write_csv(folder / name / f'2026-03-02_{k}.csv',
                      replace(record, info={'vehicle': nominal.name}))
        truth[name] = sorted(effects)
        print(done, len(names), flush=True)
    write_vehicle(folder / 'vehicle.yaml', nominal)
    return truth


def main() -> int:
    """Fly both parts of a make; seal what they are, whose key goes to a pipe."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--folder', type=Path, required=True)
    parser.add_argument('--sealed', type=Path, required=True)
    parser.add_argument('--key', type=int, required=True)
    parser.add_argument('--vehicles', type=int, required=True)
    parser.add_argument('--seed', type=int)
    options = parser.parse_args()
    seed = secrets.randbits(31) if options.seed is None else options.seed
    rng = np.random.default_rng([seed, 1])
    nominal = load_vehicle(NOMINAL)
    make = make_of(nominal, rng)
    names = [f'uav{k + 1:02d}' for k in range(options.vehicles)]
    truth = {part: fly(options.folder / part, names, make, nominal, rng)
             for part in ('taught', 'tried')}
    sealed, key = seal({'seed': seed, 'tried': truth['tried'],
                        'make': {name: share for name, (share, _) in make.items()}})
    options.sealed.write_bytes(sealed)
    with os.fdopen(options.key, 'wb') as pipe:
        pipe.write(key)
    return 0


if __name__ == '__main__':
    sys.exit(main())
