# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Physical parameters from flights of known truth, and what the flights leave undetermined."""

import dataclasses
import json

import numpy as np
import pytest
from scipy.stats import chi2

from benchmarks.flights import FlightProblem, NAMES, NOISE, VEHICLE, with_constants
from quad_ident_ros.cli.main import main
from quad_ident_ros.data.commands import with_commands, with_inputs
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.quality import Finding, findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import Noise, SENSORS, Sensors
from quad_ident_ros.greybox.cautions import cautions
from quad_ident_ros.greybox.errors import difference, ERRORS, moved
from quad_ident_ros.greybox.fit import as_data, fit, fitted_vehicle
from quad_ident_ros.greybox.flights import flight_of, track_of
from quad_ident_ros.greybox.identifiable import freedoms
from quad_ident_ros.greybox.linear import errors_along, linear_of, STEP, tangent_of
from quad_ident_ros.greybox.normal import CHANCE, Normal, scatter_of
from quad_ident_ros.greybox.parameters import INDEX, limits, nominal
from quad_ident_ros.model.dynamics import course_of, STATES, states_of
from quad_ident_ros.model.quantities import value_of
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.vehicle_files.draws import draw

DRAWS = 20
KNOWN_MASS = NAMES[1:]
WHITE = Sensors(white=Noise(position=0.002, velocity=0.02, attitude=0.004, rate=0.02))


def values(found, field='value'):
    return np.array([getattr(parameter, field) for parameter in found.parameters], float)


def by_name(found):
    return {parameter.name: parameter for parameter in found.parameters}


@pytest.fixture(scope='module')
def problem():
    return FlightProblem()


@pytest.fixture(scope='module')
def draws(problem):
    """Return the fits to 20 draws of the noise, from starts up to 30 % off, one by one."""
    random = np.random.default_rng(7)
    found = []
    for seed in range(DRAWS):
        off = random.uniform(0.7, 1.3, len(KNOWN_MASS))
        start = with_constants(VEHICLE, dict(zip(KNOWN_MASS, problem.truth * off, strict=True)))
        found.append(fit([problem.draw(seed)], start, KNOWN_MASS))
    return found


@pytest.mark.slow
def test_errors_are_those_of_the_cramer_rao_bound(problem, draws):
    misses = np.array([values(found) - problem.truth for found in draws]) / problem.bound
    assert np.sqrt(np.mean(misses ** 2)) <= 1.15
    # A mean over 20 draws has a standard error of 0.22 of one draw's.
    assert np.abs(misses.mean(axis=0)).max() < 4 / np.sqrt(DRAWS)


@pytest.mark.slow
def test_95_percent_intervals_hold_the_truth_as_often_as_they_say(problem, draws):
    inside = np.array([np.abs(values(found) - problem.truth) <= 1.96 * values(found, 'std')
                       for found in draws])
    assert 0.90 <= inside.mean() <= 0.99
    stds = np.array([values(found, 'std') for found in draws]) / problem.bound
    np.testing.assert_allclose(stds.mean(axis=0), 1.0, atol=0.1)


@pytest.mark.slow
def test_every_start_converges_and_the_noise_comes_out(draws):
    assert all(found.estimate.converged for found in draws)
    noise = np.array([found.estimate.noise[0] for found in draws])
    # 2,000 samples a channel and draw: a standard error of 0.4 % of the mean over the draws.
    np.testing.assert_allclose(noise.mean(axis=0) / NOISE, 1.0, atol=0.016)


@pytest.mark.slow
def test_the_true_vehicle_is_as_far_from_the_written_one_as_its_covariance_says(problem, draws):
    """Squared distances by the covariance in the vehicle file, of seven numbers each."""
    distances = []
    for found in draws:
        vehicle = fitted_vehicle(found)
        names = vehicle.covariance.names
        off = [value_of(vehicle, name) - value_of(VEHICLE, name) for name in names]
        distances.append(off @ np.linalg.solve(vehicle.covariance.matrix, off))
    low, high = chi2.ppf([0.001, 0.999], len(KNOWN_MASS) * DRAWS)
    assert low < sum(distances) < high


