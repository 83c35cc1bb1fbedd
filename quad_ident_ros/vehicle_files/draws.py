# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles drawn at random, as far apart as flights leave a vehicle open."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.quantities import unit_of, value_of, with_values
from quad_ident_ros.model.vehicle import (
    hover_fault,
    Vehicle,
    vehicle_from_mapping,
    vehicle_to_mapping,
)
from quad_ident_ros.schema import lengthened
from quad_ident_ros.vehicle_files.bodies import Body, is_body
from quad_ident_ros.vehicle_files.known import known_of
from quad_ident_ros.vehicle_files.wanted import Wanted, wanted_of

AT_ONCE = 64        # so that the first vehicles of a seed are the same, however many are drawn
FEWEST = 0.01       # of the draws that can be vehicles: with fewer the widths are too large
DRAWN = 1000        # that show it


@dataclass(frozen=True, eq=False)
class Draws:
    """
    Vehicles drawn at random, and the numbers in which they differ.

    names (P,) of model.quantities and units; means (P,) and stds (P,): of the vehicle file and of
    its covariance; values (N, P); cut: how many draws cannot be vehicles and were drawn again, and
    why, of the first of them, the first could not be.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    means: np.ndarray
    stds: np.ndarray
    values: np.ndarray
    vehicles: tuple[Vehicle, ...]
    cut: int
    why: str


def draw(vehicle: Vehicle, count: int, seed: int = 0,
         on_progress: Callable[[float], None] = lambda share: None) -> Draws:
    """
    Return Draws of so many vehicles from the normal distribution that a vehicle file states.

    Its covariance about its values, and apart from these each constant whose deviation is stated
    and that the covariance does not know by this or another name. What cannot be a vehicle is
    drawn again: the distribution is cut off at the bounds of effects and constants, at inertias
    that no body has, and where it could not hover.
    Raises InputError where the file has no covariance, or one that is no width of vehicles.
    """
    if vehicle.covariance is None:
        raise InputError(f'vehicle {vehicle.name}: its file has no covariance; `quad_ident '
                         'diagnose` and `quad_ident fit` write that of what they estimate by '
                         '`--out-vehicle FILE`')
    names, matrix = known_of(vehicle)
    means = np.array([value_of(vehicle, name) for name in names])
    stds = np.sqrt(np.diag(matrix))
    scale = np.where(stds > 0.0, stds, 1.0)
    spread, axes = np.linalg.eigh(matrix / np.outer(scale, scale))
    root = scale[:, None] * axes * np.sqrt(np.maximum(spread, 0.0))
    plain = replace(vehicle, covariance=None, uncertainty={})
    real = _is_real(plain)
    rng = np.random.default_rng(seed)
    rows: list[np.ndarray] = []
    vehicles: list[Vehicle] = []
    cut, why = 0, ''
    while len(rows) < count:
        for row in means + rng.standard_normal((AT_ONCE, len(names))) @ root.T:
            if len(rows) == count:
                break
            made = with_values(plain, dict(zip(names, row.tolist(), strict=True)))
            fault = _fault(made, real)
            if fault:
                cut, why = cut + 1, why or fault
                continue
            rows.append(row)
            vehicles.append(replace(made, name=lengthened(vehicle.name,
                                                          f'_{len(rows):04d}')))
        if cut >= DRAWN and len(rows) < FEWEST * cut:
            raise InputError(f'vehicle {vehicle.name}: {len(rows)} of {len(rows) + cut} draws can '
                             f'be vehicles; the first that cannot: {why}; correct the covariance '
                             'and the stds of the vehicle file')
        on_progress(len(rows) / count)
    return Draws(names, tuple(map(unit_of, names)), means, stds, np.array(rows), tuple(vehicles),
                 cut, why)


def table_of_draws(draws: Draws, on_progress: Callable[[float], None] = lambda share: None
                   ) -> tuple[tuple[str, ...], tuple[str, ...], np.ndarray]:
    """
    Return names (C,), units and values (N, C) of drawn vehicles for simulators that batch.

    What was drawn, and what a simulator has of it with the effects in it, which begins with
    `with_effects.`: mass, places of the centre of mass and of each rotor in body axes, inertia
    about that centre, thrust and torque coefficient of each rotor; a sag of the battery is left
    out of it. on_progress is called with the share done.
    """
    first: dict[str, float] = {}
    rows: list[list[float]] = []
    for number, vehicle in enumerate(draws.vehicles):
        if number % AT_ONCE == 0:
            on_progress(number / len(draws.vehicles))
        first = _with_effects(vehicle, wanted_of(vehicle, None, ()))
        rows.append(list(first.values()))
    table = np.array(rows)
    units = {'mass': 'kg', 'centre': 'm', 'inertia': 'kg m^2', 'rotor': 'm',
             'thrust': 'N/(rad/s)^2', 'torque': 'N m/(rad/s)^2'}
    return ((*draws.names, *(f'with_effects.{name}' for name in first)),
            (*draws.units, *(units[name.partition('_')[0]] for name in first)),
            np.hstack([draws.values, table]))


def _with_effects(vehicle: Vehicle, wanted: Wanted) -> dict[str, float]:
    inertia = {f'inertia_{one}{other}': float(wanted.inertia[i, j])
               for i, one in enumerate('xyz') for j, other in enumerate('xyz') if j >= i}
    return {'mass': wanted.mass,
            **{f'centre_{axis}': float(at) for axis, at in zip('xyz', wanted.centre, strict=True)},
            **inertia,
            **{f'rotor_{j}_{axis}': float(at) for j, rotor in enumerate(vehicle.rotors, 1)
               for axis, at in zip('xyz', wanted.arms * rotor.position, strict=True)},
            **{f'thrust_coefficient_{j}': wanted.thrust * (1.0 - float(loss))
               for j, loss in enumerate(wanted.losses, 1)},
            **{f'torque_coefficient_{j}': wanted.torque * (1.0 - float(loss))
               for j, loss in enumerate(wanted.torque_losses, 1)}}


def _fault(vehicle: Vehicle, real: bool) -> str:
    """Return why a vehicle cannot be, or ''; real: whether its inertia is to be that of a body."""
    try:
        vehicle_from_mapping(vehicle_to_mapping(vehicle), 'draw')
    except InputError as error:
        return str(error).removeprefix('draw: ')
    fault = hover_fault(vehicle)
    if fault:
        return fault[0]
    return 'no body has its inertia' if real and not _is_real(vehicle) else ''


def _is_real(vehicle: Vehicle) -> bool:
    """Return whether there is a body of the mass and inertia of a vehicle with its effects."""
    wanted = wanted_of(vehicle, None, ())
    return is_body(Body(wanted.mass, wanted.centre, wanted.inertia))
