# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The vehicle file: the nominal vehicle, how well it is known, and its effects."""

from dataclasses import asdict, dataclass, field, fields, replace
import math
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import yaml

from quad_ident_ros import resources, schema
from quad_ident_ros.effects import registry
from quad_ident_ros.errors import InputError
from quad_ident_ros.model import residual_function
from quad_ident_ros.model.covariance import (
    Covariance,
    covariance_from,
    covariance_to_mapping,
)
from quad_ident_ros.model.motors import Motors, motors_from, motors_to_mapping
from quad_ident_ros.model.plausible import refuse_absurd
from quad_ident_ros.model.residual_function import ResidualFunction
from quad_ident_ros.whole_file import write_whole

Uncertainty: TypeAlias = float | tuple[float | None, ...]

# Constants by key of the file, and whether zero is refused.
NUMBERS = {'mass': True, 'gravity': True, 'thrust_coefficient': True, 'torque_coefficient': True,
           'rotor_inertia': False, 'rotor_radius': False, 'speed_min': False, 'speed_max': False}
TRIPLES = {'inertia': True, 'linear_drag': False, 'rotational_drag': False}
SYMMETRIC = 1e-6    # of the largest moment of inertia: entries are printed with some digits
LEAST_HOVER = 0.03  # of speed_max: the rotors would carry a thousand times the weight


@dataclass(frozen=True)
class Rotor:
    """A rotor: its place in the body frame (m) and the sign of its reaction torque about +z."""

    position: tuple[float, ...]
    spin: int


@dataclass(frozen=True)
class Vehicle:
    """
    A rigid multirotor; SI units, body frame x forward, y left, z up.

    inertia (3,) kg m^2, Ixx, Iyy, Izz about the centre of mass, and products (3,), Ixy, Ixz, Iyz,
    the entries beside the diagonal, with the sign that they have there;
    thrust_coefficient N/(rad/s)^2; torque_coefficient N m/(rad/s)^2;
    linear_drag (3,) N/(m/s); rotational_drag (3,) N m/(rad/s)^2; speeds rad/s; effects that it
    has beside the nominal model, {effect: {parameter: value}}, see effects.registry; uncertainty:
    standard deviations of the constants that have one, in the constant's unit, by key (those of
    places by 'rotors[0].position'); those of lists are tuples, None where an entry has none;
    motors: what the signals of its records are, or None; covariance: how well flights, and what
    was stated before, tell numbers of it together, or None; residual: a force and moment beside
    all effects, or None.
    """

    name: str
    mass: float
    inertia: tuple[float, ...]
    gravity: float
    thrust_coefficient: float
    torque_coefficient: float
    rotors: tuple[Rotor, ...]
    rotor_inertia: float = 0.0
    rotor_radius: float = 0.0
    linear_drag: tuple[float, ...] = (0.0, 0.0, 0.0)
    rotational_drag: tuple[float, ...] = (0.0, 0.0, 0.0)
    speed_min: float = 0.0
    speed_max: float = float('inf')
    effects: registry.Values = field(default_factory=dict, hash=False)
    uncertainty: dict[str, Uncertainty] = field(default_factory=dict, hash=False)
    motors: Motors | None = None
    products: tuple[float, float, float] = (0.0, 0.0, 0.0)
    covariance: Covariance | None = field(default=None, hash=False)
    residual: ResidualFunction | None = field(default=None, hash=False)

    @property
    def arm_length(self) -> float:
        """Lever arm l in m: the mean distance of the rotors from the body's z axis."""
        return float(np.mean([np.hypot(r.position[0], r.position[1]) for r in self.rotors]))

    @property
    def inertia_matrix(self) -> np.ndarray:
        """Matrix of inertia about the centre of mass, body axes, (3, 3) kg m^2."""
        xy, xz, yz = self.products
        return np.diag(self.inertia) + np.array([[0.0, xy, xz], [xy, 0.0, yz], [xz, yz, 0.0]])

    @property
    def hover_speed(self) -> float:
        """Speed of each rotor, rad/s, at which they all carry the weight."""
        return math.sqrt(self.mass * self.gravity / (len(self.rotors) * self.thrust_coefficient))

    @property
    def hover_input(self) -> np.ndarray:
        """Return the inputs U1..U4 (4,) that hold the vehicle still: the weight on U1, N."""
        return np.array([self.mass * self.gravity, 0.0, 0.0, 0.0])


