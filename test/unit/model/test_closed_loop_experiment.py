# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Experiments in closed loop: their files, their flights, the effects switched on for them."""

import json

import numpy as np
import pytest
import yaml

from quad_ident_ros import resources
from quad_ident_ros.data.commands import with_commands
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import from_entries
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.model.vehicle import load_vehicle

HEAVY = {'mass_offset': {'mass': 0.1}}


@pytest.fixture
def load(tmp_path):
    """Return a function that loads the shipped experiment with other content."""
    def loader(runs=None, **changes):
        data = {**resources.read_yaml(resources.find('experiments', 'closed_loop')), **changes}
        if runs is not None:
            data['runs'] = [{'name': f'run{k}', 'duration': 5.0, 'trajectory': 'hover', **run}
                            for k, run in enumerate(runs)]
        path = tmp_path / 'e.yaml'
        path.write_text(yaml.safe_dump(data), encoding='utf-8')
        return load_experiment(path)
    return loader


@pytest.mark.parametrize('changes, said', [
    ({'runs': [{'trajectory': 'loops'}]}, "runs[0]: trajectory: 'loops' is not one of hover"),
    ({'runs': [{'sensors': 'eyes'}]}, "runs[0]: sensors: 'eyes' is not one of clean"),
    ({'runs': [{'inputs': {}}]}, "runs[0]: 'inputs' is not known here"),
    ({'runs': [{'duration': 0.5}]}, 'runs[0]: duration: 0.5 is out of range'),
    ({'period': 0.1}, 'period: 0.1 is out of range'),
    ({'altitude': 3.0}, "(model closed_loop): 'altitude' is not known here"),
    ({'noise': {'altitude': 0.1}}, "noise: 'altitude' is not known here"),
    ({'model': 'open_loop'}, "'open_loop' is not one of newton_euler, paper, closed_loop")])
def test_bad_files_are_refused_in_one_line(load, changes, said):
    with pytest.raises(InputError) as caught:
        load(**changes)
    assert said in str(caught.value) and '\n' not in str(caught.value)


def test_the_same_seed_gives_the_same_flight_and_each_run_another_one(load):
    experiment = load([{'trajectory': 'figure8', 'sensors': 'mocap_imu'}] * 2)
    one, again, other = (fly(experiment, experiment.runs[k], seed=seed).record
                         for k, seed in ((0, 1), (0, 1), (1, 1)))
    np.testing.assert_array_equal(one.columns['px'], again.columns['px'])
    assert np.ptp(one.columns['px'] - other.columns['px']) > 0.1


def test_a_payload_needs_the_thrust_that_carries_it(load):
    experiment = load([{}])
    vehicle = experiment.vehicle
    for effects, mass in (({}, vehicle.mass), (HEAVY, vehicle.mass + 0.1)):
        record = fly(experiment.with_effects(effects), experiment.runs[0]).record
        assert np.mean(record.columns['u1']) == pytest.approx(mass * vehicle.gravity, rel=1e-3)


def test_the_flight_says_nothing_of_its_effects(load):
    experiment = load([{}]).with_effects(HEAVY)
    info = json.dumps(fly(experiment, experiment.runs[0]).record.info)
    assert 'mass_offset' not in info and 'closed_loop' in info


def test_noise_takes_the_place_of_the_sensors_own(load):
    experiment = load([{'sensors': 'clean'}])
    quiet, loud = (fly(experiment, experiment.runs[0], noise=noise).record.columns['wx']
                   for noise in ({}, {'rate': 0.05}))
    assert np.std(quiet) < 1e-3 and np.std(loud) == pytest.approx(0.05, rel=0.2)


def test_commands_come_back_from_the_inputs(load):
    experiment = load([{'trajectory': 'figure8'}])
    record = fly(experiment, experiment.runs[0]).record
    bare = FlightRecord(record.t, {name: values for name, values in record.columns.items()
                                   if not name.startswith('cmd')})
    commanded = with_commands(bare, experiment.vehicle)
    for j in range(1, 5):
        np.testing.assert_allclose(commanded.columns[f'cmd{j}'], record.columns[f'cmd{j}'],
                                   rtol=1e-9)
    assert with_commands(record, experiment.vehicle) is record


def test_effects_go_over_those_of_the_vehicle(load):
    start = {'mass_offset': {'mass': 0.3}, 'wind': {'y': 2.0}}
    experiment = load().with_effects(from_entries(
        ['mass_offset:mass=0.1', 'rotor_drag:coefficient=0.2', 'wind:x=1'], start, 'here'))
    assert experiment.vehicle.effects == {
        'mass_offset': {'mass': 0.1}, 'wind': {'x': 1.0, 'y': 2.0},
        'rotor_drag': {'coefficient': 0.2}}
    assert start == {'mass_offset': {'mass': 0.3}, 'wind': {'y': 2.0}}
    assert load_vehicle('hummingbird').effects == {}


@pytest.mark.parametrize('entry, said', [
    ('rotor_drag', 'expected NAME:PARAMETER=VALUE'),
    ('rotor_drag=0.2', 'expected NAME:PARAMETER=VALUE'),
    ('wind:x=2,z=0.5', 'one parameter at a time; repeat here'),
    ('rotor_drg:coefficient=0.2', "did you mean 'rotor_drag'"),
    ('rotor_drag:coeficient=0.2', "did you mean 'coefficient'"),
    ('rotor_drag:coefficient=much', "expected a number, got 'much'"),
    ('rotor_drag:coefficient=-1', 'out of range')])
def test_effects_that_are_none_are_refused(load, entry, said):
    with pytest.raises(InputError, match='^here') as caught:
        load().with_effects(from_entries([entry], {}, 'here'), 'here')
    assert said in str(caught.value)
