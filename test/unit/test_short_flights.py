# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights that are too short for a diagnosis, and those that are just long enough."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.leftover import FEWEST, Leftover, leftovers, REMAINS
from quad_ident_ros.diagnose.length import SHORTEST
from quad_ident_ros.diagnose.where import Lacking
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')


@pytest.fixture(scope='module')
def flight():
    return fly_closed_loop(VEHICLE, {'rotor_drag': {'coefficient': 0.3}}, 'figure8',
                           duration=10.0, seed=1, noise=MOCAP_IMU)


def cut(flight, seconds):
    return flight.slice(0, round(100 * seconds))


def test_the_library_refuses_a_short_flight_and_says_what_is_needed(flight):
    text = '5 s are too short for a diagnosis; at least 8 s are needed'
    with pytest.raises(InputError, match=text):
        diagnose([cut(flight, 5.0)], VEHICLE)
    with pytest.raises(InputError, match=text):
        diagnose([flight], VEHICLE, hold_out=cut(flight, 5.0))


@pytest.mark.parametrize('seconds', [0.02, 0.5, SHORTEST - 0.05])
def test_the_command_refuses_in_one_line(flight, seconds, tmp_path, capsys):
    path = tmp_path / 'short.csv'
    write_csv(path, cut(flight, seconds))
    assert main(['diagnose', str(path), '--vehicle', 'hummingbird']) != 0
    said = capsys.readouterr()
    assert said.out == '' and said.err.count('\n') == 1
    assert f'{seconds:.3g} s are too short' in said.err and '8 s are needed' in said.err


def test_the_shortest_flight_bears_a_verdict(flight):
    found = diagnose([cut(flight, SHORTEST)], VEHICLE, effects=['rotor_drag', 'mass_offset'])
    assert 'rotor_drag' in found.data['verdict']


def structured(count):
    """Return what a flight of `count` windows lacks: a force that grows with the speed."""
    values, speed = np.zeros((count, 6)), np.linspace(-1.0, 1.0, count)
    values[:, 0] = speed
    values += 1e-3 * np.random.default_rng(1).standard_normal(values.shape)
    return Lacking(values, np.full((count, 6), 1e-3), np.arange(count), {'speed': ('m/s', speed)})


@pytest.mark.parametrize('count', [1, 6, 7, FEWEST - 1])
def test_few_windows_tell_nothing_of_what_is_left(count):
    assert leftovers([structured(count)]) == []
    with_more = leftovers([structured(count), structured(100)])
    assert with_more == leftovers([structured(100)])
    assert with_more[0].channel == 'Fx' and with_more[0].depends_on == 'speed'


@pytest.mark.parametrize(('channel', 'off', 'matters'), [
    ('Fx', 'rate', False), ('Fx', 'attitude', False), ('Fx', 'velocity', True),
    ('Mx', 'rate', True), ('Mx', 'velocity', True), ('Mx', None, False)])
def test_structure_matters_where_it_makes_a_gap(channel, off, matters):
    """Lost commands make rates that are off, which no force does."""
    times = dict.fromkeys(('position', 'velocity', 'attitude', 'rate'), 1.02) | {off: 1.3}
    one = Leftover(channel, 'the time', 0.6, 1e-9)
    assert (one.remains(times) > REMAINS) is matters


@pytest.mark.parametrize(('gone', 'instead'), [
    (('qw', 'qx', 'qy', 'qz'), 'phi, theta, psi'),
    (('cmd1', 'cmd2', 'cmd3', 'cmd4'), 'u1, u2, u3, u4')])
def test_of_columns_that_are_missing_it_is_said_what_would_do(flight, gone, instead):
    columns = {name: values for name, values in flight.columns.items() if name not in gone}
    with pytest.raises(InputError, match=f'has no column {", ".join(gone)}; .*{instead}'):
        diagnose([replace(flight, columns=columns)], VEHICLE)
