# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the sets are made of: which effects, how strong, on which vehicle, how flown."""

from dataclasses import dataclass, field

import numpy as np

EFFECTS = ('motor_lag', 'actuation_delay', 'rotor_drag', 'body_drag', 'wind', 'inflow',
           'ground_effect', 'battery_sag', 'thrust_scale', 'mass_offset', 'inertia_mismatch',
           'com_offset', 'rotor_fault', 'rotor_gyro', 'blade_flapping', 'attitude_misalignment',
           'gyro_bias')
STRANGERS = ('periodic_force', 'tether', 'updraft', 'thrust_exponent', 'backlash', 'slosh')
STRENGTHS = (0.3, 1.0, 3.0)
VEHICLES = 3
# A pair of these in one reality would be one effect with another name.
TWINS = ({'thrust_scale', 'mass_offset'}, {'com_offset', 'rotor_fault'})
HOVERED = ('thrust_scale', 'mass_offset', 'com_offset', 'rotor_fault', 'wind',
           'attitude_misalignment', 'motor_lag', 'rotor_drag', 'inertia_mismatch', 'none')


@dataclass(frozen=True)
class Case:
    """
    One reality to make.

    kind: single, none, pair, mixture, unknown, poor or datasheet; effects {name: strength};
    stranger (kind, strength) or None; vehicle of the three; faulty: with the faults of real
    records; forms {effect: form} of those that have another than the library's; wrong_file: every
    constant of the vehicle file is a little off; log: one of logs.LOGS.
    """

    kind: str
    effects: dict
    vehicle: int
    stranger: tuple | None = None
    faulty: bool = False
    forms: dict = field(default_factory=dict)
    wrong_file: bool = False
    log: str = ''


def _several(count, rng):
    while True:
        names = list(rng.choice(EFFECTS, count, replace=False))
        if not any(twins <= set(names) for twins in TWINS):
            return {str(name): float(np.round(rng.uniform(0.8, 3.0), 2)) for name in names}


def quick_set(rng):
    """Return a small set to develop with: each effect at each strength once, and some others."""
    cases = [Case('single', {name: strength}, (i + j) % VEHICLES)
             for i, name in enumerate(EFFECTS) for j, strength in enumerate(STRENGTHS)]
    cases += [Case('none', {}, i % VEHICLES) for i in range(5)]
    cases += [Case('pair', _several(2, rng), i % VEHICLES) for i in range(6)]
    cases += [Case('mixture', _several(3, rng), i % VEHICLES) for i in range(3)]
    cases += [Case('unknown', {}, i % VEHICLES, (kind, (1.0, 3.0)[i % 2]))
              for i, kind in enumerate(STRANGERS)]
    cases += [Case('single', {str(name): 3.0}, i % VEHICLES, faulty=True)
              for i, name in enumerate(rng.choice(EFFECTS, 6, replace=False))]
    cases += [Case('none', {}, i, faulty=True) for i in range(VEHICLES)]
    cases += [Case('pair', _several(2, rng), i % VEHICLES, faulty=True) for i in range(6)]
    cases += [Case('mixture', _several(3 + i % 3, rng), i % VEHICLES, faulty=True)
              for i in range(6)]
    return [cases[k] for k in rng.permutation(len(cases))]


def full_set(rng):
    """Return the whole set: what the tables are made of."""
    cases = [Case('single', {name: strength}, vehicle) for name in EFFECTS
             for strength in STRENGTHS for vehicle in range(VEHICLES)]
    cases += [Case('none', {}, i % VEHICLES) for i in range(24)]
    cases += [Case('pair', _several(2, rng), i % VEHICLES) for i in range(24)]
    cases += [Case('mixture', _several(3 + i % 3, rng), i % VEHICLES) for i in range(18)]
    cases += [Case('unknown', {}, i % VEHICLES, (kind, strength))
              for i, kind in enumerate(STRANGERS) for strength in (1.0, 3.0)]
    cases += [Case('unknown', {}, i % VEHICLES, (kind, 3.0)) for i, kind in enumerate(STRANGERS)]
    cases += [Case('poor', {} if name == 'none' else {name: 3.0}, i % VEHICLES)
              for i, name in enumerate(HOVERED)]
    faulty = [Case('single', {name: (1.0, 3.0)[i % 2]}, i % VEHICLES, faulty=True)
              for i, name in enumerate(EFFECTS)]
    faulty += [Case('none', {}, i % VEHICLES, faulty=True) for i in range(10)]
    faulty += [Case('pair', _several(2, rng), i % VEHICLES, faulty=True) for i in range(12)]
    faulty += [Case('mixture', _several(3 + i % 3, rng), i % VEHICLES, faulty=True)
               for i in range(12)]
    faulty += [Case('unknown', {}, i % VEHICLES, (kind, 3.0), faulty=True)
               for i, kind in enumerate(STRANGERS)]
    cases += faulty
    return [cases[k] for k in rng.permutation(len(cases))]


@dataclass(frozen=True)
class Set:
    """Cases, whose vehicles and paths they fly, and how many flights of how many seconds."""

    cases: object
    part: str
    flights: int
    seconds: float


SETS = {'development': Set(quick_set, 'development', 3, 20.0),
        'evaluation': Set(full_set, 'evaluation', 4, 20.0)}
