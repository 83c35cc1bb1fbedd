# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Outputs to the motors become rotor speed commands, whatever file they come from."""

from dataclasses import replace

from blackbox_files import blackbox, rows_of
from dataflash_files import copter, dataflash
from flightmaker import flight, VEHICLE
import numpy as np
import pytest
from usd_files import crazyflie_events, usdlog
import yaml

from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import Actuators, Mapping
from quad_ident_ros.data.outputs import commanded
from quad_ident_ros.data.quality import cautions, findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.signal_kind import kinds_of
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.parameters import INDEX, prior_sizes
from quad_ident_ros.model.motors import KINDS, Motors, motors_from
from quad_ident_ros.model.vehicle import load_vehicle

FLIGHT = flight(seconds=4.0, noise=0.0)
CMD, OUTPUTS = ('cmd1', 'cmd2', 'cmd3', 'cmd4'), ('output1', 'output2', 'output3', 'output4')
SPEEDS = FLIGHT.stack(*CMD)
SHARES = (SPEEDS - 100) / 1600      # of VEHICLE's speeds, 100 to 1700 rad/s
FAST = replace(VEHICLE, thrust_coefficient=VEHICLE.thrust_coefficient / 9, speed_min=300.0,
               speed_max=5100.0)    # hovers at the same share, far from the size of PWM in rad/s
TURNED = replace(VEHICLE, rotors=(*VEHICLE.rotors[1:], VEHICLE.rotors[0]))


def with_outputs(tmp_path, outputs, name='f.csv', **more):
    """Write FLIGHT as CSV with outputs in place of its commands; return the path."""
    columns = {key: values for key, values in FLIGHT.columns.items() if key not in CMD}
    columns |= {f'output{k}': column for k, column in enumerate(np.asarray(outputs).T, 1)} | more
    write_csv(tmp_path / name, FlightRecord(FLIGHT.t, columns))
    return tmp_path / name


def refused(path, *words, vehicle=VEHICLE):
    with pytest.raises(InputError) as error:
        load(path, vehicle=vehicle)
    message = str(error.value)
    assert message.startswith(str(path)) and '\n' not in message and len(message) < 500
    for word in words:
        assert word in message, message


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['normalised', 'percent', 'pwm', 'duty16'])
def test_the_kind_is_told_by_the_values_and_said(tmp_path, kind):
    low, high = KINDS[kind]
    values = low + SHARES * (high - low)
    read = load(with_outputs(tmp_path, np.round(values) if high > 1000 else values),
                vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, atol=1.0 if high > 100 else 1e-6)
    assert not read.has('output1')
    said = [one.message for one in findings(read, VEHICLE) if one.code == 'commands']
    assert len(said) == 1 and f'{low:g} to {high:g}, by their size' in said[0]
    assert 'speed in rad/s: 100 + 1600 x' in said[0]
    assert [one['code'] for one in cautions(read, VEHICLE)] == ['commands']


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['pwm', 'dshot'])
def test_pwm_and_dshot_of_the_same_size_are_told_by_hover_or_refused(tmp_path, kind):
    low, high = KINDS[kind]
    shares = np.maximum(SHARES, 0.4)
    path = with_outputs(tmp_path, np.round(low + shares * (high - low)))
    [said] = load(path, vehicle=FAST).info['commands']
    assert f'{low:g} to {high:g}, by their size' in said
    unknown = replace(FAST, speed_min=0.0, speed_max=np.inf)
    refused(path, 'could be PWM, 1000 to 2000 or DSHOT, 48 to 2047', vehicle=unknown)
    read = load(path, vehicle=replace(unknown, motors=Motors(kind, low, high)))
    assert read.has(*CMD)


def test_pwm_and_dshot_that_hover_alike_are_refused(tmp_path):
    heavy = replace(FAST, thrust_coefficient=0.4 * FAST.thrust_coefficient)
    values = np.round(1900 + 50 * np.sin(FLIGHT.t)[:, None] * np.ones(4))
    refused(with_outputs(tmp_path, values), 'PWM, 1000 to 2000 or DSHOT', vehicle=heavy)


