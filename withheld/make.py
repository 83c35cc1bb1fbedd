# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fly realities and write their records; their truth goes to the caller and nowhere else."""

import argparse
from dataclasses import asdict, replace
from functools import partial
import logging
import os
from pathlib import Path
import secrets
import shutil
import sys
import tempfile

from distributed import as_completed, Client, LocalCluster
import numpy as np

from withheld.cases import ALSO, SETS
from withheld.estimator.flight import EstimatedWorld
from withheld.estimator.setups import SETUPS
from withheld.faults import csv_text, draw_faults, Faults, record_of
from withheld.files import misread
from withheld.fly import Lost
from withheld.hybrids import make_hybrids
from withheld.logs import Grounded, Logging, LOGS, PERIODS
from withheld.paths import Hover, PATHS
from withheld.realities import (
    DATASHEET,
    gaps_of,
    LARGEST,
    Setting,
    shape_of,
    size_of,
    strength_of_gap,
    World,
)
from withheld.seal import seal
from withheld.sensors import noise_of
from withheld.vehicles import nominal_file, vehicle_of, yaw_authority

STEP = 0.01         # s, of the controller and of the record
RATES = (50.0, 100.0, 100.0, 200.0, 200.0, 500.0)      # Hz, of faulty records
ATTEMPTS = 8
FLOOR = 0.7         # rotor radii from the floor to the body origin of what stands on it
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
    # Wind and gusts act through drag alone.
    drag = bool(rng.random() < 0.5) or 'wind' in case.effects or bool(case.gusts)
    params = vehicle_of(case.vehicle, rng, drag)
    told, factors = misread(params, rng) if case.wrong_file else (params, {})
    log = LOGS[case.log]
    noise, step = noise_of(case.noise, rng), PERIODS.get(case.log, STEP)
    if case.faulty:
        step = 1.0 / rng.choice(RATES)
        noise = replace(noise, correlation=rng.uniform(0.05, 0.3), bias=0.5)
    paths = [_path(case, params, rng) for _ in range(log.flights or flights)]
    setting = Setting(told, case.controller, log.logging, fall=rng.uniform(0.005, 0.05),
                      bodies=case.bodies, gusts=case.gusts)
    span, above = None, paths[-1]
    if log.landing:
        setting = replace(setting, floor=FLOOR * params['rotor_radius'])
        paths = [Grounded(path, seconds, setting.floor) for path in paths]
        span = paths[-1].up, paths[-1].down
    charges = 1.0 + log.charge * rng.uniform(-1.0, 1.0, len(paths))
    seed, voltage = int(rng.integers(2 ** 31)), rng.uniform(3.7, 16.8)
    shapes = {name: shape_of(name, params, rng) for name in case.effects}
    kind, draws, flights = _world(case, part), int(rng.integers(2 ** 31)), {}

    def fly_last(sizes, setting, path, step, charge=1.0):
        key = (*sizes.items(), setting is plain, charge)
        if key not in flights:
            flights[key] = kind(params, setting, shapes, case.forms, sizes, draws).fly(
                path, seconds, step, noise, np.random.default_rng(seed), voltage, charge)
        return flights[key]

    # Strengths are those of an effect alone: the file is right, the air still, the log complete.
    plain = replace(setting, told=params, gusts=0.0, floor=None, logging=Logging())
    plain_step = STEP if case.log else step
    if not (case.log or case.wrong_file or case.gusts):
        plain = setting
    sizes, reached = _sizes(case, lambda sizes: fly_last(sizes, plain, above, plain_step), params,
                            rng)
    world = kind(params, setting, shapes, case.forms, sizes, draws)
    flown = [world.fly(path, seconds, step, noise, rng, voltage, charge)
             for path, charge in zip(paths[:-1], charges[:-1], strict=True)]
    flown.append(fly_last(sizes, setting, paths[-1], step, charges[-1]))
    parts = world.parts()
    voltages = all(getattr(one, 'recorded', True) for one in parts.values())
    faults = [draw_faults(rng) if case.faulty else Faults(voltage=voltages) for _ in flown]
    folder.mkdir(parents=True)
    for number, (one, wrong) in enumerate(zip(flown, faults, strict=True), 1):
        (folder / f'flight_{number}.csv').write_text(csv_text(record_of(one, wrong, rng)))
    (folder / 'vehicle.yaml').write_text(nominal_file(told, folder.name))
    exact, alone, before = gaps_of(flown[-1], told, span)
    floor = alone
    if case.log or case.gusts:
        # What the log hides and gusts do is left when every effect is known.
        none = fly_last({}, replace(setting, told=params), paths[-1], step, charges[-1])
        floor = gaps_of(none, params, span)[2]
    return _label(case, world, reached) | {
        'period': flown[-1].step, 'file': factors, 'faults': [asdict(one) for one in faults],
        'thrust_by_flight': charges.tolist() if log.charge else None,
        'beside': sorted(_beside(case, parts, params, log) - set(case.effects)),
        'instead': list(_instead(case)),
        'held_out': {'exact': exact, 'noise': alone, 'before': before, 'floor': floor}}


def _world(case, part):
    """Return the class of the case's worlds."""
    if case.setup is None:
        return World
    return partial(EstimatedWorld, setup=SETUPS[part][case.setup])


