# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the constants of a multirotor can be by physics, from one of 0.1 g to one of 100 t."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations
import math
from typing import TYPE_CHECKING

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.motors import Motors, rotor_speeds, TO_SPEED

if TYPE_CHECKING:
    from quad_ident_ros.model.vehicle import Vehicle

MASSES = (1e-4, 1e5)        # kg: insects with wings of foil, and ten times the largest helicopter
GRAVITIES = (0.01, 30.0)    # m/s^2: an asteroid, and Jupiter has 24.8
FARTHEST = 100.0            # m of a rotor from the centre of mass; tips stay below sound
SHORTEST_ARM = 1e-3         # m
MOST_ROTORS = 64
ONE_PLACE = 0.01            # of an arm between two rotors: less is the same place, typed twice
BALANCED = 0.1              # of an arm from the axis to the middle of all rotors
SPEEDS = (1.0, 1e5)         # rad/s at hover: 10 rpm and a million
GYRATION = (0.01, 5.0)      # radius, in arms: what flies is neither a needle nor a long boom
FLAT = 10.0     # times the sum of the other two: of a rigid body it is 1, estimates are not exact
REACTION = (1e-6, 10.0)     # torque over thrust, in arms: of real rotors about 0.1
SLOWEST_FALL = 0.1          # m/s at which drag carries the weight: a kite falls faster
SLOWEST_TURN = 5.0          # rad/s at which drag stands against the weight on one arm
SIGNALS = 1e6               # at no and full throttle: 16 bits have 65535
EXPONENTS = (0.1, 10.0)     # of a map: 0.5 to 2 are usual
VOLTAGES = (0.5, 1e3)       # V: less than a cell has, and ten times a car's
MOST_BY_VOLTAGE = 10.0      # exponent of the voltage: thrust goes with its square at most
FULL_THRUSTS = (1e-3, 1e3)  # in shares of the weight: racers lift ten times theirs, and a map in
                            # another unit is off by more
MOST_STDS = 1e3             # of the scale of a constant: more says nothing


def refuse_absurd(where: str, vehicle: Vehicle) -> None:
    """Raise InputError where a constant of a vehicle is not one that a multirotor can have."""
    for key, value, low, high, unit, why in _ranges(vehicle):
        if not low <= value <= high:
            raise InputError(f'{where}: {key}: {value:.6g} {unit} cannot be, expected '
                             f'{low:.3g} to {high:.3g}: {why}')
    _refuse_one_place(where, vehicle)
    for key, std, most in _deviations(vehicle):
        if std > most:
            raise InputError(f'{where}: {key}: std: {std:.6g} is so large that it says nothing; '
                             f'expected at most {most:.3g}')


def _refuse_one_place(where: str, vehicle: Vehicle) -> None:
    """
    Raise InputError for two rotors at one place that are not coaxial.

    Files often leave out the height between coaxial rotors. But those turn against one another,
    and with them the rotors are around the centre of mass all the same.
    """
    arm = vehicle.arm_length
    middle = math.hypot(*np.mean([one.position[:2] for one in vehicle.rotors], axis=0))
    for (i, one), (j, other) in combinations(enumerate(vehicle.rotors), 2):
        if math.dist(one.position, other.position) >= ONE_PLACE * arm:
            continue
        if one.spin == other.spin:
            why = 'and turn the same way: coaxial rotors turn against one another'
        elif middle > BALANCED * arm:
            why = f'and the middle of all rotors is {middle:.2g} m from the centre of mass'
        else:
            continue
        place = ', '.join(f'{value:g}' for value in one.position)
        raise InputError(f'{where}: rotors[{i}] and rotors[{j}] are at one place, [{place}] m, '
                         f'{why}; give each its own place and spin')


