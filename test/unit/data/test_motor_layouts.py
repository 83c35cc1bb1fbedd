# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames of four, six and eight motors by their names, and vehicle files that fit them."""

from dataclasses import replace

from dataflash_files import copter, dataflash
from flightmaker import changed, VEHICLE
import numpy as np
from px4_files import log_of
import pytest
from reader_checks import log, refused, SMALL

from quad_ident_ros.data.load import load
from quad_ident_ros.data.motor_layouts import layout
from quad_ident_ros.data.motor_order import order_of
from quad_ident_ros.model.vehicle import Rotor

NAMES = ('quad x', 'quad +', 'quad x of Betaflight', 'quad x of Betaflight, turning outwards',
         'quad x of DJI', 'quad x, clockwise', 'hexa x', 'hexa +', 'octo x',
         'octo +', 'coaxial octo x', 'coaxial octo +')
SPEEDS = np.linspace(0.30, 0.65, 8)     # a share of each motor's own, so that none is confused


def vehicle_of(name, order, turned=0.0):
    """Return VEHICLE with the rotors of a layout, in an order of its motors, turned by deg."""
    motors = layout(name)
    cosine, sine = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    places = [np.array(motors[k - 1].position) * 0.3 for k in order]
    return replace(VEHICLE, rotors=tuple(
        Rotor((cosine * x - sine * y, sine * x + cosine * y, z), motors[k - 1].spin)
        for (x, y, z), k in zip(places, order, strict=True)))


def shuffled(name, seed=3):
    """Return an order of the motors of a layout, by their numbers from 1."""
    return (np.random.default_rng(seed).permutation(len(layout(name))) + 1).tolist()


@pytest.mark.parametrize('name', NAMES)
def test_rotors_at_one_speed_cause_no_moment_and_all_four_can_be_controlled(name):
    rotors = layout(name)
    x, y, _ = np.array([rotor.position for rotor in rotors]).T
    effect = np.stack([np.ones(len(rotors)), y, -x, [rotor.spin for rotor in rotors]])
    np.testing.assert_allclose(effect.sum(axis=1), [len(rotors), 0, 0, 0], atol=1e-12)
    assert np.linalg.matrix_rank(effect) == 4


@pytest.mark.parametrize('name', NAMES)
def test_each_rotor_gets_the_motor_in_its_direction(name):
    order = shuffled(name)
    assert list(order_of('log', layout(name), 'test', vehicle_of(name, order))) == order


@pytest.mark.parametrize('name, other', [('hexa x', 'hexa +'), ('octo x', 'octo +')])
def test_a_frame_that_is_turned_by_half_the_angle_between_rotors_is_another_one(
        tmp_path, name, other):
    """Each of its rotors is as near to two motors: any order would be an invention."""
    kinds = {'hexa': (13, 6001), 'octo': (14, 8001)}
    kind, start = kinds[name.split()[0]]
    count = len(layout(name))
    path = log(tmp_path, log_of(SMALL, motors=np.tile(SPEEDS[:count], (len(SMALL), 1)),
                                named={'MAV_TYPE': kind, 'SYS_AUTOSTART': start}))
    refused(path, 'no motor', name, 'positions', vehicle=vehicle_of(other, range(1, count + 1)))


@pytest.mark.parametrize('kind, start, name', [
    (13, 6001, 'hexa x'), (13, 7001, 'hexa +'), (14, 8001, 'octo x'), (14, 9001, 'octo +'),
    (14, 12001, 'coaxial octo x'), (2, 5001, 'quad +'), (2, 4001, 'quad x')])
def test_older_airframes_of_px4_are_told_by_their_names(tmp_path, kind, start, name):
    count, order = len(layout(name)), shuffled(name)
    motors = np.tile(SPEEDS[:count], (len(SMALL), 1))
    path = log(tmp_path, log_of(SMALL, motors=motors,
                                named={'MAV_TYPE': kind, 'SYS_AUTOSTART': start}))
    read = load(path, vehicle=vehicle_of(name, order))
    speeds = VEHICLE.speed_min + SPEEDS * (VEHICLE.speed_max - VEHICLE.speed_min)
    commands = read.stack(*(f'cmd{k}' for k in range(1, count + 1)))
    np.testing.assert_allclose(commands[0], speeds[[k - 1 for k in order]], rtol=1e-5)
    assert name in '; '.join(read.info['notes'])


def test_a_coaxial_hexacopter_of_px4_is_not_taken_for_another(tmp_path):
    path = log(tmp_path, log_of(SMALL, motors=np.tile(SPEEDS[:6], (len(SMALL), 1)),
                                named={'MAV_TYPE': 13, 'SYS_AUTOSTART': 11001}))
    read = load(path, vehicle=vehicle_of('hexa x', range(1, 7)))
    assert 'does not say which motor lies where' in '; '.join(read.info['notes'])


@pytest.mark.parametrize('frame, name', [
    ((1, 12), 'quad x of Betaflight'), ((1, 13), 'quad x of DJI'), ((1, 14), 'quad x, clockwise'),
    ((2, 1), 'hexa x'), ((2, 0), 'hexa +'), ((3, 1), 'octo x'), ((3, 0), 'octo +'),
    ((4, 1), 'coaxial octo x')])
def test_frames_of_ardupilot_are_told_by_their_class_and_type(tmp_path, frame, name):
    pytest.importorskip('pymavlink', reason='pymavlink is not installed: pip install pymavlink')
    count, order = len(layout(name)), shuffled(name)
    pwm = np.tile(np.round(1000 + 1000 * SPEEDS[:count]), (len(SMALL), 1))
    record = changed(SMALL, **{f'cmd{k}': SMALL.columns['cmd1'] for k in range(5, count + 1)})
    path = tmp_path / '00000012.BIN'
    path.write_bytes(dataflash(copter(record, pwm, frame=frame,
                                      channels=tuple(range(1, count + 1)))))
    read = load(path, vehicle=vehicle_of(name, order))
    outputs = [f'cmd{k}' for k in range(1, count + 1)]
    ranks = np.argsort(np.argsort(read.stack(*outputs)[0])) + 1
    assert ranks.tolist() == order      # the higher the number of a motor, the faster it turns
    assert name in '; '.join(read.info['notes'])
