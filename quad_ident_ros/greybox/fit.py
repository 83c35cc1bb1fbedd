# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Chosen physical parameters from flights, with what the flights cannot determine."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from quad_ident_ros import __version__
from quad_ident_ros.arguments import flight_records, vehicle_given
from quad_ident_ros.data.clocks import clocks_of, on_one_clock
from quad_ident_ros.data.differentiated import with_motion
from quad_ident_ros.data.inertial import is_inertial, with_position
from quad_ident_ros.data.record import FlightRecord, refuse_twice
from quad_ident_ros.data.thrust_level import FULL_SPEED, on_one_level
from quad_ident_ros.effects.registry import mapping, titled
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.errors import GROUPS, UNITS
from quad_ident_ros.greybox.estimate import Estimate, estimate
from quad_ident_ros.greybox.flights import Flight, highest_voltage, track_of
from quad_ident_ros.greybox.free import columns_of_names, excitation_of
from quad_ident_ros.greybox.identifiable import correlated, Freedom, freedoms
from quad_ident_ros.greybox.known_together import known_together
from quad_ident_ros.greybox.near import near_flights
from quad_ident_ros.greybox.noise import quick_noise
from quad_ident_ros.greybox.normal import covariance_of, Normal, scatter_of
from quad_ident_ros.greybox.parameters import FACTORS, INDEX, limits, nominal, SPLIT
from quad_ident_ros.greybox.rotor_answer import is_driven_by_speeds, NO_COMMANDS, OF_MOTORS
from quad_ident_ros.model.covariance import Covariance
from quad_ident_ros.model.quantities import unit_of
from quad_ident_ros.model.vehicle import Uncertainty, Vehicle

SCHEMA = 'quad_ident/fit/1'
STRONG = 0.9    # correlation from which on two parameters are named
READ, FITTED = 0.05, 0.6    # shares of the work: a second fit may hold what is undetermined
COLOURED = 1.5  # noise over what changes from sample to sample, from which on it is said

OF_LEVEL = ('mass', 'thrust_coefficient', 'mass_offset.mass', *FACTORS['thrust_coefficient'])
"""Names of what scales thrust over mass."""


@dataclass(frozen=True)
class Parameter:
    """
    What was found of a parameter; value and std (standard error) in `unit`.

    status: 'determined', 'bound' (it ends there, without a standard error) or 'undetermined'. The
    value of an undetermined one holds if those in `given`, {name: value}, have these values; it
    is None where it is not even known then.
    """

    name: str
    unit: str
    nominal: float
    value: float | None
    std: float | None
    status: str
    given: dict[str, float]


@dataclass(frozen=True, eq=False)
class Fit:
    """
    Parameters of a vehicle fitted to flights.

    names of the columns of the estimate, and so of its covariance; together: how well they are
    known with the constants whose deviation the file states, or None where nothing is; findings:
    lines of text; correlations: (name, name, value) of those that are strong.
    """

    vehicle: Vehicle
    flights: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    estimate: Estimate
    names: tuple[str, ...]
    together: Covariance | None
    correlations: tuple[tuple[str, str, float], ...]
    findings: tuple[str, ...]


