# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the signals to the motors are, and the rotor speeds that they stand for."""

from dataclasses import dataclass, field, replace
import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
import scipy

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError

KINDS: dict[str, tuple[float, float] | None] = {
    'speed': None, 'rpm': None, 'pwm': (1000.0, 2000.0), 'normalised': (0.0, 1.0),
    'percent': (0.0, 100.0), 'duty16': (0.0, 65535.0), 'dshot': (48.0, 2047.0)}
"""Kinds of signals, with those at no and at full throttle by default; None: rotor speeds."""

TO_SPEED = {'speed': 1.0, 'rpm': math.pi / 30.0}
"""Factor to rad/s of the kinds that are rotor speeds."""

MOTORS_OFF = -1.0
"""Stands in the signals of a record for a motor that is off: below the minimum of any kind."""

MAPS = ('speed', 'thrust')
CURVE = ('offset', 'gain', 'exponent')
MOST = 4        # coefficients of a curve; published ones have three


@dataclass(frozen=True)
class Motors:
    """
    The map from the signals of a record to rotor speeds or thrusts.

    kind: one of KINDS; minimum, maximum: signals at share x = 0 and 1. gives: speed (rad/s) or
    thrust (N) of a rotor, '' where the file does not say: offset + gain x^exponent, or the sum of
    coefficients[k] x^k; gain is None where it is not known. Both are times
    (voltage / voltage_reference)^voltage_exponent, V. uncertainty: standard deviations of these
    numbers by name, those of coefficients by 'coefficients[0]'.
    """

    kind: str
    minimum: float = 0.0
    maximum: float = 1.0
    gives: str = ''
    offset: float = 0.0
    gain: float | None = None
    exponent: float = 1.0
    coefficients: tuple[float, ...] = ()
    voltage_reference: float | None = None
    voltage_exponent: float = 0.0
    uncertainty: dict[str, float] = field(default_factory=dict, hash=False)

    @property
    def needs_voltage(self) -> bool:
        """Whether the map depends on the voltage."""
        return self.voltage_reference is not None

    @property
    def whole(self) -> bool:
        """Whether the map gives numbers: its kind is a speed, or nothing of it is unknown."""
        return self.kind in TO_SPEED or bool(
            self.gives and (self.coefficients or self.gain is not None))


def are_thrusts(motors: Motors | None) -> bool:
    """Whether signals are thrusts or shares of one, so that speeds may only stand for them."""
    return (motors is not None and motors.kind == 'normalised' and motors.gives == 'thrust'
            and motors.exponent == 1.0 and not motors.coefficients)


def shares(signals: ArrayLike, minimum: float, maximum: float) -> np.ndarray:
    """Return shares of full throttle, at most 1, of signals of any shape; nan for off."""
    with np.errstate(invalid='ignore'):
        share = (np.asarray(signals, float) - minimum) / (maximum - minimum)
        return np.where(share >= 0.0, np.minimum(share, 1.0), np.nan)


def rotor_speeds(motors: Motors, signals: ArrayLike, thrust_coefficient: float,
                 voltage: np.ndarray | None = None) -> np.ndarray:
    """
    Return the rotor speeds (N, n), rad/s, of signals (N, n).

    Those of a thrust are sqrt(thrust / thrust_coefficient). A signal that is off, below its
    minimum or not finite, is a rotor that stands; so is one whose map gives less than 0.
    Args: motors, whole; thrust_coefficient N/(rad/s)^2; voltage (N,) V, for a map that needs it.
    """
    signals = np.asarray(signals, float)
    signals = np.where(np.isfinite(signals), signals, np.nan)
    if motors.kind in TO_SPEED:
        return np.nan_to_num(signals) * TO_SPEED[motors.kind]
    value = _curve(motors, shares(signals, motors.minimum, motors.maximum))
    if motors.voltage_reference is not None and voltage is not None:
        ratio = np.maximum(voltage, 0.0) / motors.voltage_reference
        value = value * (ratio ** motors.voltage_exponent)[:, None]
    value = np.maximum(np.nan_to_num(value), 0.0)
    return np.sqrt(value / thrust_coefficient) if motors.gives == 'thrust' else value


