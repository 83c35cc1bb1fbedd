# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The map from signals to rotor speeds by speeds that were measured beside them."""

from collections.abc import Sequence
from dataclasses import replace
import math

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.motors import Motors, rotor_speeds, shares

FEWEST = 50         # samples
FOLLOWS = 0.5       # correlation with the signal; motors that lag follow it by less than 1


def measured_map(signal: np.ndarray, speed: np.ndarray) -> tuple[str, tuple[float, float]] | None:
    """
    Return (curve, (low, high)) of the map from signal to rotor speed by measured speeds, or None.

    Args: signal (n, m) of 0 to 1; speed (n, m) rad/s at the same times, of turning rotors.
    The curve is linear (speed) or thrust (its square), whichever leaves less unexplained.
    """
    use = np.isfinite(signal) & np.isfinite(speed) & (signal > 0.05) & (speed > 0)
    x, y = signal[use], speed[use]
    # 50 samples over a fifth of the range: fewer do not show which of the two curves it is.
    if len(x) < FEWEST or np.ptp(x) < 0.2 or np.ptp(y) < 1e-9:
        return None
    best = None
    for curve in ('linear', 'thrust'):
        values = y if curve == 'linear' else y ** 2
        slope, offset = np.polyfit(x, values, 1)
        high, low = offset + slope, max(offset, 0.0)
        if curve == 'thrust':
            high, low = math.sqrt(max(high, 0.0)), math.sqrt(low)
            fitted = np.sqrt(np.maximum(offset + slope * x, 0.0))
        else:
            fitted = offset + slope * x
        rest = float(np.std(y - fitted))
        if high > low and (best is None or rest < best[0]):
            best = rest, curve, (low, high)
    # Speeds that the signal explains to a third of their spread are its answer.
    return None if best is None or best[0] > np.std(y) / 3 else best[1:]


def by_measured(records: Sequence[FlightRecord], signals: Sequence[np.ndarray], motors: Motors,
                thrust_coefficient: float) -> Motors | None:
    """
    Return Motors with the gain that measured rotor speeds show, or None where they show none.

    Where the map has no shape either (Motors.gives is ''), the speeds give that, too.
    Args: records of flights with the same motors, rotor1..n of some in the order of the signals;
    signals (N, n) of each; motors without a gain; thrust_coefficient N/(rad/s)^2.
    """
    pairs = [(record, values) for record, values in zip(records, signals, strict=True)
             if len(record.numbered('rotor')) == values.shape[1]]
    if not pairs:
        return None
    speeds = np.concatenate([record.stack(*record.numbered('rotor')) for record, _ in pairs])
    share = shares(np.concatenate([values for _, values in pairs]), motors.minimum, motors.maximum)
    found = None if motors.gives else measured_map(share, speeds)
    if found is not None:
        curve, (low, high) = found
        if curve == 'linear':
            return replace(motors, gives='speed', offset=low, gain=high - low)
        k = thrust_coefficient
        return replace(motors, gives='thrust', offset=k * low ** 2,
                       gain=k * (high ** 2 - low ** 2))
    # In hover alone the shape is not to be seen, and the level is.
    unit = replace(motors, gain=1.0, gives=motors.gives or 'speed')
    given = np.concatenate([
        rotor_speeds(unit, values, thrust_coefficient,
                     record.columns['vbat'] if motors.needs_voltage else None)
        for record, values in pairs])
    turning = (given > 0) & (speeds > 0)
    x, y = given[turning], speeds[turning]
    if len(x) < FEWEST or not np.std(x) * np.std(y) > 0 or np.corrcoef(x, y)[0, 1] < FOLLOWS:
        return None
    ratio = float(np.median(y / x))
    return replace(unit, gain=ratio if unit.gives == 'speed' else ratio ** 2)
