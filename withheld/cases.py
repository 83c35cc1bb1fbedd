# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the sets are made of: which effects, how strong, on which vehicle, how flown."""

from dataclasses import dataclass, field

import numpy as np

from withheld.forms import FORMS
from withheld.logs import LOGS

EFFECTS = ('motor_lag', 'actuation_delay', 'rotor_drag', 'body_drag', 'wind', 'inflow',
           'ground_effect', 'battery_sag', 'thrust_scale', 'mass_offset', 'inertia_mismatch',
           'com_offset', 'rotor_fault', 'rotor_gyro', 'blade_flapping', 'attitude_misalignment',
           'gyro_bias')
STRANGERS = {'development': ('periodic_force', 'tether', 'thrust_exponent', 'backlash'),
             'evaluation': ('updraft', 'slosh', 'ceiling', 'neighbours')}
# Names that do as well as `unknown`: a thrust curve of another exponent is a thrust curve.
ALSO = {'thrust_exponent': ('thrust_scale',)}
STRENGTHS = (0.3, 1.0, 3.0)
VEHICLES = 3
DATASHEET = ('thrust_scale', 'inertia_mismatch', 'motor_lag', 'rotor_drag')
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
    constant of the vehicle file is a little off; log: one of logs.LOGS; setup: which of the
    estimator's setups the states come out of, or None for states with noise; bodies: flown in
    MuJoCo; gusts: 1 is light turbulence.
    """

    kind: str
    effects: dict
    vehicle: int
    stranger: tuple | None = None
    faulty: bool = False
    forms: dict = field(default_factory=dict)
    wrong_file: bool = False
    log: str = ''
    setup: int | None = None
    bodies: bool = False
    gusts: float = 0.0

    @property
    def column(self):
        """Return the column of the tables that the case counts in: see score.column_of."""
        for column, applies in (
                ('faulty', self.faulty), ('estimator', self.setup is not None),
                ('files', self.wrong_file or self.kind == 'datasheet'), ('logs', self.log),
                ('forms', self.forms or self.bodies or self.gusts)):
            if applies:
                return column
        return 'ours'


def several(count, rng, part=None):
    """Return effects {name: strength} and, where a part is given, forms {effect: form} of it."""
    while True:
        names = [str(name) for name in rng.choice(EFFECTS, count, replace=False)]
        if not any(twins <= set(names) for twins in TWINS):
            effects = {name: float(np.round(rng.uniform(0.8, 3.0), 2)) for name in names}
            return {'effects': effects} | ({} if part is None else {'forms': {
                name: str(rng.choice(list(FORMS[part][name]))) for name in names}})


def _many(kind, count, size, rng, part=None, **options):
    """Return cases of several effects; size is their number, or (least, most) in turn."""
    least, most = (size, size) if isinstance(size, int) else size
    return [Case(kind, vehicle=i % VEHICLES,
                 **several(least + i % (most - least + 1), rng, part), **options)
            for i in range(count)]


def _nones(count, **options):
    return [Case('none', {}, i % VEHICLES, **options) for i in range(count)]


def _singles(strengths, **options):
    """Return each effect once, with the strengths and vehicles in turn."""
    return [Case('single', {name: strengths[i % len(strengths)]}, i % VEHICLES, **options)
            for i, name in enumerate(EFFECTS)]


def _strangers(part, strengths, **options):
    return [Case('unknown', {}, i % VEHICLES, (kind, strength), **options)
            for i, kind in enumerate(STRANGERS[part]) for strength in strengths]


def _forms(part, strengths):
    """Return each form of a part at each strength."""
    flat = [(name, form) for name, forms in FORMS[part].items() for form in forms]
    return [Case('single', {name: strength}, (i + j) % VEHICLES, forms={name: form})
            for i, (name, form) in enumerate(flat) for j, strength in enumerate(strengths)]


def _logs(rounds):
    """Return what logging does, beside `none` and effects in turn."""
    names = ('motor_lag', 'rotor_drag', 'thrust_scale', 'actuation_delay', 'ground_effect',
             'rotor_fault', 'battery_sag')
    cases = []
    for i, log in enumerate(log for log in LOGS if log not in ('', 'dropped')):
        cases.append(Case('none', {}, i % VEHICLES, log=log))
        # Where the thrust differs by flight it is no effect that all share.
        some = [name for name in names if log != 'charge' or name not in (
            'thrust_scale', 'battery_sag')]
        cases += [Case('single', {some[(i + j) % len(some)]: (3.0, 1.0)[j % 2]},
                       (i + j) % VEHICLES, log=log) for j in range(rounds)]
    cases += [Case('single', {'mass_offset': (3.0, 10.0, 6.0)[i]}, i,
                   forms={'mass_offset': 'dropped'}, log='dropped') for i in range(rounds)]
    return cases


def _gusty(count):
    return [Case('none', {}, 0, gusts=1.0)] + [
        Case('single', {name: 3.0}, i % VEHICLES, gusts=1.0) for i, name in enumerate(
            ('wind', 'rotor_drag', 'body_drag', 'motor_lag', 'mass_offset', 'inflow')[:count])]


def quick_set(rng):
    """Return a small set to develop with: each effect at each strength once, and some others."""
    part = 'development'
    cases = [Case('single', {name: strength}, (i + j) % VEHICLES)
             for i, name in enumerate(EFFECTS) for j, strength in enumerate(STRENGTHS)]
    cases += _nones(5) + _many('pair', 6, 2, rng) + _many('mixture', 3, 3, rng)
    cases += _strangers(part, (3.0,)) + _forms(part, (3.0,))
    cases += _many('pair', 4, 2, rng, part)
    cases += _singles((1.0, 3.0), wrong_file=True)[::3] + _nones(3, wrong_file=True)
    cases += [Case('datasheet', dict.fromkeys(DATASHEET), i) for i in range(2)]
    cases += _logs(1) + _gusty(2)
    cases += _singles((3.0,), setup=0)[::4] + _singles((3.0,), setup=1)[2::4]
    cases += _nones(2, setup=0) + _nones(2, setup=1)
    cases += _singles((3.0,), faulty=True)[::3] + _nones(3, faulty=True)
    cases += _many('pair', 6, 2, rng, faulty=True) + _many('mixture', 6, (3, 5), rng, faulty=True)
    return [cases[k] for k in rng.permutation(len(cases))]


def full_set(rng):
    """Return the whole set: what the tables are made of."""
    part = 'evaluation'
    cases = [Case('single', {name: strength}, vehicle) for name in EFFECTS
             for strength in STRENGTHS for vehicle in range(VEHICLES)]
    cases += _nones(24) + _many('pair', 24, 2, rng) + _many('mixture', 18, (3, 5), rng)
    cases += _strangers(part, (1.0, 3.0, 3.0))
    cases += [Case('poor', {} if name == 'none' else {name: 3.0}, i % VEHICLES)
              for i, name in enumerate(HOVERED)]
    cases += _forms(part, (1.0, 3.0)) + _many('pair', 18, 2, rng, part)
    cases += _many('mixture', 12, (3, 5), rng, part)
    cases += _singles((3.0,), bodies=True)[::2] + _gusty(6)
    cases += _singles((1.0, 3.0), wrong_file=True) + _nones(8, wrong_file=True)
    cases += _many('pair', 8, 2, rng, wrong_file=True)
    cases += [Case('datasheet', dict.fromkeys(DATASHEET), i % VEHICLES) for i in range(8)]
    cases += _logs(3)
    for setup in (0, 1):
        cases += _singles((1.0, 3.0)[::1 - 2 * setup], setup=setup) + _nones(8, setup=setup)
        cases += _many('pair', 7, 2, rng, setup=setup)
        cases += _many('mixture', 5, (3, 5), rng, setup=setup)
        cases += _strangers(part, (3.0,), setup=setup)
    cases += _singles((1.0, 3.0), faulty=True) + _nones(12, faulty=True)
    cases += _many('pair', 12, 2, rng, faulty=True) + _many('mixture', 12, (3, 5), rng,
                                                            faulty=True)
    cases += _strangers(part, (3.0,), faulty=True)
    return [cases[k] for k in rng.permutation(len(cases))]


@dataclass(frozen=True)
class Set:
    """
    Cases, whose vehicles and paths they fly, and how many flights of how many seconds.

    hybrids: with the changes made to real flights, where these are there.
    """

    cases: object
    part: str
    flights: int
    seconds: float
    hybrids: bool = False


SETS = {'development': Set(quick_set, 'development', 3, 20.0),
        'evaluation': Set(full_set, 'evaluation', 4, 20.0, hybrids=True)}
