# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Order, spin, number and limits of the rotors, by what their commands do."""

from dataclasses import replace
from itertools import permutations, product
import json

from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest
from quality_records import CMD, codes, named
from real import needs_real_flights, real_flight, real_vehicle
from scipy.spatial.transform import Rotation

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.data.quality import cautions, findings, refuted
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.source import Source


@pytest.mark.parametrize('order', [p for p in permutations(range(4)) if p != (0, 1, 2, 3)])
def test_every_wrong_order_of_the_rotors_is_found_and_named(order):
    record = flight()
    names = [CMD[k] for k in order]
    [finding] = findings(changed(record, **named(CMD, record.stack(*names))), VEHICLE)
    assert finding.code == 'rotor_order'
    assert f'rotors {", ".join(str(k + 1) for k in order)} of' in finding.message


@pytest.mark.parametrize('columns', [{'cmd4': None}, {'cmd5': flight().columns['cmd1']}])
def test_the_commands_of_another_vehicle_are_found(columns):
    [finding] = findings(changed(flight(), **columns), VEHICLE)
    assert finding.code == 'rotor_count' and finding.severity == 'error'


@pytest.mark.parametrize('lost', ['cmd1', 'cmd3'])
def test_measured_speeds_do_not_hide_that_a_command_is_missing(lost):
    record = flight()
    speeds = named([f'rotor{j}' for j in range(1, 5)], record.stack(*CMD))
    record = changed(record, **{lost: None}, **speeds)
    [finding] = [one for one in findings(record, VEHICLE) if one.code == 'rotor_count']
    assert finding.severity == 'error' and finding.where == lost
    with pytest.raises(InputError, match=f'{lost}: missing: .* 3 of the 4 rotors'):
        diagnose([record, flight(seed=2)], VEHICLE)


@pytest.mark.slow
@needs_real_flights
@pytest.mark.parametrize('name', ['star_fast', 'oval_fast'])
def test_wrong_orders_are_found_in_real_flights(name):
    record = real_flight(name)
    vehicle = real_vehicle()
    for order in permutations(range(4)):
        mixed = changed(record, **named(CMD, record.stack(*[CMD[k] for k in order])))
        found = [f for f in findings(mixed, vehicle) if f.code == 'rotor_order']
        said = [f'rotors {", ".join(str(k + 1) for k in order)} of' in f.message for f in found]
        assert said == ([] if order == (0, 1, 2, 3) else [True])


@pytest.mark.parametrize('spins', [spins for spins in product((1, -1), repeat=4)
                                   if spins != (1, -1, 1, -1)])
def test_every_wrong_set_of_spins_is_found(spins):
    wrong = replace(VEHICLE, rotors=tuple(replace(rotor, spin=spin) for rotor, spin in
                                          zip(VEHICLE.rotors, spins, strict=True)))
    [finding] = findings(flight(), wrong)
    assert finding.code == 'rotor_spin'
    assert str([rotor.spin for rotor in VEHICLE.rotors]) in finding.message


@pytest.mark.parametrize('wrong, said', [
    ({'mass': 500.0}, 'beyond its speed_max'), ({'mass': 0.0005}, 'below its speed_min'),
    ({'thrust_coefficient': 1.2e-6 / 91, 'speed_max': 1700.0}, 'beyond its speed_max'),
    ({'speed_max': 178.0}, 'beyond its speed_max'), ({'speed_max': 1e6}, '% of its speed_max')])
def test_a_vehicle_that_cannot_hover_is_found(wrong, said):
    vehicle = replace(VEHICLE, **wrong)
    [finding] = [finding for finding in findings(flight(), vehicle) if finding.code == 'hover']
    assert finding.severity == 'error' and said in finding.message and 'kg' in finding.remedy
    with pytest.raises(InputError, match='half_kilogram would hover at'):
        fly_closed_loop(vehicle, {}, 'hover', duration=10.0)


@pytest.mark.parametrize(('arms', 'inertia'), [(100.0, 1.0), (1000.0, 1.0), (1.0, 1e3),
                                               (1.0, 1e4)],
                         ids=['cm', 'mm', 'g m^2', 'kg cm^2'])
