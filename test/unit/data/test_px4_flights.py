# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a PX4 log says beside its samples: motors, kind of vehicle, flights, resets."""

from dataclasses import replace
import json
import math
from pathlib import Path
import random
import struct

from flightmaker import flight, frd, ned, ned_attitude, px4_samples, ulog, VEHICLE
from full_disk import file_size_limit
import numpy as np
from px4_files import (
    controls,
    esc,
    FORMATS,
    landed,
    log_of,
    ORDER,
    parameters,
    PLACES,
    POSITION,
    status,
    TURNED,
)
import pytest
from reader_checks import CMD, log, refused, SMALL
from real import SHARED
import yaml

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.load import contents_of, load, load_all
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.data.quality import cautions, findings
from quad_ident_ros.data.split import joined, part
from quad_ident_ros.data.thrust_level import FULL_SPEED
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.flights import track_of
from quad_ident_ros.model.attitude import product, rotate
from quad_ident_ros.model.motors import motors_from
from quad_ident_ros.model.vehicle import load_vehicle, Rotor

FIRST = 5_000_000   # us, of px4_samples


def notes(record):
    """Return all notes of a record as one text."""
    return '; '.join(record.info['notes'])


def test_the_parameters_of_a_log_give_commands_without_a_mapping(tmp_path):
    read = load(log(tmp_path, log_of(SMALL, motors=controls(SMALL))), vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SMALL.stack(*CMD), atol=1e-3)
    assert 'motors 1, 4, 2, 3' in notes(read) and 'CA_ROTOR' in notes(read)


def test_thr_mdl_fac_is_the_thrust_curve(tmp_path):
    path = log(tmp_path, log_of(SMALL, motors=controls(SMALL, 'thrust'),
                                named=parameters(THR_MDL_FAC=0.4)))
    read = load(path, vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SMALL.stack(*CMD), atol=1e-2)
    assert 'THR_MDL_FAC' in notes(read)


@pytest.mark.parametrize(('curve', 'factor', 'pwm'), [
    ('linear', 0.0, False), ('thrust', 0.4, False), ('thrust', 0.4, True)])
def test_without_a_speed_at_full_signal_the_weight_tells_the_level(tmp_path, curve, factor, pwm):
    """The log knows the form of the map, by which speeds are right but for the weight's noise."""
    record = flight(seconds=4.0, noise=0.0)
    full, speed = 1700.0, record.stack(*CMD)
    signal = np.empty_like(speed)
    signal[:, np.array(ORDER) - 1] = (speed / full) ** (1 if curve == 'linear' else 2)
    samples = {'motors': signal}
    if pwm:     # as PX4 undoes THR_MDL_FAC
        half = (1 - factor) / (2 * factor)
        samples = {'outputs': 1000 + 1000 * (np.sqrt(half ** 2 + signal / factor) - half)}
    named = parameters(THR_MDL_FAC=factor, PWM_MAIN_MIN=1000, PWM_MAIN_MAX=2000)
    vehicle = replace(VEHICLE, speed_min=0.0, speed_max=math.inf)
    read = load(log(tmp_path, log_of(record, named=named, **samples)), vehicle=vehicle)
    assert read.info[FULL_SPEED] == pytest.approx(full, rel=5e-3)
    np.testing.assert_allclose(read.stack(*CMD), speed, rtol=5e-3)
    assert 'neither the log nor the vehicle file' in notes(read) and 'the weight' in notes(read)


def test_pwm_is_undone_with_its_limits_and_curve(tmp_path):
    """The PWM that PX4 makes of thrust by THR_MDL_FAC between the limits of each channel."""
    share, factor = controls(SMALL, 'thrust'), 0.4
    half = (1 - factor) / (2 * factor)
    signal = np.sqrt(half ** 2 + share / factor) - half
    low, high = np.array([1050.0, 1050.0, 1075.0, 1050.0]), np.array([1900.0] * 3 + [1950.0])
    named = parameters(THR_MDL_FAC=factor, PWM_MAIN_MIN=1050, PWM_MAIN_MAX=1900,
                       PWM_MAIN_MIN3=1075, PWM_MAIN_MAX4=1950)
    path = log(tmp_path, log_of(SMALL, outputs=low + signal * (high - low), named=named))
    np.testing.assert_allclose(load(path, vehicle=VEHICLE).stack(*CMD), SMALL.stack(*CMD),
                               atol=1e-2)


