# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which motor of a log is which rotor of a vehicle file."""

from collections.abc import Sequence
import math
from pathlib import Path

import numpy as np
import scipy

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Rotor, Vehicle

NEAR = math.radians(30)     # of a rotor of a quadrotor; less where rotors are closer together
NEIGHBOUR = 0.45    # of the angle to the next rotor: a frame turned by half of it is another one
ABOVE = math.radians(5)     # rotors that are closer in direction are above each other


def order_of(where: str | Path, rotors: Sequence[Rotor], source: str,
             vehicle: Vehicle) -> tuple[int, ...]:
    """
    Return for each rotor of a vehicle file the number of its motor in a log, from 1.

    They are matched by their direction from the middle; rotors above each other by height and
    sense of turning.
    Args: where the file, for messages; rotors: of the log, in FLU, spin 0 where it does not know
    it; source: what says so; vehicle Vehicle.
    Raises InputError that names what does not match.
    """
    if len(rotors) != len(vehicle.rotors):
        raise InputError(f'{where}: the vehicle of the log has {len(rotors)} motors ({source}), '
                         f'{vehicle.name} has {len(vehicle.rotors)} rotors; give the vehicle file '
                         'of this vehicle')
    angles = np.abs(np.angle(np.exp(1j * (_direction(vehicle.rotors)[:, None]
                                          - _direction(rotors)[None, :]))))
    # The product of two spins is -1 where they differ, 0 where one is not known.
    turning = np.multiply.outer([rotor.spin for rotor in vehicle.rotors],
                                [rotor.spin for rotor in rotors]) < 0
    # A sense of turning that differs decides only among motors in one direction.
    rows, columns = scipy.optimize.linear_sum_assignment(angles + 0.01 * turning)
    order = tuple(int(columns[k]) + 1 for k in np.argsort(rows))
    near = _near(rotors)
    for k, motor in enumerate(order):
        away = angles[k, motor - 1]
        if away > near:
            raise InputError(
                f'{where}: rotors[{k}] of {vehicle.name} at {_place(vehicle.rotors[k])} has no '
                f'motor of the log ({source}) in its direction, the nearest, motor '
                f'{motor}, is {math.degrees(away):.0f} deg away; correct the positions in the '
                'vehicle file (x forward, y left), or give the order in a mapping')
        if turning[k, motor - 1]:
            spin = rotors[motor - 1].spin
            raise InputError(
                f'{where}: rotors[{k}] of {vehicle.name} has spin {vehicle.rotors[k].spin:+d}, '
                f'motor {motor} of the log ({source}), which lies there, has {spin:+d}; '
                'correct the spin in the vehicle file, or give the order in a mapping')
    return order


def _near(rotors: Sequence[Rotor]) -> float:
    """Return the angle (rad) by which the directions of a rotor and of its motor may differ."""
    around = np.sort(_direction(rotors))
    apart = np.diff([*around, around[0] + 2 * np.pi])
    apart = apart[apart > ABOVE]
    return min(NEAR, NEIGHBOUR * float(apart.min())) if len(apart) else NEAR


def about_motors(rotors: Sequence[Rotor] = (), source: str = '', kind: str = '',
                 curve: dict | None = None) -> dict:
    """
    Return what a reader knows of its motors, for the info `motors` of a record, JSON-able.

    Args: rotors of motors 1.. as in order_of; source: what says so; kind: of model.motors.KINDS;
    curve: of thrust, {minimum, maximum, factor}, as data.thrust_curve has it, or None.
    """
    return {'rotors': [[*rotor.position, rotor.spin] for rotor in rotors], 'source': source,
            'kind': kind, **({'curve': curve} if curve else {})}


def rotors_of(info: dict) -> tuple[Rotor, ...]:
    """Return the rotors in what about_motors made."""
    return tuple(Rotor(tuple(place), int(spin)) for *place, spin in info.get('rotors', ()))


def quad(*directions: tuple[int, int]) -> tuple[Rotor, ...]:
    """Return rotors in directions (forward, left) whose sense of turning is not known."""
    return tuple(Rotor((float(x), float(y), 0.0), 0) for x, y in directions)


def _direction(rotors: Sequence[Rotor]) -> np.ndarray:
    return np.array([math.atan2(rotor.position[1], rotor.position[0]) for rotor in rotors])


def _place(rotor: Rotor) -> str:
    return '[' + ', '.join(f'{value:g}' for value in rotor.position) + ']'
