# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights that are too short for a diagnosis, and those that are just long enough."""

from dataclasses import replace

import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.rules import RULES
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


@pytest.mark.slow
def test_the_library_refuses_a_short_flight_and_says_what_is_needed(flight):
    text = '3 s are too short for a diagnosis; at least 4 s are needed'
    with pytest.raises(InputError, match=text):
        diagnose([cut(flight, 3.0)], VEHICLE)
    with pytest.raises(InputError, match=text):
        diagnose([flight], VEHICLE, hold_out=cut(flight, 3.0))
    with pytest.raises(InputError, match='9 s are needed'):
        diagnose([cut(flight, 8.0)], VEHICLE, rules=replace(RULES, shortest=9.0))


@pytest.mark.parametrize('seconds', [0.02, 0.5, RULES.shortest - 0.05])
def test_the_command_refuses_in_one_line(flight, seconds, tmp_path, capsys):
    path = tmp_path / 'short.csv'
    write_csv(path, cut(flight, seconds))
    assert main(['diagnose', str(path), '--vehicle', 'hummingbird']) != 0
    said = capsys.readouterr()
    assert said.out == '' and said.err.count('\n') == 1
    assert f'{seconds:.3g} s are too short' in said.err and '4 s are needed' in said.err


@pytest.mark.slow
def test_the_shortest_flight_bears_a_verdict(flight):
    found = diagnose([cut(flight, RULES.shortest)], VEHICLE, effects=['rotor_drag', 'mass_offset'])
    assert 'rotor_drag' in found.verdict


@pytest.mark.parametrize(('gone', 'instead'), [
    (('qw', 'qx', 'qy', 'qz'), 'phi, theta, psi'),
    (('cmd1', 'cmd2', 'cmd3', 'cmd4'), 'u1, u2, u3, u4')])
def test_of_columns_that_are_missing_it_is_said_what_would_do(flight, gone, instead):
    columns = {name: values for name, values in flight.columns.items()
               if name not in gone and not name.startswith('rotor')}
    with pytest.raises(InputError, match=f'has no column {", ".join(gone)}; .*{instead}'):
        diagnose([replace(flight, columns=columns)], VEHICLE)


@pytest.mark.slow
def test_a_lossy_flight_held_out_has_the_horizons_that_its_stretches_allow(flight):
    """Rows are lost every 1.1 s: no stretch is as long as 1 s and its margin."""
    since = (flight.t - flight.t[0]) % 1.1
    lossy = replace(flight, t=flight.t[since > 0.12], columns={
        name: values[since > 0.12] for name, values in flight.columns.items()})
    found = diagnose([flight], VEHICLE, hold_out=lossy, effects=['rotor_drag', 'mass_offset'])
    assert 'rotor_drag' in found.verdict
    assert {'0.1', '0.5'} <= found.gap.horizons.keys() and '1.0' not in found.gap.horizons


@pytest.mark.slow
def test_a_flight_held_out_that_is_among_the_others_is_listed_once(flight):
    other = fly_closed_loop(VEHICLE, {}, 'lissajous', duration=6.0, seed=2, noise=MOCAP_IMU)
    found = diagnose([other, flight], VEHICLE, hold_out=flight, effects=['rotor_drag'])
    assert [one.flight for one in found.recorded] == [other.info['name'], flight.info['name']]


@pytest.mark.slow
def test_flights_with_and_without_a_position_make_one_diagnosis(flight):
    without = replace(flight, columns={name: values for name, values in flight.columns.items()
                                       if name not in ('px', 'py', 'pz')}, info={'name': 'other'})
    other = fly_closed_loop(VEHICLE, {'rotor_drag': {'coefficient': 0.3}}, 'lissajous',
                            duration=8.0, seed=3, noise=MOCAP_IMU)
    for records in ([other, without], [without, other]):
        found = diagnose(records, VEHICLE, effects=['rotor_drag'])
        assert found.verdict == ('rotor_drag',)
