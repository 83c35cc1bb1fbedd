# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Time on the ground: reported, and left out of a diagnosis."""

from dataclasses import replace
import json

import numpy as np
import pytest
from standing import after_another, brisk, hover_of, standing_first, VEHICLE, WITHOUT, without

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.quality.ground import airborne, resting, standing, stands
from quad_ident_ros.data.quality.timing import gaps
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import CLEAN, MOCAP_IMU

STAND = 2.0     # s


def grounded(flight, before=STAND, after=STAND, idle=0.3):
    """Return a flight between two times on the ground, 1 m below it, with rotors that idle."""
    period = flight.period()
    pads = [int(before / period), int(after / period)]
    columns = {}
    rng = np.random.default_rng(5)
    for name, values in flight.columns.items():
        rest = 1.0 if name == 'qw' else 0.0
        if name.startswith('cmd'):
            rest = idle * hover_of(VEHICLE)
        if name == 'pz':
            rest = float(values.min()) - 1.0
        if name == 'vbat':
            rest = float(values[0])
        sigma = 0.0 if name.startswith(('cmd', 'vbat')) else 1e-3
        columns[name] = np.concatenate([
            rest + sigma * rng.standard_normal(pads[0]), values,
            rest + sigma * rng.standard_normal(pads[1])])
    t = flight.t[0] + period * np.arange(len(flight) + sum(pads))
    return FlightRecord(t, columns, dict(flight.info))


@pytest.fixture(scope='module')
def flight():
    return fly_closed_loop(VEHICLE, {}, 'lissajous', duration=12.0, seed=3, noise=MOCAP_IMU)


def test_a_flight_without_ground_is_left_as_it_is(flight):
    assert not standing(flight, VEHICLE).any()
    assert airborne(flight, VEHICLE) is flight
    assert stands(flight, VEHICLE) == []


def test_ground_on_both_sides_is_cut_off_and_told(flight):
    whole = grounded(flight)
    part = airborne(whole, VEHICLE)
    assert len(part) == len(flight)
    assert np.array_equal(part.columns['pz'], flight.columns['pz'])
    [finding] = stands(whole, VEHICLE)
    assert '4.0 s' in finding.message and finding.severity == 'warning'


def test_the_battery_has_been_emptying_since_the_record_began(flight):
    whole = grounded(flight)
    assert airborne(whole, VEHICLE).info['began'] == whole.t[0]


def test_of_two_flights_in_one_record_those_of_4_s_are_kept(flight):
    both = after_another(grounded(flight.slice(0, 500)), grounded(flight, before=0.0))
    kept = airborne(both, VEHICLE)
    assert len(kept) == 500 + len(flight) and kept.info['name'] == 'both'
    assert np.diff(kept.t).max() == pytest.approx(2.0, abs=0.02)
    [finding] = stands(both, VEHICLE)
    assert '6.0 s' in finding.message and finding.message.count(' to ') == 2
    both = after_another(grounded(flight.slice(0, 350)), grounded(flight, before=0.0))
    assert len(airborne(both, VEHICLE)) == len(flight)