def test_the_motors_of_the_vehicle_hold_before_the_parameters(tmp_path):
    curve = {'offset': 100, 'gain': 1600}
    for kind, outputs in (('normalised', {'motors': controls(SMALL)}),
                          ('normalised', {'outputs': 1000 + 1000 * controls(SMALL)}),
                          ('pwm', {'outputs': 1000 + 1000 * controls(SMALL),
                                   'motors': 0 * controls(SMALL)})):
        vehicle = replace(VEHICLE, speed_max=9000.0,
                          motors=motors_from('v', {'kind': kind, 'speed': curve}))
        read = load(log(tmp_path, log_of(SMALL, **outputs)), vehicle=vehicle)
        np.testing.assert_allclose(read.stack(*CMD), SMALL.stack(*CMD), atol=1e-3)
        assert 'by motors: of half_kilogram' in notes(read)


def test_outputs_are_found_by_their_functions(tmp_path):
    """Motor 1 on channel 4 and so on, as PWM_MAIN_FUNC says."""
    named = parameters(**{f'PWM_MAIN_FUNC{5 - k}': 100 + k for k in range(1, 5)})
    pwm = (1000 + 1000 * controls(SMALL))[:, ::-1]
    path = log(tmp_path, log_of(SMALL, outputs=pwm, named=named))
    np.testing.assert_allclose(load(path, vehicle=VEHICLE).stack(*CMD), SMALL.stack(*CMD),
                               atol=1e-2)


def test_an_older_airframe_is_told_by_its_type(tmp_path):
    """Without CA_ROTOR the order of quad x holds; the spins of the vehicle file must fit it."""
    named = {'MAV_TYPE': 2, 'SYS_AUTOSTART': 4001}
    path = log(tmp_path, log_of(SMALL, motors=controls(SMALL), named=named))
    turned = replace(VEHICLE, rotors=tuple(Rotor(rotor.position, -rotor.spin)
                                           for rotor in VEHICLE.rotors))
    np.testing.assert_allclose(load(path, vehicle=turned).stack(*CMD), SMALL.stack(*CMD),
                               atol=1e-3)
    refused(path, 'rotors[0]', 'motor 1', 'spin', vehicle=VEHICLE)


def test_a_vehicle_that_does_not_match_is_named(tmp_path):
    path = log(tmp_path, log_of(SMALL, motors=controls(SMALL)))
    plus = replace(VEHICLE, rotors=tuple(
        Rotor(place, 1) for place in ((0.2, 0, 0), (0, 0.2, 0), (-0.2, 0, 0), (0, -0.2, 0))))
    refused(path, 'half_kilogram', '45 deg', 'positions', vehicle=plus)
    three = replace(VEHICLE, rotors=VEHICLE.rotors[:3])
    refused(path, '4 motors', '3 rotors', vehicle=three)
    other = log(tmp_path, log_of(SMALL, motors=controls(SMALL), named=parameters(PLACES)))
    refused(other, 'spin', vehicle=VEHICLE)
    # What a mapping says holds.
    mapping = mapping_from({'actuators': {'kind': 'normalised', 'order': ORDER}}, 'm')
    assert load(other, mapping, VEHICLE).has('cmd4')


def test_without_parameters_outputs_are_taken_in_order_and_it_is_said(tmp_path):
    read = load(log(tmp_path, log_of(SMALL, motors=controls(SMALL), named={})), vehicle=VEHICLE)
    assert read.has('cmd4') and not read.has('output1')
    assert 'CA_ROTOR' in notes(read) and 'mapping' in notes(read)