@pytest.mark.slow
def test_a_mass_known_to_two_percent_scales_what_goes_with_it(problem):
    """Mass, thrust, torque, inertia and drag in proportion are one motion."""
    exact = fit([problem.draw(0)], problem.start(0), KNOWN_MASS)
    stated = dataclasses.replace(problem.start(0), uncertainty={'mass': 0.02})
    vehicle = fitted_vehicle(fit([problem.draw(0)], stated, KNOWN_MASS))
    assert set(vehicle.covariance.names) == {'mass', *KNOWN_MASS}
    draws = draw(vehicle, 2000, seed=1)
    shares = draws.values / draws.means
    mass = shares[:, draws.names.index('mass')]
    assert mass.std() == pytest.approx(0.02, rel=0.05)
    for name, each in by_name(exact).items():
        error = each.std / each.value
        other = shares[:, draws.names.index(name)]
        # The ratio to the mass is as sure as with an exact mass.
        assert np.std(other / mass) == pytest.approx(error, rel=0.1)
        assert other.std() == pytest.approx(np.hypot(error, 0.02), rel=0.1)


@pytest.mark.slow
def test_what_is_undetermined_or_at_a_bound_is_not_drawn(problem):
    found = fit([problem.draw(0)], problem.start(0), NAMES)
    assert set(fitted_vehicle(found).covariance.names) == set(KNOWN_MASS)
    lagging = fit([problem.draw(0)], VEHICLE, ['thrust_coefficient', 'motor_lag'])
    [lag] = [one for one in lagging.parameters if one.name == 'motor_lag.time_constant']
    assert lag.status == 'bound'
    assert fitted_vehicle(lagging).covariance.names == ('thrust_coefficient',)


@pytest.mark.slow
def test_all_eight_free_have_no_scale_and_it_is_said(problem):
    found = fit([problem.draw(0)], problem.start(0), NAMES)
    assert {parameter.status for parameter in found.parameters} == {'undetermined'}
    parts = by_name(found)
    assert parts['mass'].value is None
    assert parts['mass'].std is None
    assert all(parts[name].given == {'mass': 1.0} for name in KNOWN_MASS)
    assert 'multiplied by one factor' in found.findings[0]
    with_mass = fit([problem.draw(0)], problem.start(0), KNOWN_MASS)
    for name in KNOWN_MASS:
        one, other = parts[name], by_name(with_mass)[name]
        assert one.value == pytest.approx(other.value, abs=0.05 * other.std)
        assert one.std == pytest.approx(other.std, rel=0.02)


def test_a_start_whose_attitude_is_soon_anywhere_is_mended_all_the_same():
    """Offset mass and weak thrust turn the model over within half a second."""
    vehicle = load_vehicle('crazyflie')
    truth = {'com_offset': {'x': 0.003, 'y': -0.003}, 'thrust_scale': {'factor': 0.7}}
    record = fly_closed_loop(vehicle, truth, 'lissajous', duration=15.0, seed=2, noise=WHITE)
    found = by_name(fit([record], vehicle, ['com_offset', 'thrust_scale']))
    for name, value in (('com_offset.x', 0.003), ('com_offset.y', -0.003),
                        ('thrust_scale.factor', 0.7)):
        assert abs(found[name].value - value) < 4 * found[name].std


def test_effects_are_found_beside_constants():
    truth = {'motor_lag': {'time_constant': 0.04}, 'rotor_drag': {'coefficient': 0.3}}
    record = fly_closed_loop(VEHICLE, truth, 'lissajous', duration=20.0, seed=5, noise=WHITE)
    start = dataclasses.replace(VEHICLE, thrust_coefficient=1.2e-5)
    found = by_name(fit([record], start, ['thrust_coefficient', 'motor_lag', 'rotor_drag']))
    for name, value in (('thrust_coefficient', 1e-5), ('motor_lag.time_constant', 0.04),
                        ('rotor_drag.coefficient', 0.3)):
        assert abs(found[name].value - value) < 4 * found[name].std < 0.2 * value