@pytest.mark.slow
def test_signals_from_minus_one_to_one_are_not_taken_for_0_to_1(tmp_path):
    """Their lower half would read as motors that are off."""
    strong = replace(VEHICLE, speed_max=2500.0)
    path = with_outputs(tmp_path, (SPEEDS - 100) / 1200 - 1)
    refused(path, 'from -1 to 1, or from 0 to 1', 'motors: {kind: normalised, minimum: -1, '
            'maximum: 1} or motors: {kind: normalised, minimum: 0, maximum: 1}', vehicle=strong)
    told = Actuators(kind='normalised', minimum=-1.0, maximum=1.0)
    read = commanded([load(path)], strong, told)[0]
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=1e-9)
    motors = motors_from('v', {'kind': 'normalised', 'minimum': -1, 'maximum': 1})
    read = load(path, vehicle=replace(strong, motors=motors))
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=1e-9)


@pytest.mark.parametrize('signed', [False, True])
def test_signals_that_would_hover_from_minus_one_to_one_are_said_to(tmp_path, signed):
    """None of them is below 0, so that their range leaves both open; a vehicle that hovers."""
    fast = replace(VEHICLE, speed_max=1600.0)
    shares = (SPEEDS - fast.speed_min) / (fast.speed_max - fast.speed_min)
    path = with_outputs(tmp_path, 2 * shares - 1 if signed else shares)
    assert not signed or (2 * shares - 1).min() > 0
    said = load(path, vehicle=fast).info['commands'][-1]
    assert ('motors: {kind: normalised, minimum: -1, maximum: 1}' in said) == signed


@pytest.mark.slow
def test_signals_that_a_mixer_has_not_limited_are_read_by_the_line_for_them(tmp_path):
    """Those below 0 are motors that are off; the same message has the line for either."""
    values = (SPEEDS - 100) / 1600
    values[::10, 0] = -0.2
    path = with_outputs(tmp_path, values)
    refused(path, 'minimum: 0, maximum: 1}', vehicle=VEHICLE)
    told = Actuators(kind='normalised', minimum=0.0, maximum=1.0)
    read = commanded([load(path)], VEHICLE, told)[0].stack(*CMD)
    np.testing.assert_allclose(read[:, 1:], SPEEDS[:, 1:], rtol=1e-9)
    assert (read[::10, 0] == 0.0).all()


@pytest.mark.parametrize('factor', [1.0, 30 / np.pi])
def test_speeds_and_rpm_are_told_by_the_hover_speed(tmp_path, factor):
    read = load(with_outputs(tmp_path, SPEEDS * factor), vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=1e-9)


def test_without_a_vehicle_outputs_stay(tmp_path):
    path = with_outputs(tmp_path, SHARES)
    np.testing.assert_array_equal(load(path).stack(*OUTPUTS), SHARES)


def test_the_motors_of_the_vehicle_hold_before_what_values_tell(tmp_path):
    """A rotor's thrust is published as c0 + c1 u + c2 u^2: each speed comes at the u of it."""
    section = {'kind': 'duty16', 'thrust': [0.05, 0.3, 2.0]}
    vehicle = replace(VEHICLE, motors=motors_from('v', section))
    thrust = VEHICLE.thrust_coefficient * SPEEDS ** 2
    u = (-0.3 + np.sqrt(0.3 ** 2 + 4 * 2.0 * (thrust - 0.05))) / 4.0
    read = load(with_outputs(tmp_path, 65535 * u), vehicle=vehicle)
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=1e-9)
    assert 'thrust in N: 0.05 + 0.3 x + 2 x^2' in read.info['notes'][-1]
    assert 'by motors: of half_kilogram' in read.info['notes'][-1]


def test_a_map_that_hangs_on_the_voltage_needs_it(tmp_path):
    section = {'kind': 'percent', 'speed': {'offset': 100, 'gain': 1600},
               'voltage': {'reference': 12.0, 'exponent': 1}}
    vehicle = replace(VEHICLE, motors=motors_from('v', section))
    volts = np.linspace(12.6, 10.8, len(FLIGHT))
    path = with_outputs(tmp_path, 100 * SHARES, vbat=volts)
    read = load(path, vehicle=vehicle)
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS * volts[:, None] / 12.0, rtol=1e-9)
    columns = {key: values for key, values in load(path).columns.items() if key != 'vbat'}
    write_csv(tmp_path / 'no.csv', FlightRecord(FLIGHT.t, columns))
    refused(tmp_path / 'no.csv', 'motors: voltage:', 'no vbat', vehicle=vehicle)


