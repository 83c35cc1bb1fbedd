# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The thrust curve by which an autopilot that logs its parameters drives the motors."""

from collections.abc import Mapping
import math

import numpy as np

ARDUPILOT = ('MOT_THST_EXPO', 'MOT_SPIN_MIN', 'MOT_SPIN_MAX')
"""Parameters of ArduCopter that make the curve, beside those of the range of PWM."""

_DIGITAL = range(4, 8)      # of MOT_PWM_TYPE: DSHOT, whose signals are logged as 1000 to 2000


def ardupilot_curve(parameters: Mapping[str, float]) -> dict[str, float] | None:
    """
    Return {minimum, maximum (us of PWM), factor} of ArduCopter's parameters, or None.

    It takes thrust for factor x^2 + (1 - factor) x of the share x of the outputs from
    MOT_SPIN_MIN to MOT_SPIN_MAX, which are shares of MOT_PWM_MIN to MOT_PWM_MAX; factor is
    MOT_THST_EXPO. None where the log does not have them all, or they make no curve.
    Source: AP_Motors_Thrust_Linearization.cpp and AP_MotorsMulticopter.cpp of ArduPilot.
    """
    factor, begin, end = (parameters.get(name, math.nan) for name in ARDUPILOT)
    low, high = _range(parameters)
    if not (-1.0 <= factor <= 1.0 and 0.0 < low < high < math.inf
            and 0.0 <= begin < end <= 1.0):
        return None
    return {'minimum': low + begin * (high - low), 'maximum': low + end * (high - low),
            'factor': factor}


def _range(parameters: Mapping[str, float]) -> tuple[float, float]:
    """
    Return the lowest and the highest pulse to the motors, us, nan where it is not known.

    Where MOT_PWM_MIN and MOT_PWM_MAX are none, as by default until version 4.1, it is the range of
    the throttle of the remote control.
    """
    channel = parameters.get('RCMAP_THROTTLE', 3.0)
    own, remote = ([parameters.get(name, math.nan) for name in (f'{of}_MIN', f'{of}_MAX')]
                   for of in ('MOT_PWM', f'RC{channel:g}'))
    if 0.0 < own[0] < own[1] < math.inf:
        return own[0], own[1]
    return (1000.0, 2000.0) if parameters.get('MOT_PWM_TYPE') in _DIGITAL else (
        remote[0], remote[1])


def share_of_thrust(signals: np.ndarray, minimum: float, maximum: float,
                    factor: float) -> np.ndarray:
    """Return shares 0 to 1 of the full thrust of signals of any shape; nan stays nan."""
    x = np.clip((signals - minimum) / (maximum - minimum), 0.0, 1.0)
    return factor * x ** 2 + (1.0 - factor) * x


def in_words(minimum: float, maximum: float, factor: float) -> str:
    """Return the curve in words."""
    return (f'the share of thrust x is {factor:.3g} s^2 + {1 - factor:.3g} s of the signal s, 0 '
            f'at {minimum:g} and 1 at {maximum:g} (MOT_THST_EXPO)')
