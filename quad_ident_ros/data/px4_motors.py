# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rotor speeds from the outputs of a PX4 log: by the mapping, or by the log's parameters."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from quad_ident_ros.data.mapping import Actuators, rotor_speeds
from quad_ident_ros.data.measured_speeds import measured_map
from quad_ident_ros.data.motor_order import order_of
from quad_ident_ros.data.px4_airframe import (
    channels_of,
    Motors,
    Parameters,
    signal_limits,
    thrust_factor,
)
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.motors import MOTORS_OFF
from quad_ident_ros.model.vehicle import Vehicle

Samples: TypeAlias = tuple[np.ndarray, np.ndarray]
Columns: TypeAlias = dict[str, np.ndarray]

RANGES = {'PWM': (800.0, 2200.0), 'DSHOT': (1.0, 1999.0)}
"""Kind of outputs -> between which values all of them lie; off is 0 or nan."""

LINEAR_SPEED = 'rotor speed linear in the signal (THR_MDL_FAC is not set)'

UNORDERED = ('{topic}: the log does not say which motor lies where (CA_ROTOR*, MAV_TYPE): outputs '
             'are taken in the order of the rotors; if they are in another one, give a mapping '
             'with actuators: kind and order')


def commands(path: str | Path, topic: str, outputs: Samples, measured: Samples | None,
             actuators: Actuators | None, vehicle: Vehicle | None, motors: Motors | None,
             parameters: Parameters, simulated: bool, notes: list[str],
             bank: str = '') -> tuple[Columns, Columns]:
    """
    Return (columns of commands, columns rotor1..N of measured speeds); what was done is noted.

    Commands are cmd1..N by the log's parameters, or output1..N in the order of the rotors for a
    mapping or the motors of the vehicle file, or where the log does not know their map. Where
    nothing has the speed at full signal, output1..N are shares of it, 0 to 1.
    Args: outputs (stamps (n,) ns, values (n, m)); measured the same in rad/s in the order of the
    motors, or None; actuators of the mapping or None; vehicle, motors (px4_airframe.Motors) or
    None; parameters of the log; simulated: whether it is of PX4's simulator; bank: of
    px4_airframe.BANKS, whose outputs they are, '' where the log does not say.
    Raises InputError where the vehicle's rotors do not match those of the log.
    """
    stamps, values = outputs
    where = f'{path}, topic {topic}'
    order = None
    if vehicle is not None and motors is not None and not (actuators and actuators.order):
        order = order_of(path, motors.rotors, motors.source, vehicle)
    speeds = {}
    if measured is not None:
        chosen = measured[1] if order is None else measured[1][:, [k - 1 for k in order]]
        speeds = {f'rotor{k}': column for k, column in enumerate(chosen.T, 1)}
    signal, what = (None, '') if vehicle is None else _signal(topic, values, motors, parameters,
                                                              simulated, bank)
    if actuators is not None or vehicle is None or vehicle.motors is not None or signal is None:
        shares = vehicle is not None and vehicle.motors is not None and actuators is None and (
            vehicle.motors.kind == 'normalised')
        if order is not None and shares and signal is not None:
            values = signal[:, [k - 1 for k in order]]
        elif order is not None:
            values = values[:, _channels(where, topic, parameters, order, values.shape[1],
                                         bank)]
        elif actuators is None:
            values = values[:, np.isfinite(values).any(axis=0)]
            if vehicle is not None:
                notes.append(UNORDERED.format(topic=topic))
        return _named('output', np.where(np.isfinite(values), values, MOTORS_OFF)), speeds
    assert order is not None and motors is not None     # the signal is that of these
    made, said = _map(signal, stamps, measured, parameters)
    told = made.speeds is not None or np.isfinite(vehicle.speed_max)
    ends = '' if made.speeds is not None else (
        '; speeds at its ends from the vehicle file' if told else
        '; neither the log nor the vehicle file has the speed at full signal')
    notes.append(f'commands: {topic} ({what}), motors {_listed(order)} of the log by their '
                 f'direction ({motors.source}); {said}{ends}')
    share = _relative(signal, topic, made, parameters)
    if not told:
        return _named('output', _share_of_speed(share[:, [k - 1 for k in order]], made)), speeds
    return _named('cmd', rotor_speeds(where, share, replace(made, order=order), vehicle)), speeds


