# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the parameters of a PX4 log say of the vehicle: kind, rotors, map of the motors."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import TypeAlias

import numpy as np

from quad_ident_ros.data.motor_layouts import layout
from quad_ident_ros.model.vehicle import Rotor

Parameters: TypeAlias = Mapping[str, int | float]

MOST_ROTORS = 12        # that the parameters of PX4 have places for
FIRST_MOTOR = 101       # the output function of motor 1
BANKS = 'PWM_MAIN', 'PWM_AUX', 'UAVCAN_EC', 'SIM_GZ_EC'
"""Beginnings of the parameters of outputs that motors are on; each bank is logged by itself."""
DSHOT = 1, 1999         # outputs of PX4's DSHOT driver at the least and at full throttle
DSHOT_TIMER = -2        # of a bank's TIM; from this on down the timer speaks DSHOT

OTHERS = {1: 'a fixed wing', 3: 'a coaxial helicopter', 4: 'a helicopter', 7: 'an airship',
          8: 'a balloon', 10: 'a rover', 11: 'a boat', 12: 'a submarine', 15: 'a tricopter',
          **dict.fromkeys(range(19, 26), 'a VTOL')}
"""MAV_TYPE of MAVLink."""

OLDER = {2: ((5, 'quad +'), (0, 'quad x')),
         13: ((7, 'hexa +'), (11, ''), (0, 'hexa x')),
         14: ((9, 'octo +'), (12, 'coaxial octo x'), (0, 'octo x'))}
"""
MAV_TYPE -> thousands of SYS_AUTOSTART and the layout of these airframes, 0 for all others.

Their layouts are those of PX4 1.12 and earlier, which has no CA_ROTOR*; '' for none of ours.
"""


@dataclass(frozen=True)
class Motors:
    """
    The motors of a log: rotors in their order, in FLU; ratio torque over thrust in m or nan.

    known: whether the places are those of the vehicle, or only their directions; source: which
    parameters say so.
    """

    rotors: tuple[Rotor, ...]
    ratio: float
    known: bool
    source: str


def other_kind(parameters: Parameters, status: Mapping[str, np.ndarray] | None) -> str:
    """
    Return what a vehicle is that is no multirotor, or ''.

    Args: parameters name -> number; status: fields of vehicle_status, name -> (n,), or None.
    """
    status = status or {}
    if any(np.any(status[name] == 1) for name in ('is_vtol',) if name in status):
        return 'a VTOL'
    kind = parameters.get('MAV_TYPE')
    if kind is None and len(status.get('system_type', ())):
        kind = status['system_type'][-1]
    if kind in OTHERS:
        return OTHERS[int(kind)]
    types = status.get('vehicle_type', ())
    if len(types) and np.all(np.asarray(types) == 2):
        return 'a fixed wing'
    return ''


def motors_of(parameters: Parameters) -> Motors | None:
    """Return the Motors that the parameters of a log describe, or None."""
    count = _number(parameters, 'CA_ROTOR_COUNT')
    if 1 <= count <= MOST_ROTORS:
        rotors, ratios = [], []
        for k in range(int(count)):
            place = [_number(parameters, f'CA_ROTOR{k}_P{axis}', 0.0) for axis in 'XYZ']
            turning = _number(parameters, f'CA_ROTOR{k}_KM', 0.05)
            if not np.isfinite([*place, turning]).all():
                return None
            # Counterclockwise from above is positive: its reaction torque is about -z.
            rotors.append(Rotor((place[0], -place[1], -place[2]), -1 if turning > 0 else 1))
            ratios.append(abs(turning))
        if any(math.hypot(*rotor.position[:2]) > 0 for rotor in rotors):
            # The airframe "generic quad" has its rotors 1 m out; no frame that flies has arms
            # of exactly that in both directions.
            unit = all(abs(abs(value) - 1.0) < 1e-6 for rotor in rotors
                       for value in rotor.position[:2])
            return Motors(tuple(rotors), float(np.mean(ratios)), not unit, 'CA_ROTOR*')
    return _older(parameters)


