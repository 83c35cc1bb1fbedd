# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A reality in rotorpy with hidden effects, the user's simulator in MuJoCo: the gap closes."""

from pathlib import Path

import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.model.dynamics import STATES
from quad_ident_ros.user_simulator.simulator import Simulator
from quad_ident_ros.vehicle_files.load import load_any_vehicle

FOLDER = Path(__file__).resolve().parents[3] / 'docs' / 'simulators'
STEP = 0.01     # s
DEVIATION = np.repeat([7e-4, 7e-3, 1.4e-3, 7e-3], 3)
SHARE = 0.95    # of what is promised


def flown(hidden, seed, a, b):
    """Return the record of a flight of rotorpy's multirotor under rotorpy's controller."""
    from rotorpy.controllers.quadrotor_control import SE3Control
    from rotorpy.trajectories.lissajous_traj import TwoDLissajous
    from rotorpy.vehicles.hummingbird_params import quad_params
    from rotorpy.vehicles.multirotor import Multirotor
    places = {name: np.sign(place) * [0.12, 0.12, 0.0]
              for name, place in quad_params['rotor_pos'].items()}
    bare = quad_params | dict.fromkeys(('c_Dx', 'c_Dy', 'c_Dz', 'k_d', 'k_z', 'k_h', 'k_flap'),
                                       0.0) | {'rotor_pos': places}
    reality, draw = Multirotor(bare | hidden), np.random.default_rng(seed)
    control, path = SE3Control(bare), TwoDLissajous(1.0, 0.8, a, b, height=2.0)
    aim = path.update(0.0)
    hover = np.sqrt(bare['mass'] * 9.81 / (4 * bare['k_eta']))
    now = {'x': aim['x'].astype(float), 'v': aim['x_dot'], 'q': np.array([0.0, 0.0, 0.0, 1.0]),
           'w': np.zeros(3), 'wind': np.zeros(3), 'rotor_speeds': np.full(4, hover)}
    states, commands = [], []
    for k in range(1200):
        given = control.update(k * STEP, now, path.update(k * STEP))['cmd_motor_speeds']
        states.append(np.concatenate([now['x'], now['v'], now['q'][[3, 0, 1, 2]], now['w']]))
        commands.append(np.clip(given, 0.0, bare['rotor_speed_max']))
        now = reality.step(now, {'cmd_motor_speeds': commands[-1]}, STEP)
    noise = DEVIATION * draw.standard_normal((len(states), 12))
    states = np.array(states)
    turn = np.concatenate([np.ones((len(states), 1)), 0.5 * noise[:, 6:9]], axis=1)
    w, v = states[:, 6:7].copy(), states[:, 7:10].copy()
    states[:, 6:7] = w * turn[:, :1] - np.sum(v * turn[:, 1:], axis=1, keepdims=True)
    states[:, 7:10] = w * turn[:, 1:] + v * turn[:, :1] + np.cross(v, turn[:, 1:])
    states[:, [0, 1, 2, 3, 4, 5, 10, 11, 12]] += np.delete(noise, [6, 7, 8], axis=1)
    columns = dict(zip(STATES, states.T, strict=True))
    columns |= {f'cmd{j}': column for j, column in enumerate(np.array(commands).T, 1)}
    return FlightRecord(np.arange(len(states)) * STEP, columns, {'name': f'flight_{seed}'})


@pytest.mark.slow
@pytest.mark.parametrize('hidden', [
    {'k_d': 1.2e-4, 'mass': 0.53}, {'tau_m': 0.04, 'c_Dx': 0.08, 'c_Dy': 0.08, 'c_Dz': 0.08},
    {'k_eta': 5.2e-6, 'tau_m': 0.03, 'k_d': 8e-5}])
def test_the_gap_in_mujoco_falls_by_the_share_that_is_promised(hidden):
    pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    pytest.importorskip('rotorpy.vehicles.multirotor', reason='rotorpy is not installed')
    vehicle = load_any_vehicle(FOLDER / 'quadrotor.xml')
    # Both have the constants of the Hummingbird; a speed stands for a thrust in MuJoCo's file.
    factor = np.sqrt(5.57e-6 / vehicle.thrust_coefficient)
    records = []
    for seed, (a, b) in enumerate([(1.5, 1.0), (1.0, 2.0), (1.3, 1.7)]):
        record = flown({'tau_m': 1e-3} | hidden, seed, a, b)
        columns = {name: factor * values if name.startswith('cmd') else values
                   for name, values in record.columns.items()}
        records.append(FlightRecord(record.t, columns, record.info))
    with Simulator(f'{FOLDER}/mujoco_quadrotor.py:Quadrotor', vehicle) as simulator:
        found = diagnose(records, vehicle, simulator=simulator)
    assert found.verdict != ('none',) and found.gap.closed > 0.5
    assert found.in_simulator.closed >= SHARE * found.gap.closed
