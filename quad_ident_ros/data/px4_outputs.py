# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which of the actuator outputs of a PX4 log are those of the motors."""

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np

from quad_ident_ros.data.px4_airframe import bank_of, BANKS, channels_of, Parameters

Fields: TypeAlias = Mapping[str, np.ndarray]

FEWEST = 3      # motors of a vehicle whose log does not say how many it has


def motor_outputs(instances: Mapping[int, Fields], parameters: Parameters,
                  count: int | None) -> tuple[int, str]:
    """
    Return (instance, bank of px4_airframe.BANKS or '') of the outputs that motors are on.

    Each driver of PX4 logs its outputs as an instance of its own, and the log does not say which
    bank it drives: motors are where all their channels change. The first instance where none
    does, or all do.
    Args: instances: multi_id -> fields of actuator_outputs; count of motors, None if not known.
    """
    count_named = count or FEWEST
    banks = [bank for bank in BANKS if bank_of(parameters, count_named, (bank,))] or ['']
    for number in sorted(instances):
        changing = _changing(instances[number])
        for bank in banks:
            if count is None:
                moved = len(changing) >= FEWEST
            else:
                moved = changing.issuperset(channels_of(parameters, count, bank))
            if moved:
                return number, bank
    return min(instances), banks[0]


def _changing(fields: Fields) -> set[int]:
    """Return the channels, from 0, whose values change."""
    found, k = set(), 0
    while f'output[{k}]' in fields:
        with np.errstate(all='ignore'):     # nan of a kind that signals, and values without end
            values = np.asarray(fields[f'output[{k}]'], float)
            values = values[np.isfinite(values)]
            if len(values) and np.ptp(values) > 0:
                found.add(k)
        k += 1
    return found