def hover_fault(vehicle: Vehicle) -> tuple[str, str] | None:
    """Return (what, how to mend it) where a vehicle cannot hover by its file, or None."""
    hover, low, high = vehicle.hover_speed, vehicle.speed_min, vehicle.speed_max
    if hover >= high:
        limit = f'beyond its speed_max of {high:g} rad/s: it cannot take off'
    elif hover <= low:
        limit = f'below its speed_min of {low:g} rad/s: it cannot come down'
    elif math.isfinite(high) and hover < LEAST_HOVER * high:
        limit = (f'at {100 * hover / high:.2g} % of its speed_max of {high:g} rad/s: no vehicle '
                 'is so strong')
    else:
        return None
    return (f'{vehicle.name} would hover at {hover:.4g} rad/s, {limit}',
            'correct mass (kg), thrust_coefficient (N/(rad/s)^2), rotors or limits (rad/s) in the '
            'vehicle file')


def load_vehicle(name_or_path: str | Path) -> Vehicle:
    """
    Return the vehicle of a shipped name or of a vehicle file.

    Raises InputError that names file and key where the file does not describe a vehicle.
    """
    path = resources.find('vehicles', name_or_path)
    return vehicle_from_mapping(resources.read_yaml(path), str(path))


def vehicle_from_mapping(data: Any, where: str) -> Vehicle:
    """Return the vehicle that the mapping of a vehicle file describes; raises InputError."""
    known = [field.name for field in fields(Vehicle)
             if field.name not in ('uncertainty', 'products')]
    required = known[:7]
    if isinstance(data, dict):
        for key in data:
            if key in registry.EFFECTS:
                raise InputError(f'{where}: {key!r} is an effect; write it under the key '
                                 f'`effects`: effects: {{{key}: ...}}')
    schema.check_keys(where, data, known, required)
    values: dict[str, Any] = {'name': schema.name(f'{where}: name', data['name'])}
    stds: dict[str, Uncertainty | None] = {}
    for key, exclusive in NUMBERS.items():
        if key in data:
            values[key], stds[key] = schema.uncertain(f'{where}: {key}', data[key], 0.0,
                                                      exclusive)
    data, values['products'] = _without_products(where, data)
    for key, exclusive in TRIPLES.items():
        if key in data:
            values[key], stds[key] = schema.uncertain_numbers(
                f'{where}: {key}', data[key], 3, 0.0, exclusive)
    if not isinstance(data['rotors'], list) or not data['rotors']:
        raise InputError(f'{where}: rotors: expected a list of {{position: [x, y, z], spin: 1}}')
    rotors = []
    for i, rotor in enumerate(data['rotors']):
        made, stds[_place_of(i)] = _rotor(f'{where}: rotors[{i}]', rotor)
        rotors.append(made)
    vehicle = Vehicle(**values, rotors=tuple(rotors), uncertainty={
        key: std for key, std in stds.items() if std is not None and std != (None,) * 3})
    if not vehicle.arm_length > 0:
        raise InputError(f'{where}: rotors: all of them lie on the z axis; give their places')
    if vehicle.speed_max <= vehicle.speed_min:
        raise InputError(f'{where}: speed_max must be greater than speed_min')
    if 'motors' in data:
        vehicle = replace(vehicle, motors=motors_from(f'{where}: motors', data['motors']))
    if 'residual' in data:
        vehicle = replace(vehicle, residual=residual_function.from_mapping(
            f'{where}: residual', data['residual']))
    refuse_absurd(where, vehicle)
    if 'effects' in data:
        theta = registry.vector(data['effects'], vehicle, f'{where}: effects')
        vehicle = replace(vehicle, effects=registry.mapping(theta))
    if 'covariance' in data:
        vehicle = replace(vehicle, covariance=covariance_from(
            f'{where}: covariance', data['covariance'], len(vehicle.rotors)))
    return vehicle


