# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A force and moment as a function of state and command, as plain numbers of a vehicle file."""

from collections.abc import Collection
from dataclasses import dataclass, replace
import math
from typing import Any

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError

LAGS = (0.05, 0.25)     # s by which commands are smoothed: of rotors, and of the flow about them
INPUTS = (
    # Velocity against the air, m/s, rate, rad/s, and the upward direction, all along body axes.
    'air_x', 'air_y', 'air_z', 'rate_x', 'rate_y', 'rate_z', 'up_x', 'up_y', 'up_z',
    # Height of the centre of mass, m.
    'height',
    # What the rotors' speeds make by the nominal coefficients, N and N m.
    'thrust', 'moment_x', 'moment_y', 'moment_z',
    # What smoothed commands make more than that, for each of LAGS.
    'thrust_before', 'moment_x_before', 'moment_y_before', 'moment_z_before',
    'thrust_long_before', 'moment_x_long_before', 'moment_y_long_before', 'moment_z_long_before')
CHANNELS = 6            # force along and moment about body x, y, z
ARGUMENTS = 3           # inputs in one wave
MOST_WAVES = 1000       # a step of the integration takes as long as it has waves


@dataclass(frozen=True)
class Wave:
    """
    A wave over some inputs, w cos(f1 x1 + f2 x2 + f3 x3 + phase), x from -1 to 1.

    inputs (3,): their places among those of the function; frequencies (3,), rad; phase, rad;
    weights (6,), N and N m.
    """

    inputs: tuple[int, ...]
    frequencies: tuple[float, ...]
    phase: float
    weights: tuple[float, ...]


@dataclass(frozen=True)
class Input:
    """An input's lowest and highest value, in its unit, and weights (6,), N and N m."""

    low: float
    high: float
    weights: tuple[float, ...]


@dataclass(frozen=True)
class ResidualFunction:
    """
    A force (N) and moment (N m) on the centre of mass, body axes, by state and command.

    constant (6,) + sum of x weights of inputs {name of INPUTS: Input} + sum of waves. x goes from
    -1 at an input's lowest value to 1 at its highest one, and no further beyond; no channel goes
    beyond its limit (6,). So it is bounded at every state.
    """

    limit: tuple[float, ...]
    constant: tuple[float, ...]
    inputs: tuple[tuple[str, Input], ...]
    waves: tuple[Wave, ...]

    @property
    def table(self) -> np.ndarray:
        """Return it as one row of numbers, (T,), as residual_in_flight.add reads it."""
        inputs = np.zeros((len(INPUTS), 2 + CHANNELS))
        places = [INPUTS.index(name) for name, _ in self.inputs]
        for place, (_, one) in zip(places, self.inputs, strict=True):
            inputs[place] = [0.5 * (one.low + one.high), 2.0 / (one.high - one.low), *one.weights]
        waves = [[*(places[k] for k in wave.inputs), *wave.frequencies, wave.phase, *wave.weights]
                 for wave in self.waves]
        return np.concatenate([self.limit, self.constant, inputs.ravel(), np.ravel(waves)])

    def of(self, channels: Collection[int]) -> 'ResidualFunction':
        """Return it with nothing but some of its six channels."""
        def kept(row: tuple[float, ...]) -> tuple[float, ...]:
            return tuple(one if k in channels else 0.0 for k, one in enumerate(row))

        return ResidualFunction(
            kept(self.limit), kept(self.constant),
            tuple((name, replace(one, weights=kept(one.weights))) for name, one in self.inputs),
            tuple(replace(wave, weights=kept(wave.weights)) for wave in self.waves))


NOTHING = ResidualFunction((0.0,) * CHANNELS, (0.0,) * CHANNELS, (), ())


def from_mapping(where: str, data: Any) -> ResidualFunction:
    """Return what the section `residual` of a vehicle file describes; raises InputError."""
    schema.check_keys(where, data, ('limit', 'constant', 'inputs', 'waves'),
                      ('limit', 'constant', 'inputs', 'waves'))
    if not isinstance(data['inputs'], dict) or not data['inputs']:
        raise InputError(f'{where}: inputs: expected NAME: {{range: [low, high], weights: [6 '
                         f'numbers]}}, NAME one of {", ".join(INPUTS)}')
    schema.check_keys(f'{where}: inputs', data['inputs'], INPUTS)
    inputs = tuple((name, _input(f'{where}: inputs: {name}', one))
                   for name, one in data['inputs'].items())
    rows = data['waves']
    if not isinstance(rows, list) or len(rows) > MOST_WAVES:
        raise InputError(f'{where}: waves: expected a list of at most {MOST_WAVES} waves')
    return ResidualFunction(
        schema.numbers(f'{where}: limit', data['limit'], CHANNELS, 0.0),
        schema.numbers(f'{where}: constant', data['constant'], CHANNELS), inputs,
        tuple(_wave(f'{where}: waves[{k}]', row, len(inputs)) for k, row in enumerate(rows)))


def to_mapping(function: ResidualFunction) -> dict[str, Any]:
    """Return the section `residual` of a vehicle file that describes a ResidualFunction."""
    return {'limit': list(function.limit), 'constant': list(function.constant),
            'inputs': {name: {'range': [one.low, one.high], 'weights': list(one.weights)}
                       for name, one in function.inputs},
            'waves': [[*wave.inputs, *wave.frequencies, wave.phase, *wave.weights]
                      for wave in function.waves]}


def _input(where: str, data: Any) -> Input:
    schema.check_keys(where, data, ('range', 'weights'), ('range', 'weights'))
    low, high = schema.numbers(f'{where}: range', data['range'], 2)
    if not (low < high and math.isfinite(2.0 / (high - low))):
        raise InputError(f'{where}: range: {high:g} is not above {low:g}; give the lowest and the '
                         'highest value')
    return Input(low, high, schema.numbers(f'{where}: weights', data['weights'], CHANNELS))


def _wave(where: str, row: Any, count: int) -> Wave:
    values = schema.numbers(where, row, 2 * ARGUMENTS + 1 + CHANNELS)
    places = values[:ARGUMENTS]
    if any(place != int(place) or not 0 <= place < count for place in places):
        raise InputError(f'{where}: the first {ARGUMENTS} numbers are places among the {count} '
                         f'inputs, from 0 to {count - 1}; got {schema.shown(list(places))}')
    return Wave(tuple(int(place) for place in places), values[ARGUMENTS:2 * ARGUMENTS],
                values[2 * ARGUMENTS], values[2 * ARGUMENTS + 1:])
