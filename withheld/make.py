# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fly realities and write their records; what they are goes to whoever asked, and nowhere else."""

import argparse
from concurrent.futures import as_completed, ProcessPoolExecutor
from dataclasses import asdict, replace
import os
from pathlib import Path
import secrets
import sys

import numpy as np

from withheld.cases import SETS
from withheld.faults import csv_text, draw_faults, Faults, record_of
from withheld.fly import Lost
from withheld.paths import Hover, Sines, Waypoints
from withheld.realities import gaps_of, LARGEST, shape_of, size_of, World
from withheld.seal import seal
from withheld.sensors import Noise
from withheld.vehicles import nominal_file, vehicle_of, yaw_authority

STEP = 0.01         # s, of the controller and of the record
RATES = (50.0, 100.0, 100.0, 200.0, 200.0, 500.0)      # Hz, of faulty records
ATTEMPTS = 8
MOST = 30.0         # the largest size of an effect that has no limit of its own


class Unflyable(Exception):
    """No vehicle stays on its path with what was asked for."""


def make_case(case, part, flights, seconds, folder, rng):
    """
    Write the records and the vehicle file of a case into a folder and return its label.

    Args: part: 'development' or 'evaluation'; flights of `seconds` s, the last one held out.
    """
    for _ in range(ATTEMPTS):
        try:
            return _attempt(case, part, flights, seconds, Path(folder), rng)
        except Lost:
            continue
    raise Unflyable(f'no vehicle stays on its path with {case}')


def _attempt(case, part, flights, seconds, folder, rng):
    drag = bool(rng.random() < 0.5) or 'wind' in case.effects
    params = vehicle_of(part, case.vehicle, rng, drag)
    noise, step = Noise(), STEP
    if case.faulty:
        step = 1.0 / rng.choice(RATES)
        noise = replace(noise, correlation=rng.uniform(0.05, 0.3), bias=0.5)
    paths = [_path(case, params, part, rng) for _ in range(flights)]
    seed, voltage = int(rng.integers(2 ** 31)), rng.uniform(3.7, 16.8)
    shapes = {name: shape_of(name, params, rng) for name in case.effects}
    sizes, reached, draws, fall = {}, {}, int(rng.integers(2 ** 31)), rng.uniform(0.005, 0.05)

    def world_of(sizes):
        inside = {name: size for name, size in sizes.items() if name in shapes}
        outside = [item for item in sizes.items() if item[0] not in shapes]
        return World(params, shapes, inside, outside[0] if outside else None, draws, fall)

    def held_out(sizes):
        return world_of(sizes).fly(paths[-1], seconds, step, noise, np.random.default_rng(seed),
                                   voltage)

    asked = case.effects if case.stranger is None else dict([case.stranger])
    for name, strength in asked.items():
        sizes[name], reached[name] = size_of(
            lambda size, name=name: held_out({name: size}), params, strength,
            LARGEST.get(name, MOST))
    world, last = world_of(sizes), held_out(sizes)
    flown = [world.fly(path, seconds, step, noise, rng, voltage) for path in paths[:-1]] + [last]
    faults = [draw_faults(rng) if case.faulty else Faults() for _ in flown]
    folder.mkdir()
    for number, (one, wrong) in enumerate(zip(flown, faults, strict=True), 1):
        (folder / f'flight_{number}.csv').write_text(csv_text(record_of(one, wrong, rng)))
    (folder / 'vehicle.yaml').write_text(nominal_file(params, folder.name))
    exact, alone, before = gaps_of(last, params)
    return {
        'kind': case.kind, 'period': step, 'faulty': case.faulty, 'vehicle': case.vehicle,
        'effects': {name: {'asked': case.effects[name], 'strength': reached[name],
                           'parameters': world.effects[name]} for name in case.effects},
        'stranger': None if case.stranger is None else {
            'kind': case.stranger[0], 'asked': case.stranger[1],
            'strength': reached[case.stranger[0]]},
        'faults': [asdict(one) for one in faults],
        'held_out': {'exact': exact, 'noise': alone, 'before': before}}


def _path(case, params, part, rng):
    radius = params['rotor_radius']
    near = 'ground_effect' in case.effects or rng.random() < 0.4
    low = rng.uniform(1.2, 2.0) * radius if near else rng.uniform(8.0, 14.0) * radius
    if case.kind == 'poor':
        return Hover(rng, low)
    span = float(np.sqrt(params['rotor_radius'] / 0.1))
    family = Sines if part == 'development' else Waypoints
    return family(rng, size=2.0 * span ** 0.5, acceleration=rng.uniform(1.8, 3.2), low=low,
                  turn=min(3.0, 0.25 * yaw_authority(params)))


def make_set(name, count, seed, jobs, folder, on_case=lambda done, total: None):
    """
    Write the cases of a set into `folder`, each in one with a random name.

    Returns the labels, and what could not be flown.

    Args: name of SETS; count: only the first so many cases, or None; seed: what is drawn depends
    on it alone; jobs: processes; on_case is called after each case.
    """
    chosen = SETS[name]
    cases = chosen.cases(np.random.default_rng(seed))[:count]
    names = [secrets.token_hex(6) for _ in cases]
    labels, not_flown = {}, []
    with ProcessPoolExecutor(jobs) as pool:
        waiting = {pool.submit(make_case, case, chosen.part, chosen.flights, chosen.seconds,
                               Path(folder) / names[k], np.random.default_rng([seed, k])): names[k]
                   for k, case in enumerate(cases)}
        for done in as_completed(waiting):
            try:
                labels[waiting[done]] = done.result()
            except Unflyable as error:
                not_flown.append(str(error))
            except Exception as error:      # of rotorpy: it takes no other case with it
                not_flown.append(f'{type(error).__name__}: {error}')
            on_case(len(labels) + len(not_flown), len(cases))
    return labels, not_flown


def main(arguments=None):
    """Fly a set, seal its labels, and give the key to the pipe that was handed over."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--set', required=True, choices=SETS)
    parser.add_argument('--flights', required=True)
    parser.add_argument('--sealed', required=True)
    parser.add_argument('--key', required=True, type=int)
    parser.add_argument('--count', type=int)
    parser.add_argument('--seed', type=int)
    parser.add_argument('--jobs', type=int, default=1)
    options = parser.parse_args(arguments)
    seed = secrets.randbits(48) if options.seed is None else options.seed
    labels, not_flown = make_set(options.set, options.count, seed, options.jobs, options.flights,
                                 lambda done, total: print(done, total, flush=True))
    sealed, key = seal({'seed': seed, 'labels': labels, 'not_flown': not_flown})
    Path(options.sealed).write_bytes(sealed)
    with os.fdopen(options.key, 'wb') as pipe:
        pipe.write(key)
    return 0


if __name__ == '__main__':
    sys.exit(main())
