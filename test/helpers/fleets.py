# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of made vehicles along made flights, as values with standard errors."""

from datetime import datetime, timedelta, timezone

import numpy as np

from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.fleet.history import Series

DAY = 86400.0
START = datetime(2026, 5, 1, 8, 0, tzinfo=timezone.utc)


def series(values, errors, *, days=None, covariates=None, vehicle='uav1', effect='thrust_scale',
           parameter='factor', unit='1'):
    """Return a Series of values (N,), by default of one flight every three days."""
    values = np.asarray(values, float)
    count = len(values)
    days = 3.0 * np.arange(count) if days is None else days
    covariates = np.zeros((count, 0)) if covariates is None else np.asarray(covariates, float)
    return Series(vehicle, 'plain', effect, parameter, unit, DAY * np.asarray(days, float),
                  tuple(f'flight {k}' for k in range(count)),
                  tuple(f'{k}.csv' for k in range(count)), np.arange(count), values,
                  np.broadcast_to(np.asarray(errors, float), (count,)), covariates,
                  tuple(f'covariate {k}' for k in range(covariates.shape[1])))


def steady(rng, count, *, error=1.0, scatter=1.0, told=1.0, **options):
    """
    Return a Series of a vehicle that stays as it is.

    Args: error, scatter: standard deviations of a value and between flights; told: what is said
    of the standard errors, times what they are.
    """
    values = 3.0 + error * rng.standard_normal(count) + scatter * rng.standard_normal(count)
    return series(values, told * error, **options)


def in_days(rng, days, each, *, apart=0.0, error=0.3, **options):
    """
    Return a Series of a vehicle that stays as it is, with flights an hour apart on each of days.

    Args: each: flights of a day, whose values differ by 1, error of it their standard errors;
    apart: standard deviation of days.
    """
    day = np.repeat(np.arange(days), each)
    values = 3.0 + rng.standard_normal(days * each) + apart * rng.standard_normal(days)[day]
    return series(values, error, days=day + np.tile(np.arange(each), days) / 24.0, **options)


DENSITY = 1.0 / 288.0       # share of its thrust that a rotor loses in air a degree warmer
WEEK = 7 * DAY


def in_spring(rng, vehicles, flights, *, weather=3.0, follows=(), wrong=0.0):
    """
    Return Series of the thrust of steady vehicles, twice a week in a spring that gets warmer.

    Args: weather: standard deviation (degrees C) of days about the season; follows: how much of
    the thrust that air takes the first vehicles lose, all others 1; wrong: standard deviation of
    the temperature that is told.
    """
    days, warm, told, values = [], [], [], []
    for number in range(vehicles):
        days.append(3.5 * np.arange(flights) + rng.uniform(0.0, 1.0, flights))
        warm.append(10.0 * np.sin(2.0 * np.pi * (days[-1] - 40.0) / 365.25)
                    + weather * rng.standard_normal(flights))
        told.append(warm[-1] + wrong * rng.standard_normal(flights))
        share = follows[number] if number < len(follows) else 1.0
        values.append(1.0 + 0.01 * rng.standard_normal() - DENSITY * share * warm[-1]
                      + 0.004 * rng.standard_normal(flights))
    usual, apart = np.mean(told), np.std(told)
    return [series(values[number], 1.5e-4, days=days[number], vehicle=f'uav{number}',
                   covariates=(told[number][:, None] - usual) / apart)
            for number in range(vehicles)]


def drift(one, per_week):
    """Let the values of a Series drift from its first flight on."""
    one.values[:] += per_week * (one.t - one.t[0]) / WEEK


TRACKED = {('rotor_drag', 'coefficient'): ('kg/s', 0.06, 0.004, 0.001),
           ('com_offset', 'x'): ('m', 0.0, 5e-4, 2e-4),
           ('thrust_scale', 'factor'): ('1', 1.0, 0.01, 0.004)}