def test_time_on_the_ground_between_two_parts_is_no_gap_of_the_record(flight):
    both = after_another(grounded(flight), grounded(flight, before=0.0))
    kept = airborne(both, VEHICLE)
    assert gaps(kept, VEHICLE) == []
    lost = kept.slice(0, len(flight) // 2)
    rest = kept.slice(len(flight) // 2 + 60)
    assert len(gaps(FlightRecord(np.append(lost.t, rest.t), {
        'pz': np.append(lost.columns['pz'], rest.columns['pz'])}, kept.info), VEHICLE)) == 1


def lifted(flight, seconds, height=1.5, throw=0.0):
    """
    Return a flight after it was carried to its place, with rotors that stand still.

    throw: m/s of the speed upward with which it is let go; it comes to rest where the flight
    begins.
    """
    g, period = VEHICLE.gravity, flight.period()
    t = np.arange(0.0, seconds, period)
    speed, fall = height * np.pi / seconds, throw / g
    held = t < seconds - fall
    up = 0.5 * speed * np.sin(np.pi * t / (seconds - fall)) * held
    swing = np.exp(-((t - (seconds - fall)) / 0.15) ** 2) * held       # the arm speeds it up
    up += throw * swing + np.where(held, 0.0, throw - g * (t - (seconds - fall)))
    z = np.cumsum(up) * period
    values = {'vz': up, 'pz': z - z[-1] + flight.columns['pz'][0], 'qw': 1.0 + 0 * t,
              'vbat': flight.columns['vbat'][0] + 0 * t,
              'px': flight.columns['px'][0] + 0 * t, 'py': flight.columns['py'][0] + 0 * t}
    random = np.random.default_rng(6)
    columns = {name: values.get(name, 0 * t) + (
        0.0 if name.startswith(('cmd', 'vbat')) else 1e-3 * random.standard_normal(len(t)))
        for name in flight.columns}
    return after_another(FlightRecord(t, columns), flight)


def test_a_vehicle_that_is_carried_to_its_place_does_not_fly_there(flight):
    whole = lifted(flight, seconds=6.0)
    assert np.abs(whole.columns['vz'][:600]).max() > 0.3
    kept = airborne(whole, VEHICLE)
    # The flight begins with a hover at the height at which it was held.
    assert 5.8 < kept.t[0] < 7.5 and kept.t[-1] == whole.t[-1]
    [finding] = stands(whole, VEHICLE)
    assert f'the parts in flight are kept: t = {kept.t[0]:.3f} to' in finding.message


def test_a_flight_begins_where_the_vehicle_is_thrown(flight):
    """A throw is no flight; the fall after it, with rotors that stand still, is one."""
    whole = lifted(flight, seconds=4.0, throw=5.0)
    kept = airborne(whole, VEHICLE)
    assert 4.0 - 5.0 / VEHICLE.gravity <= kept.t[0] + 0.02 <= 4.0
    assert kept.t[0] < 3.8


def test_rotors_that_spin_up_on_the_ground_do_not_fly(flight):
    whole = grounded(flight, before=3.0)
    first = round(3.0 / flight.period())
    ramp = np.clip((whole.t - 1.0) / 2.0, 0.3, 1.0) * hover_of(VEHICLE)
    spun = {f'cmd{j}': np.where(np.arange(len(whole)) < first, ramp, whole.columns[f'cmd{j}'])
            for j in range(1, 5)}
    assert airborne(changed(whole, **spun), VEHICLE).t[0] == pytest.approx(3.0, abs=0.011)


def test_what_lies_after_a_crash_is_carried_by_the_ground(flight):
    """It slides and turns, so that it stands nowhere, and its motors are off."""
    t = flight.t
    wild = {'vx': 0.5 * np.sin(3 * t), 'vy': 0.4 * np.cos(4 * t), 'vz': 0 * t,
            **{f'cmd{j}': 0 * t for j in range(1, 5)}}
    whole = after_another(flight, changed(flight, **wild))
    assert airborne(whole, VEHICLE).t[-1] == pytest.approx(flight.t[-1], abs=0.2)


@pytest.mark.parametrize('trajectory', ['vertical', 'figure8', 'chirp_z'])
def test_no_manoeuvre_is_taken_for_being_carried(trajectory):
    whole = fly_closed_loop(VEHICLE, {'rotor_drag': {'coefficient': 0.2}}, trajectory,
                            duration=12.0, seed=4, noise=MOCAP_IMU)
    assert not resting(whole, VEHICLE).any()
    half = replace(VEHICLE, thrust_coefficient=0.4 * VEHICLE.thrust_coefficient)
    assert not resting(whole, half).any()       # a vehicle file that is wrong by far


def test_a_hover_is_no_standing():
    hover = fly_closed_loop(VEHICLE, {}, 'hover', duration=8.0, seed=3, noise=MOCAP_IMU)
    assert not standing(hover, VEHICLE).any()


def changed(flight, **columns):
    return FlightRecord(flight.t, {**flight.columns, **columns}, dict(flight.info))


def test_what_is_held_in_a_hand_above_the_flight_is_no_flight(flight):
    whole = grounded(flight, after=0.0)
    held = np.arange(len(whole)) < len(whole) - len(flight)
    whole = changed(whole, pz=np.where(held, flight.columns['pz'].max() + 1.5,
                                       whole.columns['pz']))
    assert len(airborne(whole, VEHICLE)) == len(flight)


def low_flight(noise=CLEAN, rate=100.0):
    """Return a flight at the height of the stands before and after it, as from a hand."""
    flown = fly_closed_loop(VEHICLE, {}, 'circle', duration=12.0, rate=rate, seed=3, noise=noise)
    assert np.ptp(flown.columns['pz']) < 0.1
    whole = grounded(flown, idle=0.0)
    pad = (len(whole) - len(flown)) // 2
    height = np.concatenate([np.full(pad, flown.columns['pz'][0]), flown.columns['pz'],
                             np.full(pad, flown.columns['pz'][-1])])
    return replace(whole, columns={**whole.columns, 'pz': height})


def kept_whole(record):
    """Return whether a flight of low_flight is kept."""
    part = airborne(record, VEHICLE)
    return (part.t[0] == pytest.approx(STAND, abs=1.0)
            and part.t[-1] == pytest.approx(STAND + 12.0, abs=1.0))


@pytest.mark.parametrize('noise', [CLEAN, MOCAP_IMU], ids=['clean', 'mocap_imu'])
def test_a_flight_at_the_height_of_the_stand_is_kept(noise):
    """From a hand, a stand or a string, along a path that does not change its height."""
    assert kept_whole(low_flight(noise))


@pytest.mark.parametrize('rate', [250.0, 500.0])
@pytest.mark.parametrize('kind', ['noise', 'held'])
def test_no_noise_of_a_fast_log_is_a_blow(rate, kind):
    whole = low_flight(rate=rate)
    rows, random = np.arange(len(whole)), np.random.default_rng(7)
    held = rows // round(rate / 30.0) * round(rate / 30.0)
    changed_to = {name: whole.columns[name] + 0.05 * random.standard_normal(len(whole))
                  if kind == 'noise' else whole.columns[name][held] for name in ('vx', 'vy')}
    part = airborne(changed(whole, **changed_to), VEHICLE)
    assert len(part) > 10.0 * rate


@pytest.mark.parametrize('rows', [1, 2, 5, 10])
def test_a_glitch_of_the_velocity_is_no_blow(rows):
    whole = low_flight()
    glitch = (whole.t > 6.0) & (whole.t < 6.0 + 0.01 * rows - 0.005)
    assert kept_whole(changed(whole, vx=whole.columns['vx'] + 3.0 * glitch))


def test_a_bump_in_a_stand_is_no_landing():
    whole = low_flight()
    bump = (whole.t > 0.5) & (whole.t < 0.6)
    speed = np.where(bump, 12.0 * (whole.t - 0.5), whole.columns['vx'])
    assert kept_whole(changed(whole, vx=speed))


@pytest.mark.parametrize('strikes', [True, False])
def test_what_has_struck_the_ground_slides_on_it_whatever_its_rotors_do(flight, strikes):
    """A landing at 2 m/s and a slide with the thrust of a hover, or a flight as low as that."""
    slide = flight.slice(0, 300)
    t, last = slide.t - slide.t[0], {name: float(values[-1])
                                     for name, values in flight.columns.items()}
    speed = 0.4 + 0.1 * np.sin(3.0 * t)
    still = {'vx': speed, 'pz': last['pz'] + 0.01 * np.sin(9.0 * t) - 0.05,
             **{f'cmd{j}': np.full(len(t), hover_of(VEHICLE)) for j in range(1, 5)},
             **dict.fromkeys(('vy', 'vz', 'wx', 'wy', 'wz', 'qx', 'qy', 'qz'), 0.0 * t),
             'qw': 1.0 + 0.0 * t}
    fast = flight.columns['vx'].copy()
    fast[-60:] = np.linspace(fast[-61], 2.0 if strikes else speed[0], 60)
    lands = after_another(changed(flight, vx=fast), changed(slide, **still))
    rest = {name: np.full(200, value[-1] if name.startswith(('p', 'q')) else 0.0)
            for name, value in lands.columns.items()}
    stand = FlightRecord(flight.period() * np.arange(200), {
        **rest, 'vbat': np.full(200, last['vbat'])})
    part = airborne(after_another(lands, stand), VEHICLE)
    assert len(part) == pytest.approx(len(flight) if strikes else len(lands), abs=10)


def test_a_hover_amid_brisk_flight_is_no_standing(flight):
    """Where most of a flight needs twice the weight, the weight is half of what is usual."""
    brisk = {f'cmd{j}': 1.5 * flight.columns[f'cmd{j}'] for j in range(1, 5)}
    hover = (flight.t > 4.0) & (flight.t < 6.0)
    still = {name: np.where(hover, 0.0, flight.columns[name]) for name in ('vx', 'vy', 'vz')}
    calm = {name: np.where(hover, hover_of(VEHICLE), values) for name, values in brisk.items()}
    assert not standing(changed(flight, **still, **calm), VEHICLE).any()


def test_lost_rows_are_no_time_on_the_ground(flight):
    low = np.isin(np.arange(len(flight)), (399, 450))
    columns = {f'cmd{j}': np.where(low, 0.1, 1.0) * flight.columns[f'cmd{j}']
               for j in range(1, 5)}
    columns |= {name: np.where(low, 0.0, flight.columns[name]) for name in ('vx', 'vy', 'vz')}
    slow = changed(flight, **columns)
    kept = np.r_[0:400, 450:len(flight)]
    gap = FlightRecord(slow.t[kept], {name: values[kept] for name, values in slow.columns.items()},
                       {})
    assert not standing(gap, VEHICLE).any()


def test_a_record_that_never_leaves_the_ground_is_refused(flight):
    whole = grounded(flight, before=12.0)
    pad = whole.slice(0, len(whole) - len(flight) - round(STAND / flight.period()))
    assert standing(pad, VEHICLE).all()
    [finding] = stands(pad, VEHICLE)
    assert finding.severity == 'error'
    with pytest.raises(InputError, match='on the ground all the time'):
        diagnose([pad], VEHICLE)


def test_a_flight_that_is_short_off_the_ground_is_refused_so(flight):
    with pytest.raises(InputError, match='3 s off the ground are too short'):
        diagnose([grounded(flight.slice(0, 300), before=10.0)], VEHICLE)


def test_a_part_that_begins_in_flight_does_not_begin_at_rest(flight):
    whole = grounded(flight)
    whole = FlightRecord(whole.t, whole.columns, {'starts_at_rest': True, 'start_ns': 5})
    info = airborne(whole, VEHICLE).info
    assert 'starts_at_rest' not in info and info['start_ns'] == 5 + round(STAND * 1e9)


def test_records_without_velocity_or_commands_are_left_as_they_are(flight):
    whole = grounded(flight)
    for gone in ('vx', 'cmd'):
        columns = {name: values for name, values in whole.columns.items()
                   if not name.startswith(gone)}
        assert not standing(FlightRecord(whole.t, columns, {}), VEHICLE).any()


@pytest.mark.slow
def test_a_verdict_does_not_change_by_time_on_the_ground(flight):
    flights = [fly_closed_loop(VEHICLE, {'motor_lag': {'time_constant': 0.03}}, 'lissajous',
                               duration=12.0, seed=seed, noise=MOCAP_IMU) for seed in (1, 2)]
    cut, whole = (diagnose(records, VEHICLE) for records in
                  (flights, [grounded(one) for one in flights]))
    assert cut.verdict == whole.verdict == ('motor_lag',)
    assert [one['code'] for one in whole.findings].count('ground') == 2
    row, other = (data.ranking[0].parameters['time_constant'] for data in (cut, whole))
    assert other.value == pytest.approx(row.value, abs=0.1 * row.std)


@pytest.mark.slow
def test_two_flights_with_a_landing_between_them_are_one_that_is_held_out_in_blocks():
    lag = {'motor_lag': {'time_constant': 0.03}}
    one, other = (fly_closed_loop(VEHICLE, lag, 'lissajous', duration=12.0, seed=seed,
                                  noise=MOCAP_IMU) for seed in (1, 2))
    found = diagnose([after_another(grounded(one), grounded(other, before=0.0))], VEHICLE)
    assert found.verdict == ('motor_lag',) and found.gap.closed > 0.8
    assert found.flights[0].startswith('both (half of') and 'other half' in found.held_out
    assert [one['code'] for one in found.findings].count('ground') == 1
    value = found.ranking[0].parameters['time_constant']
    assert abs(value.value - 0.03) < 4 * value.std


@pytest.mark.slow
def test_a_fit_leaves_the_ground_out_too(flight, tmp_path, capsys):
    whole = grounded(flight)
    height = np.maximum(whole.columns['pz'], flight.columns['pz'].min() - 0.3)     # no jump
    write_csv(tmp_path / 'f.csv', changed(whole, pz=height))
    write_csv(tmp_path / 'g.csv', flight)
    values = []
    for name in ('f.csv', 'g.csv'):
        assert main(['fit', str(tmp_path / name), '--vehicle', 'hummingbird', '--free',
                     'thrust_coefficient', '--json', '-']) == 0
        data = json.loads(capsys.readouterr().out)
        values.append(data['parameters']['thrust_coefficient']['value'])
        assert any('is on the ground or carried' in line for line in data['findings']) == (
            name == 'f.csv')
    assert values[0] == pytest.approx(values[1], rel=1e-3)


@pytest.mark.parametrize('known', WITHOUT)
@pytest.mark.parametrize('spin_up', [0.0, 1.0])
@pytest.mark.parametrize('idle', [0.0, 0.3])
def test_standing_before_a_flight_is_cut_and_nothing_of_it_without_position(known, spin_up, idle):
    whole = without(standing_first(brisk(), spin_up, idle), WITHOUT[known])
    assert not resting(without(brisk(), WITHOUT[known]), VEHICLE).any()
    kept = airborne(whole, VEHICLE)
    # The last fifth of the thrust is reached in the last eighth of the spin-up,
    # and what moves less than the noise of the sensors stands, as far as they know.
    assert 3.0 + 0.85 * spin_up - 0.011 < kept.t[0] < 3.0 + spin_up + 0.15
    assert kept.t[-1] == whole.t[-1]
    [finding] = stands(whole, VEHICLE)
    assert f'the parts in flight are kept: t = {kept.t[0]:.3f} to' in finding.message


@pytest.mark.parametrize('known', ['velocity', 'accelerometer and gyro'])
def test_what_the_ground_holds_while_motors_lag_does_not_fly(known):
    whole = without(standing_first(brisk(), lag=0.2), WITHOUT[known])
    assert 3.15 < airborne(whole, VEHICLE).t[0] < 3.35


def test_a_stand_that_is_longer_than_the_flight_is_no_flight():
    whole = without(standing_first(brisk()), WITHOUT['accelerometer and gyro'])
    stand = whole.slice(0, 600)
    for _ in range(6):      # 21 s for 8 s of flight
        whole = after_another(stand, whole)
    assert airborne(whole, VEHICLE).t[0] == pytest.approx(21.0, abs=0.2)


def test_a_start_that_fails_is_no_flight():
    """It turns on the ground a little, and its motors stop for less than a rest takes."""
    stand = without(standing_first(brisk(), lag=0.2), WITHOUT['accelerometer and gyro']).slice(
        0, 640)
    turned = stand.columns['wz'] + 0.2 * (stand.t > 3.1)
    failed = changed(stand, wz=turned)
    again = without(standing_first(brisk(), idle=0.0), WITHOUT['accelerometer and gyro'])
    whole = after_another(failed, again.slice(600 - 40))
    assert airborne(whole, VEHICLE).t[0] == pytest.approx(3.4, abs=0.2)
