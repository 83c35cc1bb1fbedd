# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Axes along which rotors push."""

import math

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.reading import Draft

MOST_TILT = math.radians(10.0)      # of a rotor: it takes 1.5 % of the thrust along z
LEAST_TILT = math.radians(0.1)      # rounded angles of a file


def check_axis(draft: Draft, axis: np.ndarray, where: str) -> None:
    """
    Say of a rotor whose thrust is not along body z that it was taken so.

    Args: axis (3,) of its thrust in body axes, unit; where: file, line and element. Raises
    InputError where it is tilted by more than MOST_TILT.
    """
    tilt = math.atan2(float(np.hypot(axis[0], axis[1])), float(axis[2]))
    if tilt > MOST_TILT:
        raise InputError(f'{where}: its thrust is {math.degrees(tilt):.3g} deg off body z; rotors '
                         f'that are tilted by more than {math.degrees(MOST_TILT):g} deg are '
                         'beyond the model')
    if tilt > LEAST_TILT:
        draft.assumed.append(f'{where.partition(", ")[2]}: its thrust, {math.degrees(tilt):.3g} '
                             'deg off body z, is taken along it')