def test_measured_rpm_becomes_rotors_and_tells_the_map(tmp_path):
    """Speeds from 0 to 2500 rad/s that no vehicle file knows, in the order of the vehicle."""
    record = flight(seconds=4.0, noise=0.0)
    signal = controls(record)
    signal = 0.5 + (signal - signal.mean()) * 3
    stamps = np.round((record.t - record.t[0]) * 1e6).astype(int) + FIRST
    extra = [esc(int(stamp), 2500 * row) for stamp, row in zip(stamps, signal, strict=True)]
    read = load(log(tmp_path, log_of(record, extra, motors=signal)), vehicle=VEHICLE)
    places = [f'rotor{k}' for k in range(1, 5)]
    truth = 2500 * signal[:, np.array(ORDER) - 1]
    np.testing.assert_allclose(read.stack(*places), truth, atol=0.1)
    np.testing.assert_allclose(read.stack(*CMD), truth, atol=2.0)
    assert 'rpm of esc_status' in notes(read)


def test_odometry_does_where_the_other_topics_are_missing(tmp_path):
    stamps = np.round(SMALL.t * 1e6).astype(int) + FIRST
    q = ned_attitude(SMALL.stack('qw', 'qx', 'qy', 'qz'))
    rows = np.hstack([ned(SMALL.stack('px', 'py', 'pz')), q, ned(SMALL.stack('vx', 'vy', 'vz')),
                      frd(SMALL.stack('wx', 'wy', 'wz'))]).astype('<f4')
    samples = [('vehicle_odometry', 0, int(stamp), row.tobytes() + b'\1')
               for stamp, row in zip(stamps, rows, strict=True)]
    read = load(log(tmp_path, ulog(samples, FORMATS)))
    for names in (('px', 'py', 'pz'), ('vx', 'vy', 'vz'), ('wx', 'wy', 'wz')):
        np.testing.assert_allclose(read.stack(*names), SMALL.stack(*names), atol=1e-6)


@pytest.mark.parametrize('field, frame, own', [
    ('pose_frame', 2, True), ('local_frame', 1, True), ('pose_frame', 1, False)])
def test_an_odometry_of_another_heading_has_its_own_attitude(tmp_path, field, frame, own):
    """Visual odometry starts at any heading, and vehicle_attitude has that of the compass."""
    turn = np.array([np.cos(0.5), 0.0, 0.0, np.sin(0.5)])     # 1 rad to the left
    stamps = np.round(SMALL.t * 1e6).astype(int) + FIRST
    q = product(turn, SMALL.stack('qw', 'qx', 'qy', 'qz'))
    place, speed = (rotate(turn, SMALL.stack(*names)) for names in (('px', 'py', 'pz'),
                                                                    ('vx', 'vy', 'vz')))
    rows = np.hstack([ned(place), ned_attitude(q), ned(speed)]).astype('<f4')
    samples = [one for one in px4_samples(SMALL) if one[0] != 'vehicle_local_position']
    samples += [('vehicle_odometry', 0, int(stamp), row.tobytes() + bytes([frame]))
                for stamp, row in zip(stamps, rows, strict=True)]
    fields = ('uint64_t timestamp', 'uint64_t timestamp_sample', 'float[3] position', 'float[4] q',
              'float[3] velocity', f'uint8_t {field}')
    read = load(log(tmp_path, ulog(sorted(samples, key=lambda one: one[2]),
                                   {**FORMATS, 'vehicle_odometry': fields})))
    np.testing.assert_allclose(read.stack('px', 'py', 'pz'), place[:len(read)], atol=1e-6)
    expected = (q if own else SMALL.stack('qw', 'qx', 'qy', 'qz'))[:len(read)]
    off = np.sum(read.stack('qw', 'qx', 'qy', 'qz') * expected, axis=1)
    np.testing.assert_allclose(np.abs(off), 1.0, atol=1e-6)


@pytest.mark.parametrize('named, first, said', [
    ({'MAV_TYPE': 22}, None, 'VTOL'), ({'MAV_TYPE': 1}, None, 'fixed wing'),
    ({}, status(FIRST, kind=2), 'fixed wing'), ({}, status(FIRST, vtol=True), 'VTOL'),
    ({'MAV_TYPE': 10}, None, 'rover')])