def fit(records: Sequence[FlightRecord], vehicle: Vehicle, names: Iterable[str],
        on_progress: Callable[[float], None] = lambda share: None) -> Fit:
    """
    Return the Fit of the named parameters of a vehicle to flight records.

    Args: names of vehicle constants, effects or parameters of effects (see free.py), or a single
    one; on_progress is called with the share that is done. What the flights leave undetermined is
    held at the vehicle file's value, and said. Raises InputError, also for what scales thrust over
    mass where commands were scaled by the weight (thrust_level): it would come out as the file has
    it; and for effects of the motors where measured rotor speeds take the place of commands.
    """
    records = flight_records('records', records)
    vehicle_given(vehicle)
    free = columns_of_names([names] if isinstance(names, str) else names, vehicle)
    refuse_twice(records)
    _refuse_level(records, free)
    _refuse_motors(records, free)
    records = [with_motion(record) for record in records]
    for record in records:
        if is_inertial(record):
            name = record.info.get('source') or record.info.get('name', 'a flight')
            raise InputError(f'{name}: it has neither position nor velocity, which a fit needs; '
                             'diagnose takes flights of accelerometer, gyro and commands alone')
    records = on_one_level([with_position(record) for record in records])
    voltage = highest_voltage(records)
    start, sizes = nominal(vehicle), limits(vehicle)[2]
    records, _, answers = zip(*on_one_clock(records), strict=True)
    flights = near_flights([track_of(record, vehicle, voltage, clock) for record, clock in
                            zip(records, clocks_of(answers), strict=True)], vehicle, start)
    flights = [replace(flight, name=name) for flight, name in
               zip(flights, _apart([flight.name for flight in flights]), strict=True)]
    on_progress(READ)
    found = estimate(flights, vehicle, start, list(free.values()))
    on_progress(FITTED)
    inside = [name for name, moves in zip(free, found.free, strict=True) if moves]
    columns = [free[name] for name in inside]
    undetermined = freedoms(_inside(found.normal, found.free).information, found.at[columns],
                            sizes[columns], [inside.index('mass')] if 'mass' in inside else [])
    if undetermined:
        held = [columns[freedom.held] for freedom in undetermined]
        z = found.z.copy()
        for freedom in undetermined:
            if freedom.scale:
                members = [columns[k] for k in freedom.members]
                z[members] *= start[columns[freedom.held]] / z[columns[freedom.held]]
        z[held] = start[held]
        rest = [place for place in free.values() if place not in held]
        found = estimate(flights, vehicle, z, rest, noise=found.noise, starts=found.starts)
    given: dict[str, dict[str, float]] = {name: {} for name in inside}
    for freedom in undetermined:
        for k in freedom.members:
            given[inside[k]][inside[freedom.held]] = float(start[columns[freedom.held]])
    covariance = np.zeros((len(found.columns),) * 2)
    covariance[np.ix_(found.free, found.free)] = covariance_of(
        _inside(found.normal, found.free), sizes[found.columns][found.free])
    errors = dict(zip(found.columns, np.sqrt(np.diag(covariance)), strict=True))
    parameters = tuple(_parameter(name, start[place], found.z[place], errors.get(place), given)
                       for name, place in free.items())
    order = tuple(name for name, place in free.items() if place in errors)
    pairs = tuple((order[i], order[j], share) for i, j, share in correlated(covariance, STRONG))
    on_progress(1.0)
    findings = (*(f'{flight.name}: {NO_COMMANDS.message}; {NO_COMMANDS.remedy}'
                  for flight, record in zip(flights, records, strict=True)
                  if is_driven_by_speeds(record)),
                *(_said(freedom, inside, start[columns]) for freedom in undetermined),
                *_findings(found, parameters, pairs, flights))
    found = replace(found, covariance=covariance)
    return Fit(vehicle, tuple(flight.name for flight in flights), parameters, found, order,
               known_together(found, flights, vehicle), pairs, findings)


def _refuse_level(records: Iterable[FlightRecord], free: Iterable[str]) -> None:
    """Raise InputError where the scale of commands to be estimated follows from the weight."""
    scales = [name for name in free if name in OF_LEVEL]
    for record in records:
        if scales and FULL_SPEED in record.info:
            where = record.info.get('source') or record.info.get('name', 'the flight record')
            raise InputError(
                f'{where}: the rotor speed at full signal is not known, and commands were scaled '
                f'by the weight of the vehicle file, so no flight determines {", ".join(scales)}; '
                'leave that out of --free, or give the vehicle file speed_max (rad/s) or motors: '
                'with a gain')


def _refuse_motors(records: Iterable[FlightRecord], free: Iterable[str]) -> None:
    """Raise InputError where parameters of motors are asked for and there are no commands."""
    asked = [name for name in free if name.partition('.')[0] in OF_MOTORS]
    for record in records:
        if asked and is_driven_by_speeds(record):
            where = record.info.get('source') or record.info.get('name', 'the flight record')
            raise InputError(f'{where}: {NO_COMMANDS.message}; leave {", ".join(asked)} out of '
                             '--free, or give flights with commands')


def _apart(names: Sequence[str]) -> list[str]:
    """Return names of flights that differ: a second flight_1 is flight_1 (2)."""
    return [name if name not in names[:k] else f'{name} ({names[:k].count(name) + 1})'
            for k, name in enumerate(names)]


def fitted_vehicle(fit: Fit) -> Vehicle:
    """
    Return the vehicle with the estimates and their covariance; what is undetermined as given.

    The deviation that the file states of a constant that was fitted belongs to the file's value,
    and is left out; so is a covariance that the file has.
    """
    z = fit.estimate.z

    def triple(key: str) -> tuple[float, ...]:
        return tuple(float(z[INDEX[f'{key}_{axis}']]) for axis in 'xyz')

    return replace(fit.vehicle, uncertainty=_uncertainty(fit), covariance=fit.together,
                   effects=mapping(z[SPLIT:]),
                   mass=float(z[INDEX['mass']]),
                   thrust_coefficient=float(z[INDEX['thrust_coefficient']]),
                   torque_coefficient=float(z[INDEX['torque_coefficient']]),
                   inertia=triple('inertia'), linear_drag=triple('linear_drag'),
                   rotational_drag=triple('rotational_drag'))


def _uncertainty(fit: Fit) -> dict[str, Uncertainty]:
    """Return the deviations that the file states of what was not fitted."""
    fitted, kept = {parameter.name for parameter in fit.parameters
                    if parameter.status != 'undetermined'}, {}
    for key, std in fit.vehicle.uncertainty.items():
        if isinstance(std, tuple):
            std = tuple(None if f'{key}_{axis}' in fitted else one
                        for axis, one in zip('xyz', std, strict=True))
        if key not in fitted and std != (None, None, None):
            kept[key] = std
    return kept


