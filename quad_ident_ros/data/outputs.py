# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotor speed commands from the outputs to the motors in the records of a file."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from quad_ident_ros.data.commands import with_arm
from quad_ident_ros.data.mapping import Actuators, actuators_from, chosen_outputs, motors_of
from quad_ident_ros.data.measured_speeds import by_measured
from quad_ident_ros.data.motor_order import order_of, rotors_of
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.signal_kind import (
    described,
    hovers_signed,
    in_newtons,
    kinds_of,
    LINEAR,
    linear_in,
    MANY,
)
from quad_ident_ros.data.thrust_curve import in_words as curve_in_words
from quad_ident_ros.data.thrust_curve import share_of_thrust
from quad_ident_ros.data.thrust_level import FULL_SPEED, full_speed, levelled
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.motors import (
    completed,
    KINDS,
    Motors,
    MOTORS_OFF,
    rotor_speeds,
    TO_SPEED,
)
from quad_ident_ros.model.vehicle import Vehicle

UNITS = {'speed': 'rad/s', 'thrust': 'N'}
ACTUATORS = 'actuators'
"""Info of a live record: what its outputs are, as the section of a mapping says it."""
BY_MOTORS = 'by_motors'
"""Info of a record: its commands are as uncertain as the vehicle file says that its motors are."""
BEYOND = 0.05       # of the range: what is further out is another kind of signal
FAINT = 0.01        # of the range: so are signals that never exceed this, as 0 to 1 in 0 to 65535
BY_SIZE = 'by their size'
SIGNED, UNSIGNED = ('{kind: normalised, minimum: -1, maximum: 1}',
                    '{kind: normalised, minimum: 0, maximum: 1}')


def commanded(records: Sequence[FlightRecord], vehicle: Vehicle | None,
              actuators: Actuators | None = None) -> list[FlightRecord]:
    """
    Return the flight records of one file with cmd1..n in place of output1..m.

    By the actuators of a mapping, or else by the motors of the vehicle, or else from its lowest
    to its highest speed, by the kind that the reader knows or the values show. Where neither has
    the speed at full signal, it is that by which thrust carries the weight: see thrust_level.
    Motors that a reader knows the places of, and their measured speeds, come into the order of
    the vehicle. Its arm length makes inputs u2 and u3 of moments: see commands.with_arm.
    Args: records; vehicle Vehicle or None; actuators Actuators, or None for those that the first
    record says it has. Without a vehicle and actuators outputs stay.
    Raises InputError, with the lines to write, where the outputs leave a doubt.
    """
    said = records[0].info.get(ACTUATORS) if records else None
    if vehicle is not None and actuators is None and said is not None:
        actuators = actuators_from(f'{_where(records[0])}: {ACTUATORS}', said)
    if vehicle is None and actuators is None:
        return list(records)
    if vehicle is not None:
        records = [with_arm(record, vehicle) for record in records]
    found = [_in_order(record, vehicle, actuators) for record in records]
    there = [k for k, record in enumerate(found)
             if record.has('output1') and not record.has('cmd1')]
    if not there:
        return found
    with np.errstate(all='ignore'):     # values so large that no motor has them
        done = _with_commands([found[k] for k in there], vehicle, actuators)
    for k, record in zip(there, done, strict=True):
        found[k] = record
    return found


@dataclass(frozen=True)
class _Map:
    """
    Motors, whose gain may be unknown, where they are from, and whether their shape is known.

    assumed: whether neither file nor log says that the speed is linear in the signal.
    """

    motors: Motors
    said: str
    shaped: bool = True
    assumed: bool = False