def test_what_a_hover_does_not_show_is_undetermined_and_stays():
    record = fly_closed_loop(VEHICLE, {}, 'hover', duration=10.0, seed=1, noise=WHITE)
    found = fit([record], VEHICLE, ['thrust_coefficient', 'rotational_drag', 'body_drag'])
    parts = by_name(found)
    assert parts['thrust_coefficient'].status == 'determined'
    for name in ('rotational_drag_x', 'rotational_drag_z', 'body_drag.horizontal'):
        assert parts[name].status != 'determined'
        assert any(name in line for line in found.findings)
    vehicle = fitted_vehicle(found)
    assert vehicle.rotational_drag == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_wind_without_a_drag_by_which_it_acts_is_undetermined():
    """Rounding alone is left of the slopes, and leads nowhere."""
    vehicle = load_vehicle('hummingbird')
    flight = fly_closed_loop(vehicle, {}, 'lissajous', duration=6.0, seed=1,
                             noise=SENSORS['mocap_imu'])
    found = fit([flight], vehicle, ['wind'])
    assert {parameter.status for parameter in found.parameters} == {'undetermined'}
    assert not fitted_vehicle(found).effects


def test_a_parameter_that_no_flight_shows_is_alone_undetermined():
    record = fly_closed_loop(VEHICLE, {}, 'hover', duration=10.0, seed=1)
    found = fit([record], VEHICLE, ['torque_coefficient', 'inertia_z'])
    assert all(parameter.status == 'undetermined' for parameter in found.parameters)


def test_one_clock_that_is_late_biases_nothing(problem):
    record, truth = problem.draw(3), dict(zip(KNOWN_MASS, problem.truth, strict=True))
    late = {name: record.columns[name][:-2] if name in STATES[:10] else values[2:]
            for name, values in record.columns.items()}
    shifted = dataclasses.replace(record, t=record.t[2:], columns=late)
    for parameter in fit([shifted], problem.start(3), KNOWN_MASS).parameters:
        assert abs(parameter.value - truth[parameter.name]) < 4 * parameter.std


@pytest.mark.slow
def test_outliers_hardly_move_the_estimate(problem):
    record = problem.draw(4)
    columns = {name: np.array(column) for name, column in record.columns.items()}
    columns['px'][::97] += 1.0
    spoilt = dataclasses.replace(record, columns=columns)
    clean, found = (fit([each], problem.start(4), KNOWN_MASS) for each in (record, spoilt))
    assert np.all(np.abs(values(found) - values(clean)) < 1.5 * values(clean, 'std'))


def test_the_slopes_are_differences_of_the_errors(problem):
    flight = flight_of(track_of(problem.clean, VEHICLE))
    z, starts = nominal(VEHICLE), flight.states[flight.first]
    columns = [INDEX[name] for name in (*NAMES, 'motor_lag.time_constant', 'wind.x')]
    tangent = tangent_of(flight, VEHICLE, z, starts, columns, STEP * limits(VEHICLE)[2, columns])
    for k, column in enumerate(columns):
        step = np.zeros(len(z))
        step[column] = 1e-3 * abs(z[column]) or 1e-4
        change = (errors_along(flight, VEHICLE, z, starts)
                  - errors_along(flight, VEHICLE, z + step, starts)) / step[column]
        expected = (change / NOISE).reshape(len(starts), -1)
        found = tangent.table[:, ERRORS + k] / np.tile(NOISE, flight.count + 1)
        np.testing.assert_allclose(found, expected, atol=0.01 * np.abs(expected).max())


def test_what_initial_states_explain_is_taken_out_of_slopes_and_errors(problem):
    flight = flight_of(track_of(problem.clean, VEHICLE))
    z, starts = nominal(VEHICLE), flight.states[flight.first]
    columns = [INDEX[name] for name in (*NAMES, 'motor_lag.time_constant', 'wind.x')]
    tangent = tangent_of(flight, VEHICLE, z, starts, columns, STEP * limits(VEHICLE)[2, columns])
    raw = errors_along(flight, VEHICLE, z, starts)
    linear = linear_of(tangent, raw, 1.0 / NOISE)
    scale = np.tile(NOISE, flight.count + 1)
    for k in range(len(starts)):
        table, error = tangent.table[k] / scale, raw[k].ravel() / scale
        whole = np.vstack([table[ERRORS:], error]).T
        explained = table[:ERRORS].T @ np.linalg.lstsq(table[:ERRORS].T, whole, rcond=None)[0]
        rest = whole - explained
        size = np.linalg.norm(rest, axis=0)
        found = np.block([[linear.products[k], linear.cross[k][:, None]],
                          [linear.cross[k], linear.power[k]]])
        size = np.outer(size, size)
        np.testing.assert_allclose(found / size, rest.T @ rest / size, atol=1e-6)