def test_other_vehicles_are_told_and_refused(tmp_path, named, first, said):
    path = log(tmp_path, log_of(SMALL, [first] if first else [], named=named))
    refused(path, said, 'multirotor')
    assert contents_of(path)[1]


def test_the_time_armed_and_not_landed_is_kept(tmp_path):
    record = flight(seconds=20.0, noise=0.0)
    extra = [status(FIRST, False), status(FIRST + 2_000_000), landed(FIRST, True),
             landed(FIRST + 4_000_000, False), landed(FIRST + 15_000_000, True)]
    [read] = load_all(log(tmp_path, log_of(record, extra)))
    assert read.t[0] == pytest.approx(4.0) and read.t[-1] == pytest.approx(14.99)
    assert read.info['start_ns'] == 9_000_000_000
    assert 'kept: t = 4.00 to 14.99 s' in notes(read) and 'armed and not landed' in notes(read)
    np.testing.assert_allclose(read.columns['px'], record.columns['px'][400:1500], atol=1e-6)


def test_flights_between_landings_are_told_apart(tmp_path):
    record = flight(seconds=20.0, noise=0.0)
    downs = [(0, True), (1, False), (7, True), (8, False), (9, True), (10, False)]
    extra = [status(FIRST), *(landed(FIRST + 1_000_000 * at, down) for at, down in downs)]
    path = log(tmp_path, log_of(record, extra))
    one, other = load_all(path)
    assert (one.t[0], other.t[0]) == (pytest.approx(1.0), pytest.approx(10.0))
    assert '1 flight shorter than 4 s' in notes(one)
    assert one.info['name'] != other.info['name'] and str(path) in one.info['source']


def test_a_log_without_a_flight_is_refused(tmp_path):
    refused(log(tmp_path, log_of(SMALL, [status(FIRST, False)])), 'never armed')


def test_slow_topics_name_the_profile(tmp_path):
    record = flight(seconds=4.0, noise=0.0)
    read = load(log(tmp_path, log_of(record, motors=controls(record), every=10)),
                vehicle=VEHICLE)
    assert 'vehicle_local_position at 10 Hz' in notes(read) and 'SDLOG_PROFILE' in notes(read)
    assert 'actuator_motors at' not in notes(read)


def reset_log(record, at, by):
    """Return a log whose position is reset by metres to the north at times (s)."""
    samples, count, moved = [], 0, 0.0
    for topic, instance, stamp, values in px4_samples(record):
        if topic == 'vehicle_local_position':
            delta = 0.0
            if count < len(at) and stamp >= FIRST + at[count] * 1e6:
                delta, moved, count = by[count], moved + by[count], count + 1
            row = np.array([values[0] + moved, *values[1:], delta, 0.0], '<f4')
            values = row.tobytes() + bytes([count])
        samples.append((topic, instance, stamp, values))
    return ulog(samples, {**FORMATS, 'vehicle_local_position': POSITION})


def test_the_record_is_split_where_the_estimator_was_reset(tmp_path):
    record = flight(seconds=20.0, noise=0.0)
    path = log(tmp_path, reset_log(record, [6.0, 7.0, 15.0], [0.5, -2.0, 0.01]))
    one, other = load_all(path)
    assert one.t[-1] == pytest.approx(5.99) and other.t[0] == pytest.approx(7.0)
    assert other.t[-1] == pytest.approx(19.99)
    assert 'position was reset by 0.5 m at t = 5.99' in notes(one)
    assert '1 part shorter than 4 s' in notes(one) and 'by less than its noise' in notes(other)


def counted(record, topic, rows, fields, counts):
    """Return a log with samples of a topic: rows (N, k) of floats and their counter, uint8."""
    stamps = np.round(record.t * 1e6).astype(int) + FIRST
    samples = [one for one in px4_samples(record) if one[0] != 'vehicle_local_position']
    samples += [(topic, 0, int(stamp), np.asarray(row, '<f4').tobytes() + bytes([int(count)]))
                for stamp, row, count in zip(stamps, rows, counts, strict=True)]
    return ulog(sorted(samples, key=lambda one: one[2]),
                {**FORMATS, topic: ('uint64_t timestamp', 'uint64_t timestamp_sample', *fields)})