def _with_commands(records: list[FlightRecord], vehicle: Vehicle | None,
                   actuators: Actuators | None) -> list[FlightRecord]:
    """Return records of the same motors with commands, the outputs in the vehicle's order."""
    where = _where(records[0])
    signals = [_signals(record, vehicle, actuators) for record in records]
    curve = _curve_of(records[0], vehicle, actuators)
    if curve is not None:
        signals = [share_of_thrust(values, **curve) for values in signals]
    made = _map_of(where, records[0].info.get('motors', {}), np.concatenate(signals), vehicle,
                   actuators)
    if made is None:
        note = ('the motors do not turn: outputs stay as '
                f'output1..{signals[0].shape[1]}, whose values do not show the kind')
        return [_noted(record, note) for record in records]
    motors, said = made.motors, made.said
    info: dict[str, Any] = {BY_MOTORS: True} if made.motors.uncertainty else {}
    if made.assumed:
        info[LINEAR] = linear_in(motors.kind)
    _refuse_voltage(records, motors)
    thrust = 1.0 if vehicle is None else vehicle.thrust_coefficient
    if not motors.whole:
        assert vehicle is not None
        measured = by_measured(records, signals,
                               motors if made.shaped else replace(motors, gives=''), thrust)
        if measured is not None:
            motors, by = measured, 'is that of the measured rotor speeds'
        else:
            motors, told = levelled(where, records, signals, motors, vehicle)
            info[FULL_SPEED] = full_speed(motors, thrust)
            by = f'is the one with which thrust carries the weight of {vehicle.name} ({told})'
        said += f'{_in_words(motors)}; the gain {by}'
    done = []
    for record, values in zip(records, signals, strict=True):
        voltage = record.columns['vbat'] if motors.needs_voltage else None
        speeds = rotor_speeds(motors, values, thrust, voltage)
        columns = {name: column for name, column in record.columns.items()
                   if name not in record.numbered('output')}
        columns |= {f'cmd{k}': column for k, column in enumerate(speeds.T, 1)}
        done.append(_noted(FlightRecord(record.t, columns, {**record.info, **info}), said))
    return done


def _in_order(record: FlightRecord, vehicle: Vehicle | None,
              actuators: Actuators | None) -> FlightRecord:
    """Return a record whose outputs and measured speeds are in the order of the vehicle."""
    about = record.info.get('motors', {})
    rotors, note = rotors_of(about), ''
    if not rotors:
        return record
    order = actuators.order if actuators is not None else ()
    prefixes = ['rotor'] if order else ['output', 'rotor']  # the mapping's order is of outputs
    if not order and vehicle is not None:
        order = order_of(_where(record), rotors, about['source'], vehicle)
        note = (f'rotors of {vehicle.name} are motors {", ".join(map(str, order))} of the log, by '
                f'their direction ({about["source"]})')
    columns = dict(record.columns)
    for prefix in prefixes:
        if order and len(record.numbered(prefix)) >= max(order):
            columns |= {f'{prefix}{k}': record.columns[f'{prefix}{motor}']
                        for k, motor in enumerate(order, 1)}
    info = {**record.info, 'motors': {**about, 'rotors': []}} if order else record.info
    return _noted(FlightRecord(record.t, columns, info), note)


def _signals(record: FlightRecord, vehicle: Vehicle | None,
             actuators: Actuators | None) -> np.ndarray:
    """Return the signals (N, n) of the rotors, nan where a motor is off; InputError."""
    where, names = _where(record), record.numbered('output')
    values = record.stack(*names)
    if not np.isfinite(values).any():
        raise InputError(f'{where}: {names[0]}..{len(names)} hold no finite number; log the '
                         'outputs to the motors, or leave these columns out')
    values = np.where(np.isfinite(values) & (values != MOTORS_OFF), values, np.nan)
    if actuators is not None:
        return chosen_outputs(where, values, actuators, vehicle)
    assert vehicle is not None
    count = len(vehicle.rotors)
    alive = [k for k, column in enumerate(values.T, 1) if np.nanmax(column, initial=0.0) > 0
             and np.ptp(column[np.isfinite(column)]) > 0]
    if len(names) < count:
        raise InputError(f'{where}: there are {len(names)} outputs for the {count} rotors of '
                         f'{vehicle.name}; name the vehicle that flew')
    if any(number > count for number in alive):
        raise InputError(f'{where}: outputs {", ".join(map(str, alive))} of {len(names)} change, '
                         f'{vehicle.name} has {count} rotors; say in a mapping which they are: '
                         f'actuators: {{kind: {_likely(values, vehicle)}, order: '
                         f'{alive[:count]}}}')
    return values[:, :count]


