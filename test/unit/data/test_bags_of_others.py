# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bags with types, frames and mappings to begin with as people have them."""

import bag_files
from bag_files import header, imu, odometry, poses, stamps, write2
from flightmaker import flight, frd, ned, ned_attitude, others_bag, VEHICLE
import numpy as np
import pytest
from reader_checks import CMD, refused

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import load_mapping, mapping_from

FLIGHT = flight(seconds=6.0, rate=50.0)
PLACE, SPEED = ('px', 'py', 'pz'), ('vx', 'vy', 'vz')
KIND = 'lab_msgs/msg/MotorPwm'
RPM = 'lab_msgs/msg/MotorRpm'


@pytest.fixture
def types(monkeypatch):
    """Return a typestore with messages of a laboratory, header and list."""
    monkeypatch.setitem(bag_files.OTHERS, KIND, 'std_msgs/Header header\nuint16[] pwm\n')
    monkeypatch.setitem(bag_files.OTHERS, RPM, 'std_msgs/Header header\nfloat32[] rpm\n')
    return bag_files.store()


def messages(topic, kind, field, table):
    """Return messages with a list for each sample of FLIGHT."""
    return [(topic, kind, ns, {'header': header(ns), field: row})
            for ns, row in zip(stamps(FLIGHT), table, strict=True)]


def written(path, out):
    """Write a mapping to begin with and return it."""
    main(['info', str(path), '--write-mapping', str(out)])
    return load_mapping(out)


@pytest.mark.slow
def test_the_mapping_to_begin_with_reads_what_is_read_without_it(tmp_path):
    """MAVROS: a pose besides an attitude of the IMU, two rates, outputs in a field channels."""
    pwm = np.round(1000 + (FLIGHT.stack(*CMD) - 100) / 1.6).astype(np.uint16)
    made = [*odometry(FLIGHT, '/mavros/local_position/odom'),
            *poses(FLIGHT, '/mavros/local_position/pose'), *imu(FLIGHT, '/mavros/imu/data'),
            *messages('/mavros/rc/out', 'mavros_msgs/msg/RCOut', 'channels', pwm)]
    path = write2(tmp_path / 'bag', sorted(made, key=lambda one: one[2]))
    alone = load(path, vehicle=VEHICLE)
    mapped = load(path, written(path, tmp_path / 'map.yaml'), VEHICLE)
    assert set(alone.columns) == set(mapped.columns)
    for name, values in alone.columns.items():
        np.testing.assert_array_equal(mapped.columns[name], values)


def test_a_flight_has_the_name_of_its_bag(tmp_path):
    """By it several bags of one diagnosis are told apart."""
    folder = write2(tmp_path / 'third_lap', [*odometry(FLIGHT), *imu(FLIGHT)])
    assert load(folder).info['name'] == 'third_lap'
    [file] = folder.glob('*.mcap')
    assert load(file.rename(tmp_path / 'fourth_lap.mcap')).info['name'] == 'fourth_lap'


def test_a_bag_that_was_not_copied_whole_says_so_without_any_message(tmp_path):
    others_bag(tmp_path / 'bag', FLIGHT)
    [file] = (tmp_path / 'bag').glob('*.mcap')
    cut = tmp_path / 'cut.mcap'
    cut.write_bytes(file.read_bytes()[:file.stat().st_size // 2])   # within its one chunk
    refused(cut, 'ends within its first message', 'copy it again')


@pytest.mark.slow
def test_lists_of_a_laboratory_are_named_as_outputs(tmp_path, types):
    speeds = FLIGHT.stack(*CMD)
    pwm = np.round(1000 + (speeds - 100) / 1.6).astype(np.uint16)
    made = [*poses(FLIGHT), *imu(FLIGHT), *messages('/uav/motor_pwm', KIND, 'pwm', pwm),
            *messages('/uav/motor_rpm', RPM, 'rpm', (speeds * 30 / np.pi).astype(np.float32))]
    path = write2(tmp_path / 'bag', sorted(made, key=lambda one: one[2]), types=types)
    assert '/uav/motor_pwm' in '; '.join(load(path).info['notes'])
    mapping = written(path, tmp_path / 'map.yaml')
    assert mapping.topics['commands'].field == 'pwm' and mapping.topics['rotors'].unit == 'rpm'
    read = load(path, mapping, VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), speeds, atol=1.0)
    np.testing.assert_allclose(read.columns['rotor2'], speeds[:, 1], rtol=1e-6)


@pytest.mark.parametrize(('make', 'name'), [
    (lambda speeds: speeds, 'cmd1'), (lambda speeds: (speeds - 100) / 1600, 'output1'),
    (lambda speeds: np.round(1000 + (speeds - 100) / 1.6), 'output1'),
    (lambda speeds: speeds * 30 / np.pi, 'output1')])
def test_numbers_without_a_kind_are_speeds_only_by_their_size(tmp_path, make, name):
    """A list of PWM or rpm was taken for rad/s, and the verdict was a wrong thrust."""
    speeds = FLIGHT.stack(*CMD)
    others_bag(tmp_path / 'bag', FLIGHT, make(speeds))
    mapping = mapping_from({'topics': {'pose': {'topic': '/odom'},
                                       'commands': {'topic': '/motors'}}}, 'a test')
    assert load(tmp_path / 'bag', mapping).has(name)
    read = load(tmp_path / 'bag', mapping, VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), speeds, rtol=2e-3)


def test_a_pose_whose_frame_is_ned_is_no_pose_in_enu(tmp_path):
    q, place = ned_attitude(FLIGHT.stack('qw', 'qx', 'qy', 'qz')), ned(FLIGHT.stack(*PLACE))
    rate, speed = frd(FLIGHT.stack('wx', 'wy', 'wz')), ned(FLIGHT.stack(*SPEED))
    made = []
    for k, (topic, kind, ns, fields) in enumerate(odometry(FLIGHT, frame='world_ned')):
        fields['pose']['pose'] = {'position': bag_files.xyz(place[k]),
                                  'orientation': dict(zip('wxyz', map(float, q[k]), strict=True))}
        fields['twist']['twist'] = {'linear': bag_files.xyz(speed[k]),
                                    'angular': bag_files.xyz(rate[k])}
        made.append((topic, kind, ns, fields))
    path = write2(tmp_path / 'bag', made)
    refused(path, 'world_ned', 'world: NED', 'body: FRD')
    both = {'world': 'NED', 'body': 'FRD'}
    named = {role: {'topic': '/odom'} for role in ('pose', 'velocity', 'rate')}
    named['velocity']['frame'] = 'world'
    read = load(path, mapping_from({**both, 'topics': named}, 'a test'))
    for names in (PLACE, SPEED, ('wx', 'wy', 'wz')):
        np.testing.assert_allclose(read.stack(*names), FLIGHT.stack(*names), atol=1e-6)
    assert load(path, mapping_from(both, 'a test')).has(*PLACE)