def _older(parameters: Parameters) -> Motors | None:
    """Return the Motors of an airframe by its name, whose parameters say no places, or None."""
    kind = int(_number(parameters, 'MAV_TYPE', -1))
    start = int(_number(parameters, 'SYS_AUTOSTART', 0))
    name = next((name for thousands, name in OLDER.get(kind, ())
                 if thousands in (0, start // 1000)), '')
    if not name:
        return None
    return Motors(layout(name), math.nan, False,
                  f'MAV_TYPE {kind}, SYS_AUTOSTART {start}: {name}')


def bank_of(parameters: Parameters, count: int, names: Sequence[str] = BANKS) -> str:
    """Return the first of the banks of outputs whose functions name motors 1..count, or ''."""
    return next((name for name in names if _functions(parameters, name, count)), '')


def signal_limits(parameters: Parameters, count: int, simulated: bool,
                  bank: str = '') -> tuple[np.ndarray, np.ndarray, str]:
    """
    Return (lowest, highest) value of outputs 1..count, (count,) each, and their kind: PWM, DSHOT.

    Those of each channel where they are set, else those of all channels. PX4's simulator has
    1000 to 2000 us whatever the parameters say.
    """
    bank = bank or BANKS[0]
    if not simulated and is_dshot(parameters, bank):
        share = _number(parameters, 'DSHOT_MIN', 0.0)
        least = min(max(round(share * DSHOT[1]), DSHOT[0]), DSHOT[1] - 1)
        return np.full(count, float(least)), np.full(count, float(DSHOT[1])), 'DSHOT'
    limits = []
    for ending, usual in (('MIN', 1000.0), ('MAX', 2000.0)):
        shared = next((value for value in (_number(parameters, f'{name}_{ending}') for name in
                                           (bank, 'PWM')) if 800 <= value <= 2200), usual)
        each = [_number(parameters, f'{bank}_{ending}{k}') for k in range(1, count + 1)]
        limits.append(np.array([usual if simulated else value if 800 <= value <= 2200 else shared
                                for value in each]))
    low, high = limits
    if not (high > low).all():
        low, high = np.full(count, 1000.0), np.full(count, 2000.0)
    return low, high, 'PWM'


def is_dshot(parameters: Parameters, bank: str) -> bool:
    """Return whether motors of a bank are driven by DSHOT: its timers, or the old DSHOT_CONFIG."""
    # A timer of DSHOT drives motors only; those beside it, for servos, stay at PWM.
    return _number(parameters, 'DSHOT_CONFIG', 0) > 0 or any(
        _number(parameters, f'{bank}_TIM{k}', 0) <= DSHOT_TIMER for k in range(8))


def channels_of(parameters: Parameters, count: int, bank: str = '') -> list[int]:
    """Return the 0-based channel of motors 1.., (count,), by the functions of a bank's outputs."""
    return _functions(parameters, bank or BANKS[0], count) or list(range(count))


def _functions(parameters: Parameters, bank: str, count: int) -> list[int]:
    """Return the 0-based channels of motors 1..count of a bank, empty where not all have one."""
    channels = {}
    for k in range(16):
        function = _number(parameters, f'{bank}_FUNC{k + 1}')
        if FIRST_MOTOR <= function < FIRST_MOTOR + MOST_ROTORS:
            channels[int(function) - FIRST_MOTOR] = k
    if any(motor not in channels for motor in range(count)):
        return []
    return [channels[motor] for motor in range(count)]


def thrust_factor(parameters: Parameters) -> float:
    """Return THR_MDL_FAC, the quadratic share of the thrust curve that is set, 0 for none."""
    factor = _number(parameters, 'THR_MDL_FAC', 0.0)
    return factor if 0.0 < factor <= 1.0 else 0.0


def _number(parameters: Parameters, name: str, default: float = math.nan) -> float:
    value = parameters.get(name, default)
    return float(value) if isinstance(value, int | float) and math.isfinite(value) else default