def test_moved_undoes_difference():
    random = np.random.default_rng(0)
    states = random.normal(size=(50, 13))
    states[:, 6:10] /= np.linalg.norm(states[:, 6:10], axis=1, keepdims=True)
    change = random.normal(size=(50, 12)) * np.where(np.arange(50) % 2, 1.0, 1e-5)[:, None]
    np.testing.assert_allclose(difference(moved(states, change), states), change, atol=1e-12)


def test_white_noise_widens_no_interval_but_by_the_chance_that_is_stated():
    random, count, blocks = np.random.default_rng(1), 4000, 12
    wide = 0
    for _ in range(count):
        scores = random.normal(size=(blocks, 1))
        wide += scatter_of(Normal(np.array([[float(blocks)]]), scores.sum(axis=0), 0.0,
                                  scores))[0] > 1.0
    assert wide / count == pytest.approx(CHANCE, abs=4 * np.sqrt(CHANCE / count))
    hanging = np.full((blocks, 1), 3.0) * np.where(np.arange(blocks) % 2, 1.0, -1.0)[:, None]
    assert scatter_of(Normal(np.array([[float(blocks)]]), np.zeros(1), 0.0, hanging))[0] > 9.0


def test_freedoms_of_a_matrix_that_is_known():
    slope = np.array([[1e3, -1e3, 0.0, 0.0], [0.0, 0.0, 0.0, 50.0]])
    left = freedoms(slope.T @ slope, np.array([2.0, 2.0, 0.0, 1.0]), np.full(4, 0.1))
    assert sorted(freedom.members for freedom in left) == [(0, 1), (2,)]
    assert [freedom.scale for freedom in left if freedom.members == (0, 1)] == [True]


@pytest.mark.parametrize(('names', 'said'), [
    (['mass', 'mass_offset'], 'same physical number'),
    (['inertia', 'inertia_mismatch.factor_y'], 'same physical number'),
    (['thrust_scale', 'thrust_coefficient'], 'same physical number'),
    (['masss'], "did you mean 'mass'"), (['gravity'], 'cannot be freed; known are mass, '),
    ([], 'names nothing')])
def test_names_that_cannot_be_freed_are_refused(problem, names, said):
    with pytest.raises(InputError, match=said):
        fit([problem.clean], VEHICLE, names)


@pytest.mark.slow
def test_where_measured_speeds_drive_the_model_fit_says_what_of_the_motors_is_not_told(problem):
    record = problem.draw(0)
    speeds = {name.replace('cmd', 'rotor'): values for name, values in record.columns.items()}
    driven = with_commands(FlightRecord(record.t, speeds, record.info), VEHICLE)
    [line] = [line for line in fit([driven], VEHICLE, ['inertia']).findings
              if 'measured rotor speeds drive the model' in line]
    assert 'lag of the motors (motor_lag) and delay of the commands (actuation_delay)' in line
    for name in ('motor_lag', 'actuation_delay'):
        with pytest.raises(InputError, match=f'is not visible: .*; leave {name}.* out of --free'):
            fit([record, driven], VEHICLE, ['inertia', name])
    assert not [line for line in fit([record], VEHICLE, ['inertia']).findings
                if 'drive the model' in line]


def test_a_flight_that_is_given_twice_is_refused(problem):
    one, other = problem.draw(0), problem.draw(0)
    with pytest.raises(InputError, match='given twice'):
        fit([one, problem.draw(1), other], VEHICLE, ['inertia'])


@pytest.mark.slow
def test_flights_of_one_name_are_told_apart_and_progress_rises(problem):
    shares = []
    records = [dataclasses.replace(problem.draw(k), info={'name': name})
               for k, name in enumerate(('flight_1', 'flight_2', 'flight_1'))]
    found = fit(records, VEHICLE, ['inertia'], shares.append)
    assert found.flights == ('flight_1', 'flight_2', 'flight_1 (2)')
    assert list(as_data(found)['noise']) == list(found.flights)
    assert len(shares) > 2 and shares == sorted(shares) and shares[-1] == 1.0


