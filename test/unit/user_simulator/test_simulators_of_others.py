# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The examples of docs/simulators: what is read of a simulator's file flies there as in ours."""

from dataclasses import replace
import importlib
import os
from pathlib import Path
import re
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
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.load import load_any_vehicle, source_of

FOLDER = Path(__file__).resolve().parents[3] / 'docs' / 'simulators'
WITHIN = 0.05       # of the gap that our model has


def rotorpy():
    pytest.importorskip('rotorpy.vehicles.multirotor', reason='rotorpy is not installed')
    file = importlib.import_module('rotorpy.vehicles.hummingbird_params').__file__
    return file, 'rotorpy_hummingbird.py:Hummingbird'


def mujoco():
    pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    return FOLDER / 'quadrotor.xml', 'mujoco_quadrotor.py:Quadrotor'


def crazyflie_of(name, *parts):
    if sys.version_info < (3, 11) or os.environ.get('SCIPY_ARRAY_API') != '1':
        pytest.skip(f'{name} is imported only with SCIPY_ARRAY_API=1, from Python 3.11 on')
    models = pytest.importorskip(name, reason=f'{name} is not installed')
    file = Path(models.__file__).parent.joinpath(*parts)
    return f'{file}:cf21B_500', 'drone_models_crazyflie.py:Crazyflie'


def drone_models():
    return crazyflie_of('drone_models', 'data', 'params.toml')


def crazyflow():
    """Crazyflow from 0.4 on, which has the equations and the parameters of drone-models itself."""
    return crazyflie_of('crazyflow.dynamics', 'first_principles', 'params.toml')


PARAMETERS = """    def parameters(self):
        given = load_params('first_principles', 'cf21B_500')
        with open('FOLDER/real.toml', 'rb') as file:
            given |= tomllib.load(file)['cf21B_500']
        given['J_inv'] = np.linalg.inv(given['J'])
        inner = getattr(dynamics, '__wrapped__', dynamics)
        known = inner.__kwdefaults__ or inner.__code__.co_varnames
        return {key: np.asarray(given[key]) for key in given if key in known}

    def step_many"""
EXPORTED = {    # what an example takes from its library, and from the written file instead
    'from rotorpy.vehicles.hummingbird_params import quad_params':
    'from runpy import run_path\nquad_params = run_path("FOLDER/real_params.py")["quad_params"]',
    'from drone_models import parametrize':
    'from functools import partial\nimport tomllib\nfrom drone_models.core import load_params',
    "parametrize(dynamics, 'cf21B_500')": 'partial(dynamics, **self.parameters())',
    '    def step_many': PARAMETERS}
OF_CRAZYFLOW = {    # where crazyflow has what the example takes from drone-models
    'drone_models import': 'crazyflow.dynamics.core import',
    'drone_models.core': 'crazyflow.dynamics.core',
    'drone_models.first_principles': 'crazyflow.dynamics.first_principles'}


def written(simulator, folder, found=None):
    """Write an exported file, if any, and its example; return the class for --simulator."""
    name = {'rotorpy': 'real_params.py', 'mujoco': 'quadrotor.xml'}
    changes = dict(EXPORTED) if found is not None else {}
    if found is not None:
        file = folder / name.get(simulator.__name__, 'real.toml')
        file.write_text(found.text, encoding='utf-8')
    example, _, made = simulator()[1].partition(':')
    text = (FOLDER / example).read_text(encoding='utf-8')
    for old, new in (changes | (OF_CRAZYFLOW if simulator is crazyflow else {})).items():
        text = text.replace(old, new.replace('FOLDER', str(folder)), 1)
    (folder / example).write_text(text, encoding='utf-8')
    return f'{folder / example}:{made}'


CARRIED = {     # beside the mass: what each of the formats has a number for
    rotorpy: lambda vehicle: {
        'motor_lag': {'time_constant': 0.05}, 'rotor_drag': {'coefficient': 0.6 * vehicle.mass},
        'inertia_mismatch': {'arms_x': 1.3, 'arms_y': 1.2, 'torque': 0.8}},
    mujoco: lambda vehicle: {'inertia_mismatch': {'moment_x': 1.2, 'moment_y': 0.9,
                                                  'moment_z': 1.1, 'inertia_z': 0.9},
                             'com_offset': {'x': 0.003}},
    **dict.fromkeys((drone_models, crazyflow), lambda vehicle: {
        'rotor_drag': {'x': vehicle.mass, 'y': 0.5 * vehicle.mass},
        'inertia_mismatch': {'arms_x': 1.2, 'arms_y': 1.1, 'torque': 1.1}})}


@pytest.mark.slow
@pytest.mark.parametrize('simulator', CARRIED, ids=lambda one: one.__name__)
def test_the_exported_model_flies_there_as_the_vehicle_file_does_in_ours(simulator, tmp_path):
    """Open loop along flights of a third vehicle, from the same starts: the reported gap."""
    file, _ = simulator()
    if simulator is drone_models:
        # Its gyroscopic moment about x has another sign than ours, which is not the export's.
        path, _, name = file.rpartition(':')
        text = re.sub(r'^prop_inertia = \S+', 'prop_inertia = 1e-15',
                      Path(path).read_text(encoding='utf-8'), flags=re.M)
        (tmp_path / 'base.toml').write_text(text, encoding='utf-8')
        file = f'{tmp_path / "base.toml"}:{name}'
    nominal_one = load_any_vehicle(file)
    effects = {name: dict(values) for name, values in nominal_one.effects.items()}
    effects['mass_offset'] = {'mass': 0.1 * nominal_one.mass}
    for name, values in CARRIED[simulator](nominal_one).items():
        effects[name] = effects.get(name, {}) | values if name == 'rotor_drag' else values
    vehicle = replace(nominal_one, effects=mapping(vector(effects, nominal_one)))
    to = simulator.__name__.replace('drone_models', 'crazyflow')
    found = export(vehicle, to, source_of(file))
    assert found.changes and not found.fates.not_carried
    flown = fly_closed_loop(nominal_one, effects | {'wind': {'x': 1.5}}, 'figure8', duration=8.0,
                            seed=3, noise=SENSORS['mocap_imu'])
    tracks = [track_of(flown, nominal_one)]
    with Simulator(written(simulator, tmp_path, found), vehicle) as there:
        in_simulator = gaps_of(vehicle, tracks, nominal(vehicle), there)
    for group, ours in gaps_of(vehicle, tracks, nominal(vehicle)).items():
        assert in_simulator[group] == pytest.approx(ours, rel=WITHIN)
    # The nominal model is off by far more than that: the numbers that were written matter.
    without = gaps_of(nominal_one, tracks, nominal(nominal_one))
    assert without['velocity'] > (1.0 + 5.0 * WITHIN) * in_simulator['velocity']


@pytest.fixture(scope='module', params=[rotorpy, mujoco, drone_models, crazyflow],
                ids=lambda one: one.__name__)
def flown(request, tmp_path_factory):
    """Read a vehicle of a simulator's file, and fly one that has more."""
    file, spec = request.param()
    folder = FOLDER
    if request.param is crazyflow:
        folder = tmp_path_factory.mktemp('crazyflow')
        written(crazyflow, folder)
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
    with Simulator(f'{folder}/{spec}', vehicle) as simulator:
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