def _map_of(where: str, about: dict, values: np.ndarray, vehicle: Vehicle | None,
            actuators: Actuators | None) -> _Map | None:
    """Return the _Map of signals (N, n), or None where the motors do not turn; InputError."""
    if actuators is not None:
        motors = motors_of(where, actuators, vehicle)
        return _Map(motors, '')     # who wrote the mapping knows
    assert vehicle is not None
    told = vehicle.motors
    curve = about.get('curve')
    if told is None and curve is not None:
        told, how = Motors('normalised', gives='thrust'), f'by the log: {curve_in_words(**curve)}'
    elif told is None:
        kind, how = about.get('kind', ''), 'as the log has them'
        if not kind:
            kinds = _kinds_of(values, vehicle)
            if in_newtons(values, kinds, vehicle.mass * vehicle.gravity / len(vehicle.rotors),
                          vehicle.hover_speed, (vehicle.speed_min, vehicle.speed_max)):
                raise _forces(where, values, vehicle)
            if len(kinds) != 1:
                if not np.nanmax(np.ptp(np.nan_to_num(values), axis=0), initial=0.0) > 0:
                    return None
                raise _doubt(where, values, kinds)
            kind, how = kinds[0], BY_SIZE
        told = _of_kind(kind)
    else:
        _refuse_range(where, values, vehicle)
        how = f'by motors: of {vehicle.name}'
    motors = completed(told, vehicle.thrust_coefficient, vehicle.speed_min, vehicle.speed_max)
    kind = about['kind'] if vehicle.motors is None and curve is not None else told.kind
    said = f'commands: outputs taken for {described(kind)}, {how}; '
    if (kind, how) == ('normalised', BY_SIZE) and hovers_signed(
            values, vehicle.hover_speed, (vehicle.speed_min, vehicle.speed_max)):
        said += (f'as signals from -1 to 1 they would carry {vehicle.name}: write motors: '
                 f'{SIGNED} into its file if they are; ')
    return _Map(motors, said + (_in_words(motors) if motors.whole else ''), bool(told.gives),
                vehicle.motors is None and curve is None and kind not in TO_SPEED)


def _curve_of(record: FlightRecord, vehicle: Vehicle | None,
              actuators: Actuators | None) -> dict[str, float] | None:
    """Return the thrust curve that a log has, or None where mapping or vehicle say otherwise."""
    if actuators is not None or vehicle is None or vehicle.motors is not None:
        return None
    return record.info.get('motors', {}).get('curve')


def _kinds_of(values: np.ndarray, vehicle: Vehicle) -> tuple[str, ...]:
    """Return the kinds that signals may be for a vehicle, the likeliest first."""
    return kinds_of(values, vehicle.hover_speed, (vehicle.speed_min, vehicle.speed_max))


def _of_kind(kind: str) -> Motors:
    low, high = KINDS[kind] or (0.0, 1.0)
    return Motors(kind, low, high)


def _in_words(motors: Motors) -> str:
    """Return what the map of Motors is, for a note."""
    if motors.kind in TO_SPEED:
        return 'which are rotor speeds'
    coefficients = motors.coefficients or (motors.offset, motors.gain or 0.0)
    terms = ' + '.join(f'{value:.4g}' + _power(k if motors.coefficients else k * motors.exponent)
                       for k, value in enumerate(coefficients) if value).replace('+ -', '- ')
    by = '' if motors.voltage_reference is None else (
        f', times (voltage / {motors.voltage_reference:g} V)^{motors.voltage_exponent:g}')
    return (f'{motors.gives} in {UNITS[motors.gives]}: {terms}, x = 0 at {motors.minimum:g}, 1 at '
            f'{motors.maximum:g}{by}')


