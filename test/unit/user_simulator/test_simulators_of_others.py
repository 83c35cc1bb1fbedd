# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The examples of docs/simulators: what is read of a simulator's file flies there as in ours."""

import importlib
import os
from pathlib import Path
import sys

import numpy as np
import pytest

from quad_ident_ros.diagnose.gap import ends, gap
from quad_ident_ros.effects.registry import mapping, vector
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.flights import track_of
from quad_ident_ros.greybox.parameters import nominal, SPLIT
from quad_ident_ros.user_simulator.simulator import Simulator
from quad_ident_ros.vehicle_files.load import load_any_vehicle

FOLDER = Path(__file__).resolve().parents[3] / 'docs' / 'simulators'
WITHIN = 0.05       # of the gap that our model has


def rotorpy():
    pytest.importorskip('rotorpy.vehicles.multirotor', reason='rotorpy is not installed')
    file = importlib.import_module('rotorpy.vehicles.hummingbird_params').__file__
    return file, 'rotorpy_hummingbird.py:Hummingbird'


def mujoco():
    pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    return FOLDER / 'quadrotor.xml', 'mujoco_quadrotor.py:Quadrotor'


def drone_models():
    if sys.version_info < (3, 11) or os.environ.get('SCIPY_ARRAY_API') != '1':
        pytest.skip('drone-models is imported only with SCIPY_ARRAY_API=1, from Python 3.11 on')
    models = pytest.importorskip('drone_models', reason='drone-models is not installed')
    file = Path(models.__file__).parent / 'data' / 'params.toml'
    return f'{file}:cf21B_500', 'drone_models_crazyflie.py:Crazyflie'


@pytest.fixture(scope='module', params=[rotorpy, mujoco, drone_models],
                ids=lambda one: one.__name__)
def flown(request):
    """Read a vehicle of a simulator's file, and fly one that has more."""
    file, spec = request.param()
    vehicle = load_any_vehicle(file)
    truth = {name: dict(values) for name, values in vehicle.effects.items()}
    drag = truth.setdefault('rotor_drag', {})
    drag['coefficient'] = drag.get('coefficient', 0.0) + 0.4 * vehicle.mass
    truth['wind'] = {'x': 1.0, 'y': -0.7}
    truth['mass_offset'] = {'mass': 0.05 * vehicle.mass}
    truth['motor_lag'] = {'time_constant': 0.05}
    tracks = [track_of(fly_closed_loop(vehicle, truth, course, duration=8.0, seed=3,
                                       noise=SENSORS['mocap_imu']), vehicle)
              for course in ('figure8', 'lissajous')]
    z = np.concatenate([nominal(vehicle)[:SPLIT], vector(truth, vehicle)])
    with Simulator(f'{FOLDER}/{spec}', vehicle) as simulator:
        yield vehicle, simulator, tracks, z


def gaps_of(vehicle, tracks, z, *simulator):
    return gap([ends(track, vehicle, z, 0.5, *simulator) for track in tracks])


@pytest.mark.slow
def test_the_gap_there_is_that_which_our_model_of_the_file_has(flown):
    vehicle, simulator, tracks, _ = flown
    there = gaps_of(vehicle, tracks, nominal(vehicle), simulator)
    for group, ours in gaps_of(vehicle, tracks, nominal(vehicle)).items():
        assert there[group] == pytest.approx(ours, rel=WITHIN)


@pytest.mark.slow
def test_with_effects_around_it_the_gap_there_falls_by_the_share_that_our_model_promises(flown):
    vehicle, simulator, tracks, z = flown
    assert mapping(z[SPLIT:]) != vehicle.effects
    there = gaps_of(vehicle, tracks, z, simulator)
    before = gaps_of(vehicle, tracks, nominal(vehicle), simulator)
    assert there['velocity'] < 0.3 * before['velocity']
    for group, ours in gaps_of(vehicle, tracks, z).items():
        assert there[group] == pytest.approx(ours, abs=WITHIN * before[group])