"""Effect and parameter: unit, mean, spread between vehicles, scatter between flights."""
GROUPS = 5          # flights of a vehicle that were diagnosed together


def data_set(out, *, vehicles=8, flights=20, seed=1, steps=(), slopes=(), odd=(), wrong=(),
             configuration=''):
    """
    Write the data set of a fleet into a folder: its values, without a flight that was flown.

    wrong, steps: (vehicle, effect, parameter, flight, size), of a flight and from it on; slopes:
    (..., per week); odd: (..., size).
    The first flight of the first vehicle is refused.
    """
    rng = np.random.default_rng(seed)
    known = {(name, key): {} for name, key in TRACKED}
    for vehicle in range(vehicles):
        name = f'uav{vehicle + 1}'
        temperatures = 15.0 + 5.0 * rng.standard_normal(flights)
        for key, (_, mean, spread, scatter) in TRACKED.items():
            values = mean + spread * rng.standard_normal() + scatter * rng.standard_normal(flights)
            for one, *what, number, size in steps:
                if (one, tuple(what)) == (name, key):
                    values[number:] += size
            for one, *what, number, size in wrong:
                if (one, tuple(what)) == (name, key):
                    values[number] += size
            for one, *what, slope in slopes:
                if (one, tuple(what)) == (name, key):
                    values += slope * 3.0 / 7.0 * np.arange(flights)
            for one, *what, size in odd:
                if (one, tuple(what)) == (name, key):
                    values += size
            known[key][name] = values
        _write(out, name, configuration, known, temperatures, vehicle == 0)


def _write(out, name, configuration, known, temperatures, refused):
    """Write the rows of a vehicle."""
    from quad_ident_ros.fleet.store import write_rows  # its pyarrow is an extra
    flights = len(temperatures)
    dates = [START + timedelta(days=3.0 * number) for number in range(flights)]
    for group in range(-(-flights // GROUPS)):
        key, numbers = f'{name}-{group}', range(group * GROUPS, min((group + 1) * GROUPS, flights))
        whose = {'group': key, 'vehicle': name, 'configuration': configuration}
        dated = whose | {'date': dates[numbers[0]]}
        bad = {0} if refused and group == 0 else set()
        write_rows(out, 'flights', key, [dated | {
            'flight': f'{name}/{number}', 'path': f'/logs/{name}/{number}.csv',
            'date': dates[number], 'duration_s': 10.0, 'rate_hz': 100.0, 'held_out': False,
            'status': 'refused' if number in bad else 'diagnosed',
            'reason': 'this is not text' if number in bad else '', 'findings': [],
            'covariates': {'temperature_c': float(temperatures[number])}} for number in numbers])
        effects = [{'effect': effect, 'probability': 0.97, 'contribution': 0.3,
                    'form': EFFECTS[effect].forms[0].name, 'named': True, 'minor': False}
                   for effect in ('rotor_drag', 'com_offset')]
        write_rows(out, 'effects', key, [dated | one for one in effects])
        gaps = {f'gap_{when}_{group}': size for group in ('position', 'velocity', 'attitude',
                                                          'rate')
                for when, size in (('before', 0.4), ('after', 0.05), ('noise', 0.03))}
        write_rows(out, 'groups', key, [dated | gaps | {
            'flights': len(numbers), 'status': 'diagnosed', 'reason': '',
            'verdict': ['rotor_drag', 'com_offset'], 'minor': [], 'closed': 0.9, 'findings': [],
            'diagnosis': '', 'version': '0', 'rules': '', 'seconds': 1.0}])
        write_rows(out, 'parameters', key, [dated | {
            'flight': f'{name}/{number}', 'date': dates[number], 'effect': effect,
            'parameter': parameter, 'unit': TRACKED[effect, parameter][0],
            'value': float(values[name][number]), 'std': 0.2 * TRACKED[effect, parameter][3]}
            for (effect, parameter), values in known.items() for number in numbers
            if number not in bad])
