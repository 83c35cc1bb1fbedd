# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Fly two vehicles of rotorpy for a second, for test/unit/docs/test_rotorpy.py to compare with.

Writes a flight record and a vehicle file of each beside itself. In an environment of its own:

    python -m venv .venv-rotorpy && .venv-rotorpy/bin/pip install rotorpy==3.0.0
    .venv-rotorpy/bin/python test/data/rotorpy/make.py
"""

import math
from pathlib import Path

import numpy as np
from rotorpy.vehicles.crazyflie_params import quad_params as crazyflie
from rotorpy.vehicles.hummingbird_params import quad_params as hummingbird
from rotorpy.vehicles.multirotor import Multirotor

HERE = Path(__file__).parent
GRAVITY = 9.81      # that of rotorpy
PERIOD, SECONDS = 0.02, 1.0
WIND = np.array([2.0, -1.0, 0.5])

# What rotorpy's files leave at zero, of a size that shows.
ADDED = {'crazyflie': {'c_Dx': 2e-3, 'c_Dy': 2e-3, 'c_Dz': 3e-3, 'k_h': 1e-4, 'k_flap': 2e-8},
         'hummingbird': {'k_flap': 4e-6}}


def hover_sum(params):
    """Return the sum of the speeds at which the rotors carry the vehicle, rad/s."""
    count = params['num_rotors']
    return count * math.sqrt(params['mass'] * GRAVITY / (count * params['k_eta']))


def vehicle_file(name, params):
    """Return the vehicle file that says what rotorpy's parameters say."""
    hover, count = hover_sum(params), params['num_rotors']
    effects = {
        'motor_lag': {'time_constant': params['tau_m']},
        'rotor_drag': {'coefficient': params['k_d'] * hover},
        'body_drag': {'horizontal': params['c_Dx'], 'vertical': params['c_Dz']},
        'wind': dict(zip('xyz', WIND.tolist(), strict=True)),
        'inflow': {'axial': params['k_z'] * hover, 'translational': params['k_h'] * count},
        'blade_flapping': {'coefficient': params['k_flap'] * hover}}
    places = [place.tolist() for place in params['rotor_pos'].values()]
    lines = [f'# Made by make.py from rotorpy, and with {ADDED[name]}.',
             f'name: rotorpy_{name}', f'mass: {params["mass"]}',
             f'inertia: {[float(params[key]) for key in ("Ixx", "Iyy", "Izz")]}',
             f'gravity: {GRAVITY}', f'thrust_coefficient: {params["k_eta"]}',
             f'torque_coefficient: {params["k_m"]}', 'rotors:']
    lines += [f'- {{position: {place}, spin: {spin}}}'
              for place, spin in zip(places, params['rotor_directions'].tolist(), strict=True)]
    lines += ['effects:'] + [f'  {effect}: {values}' for effect, values in effects.items()]
    return '\n'.join(lines).replace("'", '') + '\n'


def fly(params, seed):
    """Return the rows of a flight: t, state, commands and speeds of the rotors."""
    vehicle = Multirotor(params, integrator_kwargs={'method': 'DOP853', 'rtol': 1e-11,
                                                    'atol': 1e-13})
    random = np.random.default_rng(seed)
    count = round(SECONDS / PERIOD) + 1
    changes = np.repeat(random.uniform(0.93, 1.07, (count // 5 + 1, 4)), 5, axis=0)[:count]
    commands = hover_sum(params) / 4 * changes
    state = {'x': np.array([0.0, 0.0, 5.0]), 'v': np.array([3.0, 2.0, -1.0]),
             'q': np.array([0.1, -0.05, 0.2, math.sqrt(1 - 0.0525)]),
             'w': np.array([0.5, -0.8, 0.3]), 'wind': WIND, 'rotor_speeds': commands[0]}
    rows = []
    for k, command in enumerate(commands):
        a, b, c, w = state['q']
        rows.append([k * PERIOD, *state['x'], *state['v'], w, a, b, c, *state['w'], *command,
                     *state['rotor_speeds']])
        state = {**vehicle.step(state, {'cmd_motor_speeds': command}, PERIOD), 'wind': WIND}
    return rows


def main():
    """Write what is beside this file."""
    head = ['t', 'px', 'py', 'pz', 'vx', 'vy', 'vz', 'qw', 'qx', 'qy', 'qz', 'wx', 'wy', 'wz',
            *(f'cmd{j}' for j in range(1, 5)), *(f'rotor{j}' for j in range(1, 5))]
    for seed, (name, params) in enumerate((('crazyflie', crazyflie),
                                           ('hummingbird', hummingbird))):
        params = {**params, **ADDED[name]}
        (HERE / f'{name}.yaml').write_text(vehicle_file(name, params))
        np.savetxt(HERE / f'{name}.csv', fly(params, seed), fmt='%.12g', delimiter=',',
                   header=','.join(head), comments='')


if __name__ == '__main__':
    main()