@pytest.mark.slow
@pytest.mark.parametrize('topic', ['vehicle_odometry', 'estimator_local_position'])
def test_resets_count_of_the_topic_that_the_position_is_from(tmp_path, topic):
    """A step of 0.8 m, less than a jump that shows in the data; the attitude has its topic."""
    record = flight(seconds=20.0, noise=0.0)
    late = record.t >= 9.0
    place, speed = ned(record.stack('px', 'py', 'pz')), ned(record.stack('vx', 'vy', 'vz'))
    place[late, 0] += 0.8
    q = ned_attitude(record.stack('qw', 'qx', 'qy', 'qz'))
    odometry = 'float[3] position', 'float[4] q', 'float[3] velocity', 'uint8_t reset_counter'
    rows, fields = (([place, q, speed], odometry) if topic == 'vehicle_odometry' else
                    ([place, speed, np.where(np.diff(late, prepend=False), 0.8, 0.0)[:, None],
                      0 * late[:, None]], POSITION[2:]))
    one, other = load_all(log(tmp_path, counted(record, topic, np.hstack(rows), fields, late)))
    assert one.t[-1] == pytest.approx(8.99) and other.t[0] == pytest.approx(9.0)
    assert ('odometry was reset' if 'odometry' in topic else 'reset by 0.8 m') in notes(one)


def test_a_stamp_that_is_there_twice_hides_no_reset(tmp_path):
    record = flight(seconds=20.0, noise=0.0)
    data = reset_log(record, [9.0], [0.8])
    twice = FIRST + 2_010_000
    data = data.replace(struct.pack('<QQ', twice, twice),
                        struct.pack('<QQ', twice, twice - 10_000))
    assert len(load_all(log(tmp_path, data))) == 2


@pytest.mark.slow
def test_a_diagnosis_tells_of_commands_profile_estimates_and_resets(tmp_path):
    record = flight(seconds=20.0, noise=0.0)
    parts = load_all(log(tmp_path, reset_log(record, [6.0], [2.0])), None, VEHICLE)
    assert 'reset by 2 m at t = 5.99 s' in joined(parts)[0].info['resets']
    slow = load(log(tmp_path, log_of(record, motors=controls(record), every=10)), vehicle=VEHICLE)
    for read in (slow, *joined([part(slow, 0, 50), part(slow, 60, len(slow))])):
        told = {one['code']: one['message'] for one in cautions(read, VEHICLE)}
        assert 'CA_ROTOR' in told['commands'] and 'SDLOG_PROFILE' in told['logging']


def test_contents_are_what_is_logged(tmp_path):
    path = log(tmp_path, log_of(SMALL, [status(FIRST)], motors=controls(SMALL)))
    title, found = contents_of(path)
    topics = {content.name: content for content in found}
    assert 'PX4' in title and topics['vehicle_attitude'].roles == ('attitude',)
    assert topics['actuator_motors'].samples == len(SMALL)
    assert topics['vehicle_attitude'].rate == pytest.approx(100)
    assert topics['vehicle_attitude'].duration == pytest.approx(0.99)
    assert 'q[4]' in topics['vehicle_attitude'].fields


def test_messages_from_before_the_clock_was_set_stand_at_the_start(tmp_path):
    epoch = 1_700_000_000_000_000      # us: all but the status have a clock that GPS has set
    samples = [(topic, instance, epoch + stamp, values)
               for topic, instance, stamp, values in px4_samples(SMALL)]
    data = bytearray(ulog([status(0), *samples], FORMATS, parameters()))
    data[8:16] = epoch.to_bytes(8, 'little')
    _, found = contents_of(log(tmp_path, bytes(data)))
    starts = {content.name: content.start for content in found}
    assert starts['vehicle_status'] == 0.0 and all(0 <= start < 60 for start in starts.values())