def test_arms_or_inertia_in_another_unit_are_found(arms, inertia):
    wrong = replace(VEHICLE, inertia=tuple(inertia * one for one in VEHICLE.inertia), rotors=tuple(
        replace(rotor, position=tuple(arms * one for one in rotor.position))
        for rotor in VEHICLE.rotors))
    [found] = [one for one in findings(flight(), wrong) if one.code == 'vehicle_size']
    assert found.severity == 'error' and 'kg m^2' in found.remedy
    [found] = [one for one in findings(flight(), replace(VEHICLE, mass=1000.0 * VEHICLE.mass))
               if one.code == 'vehicle_size']
    assert 'mass in kg' in found.remedy
    assert not [one for one in findings(flight(), VEHICLE) if one.code == 'vehicle_size']


def of_size(mass, arms):
    """Return VEHICLE with a mass (kg) and arms (m) of any size, and inertia alike."""
    grown = arms / VEHICLE.arm_length
    return replace(
        VEHICLE, mass=mass, inertia=tuple(one * mass / VEHICLE.mass * grown ** 2
                                          for one in VEHICLE.inertia),
        rotors=tuple(replace(rotor, position=tuple(grown * one for one in rotor.position))
                     for rotor in VEHICLE.rotors))


@pytest.mark.parametrize(('mass', 'arms', 'said'), [
    (0.5, 17.0, 'less than any vehicle that flies'), (0.5, 170.0, 'less than any'),
    (500.0, 0.17, 'more than solid metal'), (27.0, 0.046, 'more than solid metal'),
    (1.5, 50.0, 'less than any')],
    ids=['kg cm^2', 'kg mm^2', 'g m^2', 'small, g m^2', 'arms of 50 m'])
def test_units_that_go_together_and_are_not_SI_are_found(mass, arms, said):
    [found] = [one for one in findings(flight(), of_size(mass, arms))
               if one.code == 'vehicle_size']
    assert found.severity == 'error' and said in found.message and 'in kg' in found.remedy


@pytest.mark.parametrize(('mass', 'arms'), [
    (0.01, 0.02), (0.027, 0.046), (50.0, 0.9), (600.0, 2.5), (1500.0, 6.0), (128.0, 13.0)],
    ids=['toy', 'Crazyflie', 'sprayer', 'taxi', 'large taxi', 'human-powered'])
def test_no_size_of_vehicle_is_too_small_or_too_large(mass, arms):
    assert 'vehicle_size' not in codes(flight(), of_size(mass, arms))


def test_saturated_commands_are_found():
    limit = 1080.0
    record = flight()
    clipped = np.minimum(record.stack(*CMD), limit)
    [finding] = findings(changed(record, **named(CMD, clipped)),
                         replace(VEHICLE, speed_max=limit))
    assert finding.code == 'saturation' and 'speed_max = 1080' in finding.message
    share = float(finding.message.split(' %')[0])
    assert share == pytest.approx(100 * (clipped >= limit - 2.0).any(axis=1).mean(), abs=0.3)


@pytest.mark.slow
def test_an_order_that_another_flight_refutes_is_a_warning():
    """Rotors do not change places: one flight that shows the order is right speaks for all."""
    right = replace(flight(), info={**flight().info, 'name': 'right'})
    wrong = changed(flight(), **named(CMD, flight().stack('cmd2', 'cmd1', 'cmd3', 'cmd4')))
    wrong = replace(wrong, info={**wrong.info, 'name': 'wrong'})
    assert refuted([wrong], VEHICLE) == refuted([wrong, wrong], VEHICLE) == ()
    with pytest.raises(InputError, match='rotors 2, 1, 3, 4'):
        cautions(wrong, VEHICLE, refuted([wrong, wrong], VEHICLE))
    [said] = [one for one in cautions(wrong, VEHICLE, refuted([wrong, right], VEHICLE))
              if one['code'] == 'rotor_order']
    assert said['severity'] == 'warning' and said['flight'] == 'wrong'
    assert cautions(right, VEHICLE, refuted([wrong, right], VEHICLE)) == []


