# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Streams that are stamped late: the offset is found, and they are aligned again."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from quad_ident_ros.data.aligned import (
    aligned,
    lateness,
    later_than_first,
    mean_if_alike,
    Offset,
    STREAMS,
)
from quad_ident_ros.data.clocks import on_one_clock
from quad_ident_ros.data.differentiated import with_motion
from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.quality.answer import answer_of
from quad_ident_ros.data.record import QUATERNION
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import Noise, Sensors, Stream
from quad_ident_ros.greybox.fit import fit
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
FINE = Sensors(white=Noise(position=1e-5, velocity=1e-4, attitude=1e-5, rate=1e-4, force=1e-3))
USUAL = Sensors(white=Noise(position=7e-4, velocity=7e-3, attitude=1.4e-3, rate=7e-3))
DRAG = {'rotor_drag': {'coefficient': 0.15}}
LATE = [{'pose': 0.023}, {'velocity': 0.012}, {'rate': 0.0043},
        {'pose': 0.017, 'velocity': 0.03}, {'velocity': 0.008, 'rate': 0.015}]


def late(record, offsets):
    """Return a record as if streams {name: s} were stamped later than the others."""
    columns, there = dict(record.columns), np.ones(len(record), bool)
    for stream, offset in offsets.items():
        for name in STREAMS[stream]:
            if record.has(name):
                columns[name] = np.interp(record.t - offset, record.t, columns[name])
        there &= record.t - offset >= record.t[0]
    return replace(record, t=record.t[there],
                   columns={name: values[there] for name, values in columns.items()})


def moved_back(record):
    """Return a record that is the only one, aligned, and {stream: s that it was stamped late}."""
    [told] = lateness([record])
    return aligned(record, told)


def flown(seed=0, noise=USUAL, truth=None, course='lissajous'):
    return fly_closed_loop(VEHICLE, truth or {}, course, duration=12.0, seed=seed, noise=noise)


@pytest.mark.parametrize('offsets', LATE, ids=str)
def test_how_late_a_stream_is_stamped_is_told_and_it_is_moved_back(offsets):
    record = flown(noise=FINE)
    back, told = moved_back(late(record, offsets))
    assert told.keys() == offsets.keys()
    for stream, offset in offsets.items():
        assert told[stream] == pytest.approx(offset, abs=3e-4)
    # The first rows of a late stream are of before the record, its last ones are not there yet.
    same = np.isin(record.t, back.t)
    assert same.sum() > len(record) - 20
    for name in ('px', 'vx', *QUATERNION, 'wx', 'wy'):
        was, speed = record.columns[name][same], np.gradient(record.columns[name], record.t)
        assert np.abs(back.columns[name] - was).max() < 2e-3 * np.abs(speed).max() + 1e-3


@pytest.mark.slow
def test_a_record_of_one_clock_is_left_as_it_is():
    for seed in range(5):
        record = flown(seed)
        assert moved_back(record) == (record, {})


def test_lost_rows_and_jumps_of_the_attitude_do_not_reach_their_neighbours():
    record = late(flown(noise=FINE), {'pose': 0.02})
    columns = dict(record.columns)
    jumped = np.zeros(len(record), bool)
    jumped[[200, 500, 800]] = True
    for name in QUATERNION:
        columns[name] = np.where(jumped, columns[{'qw': 'qx', 'qx': 'qw'}.get(name, name)],
                                 columns[name])
    lost = np.ones(len(record), bool)
    lost[300:306] = False
    faulty = replace(record, t=record.t[lost],
                     columns={name: values[lost] for name, values in columns.items()})
    whole, _ = moved_back(record)
    back, told = moved_back(faulty)
    assert told['pose'] == pytest.approx(0.02, abs=5e-4)
    assert len(faulty) - 20 < len(back) < len(faulty)
    both = np.intersect1d(whole.t, back.t)
    apart = [record.stack(*QUATERNION)[np.isin(record.t, both)] for record in (whole, back)]
    assert np.abs(apart[1] - apart[0]).max() < 0.01


@pytest.mark.parametrize('seed', range(6))
def test_jumps_of_the_attitude_make_no_stream_late(seed):
    record = flown(seed, replace(USUAL, mocap=Stream(delay=0.02)))
    rng = np.random.default_rng(seed)
    jumped = rng.random(len(record)) < 0.01
    turns = Rotation.from_rotvec(0.35 * rng.normal(size=(len(record), 3)) * jumped[:, None])
    attitude = Rotation.from_quat(record.stack('qx', 'qy', 'qz', 'qw')) * turns
    columns = dict(zip(('qx', 'qy', 'qz', 'qw'), attitude.as_quat().T, strict=True))
    [told] = lateness([replace(record, columns={**record.columns, **columns})])
    assert told.keys() == {'pose', 'velocity'}      # motion capture gives both
    assert told['pose'] == pytest.approx(0.02, abs=2e-3)


