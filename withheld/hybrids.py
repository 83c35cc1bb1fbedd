# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Hybrids: flights of a real vehicle, in which software changes one thing by a known amount.

Nobody knows all that a real vehicle has; what was changed is known. A case is one of `CHANGES`
made to every flight of a set (or to its vehicle file), diagnosed beside the same set as it was
flown, and scored by `judge`: the verdict names the changed effect, which moves by as much as was
changed, and nothing else of it changes. `make_hybrids` writes the cases, the set as flown under
'base'.
"""

from dataclasses import dataclass, field
import gzip
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation
import yaml

from withheld.faults import csv_text

FOLDER = Path(__file__).resolve().parents[2] / 'shared' / 'flights' / 'nanobench'
# The last one is held out. The evaluation flies other paths than the development.
FLIGHTS = {'development': ('star_fast', 'oval_fast', 'figure8_fast'),
           'evaluation': ('helix_fast', 'lissajous_fast', 'star_medium', 'trefoil_medium')}
COMMANDS = ('cmd1', 'cmd2', 'cmd3', 'cmd4')
RATES = ('wx', 'wy', 'wz')
QUATERNION = ('qx', 'qy', 'qz', 'qw')
HEADROOM = 1.1      # on the largest speed in the vehicle file: the record has greater commands
SURE = 1.96         # standard errors on either side of a value: an interval of 95 %


@dataclass(frozen=True)
class Change:
    """
    What is changed, and what a diagnosis should say of it.

    effects: {effect: {parameter: amount}}; by: 'sum' where the amount is added to what the
    vehicle has, 'product' where that is multiplied; twins: effects that act the same; flight:
    (columns, vehicle) -> columns; vehicle: vehicle file -> vehicle file.
    """

    effects: dict
    by: str = 'sum'
    twins: tuple = ()
    flight: object = field(default=lambda columns, vehicle: columns)
    vehicle: object = field(default=lambda vehicle: vehicle)


def weaker(factor):
    """Return the Change to rotors with `factor` of their thrust: recorded commands are greater."""
    def flight(columns, vehicle):
        return columns | {name: columns[name] / np.sqrt(factor) for name in COMMANDS}
    return Change({'thrust_scale': {'factor': factor}}, 'product', ('mass_offset',), flight)


def emptying(fall):
    """Return the Change to thrust that falls evenly by a share over a flight, vbat or not."""
    def flight(columns, vehicle):
        gain = 1.0 - fall * (columns['t'] - columns['t'][0]) / np.ptp(columns['t'])
        return columns | {name: columns[name] / np.sqrt(gain) for name in COMMANDS}
    return Change({'battery_sag': {}}, flight=flight)


def later(rows):
    """Return the Change to commands that act some rows later than recorded, as if delayed."""
    def flight(columns, vehicle):
        count = len(columns['t']) - rows
        return {name: values[rows:] if name in COMMANDS else values[:count]
                for name, values in columns.items()}
    return Change({'actuation_delay': {'delay': 0.01 * rows}}, flight=flight)


def broken(rotor, loss):
    """
    Return the Change to a rotor (1 to 4) that turns more slowly than it is told.

    It loses the share of its thrust and of its reaction torque.
    """
    def flight(columns, vehicle):
        name = f'cmd{rotor}'
        return columns | {name: columns[name] / np.sqrt(1.0 - loss)}
    return Change({'rotor_fault': {f'loss_both_{rotor}': loss}}, flight=flight)


def off_centre(x, y):
    """
    Return the Change to a centre of mass that lies x, y m further from the middle.

    Its moment alone, by commands that share the same thrust otherwise; where the markers are
    stays as it was.
    """
    def flight(columns, vehicle):
        places = np.array([rotor['position'][:2] for rotor in vehicle['rotors']])
        thrust = np.stack([columns[name] for name in COMMANDS], axis=1) ** 2
        lever = places * np.array([x, y]) / np.sum(places ** 2, axis=0)
        thrust = thrust + np.sum(thrust, axis=1, keepdims=True) * lever.sum(axis=1)
        return columns | dict(zip(COMMANDS, np.sqrt(np.maximum(thrust, 0.0)).T, strict=True))
    return Change({'com_offset': {'x': x, 'y': y}}, flight=flight)


def tilted(roll, pitch):
    """Return the Change to an attitude that is measured in a frame tilted by roll, pitch, rad."""
    def flight(columns, vehicle):
        q = np.stack([columns[name] for name in QUATERNION], axis=1)
        turned = Rotation.from_quat(q) * Rotation.from_euler('ZYX', [0.0, pitch, roll])
        return columns | dict(zip(QUATERNION, turned.as_quat().T, strict=True))
    return Change({'attitude_misalignment': {'roll': roll, 'pitch': pitch}}, flight=flight)


def biased(x, y, z):
    """Return the Change to a gyro that reads x, y, z rad/s too much."""
    def flight(columns, vehicle):
        return columns | {name: columns[name] + bias
                          for name, bias in zip(RATES, (x, y, z), strict=True)}
    return Change({'gyro_bias': {'x': x, 'y': y, 'z': z}}, flight=flight)


def windy(x, y):
    """
    Return the Change to a wind of x, y m/s: the flight seen from a frame that moves against it.

    Exact, for no law of motion depends on the frame, and height stays as it was.
    """
    def flight(columns, vehicle):
        since = columns['t'] - columns['t'][0]
        return columns | {'px': columns['px'] + x * since, 'vx': columns['vx'] + x,
                          'py': columns['py'] + y * since, 'vy': columns['vy'] + y}
    return Change({'wind': {'x': x, 'y': y}}, flight=flight)


def heavier(share, mass):
    """Return the Change to a vehicle file that gives less mass: the vehicle has a share more."""
    def vehicle(known):
        return known | {'mass': known['mass'] / (1.0 + share)}
    return Change({'mass_offset': {'mass': mass * share / (1.0 + share)}},
                  twins=('thrust_scale',), vehicle=vehicle)


def slower(factor_x, factor_y):
    """Return the Change to a vehicle file that gives less inertia than the vehicle has."""
    def vehicle(known):
        x, y, z = known['inertia']
        return known | {'inertia': [x / factor_x, y / factor_y, z]}
    return Change({'inertia_mismatch': {'factor_x': factor_x, 'factor_y': factor_y}}, 'product',
                  vehicle=vehicle)


def draw_changes(rng, mass):
    """Return {name: Change}; sizes and signs are drawn. Args: mass kg in the vehicle file."""
    def either(low, high):
        return float(rng.choice([-1.0, 1.0]) * rng.uniform(low, high))

    return {
        'weaker': weaker(float(rng.uniform(0.86, 0.94))),
        'emptying': emptying(float(rng.uniform(0.08, 0.15))),
        'later_2': later(2), 'later_3': later(3),
        'broken': broken(int(rng.integers(1, 5)), float(rng.uniform(0.06, 0.12))),
        'off_centre': off_centre(either(5e-4, 1e-3), either(5e-4, 1e-3)),
        'tilted': tilted(either(0.04, 0.07), either(0.02, 0.05)),
        'biased': biased(*(either(0.03, 0.08) for _ in range(3))),
        'windy': windy(either(0.5, 1.0), either(0.3, 0.8)),
        'heavier': heavier(float(rng.uniform(0.1, 0.2)), mass),
        'slower': slower(*rng.uniform(1.25, 1.6, 2).tolist()),
    }


def read_flight(path):
    """Return the columns {name: (N,)} of a flight record, compressed or not."""
    with (gzip.open if path.suffix == '.gz' else open)(path, 'rt', encoding='utf-8') as lines:
        names = lines.readline().strip().split(',')
        return dict(zip(names, np.loadtxt(lines, delimiter=',', ndmin=2).T, strict=True))


def make_hybrids(part, folder, rng, source=FOLDER, share=1.0):
    """
    Write the cases of a part into `folder`, each in one of its name, and return their labels.

    The labels are {case: {'kind': 'hybrid', 'change', 'by', 'effects', 'twins'}}; that of 'base'
    has no change. share: of the changes, drawn, at least one. Raises FileNotFoundError where the
    flights are not there: they are no part of the package.
    """
    if not source.is_dir():
        # The report is kept: it names no folders of a machine.
        raise FileNotFoundError(f'{"/".join(source.parts[-3:])}, beside the repository: the real '
                                'flights that hybrids are made of are not there')
    flights = [read_flight(source / f'{name}.csv.gz') for name in FLIGHTS[part]]
    vehicle = yaml.safe_load((source / 'vehicle.yaml').read_text(encoding='utf-8'))
    vehicle['speed_max'] *= HEADROOM
    drawn = draw_changes(rng, vehicle['mass'])
    count = max(1, round(share * len(drawn)))
    chosen = rng.permutation(list(drawn))[:count]
    changes = {'base': Change({})} | {name: drawn[name] for name in sorted(map(str, chosen))}
    labels = {}
    for name, change in changes.items():
        case = Path(folder) / name
        case.mkdir(parents=True)
        for number, columns in enumerate(flights, 1):
            changed = change.flight(columns, vehicle)
            (case / f'flight_{number}.csv').write_text(csv_text(changed), encoding='utf-8')
        (case / 'vehicle.yaml').write_text(
            yaml.safe_dump(change.vehicle(vehicle), sort_keys=False), encoding='utf-8')
        labels[name] = {'kind': 'hybrid', 'change': name, 'by': change.by,
                        'effects': change.effects, 'twins': list(change.twins)}
    return labels


def judge(label, base, found):
    """
    Return what came of one change.

    named: the verdict has the effect, or one of its twins; gained: it has, and that of the base
    has not; moved: whether each of its parameters moved by the amount, within the interval of the
    two, or None where one of the two does not state it, as another form does not; lost: what the
    base names and this verdict does not; added: what else it names. right: it is named and did not
    move by another amount, and nothing is lost or added; None where the base names it too and its
    amounts are not stated.

    Args: label of make_hybrids; base, found: diagnoses as formats.md has them.
    """
    [(effect, amounts)] = label['effects'].items()
    names = {effect, *label['twins']}
    before, after = set(base['verdict']), set(found['verdict'])
    moved = [None if _in_another_form(base, effect, parameter) else
             _moved(label['by'], amount, *(_value(one, effect, parameter)
                                           for one in (base, found)))
             for parameter, amount in amounts.items()]
    known = [one for one in moved if one is not None]
    moved = all(known) if moved and len(known) == len(moved) else None
    named, lost, added = bool(names & after), before - after - names, after - before - names
    gained = named and not names & before
    right = named and moved is not False and not lost and not added
    return {'named': named, 'gained': gained, 'moved': moved, 'lost': sorted(lost),
            'added': sorted(added), 'right': None if right and not (gained or moved) else right}


def _value(found, effect, parameter):
    """Return value and standard error, or None where the effect is not in a diagnosis."""
    for row in found['ranking']:
        one = row['parameters'].get(parameter)
        if row['effect'] == effect and one:
            return one['value'], one['std']
    return None


def _in_another_form(found, effect, parameter):
    """Return whether a diagnosis states an effect by other parameters than this one."""
    return any(row['effect'] == effect and row['parameters']
               and parameter not in row['parameters'] for row in found['ranking'])


def _moved(by, amount, before, after):
    """Return whether a parameter moved by an amount; what the base does not name is nothing."""
    if after is None:
        return None
    value, error = before or ((0.0, 0.0) if by == 'sum' else (1.0, 0.0))
    expected, error = (value + amount, error) if by == 'sum' else (value * amount, error * amount)
    return bool(abs(after[0] - expected) <= SURE * np.hypot(error, after[1]))
