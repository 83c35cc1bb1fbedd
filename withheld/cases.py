# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the sets are made of: which effects, how strong, on which vehicle, how flown."""

from dataclasses import dataclass, field, replace

import numpy as np

from withheld.forms import FORMS
from withheld.lists import CONTROLLERS, NOISES, ORDINARY, PATHS, STRANGERS, VEHICLES
from withheld.logs import LOGS

EFFECTS = ('motor_lag', 'actuation_delay', 'rotor_drag', 'body_drag', 'wind', 'inflow',
           'ground_effect', 'battery_sag', 'thrust_scale', 'mass_offset', 'inertia_mismatch',
           'com_offset', 'rotor_fault', 'rotor_gyro', 'blade_flapping', 'attitude_misalignment',
           'gyro_bias')
# Names that do as well as `unknown`: a thrust curve of another exponent is a thrust curve.
ALSO = {'thrust_exponent': ('thrust_scale',)}
STRENGTHS = (0.3, 1.0, 3.0)
DATASHEET = ('thrust_scale', 'inertia_mismatch', 'motor_lag', 'rotor_drag')
# A pair of these in one reality would be one effect with another name.
TWINS = ({'thrust_scale', 'mass_offset'}, {'com_offset', 'rotor_fault'})
HOVERED = ('thrust_scale', 'mass_offset', 'com_offset', 'rotor_fault', 'wind',
           'attitude_misalignment', 'motor_lag', 'rotor_drag', 'inertia_mismatch', 'none')


@dataclass(frozen=True)
class Case:
    """
    One reality to make.

    kind: single, none, pair, mixture, unknown, poor, datasheet or whole; effects {name: strength};
    stranger (kind, strength) or None; faulty: with the faults of real records; forms {effect:
    form} of those that have another than the library's; wrong_file: every constant of the vehicle
    file is a little off; log: one of logs.LOGS; setup: which of the estimator's setups the states
    come out of, or None for states with noise; bodies: flown in MuJoCo; gusts: 1 is light
    turbulence; vehicle, path, controller, noise: names of the lists of the set's part.
    """

    kind: str
    effects: dict
    stranger: tuple | None = None
    faulty: bool = False
    forms: dict = field(default_factory=dict)
    wrong_file: bool = False
    log: str = ''
    setup: int | None = None
    bodies: bool = False
    gusts: float = 0.0
    vehicle: str = ''
    path: str = ''
    controller: str = ''
    noise: str = ''

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


def several(count, rng, forms=None):
    """Return effects {name: strength}, with forms {effect: one of some}, where these are given."""
    while True:
        names = [str(name) for name in rng.choice(EFFECTS, count, replace=False)]
        if not any(twins <= set(names) for twins in TWINS):
            effects = {name: float(np.round(rng.uniform(0.8, 3.0), 2)) for name in names}
            return {'effects': effects} | ({} if forms is None else {'forms': {
                name: str(rng.choice(list(forms[name]))) for name in names}})


def _many(kind, count, size, rng, forms=None, **options):
    """Return cases of several effects; size is their number, or (least, most) in turn."""
    least, most = (size, size) if isinstance(size, int) else size
    return [Case(kind, **several(least + i % (most - least + 1), rng, forms), **options)
            for i in range(count)]


def _nones(count, **options):
    return [Case('none', {}, **options) for _ in range(count)]


def _singles(strengths, **options):
    """Return each effect once, with the strengths in turn."""
    return [Case('single', {name: strengths[i % len(strengths)]}, **options)
            for i, name in enumerate(EFFECTS)]


def _strangers(part, strengths, **options):
    return [Case('unknown', {}, (kind, strength), **options)
            for kind in STRANGERS[part] for strength in strengths]


def _forms(part, strengths):
    """Return each form of a part at each strength."""
    return [Case('single', {name: strength}, forms={name: form})
            for name, forms in FORMS[part].items() for form in forms for strength in strengths]


def _logs(rounds):
    """
    Return what logging does, beside `none` and effects in turn.

    Where commands are lacking in the log, what it hides is no effect: `none` as often as others.
    """
    names = ('motor_lag', 'rotor_drag', 'thrust_scale', 'actuation_delay', 'ground_effect',
             'rotor_fault', 'battery_sag')
    cases = []
    for i, log in enumerate(log for log in LOGS if log not in ('', 'dropped')):
        cases += _nones(rounds if LOGS[log].logging.every > 1 else 1, log=log)
        # Where the thrust differs by flight it is no effect that all share.
        some = [name for name in names if log != 'charge' or name not in (
            'thrust_scale', 'battery_sag')]
        cases += [Case('single', {some[(i + j) % len(some)]: (3.0, 1.0)[j % 2]}, log=log)
                  for j in range(rounds)]
    cases += [Case('single', {'mass_offset': (3.0, 10.0, 6.0)[i]},
                   forms={'mass_offset': 'dropped'}, log='dropped') for i in range(rounds)]
    return cases


def _gusty(count):
    return [Case('none', {}, gusts=1.0)] + [
        Case('single', {name: 3.0}, gusts=1.0) for name in (
            'wind', 'rotor_drag', 'body_drag', 'motor_lag', 'mass_offset', 'inflow')[:count]]


def _datasheets(count):
    return [Case('datasheet', dict.fromkeys(DATASHEET)) for _ in range(count)]


def _wholes(count, rng, part):
    """Return vehicles as real ones are: four to seven effects at once, each in another form."""
    return [Case('whole', **several(4 + i % 4, rng, FORMS[part]), wrong_file=i % 2 == 0,
                 log='fast_control' if i % 3 == 1 else '') for i in range(count)]