@pytest.mark.slow
def test_the_order_that_a_mapping_has_to_give_is_named(tmp_path):
    """Outputs of another order, which the lines of the remedy put into that of the rotors."""
    record = flight()
    logged = record.stack('cmd2', 'cmd3', 'cmd1', 'cmd4')
    table = {**{name: values for name, values in record.columns.items() if name not in CMD},
             't': record.t, **named(('m1', 'm2', 'm3', 'm4'), logged)}
    path = tmp_path / 'f.csv'
    np.savetxt(path, np.column_stack(list(table.values())), delimiter=',', comments='',
               header=','.join(table))
    [found] = [one for one in findings(load(path, vehicle=VEHICLE), VEHICLE)
               if one.code == 'rotor_order']
    order = json.loads(found.remedy.rpartition('order: ')[2])
    mapped = mapping_from({'actuators': {'kind': 'speed', 'order': order}}, 'a test')
    read = load(path, mapped, VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), record.stack(*CMD)[:len(read)], rtol=1e-9)


def mirrored(vehicle):
    return replace(vehicle, rotors=tuple(replace(rotor, spin=-rotor.spin)
                                         for rotor in vehicle.rotors))


@pytest.mark.slow
def test_a_flight_that_hardly_yaws_says_nothing_of_the_spins():
    vehicle = load_vehicle('hummingbird')
    straight, turning = (fly_closed_loop(vehicle, {}, name, duration=20.0, seed=1,
                                         noise=SENSORS['mocap_imu'])
                         for name in ('low_passes', 'lissajous'))
    assert 'rotor_spin' in refuted([straight, turning], vehicle)
    wrong = mirrored(vehicle)
    told = refuted([straight, turning], wrong)
    assert 'rotor_order' in told and 'rotor_spin' not in told
    with pytest.raises(InputError, match='spins'):
        cautions(turning, wrong, told)


@pytest.mark.slow
def test_a_slow_turn_tells_the_spins_through_the_noise_of_a_gyro():
    vehicle = load_vehicle('hummingbird')
    record = fly_closed_loop(vehicle, {}, 'lissajous', duration=20.0, seed=1)
    noise = 0.05 * np.random.default_rng(0).normal(size=len(record))
    noisy = changed(record, wz=record.columns['wz'] + noise)
    assert 'rotor_spin' in [one.code for one in findings(noisy, mirrored(vehicle))]
    assert 'rotor_spin' not in [one.code for one in findings(noisy, vehicle)]


@pytest.mark.slow
@pytest.mark.parametrize('leak', [0.6, 1.0])
def test_spins_that_explain_most_of_the_yaw_are_no_error_for_what_other_moments_add(leak):
    """A moment about z that goes with the roll looks like other spins of a hexacopter, too."""
    quad = load_vehicle('hummingbird')
    angles = np.pi / 6 + np.pi / 3 * np.arange(6)
    places = quad.arm_length * np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])
    vehicle = replace(quad, name='hexacopter', rotors=tuple(
        replace(quad.rotors[0], position=tuple(place.tolist()), spin=(1, -1)[k % 2])
        for k, place in enumerate(places)))
    record = fly_closed_loop(vehicle, {}, 'lissajous', duration=20.0, seed=1,
                             noise=SENSORS['mocap_imu'])
    rolled = changed(record, wz=record.columns['wz'] + leak * record.columns['wx'])
    [said], [wrong] = ([one.severity for one in findings(rolled, file) if one.code == 'rotor_spin']
                       for file in (vehicle, mirrored(vehicle)))
    assert said == 'warning' and wrong == 'error'


OTHER = replace(VEHICLE, name='other', mass=1.5, speed_max=2500.0,
                inertia=tuple(7 * one for one in VEHICLE.inertia))
"""A vehicle of three times the mass, whose rotors have the same places."""


@pytest.mark.slow
@pytest.mark.parametrize('thrust', [0.4, 2.5])
def test_a_vehicle_file_of_another_vehicle_is_told_by_its_thrust(thrust):
    wrong = replace(VEHICLE, thrust_coefficient=thrust * VEHICLE.thrust_coefficient,
                    speed_max=2500.0)
    [finding] = findings(flight(), wrong)
    assert finding.code == 'other_vehicle' and finding.severity == 'warning'
    ratio = float(finding.message.split(' times')[0].rpartition(' ')[2])
    assert ratio == pytest.approx(thrust, rel=0.05)
    # Where the file says so itself, it is the vehicle that flew.
    known = replace(wrong, effects={'thrust_scale': {'factor': 1.0 / thrust}})
    assert findings(flight(), known) == ()