def test_what_ends_at_a_bound_is_not_there_or_lies_beyond(problem):
    record = fly_closed_loop(VEHICLE, {}, 'figure8', duration=10.0, seed=1, noise=WHITE)
    light = dataclasses.replace(VEHICLE, torque_coefficient=VEHICLE.torque_coefficient / 50)
    [parameter], [line] = (lambda found: (found.parameters, [
        line for line in found.findings if 'bound' in line]))(
            fit([record], light, ['torque_coefficient']))
    assert parameter.status == 'bound' and 'lies beyond' in line


@pytest.mark.slow
def test_the_command_writes_table_data_and_vehicle(problem, tmp_path, capsys):
    flight, vehicle = tmp_path / 'flight.csv', tmp_path / 'vehicle.yaml'
    write_csv(flight, problem.draw(1))
    write_vehicle(vehicle, problem.start(1))
    out, data = tmp_path / 'out.yaml', tmp_path / 'fit.json'
    assert main(['fit', str(flight), '--vehicle', str(vehicle), '--free',
                 'inertia,thrust_coefficient, torque_coefficient,linear_drag_x,linear_drag_y',
                 '--out-vehicle', str(out), '--json', str(data)]) == 0
    shown = capsys.readouterr().out
    written, found = json.loads(data.read_text()), load_vehicle(out)
    assert found.mass == 1.0
    for name, place in (('inertia_x', found.inertia[0]), ('linear_drag_y', found.linear_drag[1]),
                        ('thrust_coefficient', found.thrust_coefficient)):
        assert name in shown
        assert written['parameters'][name]['value'] == place
    assert np.shape(written['covariance']['matrix']) == (7, 7)
    assert written['noise']['flight']['rate']['std'] == pytest.approx([0.02] * 3, rel=0.1)
    assert main(['export', str(out), '--randomise', '3', '-o', str(tmp_path / 'drawn')]) == 0
    assert len(list((tmp_path / 'drawn').glob('*.yaml'))) == 3
    assert written == as_data(fit([problem.draw(1)], load_vehicle(vehicle), KNOWN_MASS)) | {
        'flights': ['flight'], 'noise': written['noise']}


def test_the_command_refuses_in_one_line(problem, tmp_path, capsys):
    flight = tmp_path / 'short.csv'
    write_csv(flight, problem.clean.slice(0, 20))
    assert main(['fit', str(flight), '--vehicle', 'paper_quadrotor', '--free', 'mass']) == 2
    assert capsys.readouterr().err.count('\n') == 1


def run_on(record, tmp_path, *more):
    path, vehicle = tmp_path / 'flight.csv', tmp_path / 'vehicle.yaml'
    write_csv(path, record)
    write_vehicle(vehicle, VEHICLE)
    return main(['fit', str(path), '--vehicle', str(vehicle), *more])


def with_columns(record, **columns):
    return FlightRecord(record.t, {**record.columns, **columns}, record.info)


FAULTS = {
    'rate_in_degrees': lambda c: {name: np.degrees(c[name]) for name in ('wx', 'wy', 'wz')},
    'rotor_order': lambda c: {'cmd1': c['cmd3'], 'cmd3': c['cmd1']},
    'rotor_count': lambda c: {'cmd5': c['cmd1'], 'cmd6': c['cmd2']},
    'quaternion_order': lambda c: {'qw': c['qx'], 'qx': c['qy'], 'qy': c['qz'], 'qz': c['qw']},
}


@pytest.mark.slow
@pytest.mark.parametrize('code', FAULTS)
def test_the_command_refuses_what_info_calls_an_error(problem, tmp_path, capsys, code):
    record = with_columns(problem.clean, **FAULTS[code](problem.clean.columns))
    [wanted] = [finding for finding in findings(record, VEHICLE) if finding.code == code]
    assert run_on(record, tmp_path, '--free', 'thrust_coefficient') == 2
    said = capsys.readouterr().err
    assert wanted.message in said and wanted.remedy in said and said.count('\n') == 1


@pytest.mark.slow
def test_an_axis_that_no_flight_moves_and_warnings_are_said_beside_the_values(tmp_path, capsys):
    record = fly_closed_loop(VEHICLE, {}, 'hover', duration=10.0, noise=WHITE)
    hot = record.columns['cmd1'].copy()
    hot[:200] = VEHICLE.speed_max
    assert run_on(with_columns(record, cmd1=hot), tmp_path, '--free', 'inertia_z', '--json',
                  '-') == 0
    said = json.loads(capsys.readouterr().out)['findings']
    [still] = [line for line in said if 'yaw axis is hardly excited' in line]
    assert still.startswith('inertia_z:') and not [line for line in said if 'roll axis' in line]
    assert [line for line in said if 'at or beyond speed_max' in line]