def vehicle_to_mapping(vehicle: Vehicle) -> dict[str, Any]:
    """Return the mapping of a vehicle file that describes the vehicle."""
    stds = vehicle.uncertainty
    data = {key: _with_std(value, stds.get(key)) for key, value in asdict(vehicle).items()
            if key not in ('uncertainty', 'motors', 'products', 'covariance', 'residual')}
    data['rotors'] = [{'position': _with_std(rotor.position, stds.get(_place_of(i))),
                       'spin': rotor.spin} for i, rotor in enumerate(vehicle.rotors)]
    if any(vehicle.products):
        (x, y, z), (xy, xz, yz) = data['inertia'], vehicle.products
        data['inertia'] = [[x, xy, xz], [xy, y, yz], [xz, yz, z]]
    if math.isinf(vehicle.speed_max):
        del data['speed_max']
    if vehicle.motors is not None:
        data['motors'] = motors_to_mapping(vehicle.motors)
    if not vehicle.effects:
        del data['effects']
    if vehicle.covariance is not None:
        data['covariance'] = covariance_to_mapping(vehicle.covariance, len(vehicle.rotors))
    if vehicle.residual is not None:
        data['residual'] = residual_function.to_mapping(vehicle.residual)
    return data


def vehicle_text(vehicle: Vehicle) -> str:
    """Return the text of a vehicle file."""
    return yaml.safe_dump(vehicle_to_mapping(vehicle), sort_keys=False, default_flow_style=None)


def check_ending(path: str | Path) -> None:
    """Raise InputError where a path has not the ending of a vehicle file."""
    if Path(path).suffix not in ('.yaml', '.yml'):
        raise InputError(f'{path}: a vehicle is written to a .yaml file; name one')


def write_vehicle(path: str | Path, vehicle: Vehicle) -> None:
    """Write a vehicle file that load_vehicle reads back as it was; raises InputError."""
    check_ending(path)
    try:
        write_whole(path, vehicle_text(vehicle))
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None


def _without_products(where: str, data: dict[str, Any]
                      ) -> tuple[dict[str, Any], tuple[float, float, float]]:
    """Return the mapping with the diagonal of a matrix of inertia, and the products beside it."""
    rows = data['inertia']
    if not (isinstance(rows, list) and rows and any(isinstance(row, list) for row in rows)):
        return data, (0.0, 0.0, 0.0)
    where = f'{where}: inertia'
    if not (len(rows) == 3 and all(isinstance(row, list) and len(row) == 3 for row in rows)):
        raise InputError(f'{where}: expected [Ixx, Iyy, Izz] or 3 rows of 3 numbers, kg m^2')
    known = [[schema.uncertain(f'{where}[{i}][{j}]', entry) for j, entry in enumerate(row)]
             for i, row in enumerate(rows)]

    def product(i: int, j: int) -> float:
        (one, std), (other, other_std) = known[i][j], known[j][i]
        if std is not None or other_std is not None:
            raise InputError(f'{where}[{i}][{j}]: only moments of inertia, on the diagonal, may '
                             'have a std')
        if abs(one - other) > SYMMETRIC * max(abs(known[k][k][0]) for k in range(3)):
            raise InputError(f'{where}: {one:g} in row {i + 1} and {other:g} in row {j + 1}: the '
                             'matrix of inertia is not symmetric')
        return 0.5 * (one + other)

    return ({**data, 'inertia': [rows[k][k] for k in range(3)]},
            (product(0, 1), product(0, 2), product(1, 2)))


def _with_std(value: Any, std: Any) -> Any:
    """Return a value of a vehicle file with its standard deviation, where it has one."""
    if isinstance(value, tuple):
        return [_with_std(*pair) for pair in zip(value, std or [None] * len(value), strict=True)]
    return value if std is None else {'value': value, 'std': std}


def _place_of(rotor: int) -> str:
    """Return the key by which `uncertainty` has the place of a rotor."""
    return f'rotors[{rotor}].position'


def _rotor(where: str, data: Any) -> tuple[Rotor, tuple[float | None, ...]]:
    """Return a rotor, and the standard deviations of its place."""
    schema.check_keys(where, data, ('position', 'spin'), ('position', 'spin'))
    position, stds = schema.uncertain_numbers(f'{where}: position', data['position'], 3)
    return Rotor(position, schema.choice(f'{where}: spin', data['spin'], (1, -1))), stds