@pytest.mark.parametrize('low, high, what', [
    (1000, 2000, 'PWM, 1000 to 2000'), (0, 1, 'normalised, 0 to 1'), (0, 100, 'per cent'),
    (0, 65535, 'duty, 0 to 65535')])
def test_signals_in_the_columns_of_speeds_are_told_and_the_remedy_reads_them(
        tmp_path, low, high, what):
    vehicle = load_vehicle('hummingbird')
    flown = fly_closed_loop(vehicle, {}, 'figure8', duration=6.0, seed=2)
    signals = low + (high - low) * flown.stack(*CMD) / vehicle.speed_max
    signals = np.round(signals) if high > 2000 else signals
    found = findings(changed(flown, **named(CMD, signals)), vehicle)
    told = [one for one in found if f'signals to the motors ({what}' in one.remedy]
    assert told and 'output1 to output4' in told[0].remedy
    path = tmp_path / 'flight.csv'
    write_csv(path, changed(flown, **dict.fromkeys(CMD), **{
        f'output{k}': column for k, column in enumerate(signals.T, 1)}))
    np.testing.assert_allclose(load(path, vehicle=vehicle).stack(*CMD), flown.stack(*CMD),
                               atol=0.05)


@pytest.mark.parametrize('thrust', [0.6, 1.6])
def test_a_payload_or_a_battery_makes_no_other_vehicle(thrust):
    file = replace(VEHICLE, thrust_coefficient=thrust * VEHICLE.thrust_coefficient,
                   speed_max=2500.0)
    assert findings(flight(), file) == ()


@pytest.mark.slow
def test_info_and_diagnose_say_the_same_of_another_vehicle(tmp_path, capsys):
    """A warning, or where the rotors are in other places as well an error, of the same words."""
    paths = [str(tmp_path / f'{name}.csv') for name in 'ab']
    for seed, path in enumerate(paths):
        write_csv(path, flight(seconds=12.0, seed=seed))
    write_vehicle(tmp_path / 'other.yaml', OTHER)
    vehicle = ['--vehicle', str(tmp_path / 'other.yaml')]
    assert main(['info', paths[0], *vehicle]) == 0
    [line] = [line for line in capsys.readouterr().out.splitlines() if '[other_vehicle]' in line]
    assert line.startswith('warning: vehicle file: the commands give 0.33 times the thrust')
    said = line.partition(': ')[2].partition(';')[0]
    assert main(['diagnose', *paths, *vehicle, '--effects', 'rotor_drag']) == 0
    printed = capsys.readouterr().out
    assert said in printed and 'Next: check the vehicle file' in printed
    turned = replace(OTHER, rotors=tuple(OTHER.rotors[k] for k in (2, 0, 3, 1)))
    write_vehicle(tmp_path / 'other.yaml', turned)
    assert main(['info', paths[0], *vehicle]) == 3
    line = next(line for line in capsys.readouterr().out.splitlines() if line.startswith('error'))
    assert '[other_vehicle]' in line and 'in other places' in line
    assert main(['diagnose', *paths, *vehicle]) == 2
    said = line.partition(': ')[2].removesuffix(' [other_vehicle]')
    assert said in capsys.readouterr().err


def test_a_hover_with_the_file_of_a_heavier_vehicle_is_not_just_on_the_ground():
    record = fly_closed_loop(load_vehicle('hummingbird'), {}, 'hover', duration=10.0)
    [found] = [one for one in findings(record, load_vehicle('iris')) if one.code == 'ground']
    assert 'never carry iris' in found.message and '--vehicle' in found.remedy


