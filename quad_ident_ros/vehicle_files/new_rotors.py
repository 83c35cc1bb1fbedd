# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bodies and motors of a new file for Gazebo: rotors turn on a base, each with its plugin."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.effects.rotor_gyro_by_spin import inertias
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.bodies import Body, is_body, nearest_body
from quad_ident_ros.vehicle_files.edits import shown
from quad_ident_ros.vehicle_files.gz_motors import TURNS
from quad_ident_ros.vehicle_files.out_body import remainder
from quad_ident_ros.vehicle_files.reading import most_speed

SLOWDOWNS = 10.0, 1.0   # of the rotors' joints: what Gazebo's models have, and none
# Gazebo takes no body without mass and inertia: of those of the whole vehicle, what nobody feels.
ROTOR_MASS = 1e-6
ROTOR_INERTIA = 1e-6
# Of a disc half of its inertia about its axis is about each other, and no body has less.
ACROSS = 0.51
PLUGIN = """<plugin filename="gz-sim-multicopter-motor-model-system"
        name="gz::sim::systems::MulticopterMotorModel">
  <robotNamespace>{name}</robotNamespace>
  <jointName>rotor_{number}_joint</jointName>
  <linkName>rotor_{number}</linkName>
  <turningDirection>{turn}</turningDirection>
  <timeConstantUp>0</timeConstantUp>
  <timeConstantDown>0</timeConstantDown>
  <maxRotVelocity>{most}</maxRotVelocity>
  <motorConstant>{constant}</motorConstant>
  <momentConstant>{ratio}</momentConstant>
  <commandSubTopic>command/motor_speed</commandSubTopic>
  <motorNumber>{number}</motorNumber>
  <rotorDragCoefficient>0</rotorDragCoefficient>
  <rollingMomentCoefficient>0</rollingMomentCoefficient>
  <rotorVelocitySlowdownSim>{slow}</rotorVelocitySlowdownSim>
  <motorType>velocity</motorType>
</plugin>"""


@dataclass(frozen=True)
class Layout:
    """
    A vehicle as a base and rotors.

    base: the Body that with the rotors makes the vehicle; mass kg of a rotor, and inertias (3,)
    kg m^2 of each in its axes; slow: how much slower its joint turns than the rotor.
    """

    base: Body
    mass: float
    inertias: tuple[tuple[float, float, float], ...]
    slow: float


def rotor_inertias(vehicle: Vehicle) -> tuple[float, ...]:
    """Return the moment of inertia of each rotor about its axis that acts, or is known, kg m^2."""
    acts = vehicle.effects.get('rotor_gyro') or {'rotor_inertia': vehicle.rotor_inertia}
    apart = inertias(acts)
    return tuple(acts.get('rotor_inertia', 0.0) + apart[rotor.spin] for rotor in vehicle.rotors)


def layout(vehicle: Vehicle) -> Layout:
    """Return the Layout of a vehicle without its effects, but for the inertia of its rotors."""
    spun = [inertia or ROTOR_INERTIA * max(vehicle.inertia)
            for inertia in rotor_inertias(vehicle)]
    whole = nearest_body(Body(vehicle.mass, np.zeros(3), vehicle.inertia_matrix))
    mass = ROTOR_MASS * vehicle.mass
    for slow in SLOWDOWNS:
        moments = tuple((ACROSS * slow * one, ACROSS * slow * one, slow * one)
                        for one in spun)
        base = remainder(whole, [Body(mass, np.array(rotor.position), np.diag(each))
                                 for rotor, each in zip(vehicle.rotors, moments, strict=True)])
        if is_body(base):
            break
    return Layout(nearest_body(base), mass, moments, slow)


def plugin(vehicle: Vehicle, rotor: int, slow: float, name: str) -> str:
    """Return the motor plugin of a rotor, which counts from 0; name: of the model, escaped."""
    turn = next(turn for turn, spin in TURNS.items() if spin == vehicle.rotors[rotor].spin)
    most, constant, ratio = (shown([value]) for value in (
        most_speed(vehicle), vehicle.thrust_coefficient,
        vehicle.torque_coefficient / vehicle.thrust_coefficient))
    return PLUGIN.format(name=name, number=rotor, turn=turn, most=most, constant=constant,
                         ratio=ratio, slow=shown([slow]))
