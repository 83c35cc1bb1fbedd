# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""PX4 logs with several instances of the outputs, DSHOT, and positions that are no estimates."""

import struct

from flightmaker import px4_samples, ulog, VEHICLE
import numpy as np
from px4_files import controls, FORMATS, log_of, parameters
import pytest
from reader_checks import CMD, log, SMALL

from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import mapping_from

FIRST = 5_000_000   # us, of px4_samples
VALID = {**FORMATS, 'vehicle_local_position': (
    *FORMATS['vehicle_local_position'], 'bool xy_valid', 'bool z_valid', 'bool v_xy_valid',
    'bool v_z_valid')}


def outputs(instance, table):
    """Return the samples of an instance of actuator_outputs from a table (N, k)."""
    stamps = np.round((SMALL.t - SMALL.t[0]) * 1e6).astype(int) + FIRST
    return [('actuator_outputs', instance, int(stamp), [*row, *[0.0] * (16 - len(row))])
            for stamp, row in zip(stamps, table, strict=True)]


def pwm():
    """Return the outputs (N, 4) us of the motors of SMALL."""
    return 1000.0 + 1000.0 * controls(SMALL)


def still(value, count=8):
    """Return outputs that stay as they are, (N, count)."""
    return np.full((len(SMALL), count), value)


@pytest.mark.parametrize('value', [0.0, 900.0, 1500.0])
def test_motors_are_on_the_instance_that_changes(tmp_path, value):
    """A board logs its unused outputs, or its servos, as the first instance."""
    path = log(tmp_path, log_of(SMALL, [*outputs(0, still(value)), *outputs(1, pwm())]))
    read = load(path, vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SMALL.stack(*CMD), atol=0.1)
    assert any('that of the motors is taken: 1' in note for note in read.info['notes'])
    asked = mapping_from({'instances': {'actuator_outputs': 0}}, 'a test')
    assert not np.ptp(load(path, asked).columns['output1'])


def test_functions_of_the_auxiliary_outputs_name_the_motors(tmp_path):
    """Boards with an IO processor have motors of DSHOT on AUX, in any order, beside servos."""
    functions = {'PWM_AUX_FUNC1': 201, **{f'PWM_AUX_FUNC{k}': 106 - k for k in range(2, 6)}}
    limits = {f'PWM_AUX_{name}{k}': value for k in range(2, 6)
              for name, value in (('MIN', 1100), ('MAX', 1900))}
    table = np.column_stack([still(1500.0, 1), (1100.0 + 800.0 * controls(SMALL))[:, ::-1]])
    path = log(tmp_path, log_of(SMALL, [*outputs(0, still(1500.0)), *outputs(1, table)],
                                named=parameters(**functions, **limits)))
    read = load(path, vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SMALL.stack(*CMD), atol=0.1)


@pytest.mark.parametrize('named', [{'DSHOT_CONFIG': 600}, {'PWM_MAIN_TIM0': -3},
                                   {'PWM_MAIN_TIM0': 400, 'PWM_MAIN_TIM1': -5}])
def test_dshot_is_told_by_the_parameters(tmp_path, named):
    """A vehicle that hovers at two thirds has outputs over 1000, as PWM has."""
    least = round(0.055 * 1999)
    table = least + (1999 - least) * controls(SMALL)
    path = log(tmp_path, log_of(SMALL, outputs(0, table), named=parameters(
        **named, DSHOT_MIN=0.055)))
    read = load(path, vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SMALL.stack(*CMD), atol=0.1)
    assert any('DSHOT, 110 to 1999' in note for note in read.info['notes'])


def positions(xy, flags):
    """Return the samples of the local position with x and y as they are given, and flags."""
    stamps = np.round((SMALL.t - SMALL.t[0]) * 1e6).astype(int) + FIRST
    return [('vehicle_local_position', 0, int(stamp), struct.pack('<6f4?', xy, xy, -z, xy, xy,
                                                                  0.1, *flag))
            for stamp, z, flag in zip(stamps, SMALL.columns['pz'], flags, strict=True)]


def invalid(xy, flags):
    """Return the bytes of a log whose positions are replaced."""
    kept = [one for one in px4_samples(SMALL, motors=controls(SMALL))
            if one[0] != 'vehicle_local_position']
    every = sorted([*kept, *positions(xy, flags)], key=lambda one: one[2])
    return ulog(every, VALID, parameters())


@pytest.mark.parametrize(('xy', 'valid'), [(0.0, False), (float('nan'), False), (0.0, True)])
def test_a_position_that_is_no_estimate_is_left_out(tmp_path, xy, valid):
    """Without GPS a local position is logged as well: marked, nan or one value all along."""
    flags = len(SMALL) * [(valid, True, valid, True)]
    read = load(log(tmp_path, invalid(xy, flags)), vehicle=VEHICLE)
    assert not read.has('px') and not read.has('vx') and read.has('qw', 'wx', 'ax', 'cmd1')
    assert any('no valid estimate' in note for note in read.info['logging'])


def test_samples_before_the_first_fix_are_left_out(tmp_path):
    stamps, fix = np.arange(len(SMALL)), len(SMALL) // 4
    changing = [(stamp >= fix,) * 4 for stamp in stamps]
    made = positions(0.0, changing)
    made = [(*one[:3], struct.pack('<6f', *(0.01 * k * np.ones(6))) + one[3][24:])
            for k, one in enumerate(made)]
    kept = [one for one in px4_samples(SMALL, motors=controls(SMALL))
            if one[0] != 'vehicle_local_position']
    path = log(tmp_path, ulog(sorted([*kept, *made], key=lambda one: one[2]), VALID,
                              parameters()))
    read = load(path, vehicle=VEHICLE)
    assert read.has('px') and len(read) == len(SMALL) - fix
    assert any(f'{fix} of {len(SMALL)} samples are not valid' in note
               for note in read.info['notes'])


@pytest.mark.parametrize(('every', 'taken'), [(1, 0.0), (20, 1.0)])
def test_the_raw_gyro_is_taken_where_the_corrected_one_is_scarce(tmp_path, every, taken):
    """Default profiles log the corrected rate seldom; here it is nought, to tell it apart."""
    samples, seen = [], 0
    for topic, instance, stamp, values in px4_samples(SMALL):
        if topic == 'vehicle_angular_velocity':
            seen += 1
            if (seen - 1) % every:
                continue
            values = [0.0, 0.0, 0.0]
        samples.append((topic, instance, stamp, values))
    read = load(log(tmp_path, ulog(samples)))
    names = ('wx', 'wy', 'wz')
    np.testing.assert_allclose(read.stack(*names), taken * SMALL.stack(*names), atol=1e-4)


def test_the_battery_is_the_one_that_is_connected(tmp_path):
    """A board with two sensors logs the one without a battery as the first instance."""
    stamps = np.round((SMALL.t - SMALL.t[0]) * 1e6).astype(int) + FIRST
    samples = [one for one in px4_samples(SMALL) if one[0] != 'battery_status']
    samples += [('battery_status', number, int(stamp), [volt])
                for stamp in stamps[::10] for number, volt in ((0, 0.0), (1, 15.5))]
    path = log(tmp_path, ulog(samples))
    assert load(path).columns['vbat'][0] == 15.5
    first = mapping_from({'instances': {'battery_status': 0}}, 'a test')
    assert not load(path, first).has('vbat')