def _ranges(vehicle: Vehicle) -> Iterator[tuple[str, float, float, float, str, str]]:
    """
    Give (key, value, lowest, highest, unit, why) of each constant.

    Each range may rest on the ones before it, which were checked by then.
    """
    yield 'mass', vehicle.mass, *MASSES, 'kg', 'of an insect to a hundred tons'
    yield 'gravity', vehicle.gravity, *GRAVITIES, 'm/s^2', 'the Earth has 9.8'
    yield 'rotors', len(vehicle.rotors), 1, MOST_ROTORS, 'of them', 'one entry a rotor'
    for k, rotor in enumerate(vehicle.rotors):
        for axis, place in enumerate(rotor.position):
            yield (f'rotors[{k}]: position[{axis}]', place, -FARTHEST, FARTHEST, 'm',
                   'it is the place from the centre of mass in m')
    arm = vehicle.arm_length
    yield ('rotors', arm, SHORTEST_ARM, FARTHEST, 'm of arm',
           'they stand in m from the centre of mass')
    yield 'rotor_radius', vehicle.rotor_radius, 0.0, FARTHEST, 'm', 'it is in m'
    per_gyration = vehicle.mass * arm ** 2
    for axis, moment in enumerate(vehicle.inertia):
        yield (f'inertia[{axis}]', moment, GYRATION[0] ** 2 * per_gyration,
               GYRATION[1] ** 2 * per_gyration, 'kg m^2',
               f'its mass would lie {math.sqrt(moment / per_gyration):.2g} arms from the axis')
    for axis, moment in enumerate(vehicle.inertia):
        yield (f'inertia[{axis}]', moment, 0.0, FLAT * (sum(vehicle.inertia) - moment), 'kg m^2',
               'no body has one moment of inertia above the sum of the other two')
    if any(vehicle.products):
        moments = np.linalg.eigvalsh(vehicle.inertia_matrix).tolist()
        for moment in moments:
            yield ('inertia: principal moment', moment, GYRATION[0] ** 2 * per_gyration,
                   min(GYRATION[1] ** 2 * per_gyration, FLAT * (sum(moments) - moment)), 'kg m^2',
                   'the entries beside the diagonal are too large for those on it')
    yield ('rotor_inertia', vehicle.rotor_inertia, 0.0, vehicle.inertia[2], 'kg m^2',
           'it is a part of the inertia about z')
    weight = vehicle.mass * vehicle.gravity
    per_rotor = weight / len(vehicle.rotors)
    yield ('thrust_coefficient', vehicle.thrust_coefficient, per_rotor / SPEEDS[1] ** 2,
           per_rotor / SPEEDS[0] ** 2, 'N/(rad/s)^2',
           f'it would hover at {math.sqrt(per_rotor / vehicle.thrust_coefficient):.2g} rad/s; '
           'signals of 0 to 1, PWM or duty stand in the section motors')
    per_reaction = arm * vehicle.thrust_coefficient
    yield ('torque_coefficient', vehicle.torque_coefficient, REACTION[0] * per_reaction,
           REACTION[1] * per_reaction, 'N m/(rad/s)^2',
           'it is about a tenth of the arm (m) times the thrust coefficient')
    yield 'speed_min', vehicle.speed_min, 0.0, SPEEDS[1], 'rad/s', 'it is in rad/s'
    if not math.isinf(vehicle.speed_max):
        yield 'speed_max', vehicle.speed_max, 0.0, SPEEDS[1], 'rad/s', 'it is in rad/s'
    for axis, drag in enumerate(vehicle.linear_drag):
        yield (f'linear_drag[{axis}]', drag, 0.0, weight / SLOWEST_FALL, 'N/(m/s)',
               f'the vehicle would fall no faster than {_ratio(weight, drag):.2g} m/s')
    for axis, drag in enumerate(vehicle.rotational_drag):
        yield (f'rotational_drag[{axis}]', drag, 0.0, weight * arm / SLOWEST_TURN ** 2,
               'N m/(rad/s)^2', 'its weight on one arm would turn the vehicle no faster than '
               f'{math.sqrt(_ratio(weight * arm, drag)):.2g} rad/s')
    if vehicle.motors is not None and vehicle.motors.kind not in TO_SPEED:
        yield from _motor_ranges(vehicle, vehicle.motors, per_rotor)


def _motor_ranges(vehicle: Vehicle, motors: Motors, per_rotor: float
                  ) -> Iterator[tuple[str, float, float, float, str, str]]:
    """Give the ranges of the section motors; per_rotor: the weight that a rotor carries, N."""
    for key in ('minimum', 'maximum'):
        yield (f'motors: {key}', getattr(motors, key), -SIGNALS, SIGNALS, 'as signal',
               'signals of 16 bits go to 65535')
    yield (f'motors: {motors.gives}: exponent', motors.exponent, *EXPONENTS, 'as exponent',
           'it is between 0.5 and 2 of real motors')
    if motors.voltage_reference is not None:
        yield ('motors: voltage: reference', motors.voltage_reference, *VOLTAGES, 'V',
               'it is in V')
        yield ('motors: voltage: exponent', motors.voltage_exponent, 0.0, MOST_BY_VOLTAGE,
               'as exponent', 'thrust goes with the square of the voltage at most')
    if motors.whole:
        coefficient = vehicle.thrust_coefficient
        with np.errstate(over='ignore'):
            speed = rotor_speeds(replace(motors, voltage_reference=None), [[motors.maximum]],
                                 coefficient)[0, 0]
            thrust = coefficient * speed ** 2
        low, high = (share * per_rotor for share in FULL_THRUSTS)
        yield (f'motors: {motors.gives}', thrust, low, high,
               'N at full signal', f'each rotor carries {per_rotor:.3g} N in hover; speed is in '
               'rad/s, thrust in N')


def _deviations(vehicle: Vehicle) -> Iterator[tuple[str, float, float]]:
    """Give (key, standard deviation, most that it may be) of each constant that has one."""
    weight = vehicle.mass * vehicle.gravity
    scales = {'linear_drag': weight / SLOWEST_FALL, 'rotor_radius': FARTHEST,
              'rotor_inertia': vehicle.inertia[2], 'speed_min': SPEEDS[1],
              'speed_max': SPEEDS[1], 'inertia': max(vehicle.inertia),
              'rotational_drag': weight * vehicle.arm_length / SLOWEST_TURN ** 2}
    for key, std in vehicle.uncertainty.items():
        scale = scales.get(key)
        if scale is None:
            scale = FARTHEST if key.endswith('.position') else getattr(vehicle, key)
        for one in std if isinstance(std, tuple) else (std,):
            if one is not None:
                yield key, one, MOST_STDS * scale


def _ratio(one: float, other: float) -> float:
    return one / other if other > 0.0 else math.inf