def completed(motors: Motors, thrust_coefficient: float, speed_min: float,
              speed_max: float) -> Motors:
    """
    Return Motors whose map is what the limits of the vehicle (rad/s) make of it.

    A map that is not given goes from speed_min to speed_max, linear in the signal; a gain that is
    not given is the one that reaches speed_max. Without a finite speed_max the gain stays unknown.
    """
    if motors.whole:
        return motors
    limited = math.isfinite(speed_max)
    if not motors.gives:
        motors = replace(motors, gives='speed', offset=speed_min if limited else 0.0)
    if not limited:
        return motors
    full = speed_max if motors.gives == 'speed' else thrust_coefficient * speed_max ** 2
    return replace(motors, gain=full - motors.offset)


def spread(motors: Motors, thrust_coefficient: float, thrust: float
           ) -> tuple[float | None, float | None]:
    """
    Return how well thrust is known about `thrust` (N, of a rotor), by the uncertainty of a map.

    They are the standard deviation of its logarithm, and that of the power of the rotor speed
    that it goes with; None where the numbers that it hangs on have none.
    """
    stds = motors.uncertainty
    if not stds or not motors.whole or motors.kind in TO_SPEED:
        return None, None

    def logarithm(one: Motors, signal: float) -> float:
        voltage = None if motors.voltage_reference is None else np.array(
            [motors.voltage_reference])
        speed = rotor_speeds(one, [[signal]], thrust_coefficient, voltage)[0, 0]
        return math.log(max(thrust_coefficient * speed * speed, 1e-6 * thrust))

    low, high = motors.minimum, motors.maximum
    if logarithm(motors, low) < math.log(thrust) < logarithm(motors, high):
        place = scipy.optimize.brentq(lambda x: logarithm(motors, x) - math.log(thrust), low, high)
    else:
        place = high    # of a map that does not reach it
    step = 1e-3 * (high - low)
    place = min(max(place, low + 2 * step), high - 2 * step)

    def shape(one: Motors) -> tuple[float, float]:
        before, after = logarithm(one, place - step), logarithm(one, place + step)
        return logarithm(one, place), after - before

    level, slope = shape(motors)
    if slope == 0.0:
        return None, None
    levels, powers = [], []
    for name, std in stds.items():
        moved = shape(_moved(motors, name, 1e-3 * std))
        levels.append((moved[0] - level) / 1e-3)
        powers.append(2.0 * (moved[1] / slope - 1.0) / 1e-3)
    scaled = any(name == 'gain' or name.startswith('coefficients') for name in stds)
    bent = any(name != 'gain' and not name.startswith('voltage') for name in stds)
    return (math.hypot(*levels) if scaled else None), (math.hypot(*powers) if bent else None)


def motors_from(where: str, data: Any) -> Motors:
    """Return the Motors that the section `motors` of a vehicle file describes; InputError."""
    schema.check_keys(where, data, ('kind', 'minimum', 'maximum', *MAPS, 'voltage'), ('kind',))
    kind = schema.choice(f'{where}: kind', data['kind'], tuple(KINDS))
    limits = KINDS[kind]
    if limits is None:
        for key in data:
            if key != 'kind':
                raise InputError(f'{where}: {key}: signals of kind {kind} are rotor speeds '
                                 'already; leave it out')
        return Motors(kind)
    if all(name in data for name in MAPS):
        raise InputError(f'{where}: speed and thrust are two maps of the same signal; give one')
    numbers: dict[str, Any] = {}
    stds: dict[str, float | None] = {}
    for key, usual in zip(('minimum', 'maximum'), limits, strict=True):
        numbers[key], stds[key] = schema.uncertain(f'{where}: {key}', data.get(key, usual))
    if numbers['maximum'] <= numbers['minimum']:
        raise InputError(f'{where}: maximum: {numbers["maximum"]:g} is not above the minimum, '
                         f'{numbers["minimum"]:g}')
    gives = next((name for name in MAPS if name in data), '')
    if gives:
        _map_from(f'{where}: {gives}', data[gives], numbers, stds)
    if 'voltage' in data:
        if not gives:
            raise InputError(f'{where}: voltage: says how a map depends on it; give the map, '
                             'speed or thrust')
        place, entry = f'{where}: voltage', data['voltage']
        schema.check_keys(place, entry, ('reference', 'exponent'), ('reference', 'exponent'))
        for key, least, exclusive in (('reference', 0.0, True), ('exponent', 0.0, False)):
            numbers[f'voltage_{key}'], stds[f'voltage_{key}'] = schema.uncertain(
                f'{place}: {key}', entry[key], least, exclusive)
    return Motors(kind, gives=gives, **numbers, uncertainty={
        key: std for key, std in stds.items() if std is not None})