def precessing(hertz, late):
    """Return a record of VEHICLE, whose tilt goes round, with states stamped late by so many s."""
    rate, fine = 100.0, 10
    t = np.arange(1000) / rate

    def turn(at):
        return np.column_stack([np.cos(2.0 * np.pi * hertz * at), np.sin(2.0 * np.pi * hertz * at),
                                0.3 * np.sin(0.7 * at)])

    attitude, q = Rotation.identity(), []
    for k in range(len(t) * fine):
        if k % fine == 0:
            q.append(attitude.as_quat())
        attitude *= Rotation.from_rotvec(turn(np.array([(k + 0.5) / (rate * fine)]))[0]
                                         / (rate * fine))
    at = t + 0.5 / rate + late
    inertia, spins = np.array(VEHICLE.inertia), [rotor.spin for rotor in VEHICLE.rotors]
    moment = (inertia * (turn(at + 1e-4) - turn(at - 1e-4)) / 2e-4
              + np.cross(turn(at), inertia * turn(at)))
    positions = np.array([rotor.position for rotor in VEHICLE.rotors])
    kf, km = VEHICLE.thrust_coefficient, VEHICLE.torque_coefficient
    effect = np.stack([np.full(4, kf), kf * positions[:, 1], -kf * positions[:, 0],
                       km * np.array(spins)])
    weight = np.full(len(t), VEHICLE.mass * VEHICLE.gravity)
    squared = np.linalg.solve(effect, np.column_stack([weight, moment]).T)
    return FlightRecord(t, {**named(('qx', 'qy', 'qz', 'qw'), np.array(q)),
                            **named(('wx', 'wy', 'wz'), turn(t)),
                            **named(CMD, np.sqrt(squared).T)}, {'name': 'precessing'})


@pytest.mark.slow
@pytest.mark.parametrize('hertz', [1.6, 2.5])
@pytest.mark.parametrize('late', [-0.06, 0.0, 0.06])
def test_a_clock_that_is_off_is_no_other_order_of_the_rotors(hertz, late):
    """Where the tilt goes round, rotors moved on by one act as a quarter of a turn later."""
    assert 'rotor_order' not in [one.code for one in findings(precessing(hertz, late), VEHICLE)]


@pytest.mark.slow
@pytest.mark.parametrize(('size', 'code'), [(2.0, 'saturation'), (0.6, 'other_vehicle')])
def test_rotor_speeds_beside_a_simulator_whose_commands_are_thrusts_are_told_from_them(size, code):
    """Its file has no speeds; one that stands for the most thrust is taken, and is not theirs."""
    full = VEHICLE.mass * VEHICLE.gravity / 2       # N of a rotor, twice that of hover
    gear = '\n'.join(f'<motor site="s{k}" gear="0 0 1 0 0 {0.02 * rotor.spin}" '
                     f'ctrlrange="0 {full}"/>' for k, rotor in enumerate(VEHICLE.rotors))
    sites = '\n'.join(f'<site name="s{k}" pos="{" ".join(map(str, rotor.position))}"/>'
                      for k, rotor in enumerate(VEHICLE.rotors))
    moments = ' '.join(map(str, VEHICLE.inertia))
    vehicle = read_vehicle(Source('quad.xml', f"""<mujoco><worldbody><body><freejoint/>
<inertial pos="0 0 0" mass="{VEHICLE.mass}" diaginertia="{moments}"/>{sites}</body></worldbody>
<actuator>{gear}</actuator></mujoco>""")).vehicle
    record = flight()
    table = record.stack(*CMD) * size * vehicle.hover_speed / VEHICLE.hover_speed
    record = replace(record, columns={**record.columns, **named(CMD, table)})
    [said] = [one.remedy for one in findings(record, vehicle) if one.code == code]
    assert said.endswith('take its motors out: the speeds that it has only stand for thrusts')
    other = replace(vehicle, motors=None)
    assert not any('take its motors out' in one.remedy for one in findings(record, other))


def test_a_thrust_coefficient_per_rpm_squared_is_refused_with_its_unit():
    per_rpm = replace(VEHICLE, thrust_coefficient=VEHICLE.thrust_coefficient * (np.pi / 30.0) ** 2,
                      speed_max=np.inf)
    [found] = [one for one in findings(flight(), per_rpm) if one.code == 'thrust']
    assert 'the thrust coefficient in N/(rad/s)^2' in found.remedy