@pytest.mark.parametrize('share', [0.1, 0.2])
def test_lost_rows_take_no_others_with_them(share):
    record = flown(0, replace(USUAL, mocap=Stream(delay=0.02), lost=share))
    back, told = moved_back(record)
    assert told.keys() == {'pose', 'velocity'}
    assert len(back) > 0.97 * len(record)


def test_a_rate_that_changes_along_the_flight_leaves_no_part_out():
    record = flown(0, replace(USUAL, mocap=Stream(delay=0.02)))
    rows = np.r_[:500, 500:len(record):2]
    slower = replace(record, t=record.t[rows],
                     columns={name: values[rows] for name, values in record.columns.items()})
    assert len(moved_back(slower)[0]) > len(slower) - 5


@pytest.mark.parametrize('gone', ['velocity', 'rate'])
def test_a_stream_that_is_not_there_is_not_moved(gone):
    record = flown(0, replace(USUAL, mocap=Stream(delay=0.02)))
    columns = {name: values for name, values in record.columns.items()
               if name not in STREAMS[gone]}
    record = replace(record, columns=columns)
    assert gone not in moved_back(record)[1]


def test_a_stream_whose_offset_cannot_be_told_stays_where_it_is():
    """In hover the attitude does not say when the rate is of."""
    record = flown(0, USUAL)
    still = {name: np.full(len(record), value) for name, value in
             zip((*QUATERNION, 'wx', 'wy', 'wz'), (1, 0, 0, 0, 0, 0, 0), strict=True)}
    record = late(record, {'pose': 0.02})
    still = {name: values[:len(record)] for name, values in still.items()}
    [told] = lateness([replace(record, columns={**record.columns, **still})])
    assert told.keys() == {'pose'}


def told(value, std):
    """Return the Offset that one flight shows, in ms."""
    return Offset(1e-3 * value, 1e-3 * std, 1e-3 * std)


def test_the_mean_of_flights_weighs_them_by_their_precision():
    mean = mean_if_alike([told(4.0, 0.5), told(5.0, 1.0)])
    assert mean.value == pytest.approx((4.0 * 4.0 + 5.0) / 5.0 * 1e-3)
    assert mean.std == pytest.approx(1e-3 / np.sqrt(5.0))
    # What may be alike in both does not become less: it is between that of the one and the other.
    assert mean.by_motion == pytest.approx((4.0 * 0.5 + 1.0) / 5.0 * 1e-3)


def test_flights_that_show_nothing_hide_no_offset_that_one_of_them_shows():
    clear, vague = told(2.0, 0.35), told(0.8, 5.0)
    assert clear.clear and not vague.clear
    for count in (1, 3, 11):
        mean = mean_if_alike([clear, *count * [vague]])
        assert mean.clear and mean.value == pytest.approx(2e-3, rel=0.1)


@pytest.mark.parametrize('value, std, count, clear', [
    (4.0, 1.0, 1, False), (6.0, 1.0, 1, True), (4.0, 1.0, 4, True), (3.0, 1.0, 4, False),
    (2.4, 1.0, 100, True), (1.9, 1.0, 100, False), (0.4, 0.01, 1, False)])
def test_flights_together_show_what_each_of_them_does_not(value, std, count, clear):
    """Five standard errors of one; of many the two that the motion may make in all alike."""
    assert mean_if_alike(count * [told(value, std)]).clear is clear


def test_offsets_that_scatter_more_than_chance_lets_them_are_of_several_clocks():
    rng, agreed = np.random.default_rng(0), 0
    for _ in range(400):
        agreed += mean_if_alike([told(4.0 + rng.normal(), 1.0) for _ in range(3)]) is not None
    assert 0.92 < agreed / 400 < 0.98
    assert mean_if_alike([told(0.0, 1.0), told(9.0, 1.0)]) is None
    assert mean_if_alike([told(0.0, 0.01), told(0.3, 0.01)]) is not None    # too small to matter
    assert mean_if_alike([]) is None


def test_velocity_and_rate_of_one_clock_have_the_better_known_offset():
    one = later_than_first({'rate': told(-20.5, 0.5), 'velocity': told(-20.0, 0.1)})
    assert one == {'pose': pytest.approx(0.02002, abs=1e-5)}
    two = later_than_first({'rate': told(4.0, 0.1), 'velocity': told(0.1, 0.1)})
    assert two == {'rate': pytest.approx(0.004)}
    assert later_than_first({'rate': told(4.0, 0.1)}) == {'rate': pytest.approx(0.004)}
    assert later_than_first({}) == {}


def faint(record):
    """Return a record whose attitude is too noisy to say by itself that 6 ms are an offset."""
    turns = 0.015 * np.random.default_rng(len(record)).normal(size=(len(record), 3))
    attitude = Rotation.from_quat(record.stack('qx', 'qy', 'qz', 'qw')) * Rotation.from_rotvec(
        turns)
    return replace(record, columns=record.columns | dict(
        zip(('qx', 'qy', 'qz', 'qw'), attitude.as_quat().T, strict=True)))