def test_a_flight_whose_times_are_in_milliseconds_is_refused_as_info_says(problem):
    clean = problem.clean
    record = FlightRecord(1000 * clean.t, clean.columns, {'name': 'late.csv'})
    [wanted] = [finding for finding in findings(record) if finding.code == 'slow']
    assert wanted.severity == 'error' and 'in seconds' in wanted.remedy
    with pytest.raises(InputError, match='late.csv: t: a sample every 10 s is too slow'):
        fit([record], VEHICLE, ['inertia_x'])


def test_a_short_flight_without_a_gap_is_not_asked_for_more_samples(problem):
    record = problem.clean
    short = dataclasses.replace(record, t=record.t[:8], columns={
        name: values[:8] for name, values in record.columns.items()})
    with pytest.raises(InputError, match='too short; give a longer flight$'):
        flight_of(track_of(short, VEHICLE))


def test_angles_and_inputs_do_instead_of_quaternion_and_commands(problem):
    clean = with_inputs(problem.clean, VEHICLE)
    part = {name: values for name, values in clean.columns.items()
            if name[0] != 'q' and not name.startswith('cmd')}
    angles = dict(zip(('phi', 'theta', 'psi'), clean.euler().T, strict=True))
    other = with_commands(FlightRecord(clean.t, {**part, **angles}, clean.info), VEHICLE)
    np.testing.assert_allclose(course_of(other, VEHICLE).commands,
                               course_of(clean, VEHICLE).commands, rtol=1e-6)
    one, same = states_of(other)[:, 6:10], states_of(clean)[:, 6:10]
    np.testing.assert_allclose(np.abs(np.sum(one * same, axis=1)), 1.0, atol=1e-12)


def test_a_quaternion_that_is_zero_names_its_flight(problem):
    nothing = dict.fromkeys(('qw', 'qx', 'qy', 'qz'), 0 * problem.clean.t)
    zero = with_columns(problem.clean, **nothing)
    named = FlightRecord(zero.t, zero.columns, {'source': 'second.csv'})
    with pytest.raises(InputError, match='second.csv: sample 0: the quaternion'):
        fit([problem.clean, named], VEHICLE, ['mass'])


def test_a_flight_that_moves_an_axis_makes_up_for_one_that_does_not():
    still = Finding('excitation', 'info', 'yaw', 'hardly', 'move it')
    late = Finding('clock_offset', 'warning', 'gyro', 'late', 'shift it')
    assert cautions((('a', (still,)), ('b', ())), ['inertia_z']) == []
    assert len(cautions((('a', (still,)), ('b', (still,))), ['inertia_z'])) == 1
    assert cautions((('a', (still,)),), ['mass']) == []
    assert cautions((('a', (late,)), ('b', (late,))), ['mass']) == [
        'a (and 1 more): gyro: late; shift it']


@pytest.mark.slow
def test_effects_that_were_freed_are_in_the_vehicle_written(problem):
    effects = {'rotor_drag': {'coefficient': 0.3}}
    record = fly_closed_loop(VEHICLE, effects, 'figure8', duration=10.0, seed=1, noise=WHITE)
    found = fit([record], VEHICLE, ['rotor_drag'])
    vehicle = fitted_vehicle(found)
    assert vehicle.effects['rotor_drag']['coefficient'] == found.parameters[0].value
    # From there on nothing is left to find, and the result is kept; what the file knows of a
    # constant goes with its value.
    vehicle = dataclasses.replace(vehicle, uncertainty={'mass': 0.01, 'thrust_coefficient': 1e-6})
    again = fitted_vehicle(fit([record], vehicle, ['thrust_coefficient']))
    assert again.uncertainty == {'mass': 0.01}
    turned = dataclasses.replace(vehicle, uncertainty={'inertia': (1e-5, 2e-5, None)})
    assert fitted_vehicle(fit([record], turned, ['inertia_x'])).uncertainty == {
        'inertia': (None, 2e-5, None)}
    assert again.effects == vehicle.effects
    assert again.thrust_coefficient == pytest.approx(vehicle.thrust_coefficient, rel=0.01)