def _sizes(case, fly_last, params, rng):
    """Return the sizes {effect or stranger: size}, and the strengths that they reach, alone."""
    sizes, reached = {}, {}
    asked = case.effects if case.stranger is None else dict([case.stranger])
    for name, strength in asked.items():
        if case.kind == 'datasheet':
            sizes[name] = DATASHEET[name](rng)
            reached[name] = strength_of_gap(fly_last({name: sizes[name]}), params)
            continue
        sizes[name], reached[name] = size_of(lambda size, name=name: fly_last({name: size}),
                                             params, strength, LARGEST.get(name, MOST))
    return sizes, reached


def _label(case, world, reached):
    """Return what the reality is, without what its flights and files add."""
    parts = world.parts()
    effects = {name: {'asked': strength, 'strength': reached[name],
                      'form': case.forms.get(name, 'ours'), **_parameters(name, world, parts)}
               for name, strength in case.effects.items()}
    return {
        'column': case.column, 'kind': case.kind, 'faulty': case.faulty, 'vehicle': case.vehicle,
        'path': case.path, 'controller': case.controller, 'noise': case.noise,
        'log': case.log, 'setup': case.setup, 'bodies': case.bodies, 'gusts': case.gusts,
        'effects': effects,
        'stranger': None if case.stranger is None else {
            'kind': case.stranger[0], 'asked': case.stranger[1],
            'strength': reached[case.stranger[0]]}}


def _parameters(name, world, parts):
    """Return the parameters of an effect, and whether they mean what the library's do."""
    if name in parts:
        return {'parameters': parts[name].parameters, 'comparable': parts[name].comparable}
    # The exponent of a battery is that of a law that the library has in another form.
    return {'parameters': world.effects[name], 'comparable': name != 'battery_sag'}


def _beside(case, parts, params, log):
    """Return the names of effects that are present, too, and that a verdict may name."""
    names = {name for part in parts.values() for name in part.beside}
    if case.wrong_file:
        names |= {'inertia_mismatch'}
        # The drag of a file is linear, and that of neither rotors nor body by itself.
        names |= {'rotor_drag', 'body_drag'} if np.any(params['linear_drag']) else set()
    if case.gusts:
        names |= {'wind', 'unknown'}
    if log.charge:
        names |= {'thrust_scale', 'battery_sag'}
    return names


def _instead(case):
    """Return the names that are as good as those present."""
    if case.stranger is not None:
        return ALSO.get(case.stranger[0], ())
    # A mass that goes in flight is no constant of the vehicle.
    return ('unknown',) if case.log == 'dropped' else ()


def _path(case, params, rng):
    radius = params['rotor_radius']
    near = 'ground_effect' in case.effects or rng.random() < 0.4
    low = rng.uniform(1.2, 2.0) * radius if near else rng.uniform(8.0, 14.0) * radius
    if case.kind == 'poor':
        return Hover(rng, low)
    span = float(np.sqrt(params['rotor_radius'] / 0.1))
    return PATHS[case.path](rng, size=2.0 * span ** 0.5, acceleration=rng.uniform(1.8, 3.2),
                            low=low, turn=min(3.0, 0.25 * yaw_authority(params)))


def make_set(name, count, seed, jobs, folder, on_case=lambda done, total: None):
    """
    Write the cases of a set into `folder`, each in one with a random name.

    Returns the labels, and what could not be flown.

    Args: name of SETS; count: only the first so many cases, or None; seed: what is drawn depends
    on it alone; jobs: processes; on_case is called after each case.
    """
    chosen = SETS[name]
    whole = chosen.cases(np.random.default_rng(seed))
    cases = whole[:count]
    names = [secrets.token_hex(6) for _ in cases]
    labels, not_flown = {}, []
    # Not quad_ident_ros.cluster, which is the program's: nothing of it may see a label.
    with LocalCluster(n_workers=jobs, threads_per_worker=1, host='127.0.0.1',
                      dashboard_address=None, silence_logs=logging.CRITICAL) as local, \
            Client(local) as client:
        waiting = {client.submit(make_case, case, chosen.part, chosen.flights, chosen.seconds,
                                 Path(folder) / names[k], np.random.default_rng([seed, k]),
                                 pure=False): names[k]
                   for k, case in enumerate(cases)}
        for done in as_completed(waiting):
            try:
                labels[waiting[done]] = done.result()
            except Unflyable as error:
                not_flown.append(str(error))
            except Exception as error:      # of rotorpy: it takes no other case with it
                not_flown.append(f'{type(error).__name__}: {error}')
            on_case(len(labels) + len(not_flown), len(cases))
    if chosen.hybrids:
        try:
            labels |= _hybrids(chosen.part, Path(folder),
                               np.random.default_rng([seed, len(cases)]),
                               len(cases) / len(whole))
        except FileNotFoundError as error:
            not_flown.append(str(error))
    return labels, not_flown


def _hybrids(part, folder, rng, share):
    """Write a share of the changes to real flights, in folders of random names; return labels."""
    with tempfile.TemporaryDirectory() as apart:
        labels = make_hybrids(part, apart, rng, share=share)
        names = {name: secrets.token_hex(6) for name in labels}
        for name in labels:
            shutil.move(Path(apart) / name, folder / names[name])
    return {names[name]: label | {'base': names['base']} for name, label in labels.items()}


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
    sealed, key = seal({'set': options.set, 'seed': seed, 'labels': labels,
                        'not_flown': not_flown})
    Path(options.sealed).write_bytes(sealed)
    with os.fdopen(options.key, 'wb') as pipe:
        pipe.write(key)
    return 0


if __name__ == '__main__':
    from withheld import make  # by the name that workers import it by
    sys.exit(make.main())
