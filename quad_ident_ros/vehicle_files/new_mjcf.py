# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""New MJCF models of MuJoCo, whose controls are the thrusts of the rotors."""

import math
from xml.sax.saxutils import quoteattr

import numpy as np

from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.bodies import Body, nearest_body
from quad_ident_ros.vehicle_files.edits import shown
from quad_ident_ros.vehicle_files.out_body import MOMENTS, PRODUCTS
from quad_ident_ros.vehicle_files.reading import FULL_SPEED

MODEL = """<mujoco model={name}>
  <option integrator="RK4" timestep="0.002" gravity="0 0 {gravity}"/>
  <worldbody>
    <light pos="0 0 10"/>
    <body name={name}>
      <freejoint/>
      <inertial pos="0 0 0" mass="{mass}" {inertia}/>
      <geom type="box" size="{size}" mass="0" contype="0" conaffinity="0"/>
      {sites}
    </body>
  </worldbody>
  <actuator>
    {actuators}
  </actuator>
</mujoco>
"""


def new(vehicle: Vehicle) -> str:
    """
    Return the text of a new MJCF model with the constants of a vehicle.

    Its controls are the signals of the vehicle file where they are thrusts, else thrusts in N.
    """
    per, low, high = _controls(vehicle)
    ratio = vehicle.torque_coefficient / vehicle.thrust_coefficient
    limits = '' if math.isinf(high) else (f' ctrllimited="true" '
                                          f'ctrlrange="{shown([low, high])}"')
    arm = vehicle.arm_length
    inertia = nearest_body(Body(vehicle.mass, np.zeros(3), vehicle.inertia_matrix)).inertia
    six = [float(inertia[at]) for at in (*MOMENTS, *PRODUCTS)]
    return MODEL.format(
        name=quoteattr(vehicle.name), gravity=shown([-vehicle.gravity]),
        mass=shown([vehicle.mass]), size=shown([0.3 * arm, 0.3 * arm, 0.1 * arm]),
        inertia=(f'fullinertia="{shown(six)}"' if any(six[3:])
                 else f'diaginertia="{shown(six[:3])}"'),
        sites='\n      '.join(f'<site name="rotor{j}" pos="{shown(rotor.position)}"/>'
                              for j, rotor in enumerate(vehicle.rotors, 1)),
        actuators='\n    '.join(
            f'<general name="rotor{j}" site="rotor{j}" '
            f'gear="0 0 {shown([per, 0.0, 0.0, rotor.spin * ratio * per])}"{limits}/>'
            for j, rotor in enumerate(vehicle.rotors, 1)))


def _controls(vehicle: Vehicle) -> tuple[float, float, float]:
    """Return the thrust per control, N, the least and the most control."""
    motors, constant = vehicle.motors, vehicle.thrust_coefficient
    if (motors is not None and motors.gives == 'thrust' and vehicle.speed_max == FULL_SPEED
            and motors.gain is not None and motors.exponent == 1.0
            and math.isclose(motors.offset * motors.maximum,
                             (motors.offset + motors.gain) * motors.minimum)):
        return constant * FULL_SPEED ** 2 / motors.maximum, motors.minimum, motors.maximum
    return 1.0, constant * vehicle.speed_min ** 2, constant * vehicle.speed_max ** 2
