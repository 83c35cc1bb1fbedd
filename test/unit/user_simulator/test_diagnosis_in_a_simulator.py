# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagnosis that is held against a user's simulator, by the library and by the command."""

from dataclasses import replace
import io
import json
from pathlib import Path

import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.report.diagnosis import show
from quad_ident_ros.user_simulator.simulator import Simulator

pytestmark = pytest.mark.xdist_group('diagnosis_in_a_simulator')     # one for all tests
FILE = Path(__file__).parents[2] / 'helpers' / 'plain_simulators.py'
BARE = load_vehicle('hummingbird')
TRUTH = {'rotor_drag': {'coefficient': 0.3}, 'motor_lag': {'time_constant': 0.03}}


@pytest.fixture(scope='module')
def flights():
    return [fly_closed_loop(BARE, TRUTH, course, duration=8.0, seed=k, noise=SENSORS['mocap_imu'])
            for k, course in enumerate(('figure8', 'steps', 'lissajous'))]


def text_of(found):
    stream = io.StringIO()
    show(found, stream)
    return stream.getvalue()


@pytest.fixture(scope='module')
def found(flights):
    with Simulator(f'{FILE}:Many', BARE) as simulator:
        return diagnose(flights, BARE, simulator=simulator)


@pytest.mark.slow
def test_a_simulator_of_the_nominal_vehicle_has_the_gap_that_the_diagnosis_reports(found):
    there, ours = found.in_simulator, found.gap
    for stage in ('before', 'before_own', 'after'):
        for group, value in getattr(ours, stage).items():
            assert getattr(there, stage)[group] == pytest.approx(value, rel=0.02)
    assert there.closed == pytest.approx(ours.closed, abs=0.02) and there.closed > 0.9
    assert all(there.from_nominal[group] < 1e-3 * ours.before[group] for group in ours.before)


@pytest.mark.slow
def test_the_gap_of_the_simulator_lies_where_that_of_the_nominal_vehicle_does(found):
    for ours, theirs in zip(found.where[:2], found.in_simulator.where[:2], strict=True):
        assert (theirs.channel, theirs.regime) == (ours.channel, ours.regime)
        assert theirs.share == pytest.approx(ours.share, abs=0.02)
        assert theirs.rms == pytest.approx(ours.rms, rel=0.02)
    said = text_of(found)
    assert 'plain_simulators.py:Many, on' in said and 'warning: ' not in said


@pytest.mark.slow
def test_a_simulator_with_the_true_effects_has_noise_alone(flights):
    vehicle = replace(BARE, effects={'motor_lag': {'time_constant': 0.03}})
    records = [fly_closed_loop(vehicle, vehicle.effects, course, duration=8.0, seed=k,
                               noise=SENSORS['mocap_imu'])
               for k, course in enumerate(('figure8', 'steps', 'lissajous'))]
    with Simulator(f'{FILE}:ManyLagged', vehicle) as simulator:
        found = diagnose(records, vehicle, simulator=simulator)
    assert found.verdict == ('none',)
    for group, value in found.in_simulator.before.items():
        assert value == pytest.approx(found.gap.noise[group], rel=0.25)


@pytest.mark.slow
def test_a_simulator_that_is_not_the_vehicle_of_the_file_is_told(flights, tmp_path, capsys):
    for k, record in enumerate(flights):
        write_csv(tmp_path / f'{k}.csv', record)
    write_vehicle(tmp_path / 'v.yaml', BARE)
    command = ['diagnose', *(str(tmp_path / f'{k}.csv') for k in range(3)), '--vehicle',
               str(tmp_path / 'v.yaml'), '--effects', 'rotor_drag,motor_lag', '--report',
               str(tmp_path / 'page.html'), '--json', str(tmp_path / 'd.json'), '--simulator']
    assert main([*command, f'{FILE}:Dragged']) == 0
    said = capsys.readouterr().out
    assert 'Dragged: 0.5 s ahead it differs from the nominal vehicle' in said
    data = json.loads((tmp_path / 'd.json').read_text())['in_simulator']
    # It has a drag of its own, so that less is missing than of the vehicle of the file.
    assert data['simulator'].endswith(':Dragged')
    assert data['before']['velocity'] < json.loads(
        (tmp_path / 'd.json').read_text())['gap']['before']['velocity']
    assert 'In the simulator' in (tmp_path / 'page.html').read_text()
    assert main([*command, f'{FILE}:Missing']) == 2
    assert 'it has no class Missing' in capsys.readouterr().err


def test_flights_without_a_pose_are_refused(flights):
    bare = [replace(record, columns={name: values for name, values in record.columns.items()
                                     if name[0] in 'acw' or name in ('wx', 'wy', 'wz')})
            for record in flights]
    with Simulator(f'{FILE}:Many', BARE) as simulator:
        with pytest.raises(InputError, match='--simulator: these flights have neither position'):
            diagnose(bare, BARE, simulator=simulator)
