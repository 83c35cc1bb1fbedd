# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The nominal vehicle file that a PX4 log can fill by itself, beside the log."""

import math
from pathlib import Path

import numpy as np

from quad_ident_ros import resources
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.px4_airframe import Motors, motors_of
from quad_ident_ros.data.ulog import read_ulog, refuse_others
from quad_ident_ros.data.ulog_parse import parse
from quad_ident_ros.errors import InputError
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.model.vehicle import Vehicle, vehicle_from_mapping
from quad_ident_ros.whole_file import write_whole

FULL = 1000.0       # rad/s at full signal where no rpm is logged; only thrust over mass counts
STATUS = 'vehicle_status'
USUAL_RATIO = 0.05  # m, the KM that PX4 has where nobody set one

_HEAD = """\
# Nominal vehicle, as far as {log} describes it. Fill in mass and inertia, and give the log
# with --vehicle auto again, which fills in the coefficients that are empty.
name: {name}
mass:                           # kg
inertia: [null, null, null]     # kg m2: Ixx, Iyy, Izz
gravity: {gravity:<23}# m/s2
thrust_coefficient:             # N/(rad/s)^2; empty: {coefficient:.4g} times the mass, by this log
torque_coefficient:             # N m/(rad/s)^2; empty: {ratio:g} m times the thrust coefficient
                                # ({where})
speed_min: {low:.6g}
speed_max: {high:.6g}           # rad/s, {scale}
rotors:                         # in the order of the log's motors, by {source}
"""


def vehicle_of_log(path: Path, mapping: Mapping | None = None) -> Vehicle:
    """
    Return the Vehicle of the file beside a PX4 log, which is written where there is none.

    What the log knows (rotors, speeds, thrust over mass) is filled in; an existing file is
    never changed. Args: path of the log; mapping Mapping or None.
    Raises InputError that asks for what no log knows.
    """
    path = Path(path)
    file = file_beside(path)
    log = parse(path, (STATUS,))
    refuse_others(path, log, next((one.data for one in log.data_list if one.name == STATUS), None))
    motors = motors_of(log.initial_parameters)
    if motors is None:
        raise InputError(f'{path}: the parameters of the log do not say where its motors are '
                         '(CA_ROTOR_COUNT, CA_ROTOR*_PX, MAV_TYPE); give a vehicle file')
    coefficient, speeds, measured = _thrust(path, motors, mapping)
    ratio = motors.ratio if math.isfinite(motors.ratio) else USUAL_RATIO
    missing = ('mass (kg), inertia (kg m2)' if motors.known else
               'mass (kg), inertia (kg m2), the positions of the rotors (m)')
    if not file.exists():
        text = _text(path, motors, coefficient, ratio, speeds, measured)
        try:
            write_whole(file, text)
        except OSError as error:
            raise InputError(f'{file}: cannot be written: {error.strerror}') from None
        raise InputError(f'{file}: written with what the log knows; a log does not have '
                         f'{missing}: fill them in and run this again')
    data = resources.read_yaml(file)
    empty = [key for key in ('mass', 'inertia') if data.get(key) is None
             or isinstance(data[key], list) and None in data[key]]
    rotors = data.get('rotors')
    if isinstance(rotors, list) and any(None in (one.get('position') or [None]) for one in rotors
                                        if isinstance(one, dict)):
        empty.append('position of the rotors')
    if empty:
        raise InputError(f'{file}: {", ".join(empty)}: still empty; fill in {missing} and run '
                         'this again')
    mass = _constant(data['mass'])
    if data.get('thrust_coefficient', 0) is None and mass is not None:
        data['thrust_coefficient'] = coefficient * mass
    thrust = _constant(data.get('thrust_coefficient'))
    if data.get('torque_coefficient', 0) is None and thrust is not None:
        data['torque_coefficient'] = ratio * thrust
    return vehicle_from_mapping(data, str(file))


def _constant(value: object) -> float | None:
    """Return a number of a vehicle file, with a standard deviation or without, None for others."""
    value = value.get('value') if isinstance(value, dict) else value
    try:
        return float(value)  # type: ignore[arg-type]   # YAML takes 1e-5 for text
    except (TypeError, ValueError):
        return None


def file_beside(path: str | Path) -> Path:
    """Return the path of the vehicle file beside a PX4 log."""
    path = Path(path)
    return path.with_name(f'{path.stem}_vehicle.yaml')


def has_thrust(path: str | Path) -> bool:
    """Whether the vehicle file beside a PX4 log has a thrust coefficient without the log."""
    return resources.read_yaml(file_beside(path)).get('thrust_coefficient', 0) is not None


def _thrust(path: Path, motors: Motors,
            mapping: Mapping | None) -> tuple[float, tuple[float, float], bool]:
    """Return (thrust over mass and squared speeds, (low, high) rad/s, whether by rpm)."""
    trial = Vehicle('trial', 1.0, (1.0, 1.0, 1.0), GRAVITY, 1.0, 1.0, motors.rotors,
                    speed_max=FULL)
    records = read_ulog(path, mapping, trial)
    record = max(records, key=len)
    names = record.numbered('cmd')
    if not names:
        raise InputError(f'{path}: the log has no commands of {len(motors.rotors)} motors; '
                         'give a vehicle file')
    squares = np.sum(record.stack(*names) ** 2, axis=1)
    force = record.columns['az'] if record.has('az') else np.full(len(record), GRAVITY)
    use = (squares > 0) & (force > 0)
    if not use.any():
        raise InputError(f'{path}: the motors do not turn in this log; give a vehicle file')
    said = next((note for note in record.info['notes'] if 'esc_status' in note), '')
    high = FULL
    if said:    # by measured speeds: as far as they reached, and a tenth on
        high = 1.1 * max(float(record.stack(*names).max()), 1.0)
    return float(np.median(force[use] / squares[use])), (0.0, high), bool(said)


def _text(path: Path, motors: Motors, coefficient: float, ratio: float,
          speeds: tuple[float, float], measured: bool) -> str:
    low, high = speeds
    head = _HEAD.format(
        log=path.name, name=path.stem, gravity=GRAVITY, coefficient=coefficient, ratio=ratio,
        low=low, high=high,
        where=motors.source if math.isfinite(motors.ratio) else 'a usual value, the log has none',
        scale='1.1 times the fastest of the log, by its rpm' if measured else
        'taken, as no rpm is logged; thrust counts, not speed', source=motors.source)
    lines = []
    for rotor in motors.rotors:
        place = 'null, null, 0'
        if motors.known:
            place = ', '.join(f'{value + 0.0:.6g}' for value in rotor.position)
        quarter = (f'{"front" if rotor.position[0] > 0 else "rear"} '
                   f'{"left" if rotor.position[1] > 0 else "right"}')
        lines.append(f'  - {{position: [{place}], spin: {rotor.spin}}}    # {quarter}\n')
    return head + ''.join(lines)
