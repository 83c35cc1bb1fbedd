# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What an effect is: a cause with a name, and the forms (laws) in which it may act."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from quad_ident_ros.model.vehicle import Vehicle

Table = NDArray[np.float64]
"""Rows of what model.situation names, one column per lane."""

Hook = Callable[..., None]
Axis = Literal['roll', 'pitch', 'yaw', 'vertical', 'horizontal']
"""Axes of motion as data.quality.excitation names them."""


@dataclass(frozen=True)
class Parameter:
    """
    A number of a form: its unit, the value at which there is no effect, bounds, usual size.

    Bounds and size (what the parameter is usually about) are in units of the vehicle's own scale
    where the unit has mass or length in it, so that they hold for 30 g and for 3 kg: see scale.
    excited_by: the axis without whose motion no flight shows it, or None. A parameter that only
    shapes a form (a length, an exponent) has no effect while the form's strength is null. gain:
    the power of it by which the answer to commands about the axis of excited_by grows. beside:
    the vector of the vehicle file and the axis that it adds to: their sum is not negative. later:
    how many s later, for each unit of it, the vehicle answers commands that change evenly.
    identified: how far from none, or from what the vehicle file has, flights can show it to be: a
    simulation may have more.
    """

    name: str
    unit: str
    lower: float
    upper: float
    size: float
    description: str
    null: float = 0.0
    excited_by: Axis | None = None
    gain: Literal[-1, 0, 1] = 0
    beside: tuple[Literal['linear_drag'], int] | None = None
    later: float = 0.0
    identified: float = np.inf

    def scale(self, vehicle: Vehicle) -> float:
        """Return the vehicle's own measure of this parameter's unit: its mass, arm or inertia."""
        mass, arm = vehicle.mass, vehicle.arm_length
        weight = mass * vehicle.gravity
        scales: dict[str, float] = {
            'kg': mass, 'kg/s': mass, 'kg/m': mass, 'kg m/s': mass * arm, 'm': arm,
            'kg m^2/s': mass * arm ** 2,
            'kg m^2': vehicle.inertia[0], 's^2/rad': 1.0 / vehicle.hover_speed,
            'N': weight, 'N m': weight * arm}
        return scales.get(self.unit, 1.0)

    def bounds(self, vehicle: Vehicle) -> tuple[float, float, float]:
        """Return the lower and the upper bound and the usual size for a vehicle, SI."""
        scale = self.scale(vehicle)
        given = getattr(vehicle, self.beside[0])[self.beside[1]] if self.beside else 0.0
        return self.lower * scale - given, self.upper * scale, self.size * scale

    def fit_bounds(self, vehicle: Vehicle, given: float) -> tuple[float, float]:
        """Return bounds of what is identified for a vehicle whose file has a given value, SI."""
        (lower, upper, _), most = self.bounds(vehicle), self.identified * self.scale(vehicle)
        return (max(lower, min(self.null, given) - most),
                min(upper, max(self.null, given) + most))


@dataclass(frozen=True)
class Form:
    """
    A law of an effect.

    parameters: of Parameter; source: where the formula stands. What it changes, each a function
    or None (rows of the tables: model.situation; p (P, LANES) has its parameters from row k on):
    body(p, k, s): mass, inertia, centre of mass, before the flight; air(p, k, s): the wind;
    gust(p, k, s, rotors): the wind at a time of the flight;
    thrust(p, k, s, rotors): factors on the rotors' thrust and reaction torque;
    wrench(p, k, s, rotors): forces of the rotors, forces and moments on the body. actuator:
    'delay' or 'lag', where its parameters are those of the actuators; sensor: 'attitude' or 'rate'
    or 'block' (both) or 'heading', where they are those of a sensor; on_rotors: it acts on
    rotors, so that a vehicle flown from U1..U4 needs some; needs_voltage: it acts only where the
    voltage is recorded; without_voltage: it says something only where none is;
    apart: parameters that do what another effect does, each of them a term that errs by itself,
    for how wrong a law may be is no matter of names; needs_reference: it shows only against a
    position, a velocity or an attitude, not in accelerometer and gyro alone; needs_height: it
    shows only where the height was measured; like_feedback: it does what a controller makes of
    commands that differ from the logged ones; same_motion, separated_by: as of
    Effect, of this form.
    """

    name: str
    title: str
    parameters: tuple[Parameter, ...]
    source: str
    body: Hook | None = field(default=None, repr=False)
    air: Hook | None = field(default=None, repr=False)
    gust: Hook | None = field(default=None, repr=False)
    thrust: Hook | None = field(default=None, repr=False)
    wrench: Hook | None = field(default=None, repr=False)
    actuator: Literal['delay', 'lag'] | None = None
    sensor: Literal['attitude', 'rate', 'block', 'heading'] | None = None
    on_rotors: bool = True
    needs_voltage: bool = False
    without_voltage: bool = False
    apart: tuple[str, ...] = ()
    needs_reference: bool = False
    needs_height: bool = False
    like_feedback: bool = False
    same_motion: tuple[tuple[str, str], ...] = ()
    separated_by: str = ''


@dataclass(frozen=True)
class Effect:
    """
    Something that reality has and the nominal model does not, in one of several forms.

    forms: of Form, the first the usual one; excitation: what a flight must do to show it;
    confused_with: names of effects that look alike; per_rotor: each parameter of a form belongs to
    one rotor, and one at a time is off; scale_group: one of those that scale the whole motion, of
    which only ratios show without a force sensor; ratio: the quotient that shows, of two effects
    with one of it only one is named; per_flight: how much each of its usual form's parameters
    usually differs from one flight to the next, empty where none does; needs_air: it is felt only
    by what depends on the velocity of the air; same_motion: pairs of constants that move a vehicle
    alike, for all of which it stands; separated_by: what measurement distinguishes them.
    """

    name: str
    title: str
    forms: tuple[Form, ...]
    excitation: str
    confused_with: tuple[str, ...] = ()
    per_rotor: bool = False
    scale_group: bool = False
    per_flight: tuple[float, ...] = ()
    needs_air: bool = False
    same_motion: tuple[tuple[str, str], ...] = ()
    separated_by: str = ''
    ratio: str | None = None

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters of all forms; their names differ."""
        return tuple(parameter for form in self.forms for parameter in form.parameters)

    def parameters_of(self, form: Form, rotor_count: int) -> tuple[Parameter, ...]:
        """Return the parameters of one of its forms that a vehicle with so many rotors has."""
        return form.parameters[:rotor_count] if self.per_rotor else form.parameters

    def parameters_for(self, rotor_count: int) -> tuple[Parameter, ...]:
        """Return the parameters of all its forms that such a vehicle has."""
        return tuple(parameter for form in self.forms
                     for parameter in self.parameters_of(form, rotor_count))

    @property
    def actuator(self) -> Literal['delay', 'lag'] | None:
        """Return what of the actuators it is, in whichever form."""
        return self.forms[0].actuator
