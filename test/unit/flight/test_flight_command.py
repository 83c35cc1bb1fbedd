# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident fly`: it writes what the library flies, and takes bad input in one line."""

import json

import numpy as np
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.closed_loop.reference import ASKED
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.summary import summarise
from quad_ident_ros.effects.registry import from_entries
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle

CALL = ['fly', 'circle', '--vehicle', 'paper_quadrotor', '--duration', '5']


def test_the_command_writes_what_the_library_flies(tmp_path, capsys):
    path = tmp_path / 'new' / 'flight.csv.gz'
    assert main([*CALL, '--effect', 'rotor_drag:coefficient=0.1', '--effect', 'wind:x=2',
                 '--seed', '5', '--rate', '200', '--noise', 'mocap_imu', '-o', str(path),
                 '--json', '-']) == 0
    effects = {'rotor_drag': {'coefficient': 0.1}, 'wind': {'x': 2.0}}
    direct = fly_closed_loop(load_vehicle('paper_quadrotor'), effects, 'circle', duration=5.0,
                             rate=200.0, seed=5, noise=MOCAP_IMU)
    written = read_csv(path)
    # Beside it stands what was asked for, which is where the vehicle is but for its errors.
    assert list(written.columns) == [*direct.columns, *ASKED]
    assert np.abs(written.columns['px_ref'] - direct.columns['px']).max() < 0.5
    for name, values in direct.columns.items():
        np.testing.assert_array_equal(written.columns[name], values)
    truth = json.loads(capsys.readouterr().out)
    assert truth['effects'] == effects
    assert truth['samples'] == 1001
    columns = summarise(written)['columns']
    assert [columns[name]['unit'] for name in ASKED] == ['m', 'm', 'm', 'rad']


def test_the_command_says_what_it_flew(tmp_path, capsys):
    assert main([*CALL, '--effect', 'wind:x=2', '-o', str(tmp_path / 'a.csv')]) == 0
    said = capsys.readouterr().out
    assert '501 samples' in said and '(wind) x = 2' in said


def test_effects_of_the_command_go_over_those_of_the_vehicle():
    own = {'wind': {'x': 1.0, 'y': 1.0}}
    assert from_entries(['wind:x=2', 'thrust_scale:factor=0.9'], own, 'here') == {
        'wind': {'x': 2.0, 'y': 1.0}, 'thrust_scale': {'factor': 0.9}}
    assert own == {'wind': {'x': 1.0, 'y': 1.0}}


@pytest.mark.parametrize('arguments, hint', (
    (['--effect', 'wind'], 'NAME:PARAMETER=VALUE'),
    (['--effect', 'wind:x'], 'NAME:PARAMETER=VALUE'),
    (['--effect', 'wnd:x=1'], "did you mean 'wind'"),
    (['--effect', 'wind:u=1'], "'u' is not known"),
    (['--effect', 'wind:x=fast'], 'expected a number'),
    (['--effect', 'wind:x=1000'], 'out of range'),
    (['--noise', 'loud'], '--noise'),
    (['--rate', '1'], 'rate'),
    (['--duration', '0'], 'duration'),
    (['--duration', '3600', '--rate', '2000'], 'samples'),
    (['--effect', 'rotor_fault:loss_5=0.1'], 'loss_5'),
    (['--seed', '-1'], 'seed'),
    (['--vehicle', 'nobody'], 'nobody'),
    (['-o', 'flight.txt'], '.csv.gz')))
def test_bad_input_is_one_line(arguments, hint, tmp_path, capsys):
    output = [] if '-o' in arguments else ['-o', str(tmp_path / 'a.csv')]
    assert main([*CALL, *arguments, *output]) == 2
    error = capsys.readouterr().err
    assert error.startswith('quad_ident fly: error: ') and error.count('\n') == 1
    assert hint in error
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_an_empty_battery_keeps_a_voltage():
    """In an hour of hover it fell far below zero."""
    record = fly_closed_loop(load_vehicle('paper_quadrotor'), {}, 'hover', duration=600.0,
                             rate=50.0)
    voltage = record.columns['vbat']
    assert voltage[0] == 16.8 and voltage.min() == voltage[-1] == pytest.approx(0.7 * 16.8)
    assert (np.diff(voltage) <= 0.0).all()