def test_auto_writes_a_vehicle_file_and_asks_for_the_rest(tmp_path, capsys):
    record = flight(seconds=6.0, noise=0.0)
    path = log(tmp_path, log_of(record, motors=controls(record, 'thrust'),
                                named=parameters(THR_MDL_FAC=1.0)))
    call = ['convert', str(path), str(tmp_path / 'o.csv'), '--vehicle', 'auto']
    assert main(call) == 2
    said = capsys.readouterr().err
    file = tmp_path / 'log_vehicle.yaml'
    assert str(file) in said and 'mass' in said and 'inertia' in said and said.count('\n') == 1
    data = yaml.safe_load(file.read_text())
    assert [rotor['spin'] for rotor in data['rotors']] == [1, 1, -1, -1]
    assert data['rotors'][0]['position'] == [0.12, -0.12, 0]
    assert main(call) == 2 and 'still empty' in capsys.readouterr().err
    text = file.read_text().replace('mass: ', 'mass: 0.5 ').replace(
        '[null, null, null]', '[0.003, 0.003, 0.005]')
    file.write_text(text)
    assert main(call) == 0
    assert file.read_text() == text
    # Thrust by the file's speeds carries what the accelerometer felt.
    thrust = np.sum(load(tmp_path / 'o.csv').stack(*CMD) ** 2, axis=1)
    force = load(tmp_path / 'o.csv').columns['az']
    assert np.std(thrust / force) / np.mean(thrust / force) < 0.05


@pytest.mark.parametrize('named, first', [({'MAV_TYPE': 1}, None), ({}, status(FIRST, kind=2))])
def test_auto_tells_what_is_no_multirotor(tmp_path, capsys, named, first):
    """A fixed wing has no CA_ROTOR, either: that is not what is wrong."""
    path = log(tmp_path, log_of(SMALL, [first] if first else [], named=named))
    assert main(['convert', str(path), str(tmp_path / 'o.csv'), '--vehicle', 'auto']) == 2
    assert 'fixed wing' in capsys.readouterr().err


def test_info_shows_a_log_whose_vehicle_file_is_empty(tmp_path, capsys):
    record = flight(seconds=6.0, noise=0.0)
    path = log(tmp_path, log_of(record, motors=controls(record)))
    for said in ('written with what the log knows', 'still empty'):
        assert main(['info', str(path), '--vehicle', 'auto']) == 0
        shown = capsys.readouterr().out
        assert said in shown and 'vehicle_attitude' in shown and 'excitation' in shown


def test_fit_takes_the_vehicle_file_beside_a_log(tmp_path, capsys):
    path = log(tmp_path, log_of(SMALL, motors=controls(SMALL)))
    assert main(['fit', str(path), '--vehicle', 'auto', '--free', 'inertia']) == 2
    assert str(tmp_path / 'log_vehicle.yaml') in capsys.readouterr().err


def test_on_a_full_disk_no_part_of_a_vehicle_file_stays(tmp_path, capsys):
    path = log(tmp_path, log_of(SMALL, motors=controls(SMALL)))
    with file_size_limit(64):
        assert main(['diagnose', str(path), '--vehicle', 'auto']) == 2
    assert 'log_vehicle.yaml: cannot be written: File too large' in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [path]


def test_a_diagnosis_without_a_vehicle_says_what_the_log_could_fill_in(tmp_path, capsys):
    path = log(tmp_path, log_of(SMALL, motors=controls(SMALL)))
    assert main(['diagnose', str(path)]) == 2
    said = capsys.readouterr().err
    assert said.count('\n') == 1 and '--vehicle auto' in said and 'mass and inertia' in said
    assert str(tmp_path / 'log_vehicle.yaml') in said
    (tmp_path / 'f.csv').write_text('t,pz\n0,1\n1,2\n')
    assert main(['diagnose', str(tmp_path / 'f.csv')]) == 2
    said = capsys.readouterr().err
    assert '--vehicle FILE' in said and 'auto' not in said