@pytest.fixture(scope='module')
def of_a_late_gyro():
    """Flights whose gyro is 6 ms late, of which the last one does not show it by itself."""
    sensors = replace(USUAL, imu=Stream(delay=0.006))
    *clear, last = [flown(k, sensors, None, course)
                    for k, course in enumerate(('figure8', 'lissajous', 'figure8'))]
    return [*clear, faint(last)]


def test_what_flights_show_together_holds_for_one_that_does_not_show_it(of_a_late_gyro):
    assert lateness(of_a_late_gyro[-1:]) == [{}]
    told = lateness(of_a_late_gyro)
    assert told[0] == told[1] == told[2]
    assert told[0] == {'rate': pytest.approx(0.006, abs=5e-4)}


def test_a_flight_that_is_held_out_has_no_part_in_the_offsets_of_the_others(of_a_late_gyro):
    *clear, last = of_a_late_gyro
    told = lateness(clear)
    # It gets theirs, where it does not speak against it, and keeps its own where it does.
    assert lateness(clear, [last]) == [*told, told[0]]
    other = late(clear[0], {'rate': 0.02})
    *same, own = lateness(clear, [other])
    assert same == told and own == lateness([other])[0]
    assert own['rate'] == pytest.approx(0.026, abs=1e-3)


def test_a_rate_that_was_made_of_the_attitude_shows_no_clock(of_a_late_gyro):
    *clear, last = of_a_late_gyro
    made = with_motion(replace(last, columns={name: values for name, values in last.columns.items()
                                              if name not in STREAMS['rate'][:3]}))
    assert lateness([*clear, made]) == [*lateness(clear), {}]


@pytest.mark.slow
def test_a_flight_with_commands_is_asked_for_their_clock_unless_its_own_streams_are_apart():
    sensors = replace(USUAL, imu=Stream(delay=0.006))
    flights = [flown(0, sensors, None, 'figure8'), faint(flown(1, sensors, None, 'lissajous'))]
    for (_, late_by, answer), record in zip(on_one_clock(flights), flights, strict=True):
        own = lateness([record])[0]
        assert late_by == {'rate': pytest.approx(0.006, abs=5e-4)}
        assert answer is None if own else answer == answer_of(record)


def test_flights_whose_offsets_differ_keep_their_own(of_a_late_gyro):
    first, second, _ = of_a_late_gyro
    other = late(second, {'rate': 0.02})
    assert lateness([first, other]) == [*lateness([first]), *lateness([other])]


@pytest.mark.slow
@pytest.mark.parametrize('sensors, stream, offset, truth', [
    (replace(USUAL, imu=Stream(delay=0.006)), 'rate', 0.006, {}),
    (replace(USUAL, mocap=Stream(delay=0.02)), 'pose', 0.02, DRAG),
    (USUAL, 'velocity', 0.02, {}), (USUAL, 'velocity', 0.02, DRAG)],
    ids=['rate-none', 'pose-drag', 'velocity-none', 'velocity-drag'])
def test_a_stream_that_is_late_changes_no_verdict(sensors, stream, offset, truth):
    flights = [flown(k, sensors, truth, course)
               for k, course in enumerate(('figure8', 'low_passes', 'lissajous'))]
    if stream == 'velocity':    # the others come from one sensor each
        flights = [late(flight, {stream: offset}) for flight in flights]
    data = diagnose(flights, VEHICLE).as_data()
    assert data['verdict'] == (list(truth) or ['none'])
    # The slow passes show it to less than a millisecond, and no better.
    assert np.ravel(data['nuisances'][f'{stream}_clock']['values']) == pytest.approx(
        offset, abs=0.0025)
    assert data['gap']['after']['velocity'] < 1.15 * data['gap']['noise']['velocity']


def test_a_late_rate_is_not_taken_for_the_lag_of_motors():
    lagging = {'motor_lag': {'time_constant': 0.03}}
    record = flown(0, replace(USUAL, imu=Stream(delay=0.006)), lagging, 'figure8')
    [parameter] = fit([moved_back(record)[0]], VEHICLE, ['motor_lag']).parameters
    assert parameter.value == pytest.approx(0.03, abs=4 * parameter.std)


@pytest.mark.slow
@pytest.mark.parametrize('stream, where', [('velocity', 'position against velocity'),
                                           ('rate', 'attitude and position against gyro')])
def test_info_says_which_streams_are_apart(stream, where):
    found = [one for one in findings(late(flown(), {stream: 0.02})) if one.code == 'clock_offset']
    assert where in [one.where for one in found]
    assert all(one.severity == 'warning' for one in found)
    assert not [one for one in findings(flown()) if one.code == 'clock_offset']