def motors_to_mapping(motors: Motors) -> dict[str, Any]:
    """Return the section `motors` of a vehicle file that describes Motors."""
    if motors.kind in TO_SPEED:
        return {'kind': motors.kind}

    def number(name: str, value: float) -> Any:
        std = motors.uncertainty.get(name)
        return value if std is None else {'value': value, 'std': std}

    data: dict[str, Any] = {'kind': motors.kind, 'minimum': number('minimum', motors.minimum),
                            'maximum': number('maximum', motors.maximum)}
    if motors.coefficients:
        data[motors.gives] = [number(_place_of(k), value)
                              for k, value in enumerate(motors.coefficients)]
    elif motors.gives:
        names = CURVE if motors.gain is not None else ('exponent',)
        data[motors.gives] = {name: number(name, getattr(motors, name)) for name in names}
    if motors.voltage_reference is not None:
        data['voltage'] = {
            'reference': number('voltage_reference', motors.voltage_reference),
            'exponent': number('voltage_exponent', motors.voltage_exponent)}
    return data


def _curve(motors: Motors, share: np.ndarray) -> np.ndarray:
    """Return the speeds or thrusts at shares of the signal, at the reference voltage."""
    if motors.coefficients:
        return np.polynomial.polynomial.polyval(share, motors.coefficients)
    if motors.gain is None:
        raise ValueError('the gain of these Motors is not known')
    return motors.offset + motors.gain * share ** motors.exponent


def _moved(motors: Motors, name: str, by: float) -> Motors:
    """Return Motors with one number moved."""
    for k, value in enumerate(motors.coefficients):
        if name == _place_of(k):
            changed = (*motors.coefficients[:k], value + by, *motors.coefficients[k + 1:])
            return replace(motors, coefficients=changed)
    return replace(motors, **{name: getattr(motors, name) + by})


def _map_from(where: str, data: Any, numbers: dict[str, Any], stds: dict[str, float | None]
              ) -> None:
    """Enter the numbers of a map, a curve or the coefficients of a polynomial; InputError."""
    if isinstance(data, list):
        if not 2 <= len(data) <= MOST:
            raise InputError(f'{where}: expected 2 to {MOST} coefficients of 1, x, x^2, ... or '
                             f'{{{", ".join(CURVE)}}}, got {schema.shown(data)}')
        values, deviations = schema.uncertain_numbers(where, data, len(data))
        if sum(values) <= 0.0:
            raise InputError(f'{where}: {sum(values):g} at full signal; the coefficients of '
                             '1, x, x^2, ... for x of 0 to 1 must give more than 0')
        numbers['coefficients'] = values
        stds.update((_place_of(k), std) for k, std in enumerate(deviations))
        return
    schema.check_keys(where, data, CURVE)
    for name in CURVE:
        if name not in data:
            continue
        positive = name != 'offset'
        numbers[name], stds[name] = schema.uncertain(
            f'{where}: {name}', data[name], 0.0 if positive else -math.inf, positive)
    if 'offset' in numbers and 'gain' not in numbers:
        raise InputError(f'{where}: offset: it says nothing without the gain; give both, or none')
    if 'gain' in numbers and numbers['gain'] + numbers.get('offset', 0.0) <= 0.0:
        raise InputError(f'{where}: offset: {numbers["offset"]:g} leaves nothing of the gain, '
                         f'{numbers["gain"]:g}, at full signal')


def _place_of(coefficient: int) -> str:
    return f'coefficients[{coefficient}]'
