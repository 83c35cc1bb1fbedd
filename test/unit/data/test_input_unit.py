# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.data.commands import with_inputs
from quad_ident_ros.data.export import save
from quad_ident_ros.data.load import load
from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.record import FlightRecord, MOMENTS
from quad_ident_ros.data.topics import ARM, FLIGHT_TOPICS, raw_columns, record_columns
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.identify.signals import NO_ARM, signals
from quad_ident_ros.model.vehicle import load_vehicle


def flight(name, vehicle=None, run=0):
    """Return a record of an experiment with what the topics carry, and its vehicle."""
    experiment = load_experiment(name, vehicle)
    record = fly(experiment, experiment.runs[run], seed=3).record
    columns = {key: values for key, values in record.columns.items()
               if not key.startswith(('cmd', 'rotor'))}
    return FlightRecord(record.t, columns, record.info), experiment.vehicle


def with_moments(record, factor):
    """Return a record as one of a WrenchStamped, whose torques x, y are U2, U3 times a factor."""
    names = {'u2': 'moment_x', 'u3': 'moment_y'}
    columns = {names.get(key, key): factor * values if key in names else values
               for key, values in record.columns.items()}
    return FlightRecord(record.t, columns, {'name': 'of a real vehicle'})


FLOWN = [('closed_loop', None), ('closed_loop', 'crazyflie'), ('hover_single_axis', None),
         ('hover_single_axis', 'hummingbird')]


@pytest.mark.parametrize(('name', 'vehicle'), FLOWN)
def test_a_true_wrench_gives_the_inputs_by_the_arm_length(name, vehicle):
    record, vehicle = flight(name, vehicle)
    found = with_inputs(with_moments(record, vehicle.arm_length), vehicle)
    np.testing.assert_allclose(found.inputs(), record.inputs(), rtol=1e-12, atol=0)
    assert not found.has(MOMENTS[0])
    assert 'input_unit' not in {one.code for one in findings(found, vehicle)}


@pytest.mark.parametrize(('name', 'vehicle'), FLOWN)
def test_the_unit_of_earlier_versions_is_told_by_what_turns_the_vehicle(name, vehicle):
    record, vehicle = flight(name, vehicle)
    found = with_inputs(with_moments(record, 1.0), vehicle)
    np.testing.assert_array_equal(found.inputs(), record.inputs())
    told = [one for one in findings(found, vehicle) if one.code == 'input_unit']
    assert [one.severity for one in told] == ['warning'] and 'N m' in told[0].remedy


@pytest.mark.slow
@pytest.mark.parametrize('factor', [0.8, 1.25])
def test_an_inertia_that_is_off_does_not_change_the_unit(factor):
    record, vehicle = flight('closed_loop')
    wrong = replace(vehicle, inertia=tuple(factor * value for value in vehicle.inertia))
    for scale, told in ((vehicle.arm_length, False), (1.0, True)):
        found = with_inputs(with_moments(record, scale), wrong)
        np.testing.assert_allclose(found.inputs(), record.inputs(), rtol=1e-12)
        assert any(one.code == 'input_unit' for one in findings(found, wrong)) == told


@pytest.mark.parametrize('vehicle', [None, 'crazyflie', 'hummingbird'])
@pytest.mark.parametrize('factor', [0.45, 0.6, 1.7, 2.5])
def test_what_may_be_an_inertia_that_is_far_off_is_not_taken_for_a_unit(vehicle, factor):
    record, vehicle = flight('closed_loop', vehicle)
    wrong = replace(vehicle, inertia=tuple(factor * value for value in vehicle.inertia))
    found = with_inputs(with_moments(record, vehicle.arm_length), wrong)
    np.testing.assert_allclose(found.inputs(), record.inputs(), rtol=1e-12)
    for one in (found, record):
        assert 'input_unit' not in {each.code for each in findings(one, wrong)}