def test_doubtful_values_are_refused_with_the_lines_to_write(tmp_path):
    slow = replace(VEHICLE, thrust_coefficient=0.5 * VEHICLE.thrust_coefficient)   # hovers at 1430
    path = with_outputs(tmp_path, 1000 + 1000 * SHARES)
    refused(path, 'could be PWM, 1000 to 2000 or rad/s', 'motors: {kind: pwm}',
            'actuators: {kind: pwm}', vehicle=slow)
    told = replace(slow, motors=Motors('pwm', 1000.0, 2000.0))
    np.testing.assert_allclose(load(path, vehicle=told).stack(*CMD), SPEEDS, rtol=1e-9)
    refused(with_outputs(tmp_path, 5000 * SHARES), 'are of no kind', 'minimum: ', 'maximum: ')


@pytest.mark.slow
def test_motors_that_are_not_those_of_the_record_are_refused(tmp_path):
    vehicle = replace(VEHICLE, motors=Motors('pwm', 1000.0, 2000.0))
    refused(with_outputs(tmp_path, np.round(65535 * SHARES)), 'pwm from 1000 to 2000',
            'duty16 by their size', vehicle=vehicle)
    refused(with_outputs(tmp_path, SHARES), 'normalised by their size', vehicle=vehicle)
    for kind, high in (('duty16', 65535.0), ('percent', 100.0)):
        refused(with_outputs(tmp_path, SHARES), f'{kind} from 0 to', 'normalised by their size',
                vehicle=replace(VEHICLE, motors=Motors(kind, 0.0, high)))


def test_outputs_that_are_not_finite_are_motors_that_are_off():
    off = np.where(np.arange(len(FLIGHT)) % 2, np.inf, np.nan)
    record = FlightRecord(FLIGHT.t, {f'output{k}': column for k, column in
                                     enumerate(SHARES.T, 1)} | {'output2': off})
    [read] = commanded([record], VEHICLE)
    expected = SPEEDS.copy()
    expected[:, 1] = 0.0
    np.testing.assert_allclose(read.stack(*CMD), expected, rtol=1e-9)
    nothing = replace(record, columns=dict.fromkeys(OUTPUTS, off))
    for actuators in (None, Actuators((1, 2, 3, 4), 'normalised')):
        with pytest.raises(InputError, match='output1..4 hold no finite number') as caught:
            commanded([nothing], VEHICLE, actuators)
        assert len(str(caught.value).splitlines()) == 1


@pytest.mark.slow
def test_more_or_fewer_outputs_than_rotors_are_refused(tmp_path):
    refused(with_outputs(tmp_path, SHARES[:, :3]), '3 outputs for the 4 rotors')
    refused(with_outputs(tmp_path, np.hstack([SHARES, SHARES[:, :1]])), 'outputs 1, 2, 3, 4, 5',
            'actuators: {kind: normalised, order: [1, 2, 3, 4]}')
    # Channels that nothing is on are no motors.
    read = load(with_outputs(tmp_path, np.hstack([SHARES, 0 * SHARES])), vehicle=VEHICLE)
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=1e-9)


def test_motors_that_stand_are_left_as_they_are(tmp_path):
    read = load(with_outputs(tmp_path, 0 * SHARES), vehicle=VEHICLE)
    assert read.has('output1') and 'the motors do not turn' in read.info['notes'][-1]


PLACES = {'crazyflie': ((1, -1), (-1, -1), (-1, 1), (1, 1)),
          'betaflight': ((-1, -1), (1, -1), (-1, 1), (1, 1)),
          'ardupilot': ((1, -1), (-1, 1), (1, 1), (-1, -1))}
"""Where motors 1 to 4 are, forward and left, by the firmware."""


@pytest.mark.parametrize('vehicle', [VEHICLE, TURNED], ids=['as it is', 'turned'])
@pytest.mark.parametrize('name', PLACES)
def test_motors_are_matched_by_direction_where_the_log_knows_it(tmp_path, name, vehicle):
    """Each motor has an output that marks its place: the rotor there gets it."""
    places = PLACES[name]
    share = {place: 0.3 + 0.1 * k for k, place in enumerate(sorted(places))}
    wave = 0.02 * np.sin(5 * FLIGHT.t)[:, None]
    shares = np.array([share[place] for place in places]) + wave
    path = tmp_path / {'crazyflie': 'log00', 'betaflight': 'l.bbl', 'ardupilot': 'l.bin'}[name]
    path.write_bytes({
        'crazyflie': lambda: usdlog(crazyflie_events(FLIGHT, 65535 * shares)),
        'betaflight': lambda: blackbox(rows_of(FLIGHT, 48 + 1999 * shares)),
        'ardupilot': lambda: dataflash(copter(FLIGHT, 1000 + 1000 * shares))}[name]())
    read = load(path, vehicle=vehicle)
    found = np.median(read.stack(*CMD), axis=0)
    wanted = [100 + 1600 * share[tuple(np.sign(rotor.position[:2]))] for rotor in vehicle.rotors]
    np.testing.assert_allclose(found, wanted, atol=25)
    assert any('by their direction' in note for note in read.info['commands'])
    assert any('as the log has them' in note for note in read.info['commands'])


