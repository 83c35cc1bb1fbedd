# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""New files with a dictionary of rotorpy."""

from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.edits import shown
from quad_ident_ros.vehicle_files.reading import most_speed

LEAST_LAG = 0.001   # s of motors that have none: rotorpy divides by it, and steps by 0.01 s
FILE = '''"""Parameters of {name} for rotorpy."""
import numpy as np

quad_params = {{

    # Mass and inertia about the centre of mass
    'mass': {mass},    # kg
    'Ixx': {xx},    # kg m^2
    'Iyy': {yy},
    'Izz': {zz},
    'Ixy': {xy},
    'Ixz': {xz},
    'Iyz': {yz},

    # Rotors, from the centre of mass
    'num_rotors': {count},
    'rotor_radius': {radius},    # m
    'rotor_pos': {{    # m
{places}
    }},
    'rotor_directions': np.array([{spins}]),    # signs of the reaction torques about z
    'rI': np.array([0, 0, 0]),    # place of the IMU, m

    # Drag of the body per square of the velocity of the air
    'c_Dx': 0,    # kg/m
    'c_Dy': 0,
    'c_Dz': 0,

    # Rotors: thrust and torque, and what they lose and gain with the velocity of the air
    'k_eta': {thrust},    # N/(rad/s)^2
    'k_m': {torque},    # N m/(rad/s)^2
    'k_d': 0,    # kg/rad
    'k_z': 0,    # kg/rad
    'k_h': 0,    # kg/m
    'k_flap': 0,    # kg m/rad

    # Motors
    'tau_m': {lag},    # s
    'rotor_speed_min': {least},    # rad/s
    'rotor_speed_max': {most},
    'motor_noise_std': 0,
}}
'''


def new(vehicle: Vehicle) -> str:
    """Return the text of a new file with the constants of a vehicle."""
    names = ('mass', 'xx', 'yy', 'zz', 'xy', 'xz', 'yz', 'radius', 'thrust', 'torque', 'lag',
             'least', 'most')
    values = (vehicle.mass, *vehicle.inertia, *vehicle.products, vehicle.rotor_radius,
              vehicle.thrust_coefficient, vehicle.torque_coefficient, LEAST_LAG,
              vehicle.speed_min, most_speed(vehicle))
    places = '\n'.join(
        f"        'r{j}': np.array([{', '.join(shown([at]) for at in rotor.position)}]),"
        for j, rotor in enumerate(vehicle.rotors, 1))
    return FILE.format(
        name=vehicle.name.replace('\\', '').replace('"', ''), count=len(vehicle.rotors),
        places=places, spins=', '.join(str(rotor.spin) for rotor in vehicle.rotors),
        **{name: shown([value]) for name, value in zip(names, values, strict=True)})