def test_forces_that_are_moments_are_an_error():
    record, vehicle = flight('closed_loop')
    columns = {**record.columns, **{name: vehicle.arm_length * record.columns[name]
                                    for name in ('u2', 'u3')}}
    found = findings(FlightRecord(record.t, columns, {}), vehicle)
    assert [one.severity for one in found if one.code == 'input_unit'] == ['error']


@pytest.mark.parametrize(('name', 'vehicle'), FLOWN)
def test_forces_in_the_torque_of_a_run_that_says_its_arm_are_an_error(name, vehicle):
    """The moments of inertia were five times as large, and nothing said why."""
    record, vehicle = flight(name, vehicle)
    columns = {**record.columns, **{key: record.columns[key] / vehicle.arm_length
                                    for key in ('u2', 'u3')}}
    found = findings(FlightRecord(record.t, columns, {ARM: vehicle.arm_length}), vehicle)
    assert [one.severity for one in found if one.code == 'input_unit'] == ['error']
    assert 'input_unit' not in {one.code for one in findings(record, vehicle)}


def test_without_an_arm_altitude_and_yaw_are_identified_and_the_rest_is_said():
    record, vehicle = flight('closed_loop')
    moments = with_moments(record, vehicle.arm_length)
    pairs, remarks = signals(moments)
    assert [pair.output for pair in pairs] == ['psi', 'z'] and NO_ARM in remarks
    pairs, remarks = signals(with_inputs(moments, vehicle))
    assert len(pairs) == 4 and NO_ARM not in remarks
    without = {name: values for name, values in moments.columns.items()
               if name not in ('u1', 'u4')}
    with pytest.raises(InputError, match='name the vehicle'):
        signals(FlightRecord(moments.t, without, {}))


def test_the_arm_of_a_run_makes_forces_of_moments():
    names = raw_columns(FLIGHT_TOPICS)
    table = np.arange(2.0 * len(names)).reshape(2, -1)
    columns = record_columns(names, table, 0.25)
    k = names.index('moment_x')
    np.testing.assert_array_equal(columns['u2'], table[:, k] / 0.25)
    np.testing.assert_array_equal(columns['u3'], table[:, k + 1] / 0.25)
    assert list(columns).index('u2') == list(columns).index('u1') + 1


@pytest.mark.slow
def test_a_bag_carries_a_true_wrench(tmp_path):
    record, vehicle = flight('closed_loop')
    save(tmp_path / 'bag', record)
    from quad_ident_ros.data.bag_file import read_bag_messages
    torque = np.array([[m.wrench.torque.x, m.wrench.torque.y] for _, _, m in
                       read_bag_messages(tmp_path / 'bag', ('input',))])
    np.testing.assert_allclose(torque, vehicle.arm_length * record.inputs()[:, 1:3])
    # The columns of a table that says no arm stay as they are, and make no wrench.
    save(tmp_path / 'other', FlightRecord(record.t, record.columns, {}))
    assert not list(read_bag_messages(tmp_path / 'other', ('input',)))
    np.testing.assert_array_equal(load(tmp_path / 'other').inputs(), record.inputs())


def test_shipped_vehicles_have_arms_by_which_the_unit_is_told():
    for name in ('crazyflie', 'hummingbird', 'iris', 'paper_quadrotor'):
        assert load_vehicle(name).arm_length < 0.4


@pytest.mark.parametrize('speed', [1e300, -1e200])
def test_a_command_that_is_the_speed_of_no_rotor_is_named(speed):
    vehicle = load_vehicle('iris')
    columns = {f'cmd{j}': np.full(3, 500.0) for j in range(1, 5)}
    columns['cmd2'] = np.array([500.0, speed, 500.0])
    with pytest.raises(InputError, match=r"a\.csv, sample 1, column 'cmd2': .*e\+.*rad/s"):
        with_inputs(FlightRecord([0.0, 0.1, 0.2], columns, {'source': 'a.csv'}), vehicle)