def test_kinds_without_a_vehicle_are_by_size_alone():
    kinds = {(0.1, 0.9): 'normalised', (1000, 1900): 'pwm', (0, 40000): 'duty16',
             (310.5, 820.2): 'speed', (5100.3, 9000.2): 'rpm', (12, 80): 'percent',
             (300, 1700): 'dshot'}
    for values, kind in kinds.items():
        assert kinds_of(np.array(values)) == (kind,)
    assert kinds_of(np.array([-1.0, 0.3, 0.9, -0.001])) == ('normalised',)
    assert kinds_of(np.array([-0.5, *199 * [0.4]])) == ('normalised',)      # a glitch
    assert kinds_of(np.zeros(3)) == () and kinds_of(np.array([np.nan, -1.0])) == ()


@pytest.mark.slow
def test_how_well_the_motors_are_known_says_nothing_of_commands_in_rad_s():
    """Nor where a mapping has the speeds: the map of the vehicle file had no part in them."""
    vehicle = replace(VEHICLE, motors=motors_from('v', {
        'kind': 'normalised', 'speed': {'offset': 100, 'gain': {'value': 1600, 'std': 16}}}))
    signals = {f'output{k}': column for k, column in enumerate(SHARES.T, 1)}
    bare = FlightRecord(FLIGHT.t, {name: values for name, values in FLIGHT.columns.items()
                                   if name not in CMD} | signals)
    speeds = Actuators(kind='normalised', speeds=(100.0, 1700.0))
    usual = prior_sizes(VEHICLE, RULES.prior_width)
    scale = INDEX['thrust_scale.factor']
    for records, std in (([FLIGHT], usual[scale]),
                         (commanded([bare], vehicle, speeds), usual[scale]),
                         (commanded([bare], vehicle), 2 * 16 / 1600)):
        np.testing.assert_allclose(records[0].stack(*CMD), SPEEDS, rtol=1e-9)
        taken = take_in(records, vehicle, None, RULES)
        assert prior_sizes(taken.vehicle, RULES.prior_width)[scale] == pytest.approx(std, rel=0.1)
    assert usual[scale] > 0.1


SHARES_OF_THRUST = (SPEEDS ** 2 - 100 ** 2) / (1700 ** 2 - 100 ** 2)


def curves(record, vehicle=VEHICLE):
    """Return the Findings that signals are shares of thrust."""
    return [found for found in findings(record, vehicle) if found.code == 'thrust_curve']


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['normalised', 'percent', 'pwm', 'duty16'])
def test_shares_of_thrust_that_were_taken_for_speeds_are_told_by_the_thrust(tmp_path, kind):
    low, high = KINDS[kind]
    for shares, known in ((SHARES_OF_THRUST, True), (SHARES, False)):
        values = low + shares * (high - low)
        path = with_outputs(tmp_path, np.round(values) if high > 1000 else values)
        found = curves(load(path, vehicle=VEHICLE))
        assert [one.severity for one in found] == ['error'] * known
        assert all(f'actuators: {{kind: {kind}, curve: thrust}}' in one.remedy for one in found)
    values = low + SHARES_OF_THRUST * (high - low)
    path = with_outputs(tmp_path, values)
    # As the remedy says it, in a mapping or in the vehicle file.
    told = replace(VEHICLE, motors=motors_from('v', {'kind': kind, 'thrust': {'exponent': 1}}))
    for read in (load(path, Mapping(actuators=Actuators(kind=kind, curve='thrust')), VEHICLE),
                 load(path, vehicle=told)):
        assert not curves(read)
        hover = np.median(SPEEDS)
        assert np.median(read.stack(*CMD)) == pytest.approx(hover, rel=0.01)


