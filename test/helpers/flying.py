# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles and effects that the tests of closed-loop flights share."""

from dataclasses import replace

from quad_ident_ros import resources
from quad_ident_ros.effects.registry import bounds, EFFECTS, SLICES
from quad_ident_ros.model.vehicle import load_vehicle, Rotor

PAPER = load_vehicle('paper_quadrotor')


def _x_frame(arm):
    side = arm / 2 ** 0.5
    return tuple(Rotor((x * side, y * side, 0.0), spin)
                 for x, y, spin in ((1, -1, -1), (-1, -1, 1), (-1, 1, -1), (1, 1, 1)))


SMALL = replace(PAPER, name='small', mass=0.03, inertia=(1.5e-5, 1.5e-5, 2.7e-5),
                thrust_coefficient=2.5e-8, torque_coefficient=1.5e-10, rotor_radius=0.023,
                linear_drag=(0.0, 0.0, 0.0), rotational_drag=(0.0, 0.0, 0.0), speed_max=2500.0,
                rotors=_x_frame(0.045))
LARGE = replace(PAPER, name='large', mass=3.0, inertia=(0.06, 0.06, 0.11),
                thrust_coefficient=3e-5, torque_coefficient=6e-7, rotor_radius=0.18,
                speed_max=900.0, rotors=_x_frame(0.35))
VEHICLES = {vehicle.name: vehicle for vehicle in (
    SMALL, LARGE, *map(load_vehicle, resources.names('vehicles')))}


def usual(name, vehicle):
    """Return {effect: {parameter: value}} of an effect at its usual size; of one rotor alone."""
    sizes = bounds(vehicle)[2][SLICES[name]]
    known = zip(EFFECTS[name].forms[0].parameters, sizes, strict=True)
    values = {parameter.name: parameter.null + size for parameter, size in known}
    if EFFECTS[name].per_rotor:
        values = dict([next(iter(values.items()))])
    return {name: values}


EVERYTHING = {name: values for effect in EFFECTS
              for name, values in usual(effect, PAPER).items()}