@pytest.mark.slow
def test_auto_tells_no_thrust_that_the_log_itself_set(tmp_path, capsys, monkeypatch):
    """The thrust coefficient then follows from the weight: a factor on it comes out as 1."""
    record = flight(seconds=6.0, noise=0.0)
    path = log(tmp_path, log_of(record, motors=controls(record, 'thrust'),
                                named=parameters(THR_MDL_FAC=1.0)))
    info = ['info', str(path), '--vehicle', 'auto', '--json', '-']
    assert main(info) == 0
    file = tmp_path / 'log_vehicle.yaml'
    text = file.read_text().replace('mass: ', 'mass: 0.5 ').replace(
        '[null, null, null]', '[0.003, 0.003, 0.005]')
    capsys.readouterr()
    given = []

    def taken(records, *_, **__):
        given.extend(records)
        raise InputError('enough')

    monkeypatch.setattr('quad_ident_ros.cli.diagnose.diagnose', taken)
    for known in (False, True):
        file.write_text(text.replace('thrust_coefficient: ', 'thrust_coefficient: 1e-5 ')
                        if known else text)
        assert main(info) != 2, capsys.readouterr().err
        told = [one['message'] for one in json.loads(capsys.readouterr().out)['findings']
                if one['code'] == 'thrust_level']
        assert ['thrust coefficient is not known' in one for one in told] == [True] * (not known)
        assert main(['diagnose', str(path), '--vehicle', 'auto']) == 2
        assert track_of(given[-1], VEHICLE).levelled is not known


def test_auto_is_for_logs_of_px4(tmp_path, capsys):
    (tmp_path / 'f.csv').write_text('t,pz\n0,1\n1,2\n')
    assert main(['convert', str(tmp_path / 'f.csv'), str(tmp_path / 'o.csv'), '--vehicle',
                 'auto']) == 2
    assert 'PX4' in capsys.readouterr().err


@pytest.mark.slow
def test_mutated_logs_are_read_or_refused_in_a_line(tmp_path):
    chance = random.Random(3)
    extra = [status(FIRST), landed(FIRST, False), esc(FIRST + 1000, [500.0] * 4),
             esc(FIRST + 60_000, [500.0] * 4)]
    short = flight(seconds=0.1, noise=0.0)
    whole = log_of(short, extra, motors=controls(short), named=parameters(TURNED))
    for _ in range(300):
        data = bytearray(whole)
        for _ in range(chance.choice((1, 2, 5))):
            at = chance.randrange(16, len(data))
            if chance.random() < 0.7:
                data[at] = chance.randrange(256)
            else:
                del data[at:at + chance.choice((1, 3, 40))]
        path = log(tmp_path, bytes(data))
        for use in (lambda path: load_all(path, None, VEHICLE), contents_of):
            try:
                use(path)
            except InputError as error:
                assert len(str(error).splitlines()) == 1 and str(path) in str(error)


@pytest.mark.skipif(SHARED is None, reason='the real logs are not there: shared/flights')
def test_a_real_log_is_cut_to_its_flight():
    path = Path(SHARED) / 'px4_logs' / 'sample_px4_events.ulg'
    [read] = load_all(path, None, load_vehicle('iris'))
    assert 10 < read.t[-1] - read.t[0] < 13 and read.has(*CMD, 'rotor4')
    assert 'SDLOG_PROFILE' in notes(read) and 'rpm of esc_status' in notes(read)
    for name in ('sample', 'sample_logging_tagged_and_default_params'):
        refused(path.with_name(f'{name}.ulg'), 'never armed')


def test_shares_of_thrust_without_a_curve_in_the_parameters_are_told(tmp_path):
    """THR_MDL_FAC is 0 both where the speed is linear in the signal and where thrust is."""
    record = flight(seconds=4.0, noise=0.0)
    for curve, known in (('linear', False), ('thrust', True)):
        path = log(tmp_path, log_of(record, motors=controls(record, curve)))
        found = [one for one in findings(load(path, vehicle=VEHICLE), VEHICLE)
                 if one.code == 'thrust_curve']
        assert len(found) == known
        assert all('kind: normalised, curve: thrust' in one.remedy for one in found)