def quick_set(rng):
    """Return a small set to develop with: each effect at each strength once, and some others."""
    part = 'development'
    cases = [Case('single', {name: strength}) for name in EFFECTS for strength in STRENGTHS]
    cases += _nones(6) + _many('pair', 6, 2, rng) + _many('mixture', 6, (3, 5), rng)
    cases += _strangers(part, (3.0,)) + _forms(part, (3.0,))
    cases += _many('pair', 4, 2, rng, FORMS[part])
    cases += _many('mixture', 3, (3, 5), rng, FORMS[part])
    cases += _wholes(12, rng, part)
    cases += _singles((3.0,), bodies=True)[::6] + _gusty(2)
    cases += _singles((1.0, 3.0), wrong_file=True)[::3] + _nones(3, wrong_file=True)
    cases += _datasheets(2) + _logs(1)
    cases += _singles((3.0,), setup=0)[::4] + _singles((3.0,), setup=1)[2::4]
    cases += _nones(2, setup=0) + _nones(2, setup=1)
    cases += _singles((3.0,), faulty=True)[::3] + _nones(3, faulty=True)
    cases += _many('pair', 6, 2, rng, faulty=True) + _many('mixture', 6, (3, 5), rng, faulty=True)
    return _dealt(cases, part, rng)


def ordinary_set(rng):
    """Return a set of forms of ordinary vehicles alone, to develop with."""
    part = 'development'
    cases = [Case('single', {name: (1.0, 3.0)[i % 2]}, forms={name: form})
             for i, (name, form) in enumerate(
                 (name, form) for name, forms in ORDINARY.items() for form in forms)]
    cases += _many('pair', 36, 2, rng, ORDINARY) + _many('mixture', 24, (3, 5), rng, ORDINARY)
    return _dealt(cases, part, rng)


def full_set(rng):
    """Return the whole set: what the tables are made of."""
    part = 'evaluation'
    cases = [Case('single', {name: strength}) for name in EFFECTS for strength in STRENGTHS
             for _ in range(2)]
    cases += _nones(24) + _many('pair', 24, 2, rng) + _many('mixture', 18, (3, 5), rng)
    cases += _strangers(part, (1.0, 3.0, 3.0))
    cases += [Case('poor', {} if name == 'none' else {name: 3.0}) for name in HOVERED]
    cases += _forms(part, (1.0, 3.0)) + _many('pair', 18, 2, rng, FORMS[part])
    cases += _many('mixture', 12, (3, 5), rng, FORMS[part]) + _wholes(12, rng, part)
    cases += _singles((3.0,), bodies=True)[::2] + _gusty(6)
    cases += _singles((1.0, 3.0), wrong_file=True) + _nones(8, wrong_file=True)
    cases += _many('pair', 8, 2, rng, wrong_file=True)
    cases += _many('mixture', 4, (3, 5), rng, wrong_file=True) + _datasheets(8) + _logs(3)
    for setup in (0, 1):
        cases += _singles((1.0, 3.0)[::1 - 2 * setup], setup=setup) + _nones(8, setup=setup)
        cases += _many('pair', 7, 2, rng, setup=setup)
        cases += _many('mixture', 5, (3, 5), rng, setup=setup)
        cases += _strangers(part, (3.0,), setup=setup)
    cases += _singles((1.0, 3.0), faulty=True) + _nones(12, faulty=True)
    cases += _many('pair', 12, 2, rng, faulty=True) + _many('mixture', 12, (3, 5), rng,
                                                            faulty=True)
    cases += _strangers(part, (3.0,), faulty=True)
    return _dealt(cases, part, rng)


def stratum_of(case: Case) -> tuple:
    """Return what a smaller draw keeps the share of: a row of the tables, or what is beside it."""
    apart = case.log or ('gusts' if case.gusts else case.kind)
    return case.column, apart, case.bodies, case.setup


def _dealt(cases: list[Case], part: str, rng: np.random.Generator) -> list[Case]:
    """
    Return the cases named, in an order in which each beginning has them in proportion.

    The k-th of n cases of a stratum comes where (k + 1/2) / n of all have come; within a stratum,
    and where two fall together, chance decides. So the first N have of every stratum about what
    is its share, to a case or two. Vehicle, path, controller and noise are dealt to them in turn,
    each from a shuffled list.
    """
    strata = {}
    for k in rng.permutation(len(cases)):
        strata.setdefault(stratum_of(cases[k]), []).append(cases[k])
    places = [((number + 0.5) / len(some), rng.random(), case)
              for some in strata.values() for number, case in enumerate(some)]
    ordered = [case for *_, case in sorted(places, key=lambda place: place[:2])]
    decks = {subject: _deck(names[part], len(ordered), rng) for subject, names in (
        ('vehicle', VEHICLES), ('path', PATHS), ('controller', CONTROLLERS), ('noise', NOISES))}
    return [replace(case, **{subject: deck[k] for subject, deck in decks.items()})
            for k, case in enumerate(ordered)]


def _deck(names: tuple[str, ...], count: int, rng: np.random.Generator) -> list[str]:
    """Return so many names, each as often as any other, by shuffling the list again and again."""
    rounds = -(-count // len(names))
    return [names[k] for _ in range(rounds) for k in rng.permutation(len(names))][:count]


@dataclass(frozen=True)
class Set:
    """
    Cases, whose vehicles and paths they fly, and how many flights of how many seconds.

    hybrids: with the changes made to real flights, where these exist.
    """

    cases: object
    part: str
    flights: int
    seconds: float
    hybrids: bool = False


SETS = {'development': Set(quick_set, 'development', 3, 20.0),
        'ordinary': Set(ordinary_set, 'development', 4, 20.0),
        'evaluation': Set(full_set, 'evaluation', 4, 20.0, hybrids=True)}