def _power(exponent: float) -> str:
    return '' if exponent == 0 else ' x' if exponent == 1 else f' x^{exponent:.4g}'


def _doubt(where: str, values: np.ndarray, kinds: Sequence[str]) -> InputError:
    """Return the InputError for signals that could be of several kinds, or of none."""
    low, high = np.nanmin(values), np.nanmax(values)
    where = f'{where}: the outputs, {low:.6g} to {high:.6g},'
    if not kinds and -1.001 <= low < 0 and high <= 1.001:
        return InputError(f'{where} may go from -1 to 1, or from 0 to 1 with values that a mixer '
                          'has not limited yet; write into the vehicle file which, as motors: '
                          f'{SIGNED} or motors: {UNSIGNED}, or into a mapping as actuators: with '
                          'the same behind it')
    what = (f'could be {" or ".join(map(described, kinds))};' if kinds else
            'are of no kind that their size shows, and not rotor speeds near hover; give '
            'the vehicle that flew, or')
    line = f'{{kind: {kinds[0]}}}' if kinds else '{kind: pwm, minimum: ..., maximum: ...}'
    return InputError(f'{where} {what} write into the vehicle file what they are, such as motors: '
                      f'{line}, or into a mapping as actuators: {line}; kinds are '
                      f'{", ".join(KINDS)}')


def _forces(where: str, values: np.ndarray, vehicle: Vehicle) -> InputError:
    """Return the InputError for signals that are thrusts in N."""
    low, high = np.nanmin(values), np.nanmax(values)
    most = f'{np.ceil(10.0 * high) / 10.0:g}'
    return InputError(
        f'{where}: the outputs, {low:.6g} to {high:.6g}, carry {vehicle.name} as thrusts of its '
        'rotors in N, and not as signals; write into the vehicle file, if they are, motors: '
        f'{{kind: normalised, maximum: {most}, thrust: {{gain: {most}}}}}')


def _refuse_range(where: str, values: np.ndarray, vehicle: Vehicle) -> None:
    """Raise InputError where signals are not of the kind that the vehicle file says."""
    motors = vehicle.motors
    if motors is None or motors.kind in TO_SPEED:
        return
    on = values[np.isfinite(values) & (values > 0)]
    if not len(on):
        return
    span = motors.maximum - motors.minimum
    over = np.mean(on > motors.maximum + BEYOND * span) > MANY
    if over or not (on > motors.minimum + FAINT * span).any():
        raise InputError(
            f'{where}: the outputs, {on.min():.6g} to {on.max():.6g}, are not what {vehicle.name} '
            f'says of its motors: {motors.kind} from {motors.minimum:g} to {motors.maximum:g}; '
            f'correct kind, minimum and maximum there{_perhaps(values, vehicle)}')


def _perhaps(values: np.ndarray, vehicle: Vehicle) -> str:
    kinds = _kinds_of(values, vehicle)
    return f' (kind: {" or ".join(kinds)} by their size)' if kinds else ''


def _likely(values: np.ndarray, vehicle: Vehicle) -> str:
    if vehicle.motors is not None:
        return vehicle.motors.kind
    return next(iter(_kinds_of(values, vehicle)), 'pwm')


def _refuse_voltage(records: Sequence[FlightRecord], motors: Motors) -> None:
    for record in records:
        if motors.needs_voltage and not record.has('vbat'):
            raise InputError(f'{_where(record)}: motors: voltage: the map depends on the voltage, '
                             'and the record has no vbat; log the battery, or leave voltage out '
                             'of the vehicle file')


def _noted(record: FlightRecord, note: str) -> FlightRecord:
    """Return a record with a note, if any, on its commands: also in its info `commands`."""
    if not note:
        return record
    said = [*record.info.get('commands', ()), note]
    return replace(record, info={**record.info, 'commands': said,
                                 'notes': [*record.info.get('notes', ()), note]})


def _where(record: FlightRecord) -> str:
    return str(record.info.get('source') or record.info.get('name', 'the flight record'))