@pytest.mark.slow
def test_shares_of_thrust_as_pwm_are_not_taken_for_dshot(tmp_path):
    """Their size is that of DSHOT near hover; how the thrust changes with them is not."""
    weak = replace(VEHICLE, speed_max=float(SPEEDS.max()) * 1.2, speed_min=0.0)
    outputs = np.round(1000 + 1000 * (SPEEDS / weak.speed_max) ** 2)
    read = load(with_outputs(tmp_path, outputs), vehicle=weak)
    assert 'DSHOT' in str(read.info['commands'])
    [found] = curves(read, weak)
    assert 'kind: pwm, curve: thrust' in found.remedy


@pytest.mark.slow
def test_without_the_speed_at_full_signal_shares_of_thrust_are_told_as_well(tmp_path):
    unknown = replace(VEHICLE, speed_max=np.inf)
    for shares, known in ((SHARES_OF_THRUST, True), (SHARES, False)):
        read = load(with_outputs(tmp_path, shares), vehicle=replace(unknown, speed_min=0.0))
        assert len(curves(read, unknown)) == known


@pytest.mark.slow
def test_a_reading_that_thrust_does_not_follow_is_not_the_right_one():
    """Signals that are clipped in it tell nothing of it, least of all that it fits."""
    iris = load_vehicle('iris')
    effects = {'inflow': {'axial': 0.3 * iris.mass}, 'motor_lag': {'time_constant': 0.05}}
    record = fly_closed_loop(iris, effects, 'chirp_x', duration=12.0, seed=3,
                             noise=SENSORS['mocap_imu'])
    most = iris.hover_speed * np.sqrt(1.3)
    shares = np.clip(record.stack(*CMD) / most, 0.0, 1.0) ** (1 / 1.2)
    columns = {name: values for name, values in record.columns.items() if name not in CMD}
    columns |= dict(zip(OUTPUTS, shares.T, strict=True))
    iris = replace(iris, motors=None, speed_min=0.0, speed_max=float(most))
    [read] = commanded([FlightRecord(record.t, columns)], iris)
    assert not curves(read, iris)


@pytest.mark.slow
def test_rotors_that_turn_at_no_signal_need_a_lowest_speed(tmp_path):
    """The line that says how to name shares of thrust says it, for such motors look alike."""
    idle = replace(VEHICLE, speed_min=500.0, speed_max=2000.0)
    path = with_outputs(tmp_path, (SPEEDS - 500) / 1500)
    assert not curves(load(path, vehicle=idle), idle)
    silent = replace(idle, speed_min=0.0)
    [found] = curves(load(path, vehicle=silent), silent)
    assert 'speed_min' in found.remedy


@pytest.mark.slow
@pytest.mark.parametrize('size', [1.0, 4.0, 0.05])
def test_thrusts_in_newtons_are_refused_with_the_motors_that_read_them(tmp_path, size):
    """By their size alone they are of no kind, per cent or normalised."""
    made = replace(VEHICLE, mass=size * VEHICLE.mass,
                   thrust_coefficient=size * VEHICLE.thrust_coefficient)
    path = with_outputs(tmp_path, made.thrust_coefficient * SPEEDS ** 2)
    with pytest.raises(InputError, match='thrusts of its rotors in N') as caught:
        load(path, vehicle=made)
    told = yaml.safe_load(str(caught.value).split('motors: ')[1])
    read = load(path, vehicle=replace(made, motors=motors_from('v', told)))
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize('signals', [True, False])
def test_too_much_thrust_by_signals_may_be_that_of_their_map(signals):
    """Rotors turn at full signal at two thirds of the speed that the vehicle file has."""
    outputs = FLIGHT.stack(*CMD) / 1700
    fast = replace(VEHICLE, speed_min=0.0, speed_max=1700 * 1.5)
    columns = {name: values for name, values in FLIGHT.columns.items() if name not in CMD}
    record = FlightRecord(FLIGHT.t, columns | (
        dict(zip(OUTPUTS, outputs.T, strict=True)) if signals else
        dict(zip(CMD, 1.5 * FLIGHT.stack(*CMD).T, strict=True))))
    if signals:
        [record] = commanded([record], fast)      # as their size says
    [found] = [one for one in findings(record, fast) if one.code == 'other_vehicle']
    assert ('at other speeds by these signals' in found.message) == signals
    assert ('map from signals to speeds' in found.remedy) == signals