def _channels(where: str, topic: str, parameters: Parameters, order: Sequence[int],
              count: int, bank: str) -> list[int]:
    """Return the column of the outputs of each rotor, whose motors are in this order."""
    channels = list(range(len(order)))
    if topic == 'actuator_outputs':
        channels = channels_of(parameters, len(order), bank)
    chosen = [channels[motor - 1] for motor in order]
    if max(chosen) >= count:
        raise InputError(f'{where}: there is no output {max(chosen) + 1} of a motor, there are '
                         f'{count}; log them all, or give the order in a mapping')
    return chosen


def _signal(topic: str, values: np.ndarray, motors: Motors | None, parameters: Parameters,
            simulated: bool, bank: str) -> tuple[np.ndarray | None, str]:
    """Return the signal (n, motors) of 0 to 1, below 0 for off, and what it was; None, why."""
    if motors is None:
        return None, ''
    count = len(motors.rotors)
    if topic == 'actuator_motors':
        if values.shape[1] < count or not _within(values[:, :count], -1e-3, 1.001):
            return None, f'its values are not the shares of full thrust of {count} motors'
        return values[:, :count], 'normalised, 0 to 1'
    channels = channels_of(parameters, count, bank)
    if max(channels) >= values.shape[1]:
        return None, f'there are no outputs for {count} motors'
    chosen = values[:, channels]
    if _within(chosen, -1e-3, 1.001):
        return chosen, 'normalised, 0 to 1'
    chosen = np.where(chosen > 0, chosen, np.nan)
    low, high, kind = signal_limits(parameters, max(channels) + 1, simulated, bank)
    if not _within(chosen, *RANGES[kind]):
        return None, f'its values are neither shares of 0 to 1 nor {kind}'
    low, high = low[channels], high[channels]
    span, unit = f'{low.min():g} to {high.max():g}', ' us' if kind == 'PWM' else ''
    each = '' if np.ptp(low) == np.ptp(high) == 0 else ', limits of each channel'
    return (chosen - low) / (high - low), f'{kind}, {span}{unit}{each}'


def _map(signal: np.ndarray, stamps: np.ndarray, measured: Samples | None,
         parameters: Parameters) -> tuple[Actuators, str]:
    """Return the Actuators of a signal of 0 to 1, and how they are known."""
    if measured is not None:
        at = np.searchsorted(stamps, measured[0], side='right') - 1
        inside = at >= 0
        count = min(signal.shape[1], measured[1].shape[1])
        found = measured_map(signal[np.maximum(at, 0), :count][inside],
                             measured[1][inside, :count])
        if found is not None:
            curve, (low, high) = found
            return Actuators((), 'normalised', 0.0, 1.0, (low, high), curve), (
                f'rotor speed {low:.4g} to {high:.4g} rad/s, '
                f'{"linear" if curve == "linear" else "its square linear"} in the signal, '
                'by the rpm of esc_status')
    factor = thrust_factor(parameters)
    if factor:
        return Actuators((), 'normalised', 0.0, 1.0, None, 'thrust'), (
            f'thrust is {factor:g} x^2 + {1 - factor:.3g} x of the signal x (THR_MDL_FAC)')
    return Actuators((), 'normalised', 0.0, 1.0, None, 'linear'), (
        LINEAR_SPEED)


def _relative(signal: np.ndarray, topic: str, made: Actuators,
              parameters: Parameters) -> np.ndarray:
    """Return what the curve of the Actuators is of: the share of thrust, or the signal."""
    factor = thrust_factor(parameters)
    if made.curve != 'thrust' or made.speeds is not None or topic == 'actuator_motors':
        return signal   # actuator_motors is a share of thrust, before THR_MDL_FAC is applied
    return np.where(signal > 0, factor * signal ** 2 + (1 - factor) * signal, signal)


def _share_of_speed(share: np.ndarray, made: Actuators) -> np.ndarray:
    """Return shares (n, motors) of the full speed, of those that the Actuators are of."""
    share = np.where(share >= 0.0, np.minimum(share, 1.0), MOTORS_OFF)
    if made.curve == 'thrust':      # thrust goes with the square of the speed
        share = np.where(share > 0.0, np.sqrt(np.maximum(share, 0.0)), share)
    return share


def _within(values: np.ndarray, low: float, high: float) -> bool:
    """Return whether values are low to high where they are numbers, and some are."""
    finite = values[np.isfinite(values)]
    return bool(len(finite)) and bool((finite >= low).all() and (finite <= high).all())


def _named(name: str, values: np.ndarray) -> Columns:
    return {f'{name}{k}': column for k, column in enumerate(values.T, 1)}


def _listed(order: Sequence[int]) -> str:
    return ', '.join(map(str, order))