def as_data(fit: Fit) -> dict[str, Any]:
    """Return a Fit as data for JSON."""
    found = fit.estimate
    return {
        'schema': SCHEMA, 'version': __version__, 'vehicle': fit.vehicle.name,
        'flights': list(fit.flights),
        'parameters': {parameter.name: {key: value for key, value in asdict(parameter).items()
                                        if key != 'name'} for parameter in fit.parameters},
        'covariance': {'names': list(fit.names), 'matrix': found.covariance.tolist()},
        'correlations': [{'parameters': [a, b], 'value': share}
                         for a, b, share in fit.correlations],
        'noise': {name: {group: {'std': noise[part].tolist(), 'unit': UNITS[group]}
                         for group, part in GROUPS.items()}
                  for name, noise in zip(fit.flights, found.noise, strict=True)},
        'cost': found.cost, 'samples': sum(raw.shape[0] * raw.shape[1]
                                           for raw in found.residuals),
        'converged': found.converged, 'findings': list(fit.findings)}


def _inside(normal: Normal, free: np.ndarray) -> Normal:
    """Return the information on the columns inside their bounds, the others held."""
    return replace(normal, information=normal.information[np.ix_(free, free)],
                   gradient=normal.gradient[free], scores=normal.scores[:, free])


def _parameter(name: str, start: float, value: float, error: float | None,
               given: dict[str, dict[str, float]]) -> Parameter:
    """Return the Parameter; error: its standard error, 0 at a bound, None where it is held."""
    told = given.get(name, {})
    status = 'undetermined' if told else 'determined' if error else 'bound'
    return Parameter(name, unit_of(name), float(start), None if name in told else float(value),
                     float(error) if error else None, status,
                     {other: at for other, at in told.items() if other != name})


def _said(freedom: Freedom, names: Sequence[str], values: np.ndarray) -> str:
    """Return what a Freedom means, in words."""
    members = [titled(names[k]) for k in freedom.members]
    held = names[freedom.held]
    value = _with_unit(values[freedom.held], held)
    if freedom.scale:
        return (f'{", ".join(members)} are undetermined: multiplied by one factor they give the '
                f'same motion, so the flights determine only their ratios. Leave {held} out of '
                f'--free if it is known; the values hold if {titled(held)} is {value}')
    if len(members) == 1:
        return (f'{titled(held)} is undetermined: the flights do not show it. Fly: '
                f'{excitation_of(held)}; until then it stays at {value}')
    wanted = '; '.join(dict.fromkeys(excitation_of(names[k]) for k in freedom.members))
    return (f'{", ".join(members)} are undetermined: the flights do not determine them '
            f'separately. Leave one out of --free, or fly: {wanted}; the values hold if '
            f'{titled(held)} is {value}')


def _findings(found: Estimate, parameters: Iterable[Parameter],
              pairs: Sequence[tuple[str, str, float]], flights: Iterable[Flight]) -> list[str]:
    """Return what is to be known of the estimate besides what it leaves undetermined."""
    said = []
    if not found.converged:
        said.append('the fit did not converge: the values are not the best ones; start from a '
                    'vehicle file that is closer to the truth, or free fewer parameters')
    for parameter in parameters:
        if parameter.status == 'bound' and parameter.value is not None:
            why = 'the best value lies beyond it' if parameter.value else 'it is not there'
            said.append(f'{titled(parameter.name)} ends at its bound, '
                        f'{_with_unit(parameter.value, parameter.name)}: {why}, or it stands in '
                        'for something that is not in the model')
    if pairs:
        names = ', '.join(f'{titled(a)} and {titled(b)} ({share:.3f})' for a, b, share in pairs)
        said.append(f'correlated by more than {STRONG:g}, so a combination of them is known '
                    f'better than each one: {names}')
    widest = float(np.sqrt(scatter_of(found.normal).max(initial=1.0)))
    if widest > 1.0:
        said.append('the residuals are autocorrelated: standard errors are widened, up to '
                    f'{widest:.1f} times')
    for flight, noise, raw in zip(flights, found.noise, found.residuals, strict=True):
        ratio = noise / quick_noise(raw)
        worst = {group: float(ratio[part].max()) for group, part in GROUPS.items()}
        coloured = [f'{group} {times:.1f} times' for group, times in worst.items()
                    if times > COLOURED]
        if coloured:
            said.append(f'{flight.name}: the residuals are larger than the noise from sample to '
                        f'sample ({", ".join(coloured)}): the noise is not white, or an effect is '
                        'missing from the model')
    return said


def _with_unit(value: float, name: str) -> str:
    unit = unit_of(name)
    return f'{value:g}' if unit == '1' else f'{value:g} {unit}'
