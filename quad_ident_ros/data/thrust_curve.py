# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The thrust curve by which an autopilot that logs its parameters drives the motors."""

from collections.abc import Mapping
import math

import numpy as np

ARDUPILOT = ('MOT_THST_EXPO', 'MOT_PWM_MIN', 'MOT_PWM_MAX', 'MOT_SPIN_MIN', 'MOT_SPIN_MAX')
"""Parameters of ArduCopter that make the curve."""


def ardupilot_curve(parameters: Mapping[str, float]) -> dict[str, float] | None:
    """
    Return {minimum, maximum (us of PWM), factor} of ArduCopter's parameters, or None.

    It takes thrust for factor x^2 + (1 - factor) x of the share x of the outputs from
    MOT_SPIN_MIN to MOT_SPIN_MAX, which are shares of MOT_PWM_MIN to MOT_PWM_MAX; factor is
    MOT_THST_EXPO. None where the log does not have them all, or they make no curve: a MOT_PWM_MIN
    of 0 stands for the range of the remote control.
    Source: AP_Motors_Thrust_Linearization.cpp and AP_MotorsMulticopter.cpp of ArduPilot.
    """
    factor, low, high, begin, end = (parameters.get(name, math.nan) for name in ARDUPILOT)
    if not (-1.0 <= factor <= 1.0 and 0.0 < low < high < math.inf
            and 0.0 <= begin < end <= 1.0):
        return None
    return {'minimum': low + begin * (high - low), 'maximum': low + end * (high - low),
            'factor': factor}


def share_of_thrust(signals: np.ndarray, minimum: float, maximum: float,
                    factor: float) -> np.ndarray:
    """Return shares 0 to 1 of the full thrust of signals of any shape; nan stays nan."""
    x = np.clip((signals - minimum) / (maximum - minimum), 0.0, 1.0)
    return factor * x ** 2 + (1.0 - factor) * x


def in_words(minimum: float, maximum: float, factor: float) -> str:
    """Return the curve in words."""
    return (f'the share of thrust x is {factor:.3g} s^2 + {1 - factor:.3g} s of the signal s, 0 '
            f'at {minimum:g} and 1 at {maximum:g} (MOT_THST_EXPO)')
