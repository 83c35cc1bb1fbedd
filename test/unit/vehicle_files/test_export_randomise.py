# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles drawn from what flights leave open: their distribution, its bounds, the files."""

from dataclasses import replace
import json

from full_disk import file_size_limit
import numpy as np
import pytest
from scipy.stats import binom, chi2, truncnorm

from quad_ident_ros.cli.main import main
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.covariance import covariance_of_matrix
from quad_ident_ros.model.quantities import value_of, with_values
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.vehicle_files.bodies import Body, check_body
from quad_ident_ros.vehicle_files.draws import draw, table_of_draws
from quad_ident_ros.vehicle_files.load import load_any_vehicle

BARE = load_vehicle('hummingbird')
NAMES = ('rotor_drag.coefficient', 'mass', 'thrust_coefficient')
MEANS = np.array([0.3, BARE.mass, BARE.thrust_coefficient])


def known(names=NAMES, means=MEANS, shares=(0.05, 0.02, 0.02), correlation=0.99, **more):
    """Return a vehicle with a covariance; shares: deviations over means, the last two tied."""
    stds = np.array(shares) * means
    table = np.eye(len(names))
    table[-1, -2] = table[-2, -1] = correlation
    vehicle = with_values(BARE, dict(zip(names, map(float, means), strict=True)))
    return replace(vehicle, covariance=covariance_of_matrix(names, table * np.outer(stds, stds)),
                   **more)


@pytest.mark.slow
def test_draws_have_the_covariance_that_is_stated():
    vehicle = known()
    draws = draw(vehicle, 500, seed=3)
    away = (draws.values - MEANS) / MEANS
    exact = vehicle.covariance.matrix / np.outer(MEANS, MEANS)
    distances = np.einsum('ni,ij,nj->n', away, np.linalg.inv(exact), away)
    assert np.mean(distances < chi2.ppf(0.9, 3)) == pytest.approx(0.9, abs=0.04)
    assert np.sum(distances) == pytest.approx(3 * 500, abs=4 * np.sqrt(2 * 3 * 500))
    # What goes together stays together: the ratio of mass and thrust is known far better.
    assert np.std(away[:, 1] - away[:, 2]) == pytest.approx(0.02 * np.sqrt(0.02), rel=0.15)
    assert draws.cut == 0


@pytest.mark.slow
def test_a_draw_is_the_vehicle_with_its_numbers_and_says_nothing_of_how_well_they_are_known():
    vehicle = known(uncertainty={'mass': 0.01})
    draws = draw(vehicle, 5, seed=1)
    for row, made in zip(draws.values, draws.vehicles, strict=True):
        assert [value_of(made, name) for name in NAMES] == row.tolist()
        assert made.covariance is None and not made.uncertainty
        assert made.inertia == vehicle.inertia and made.rotors == vehicle.rotors
    more = draw(vehicle, 100, seed=1)
    assert np.array_equal(more.values[:5], draws.values)
    assert not np.array_equal(draw(vehicle, 5, seed=2).values, draws.values)


@pytest.mark.slow
def test_draws_end_at_the_bounds_of_what_vehicles_have():
    # A lag is not negative: a normal distribution that is cut off at its mean less 0.5 deviations.
    vehicle = known(('motor_lag.time_constant', *NAMES[1:]), np.array([0.002, *MEANS[1:]]),
                    (2.0, 0.02, 0.02))
    draws = draw(vehicle, 400, seed=1)
    lags = draws.values[:, 0]
    assert lags.min() >= 0.0
    cut = truncnorm(-0.5, np.inf, 0.002, 0.004)
    assert np.mean(lags) == pytest.approx(cut.mean(), abs=4 * cut.std() / np.sqrt(400))
    share = draws.cut / (draws.cut + 400)
    assert share == pytest.approx(0.3085, abs=0.08) and 'time_constant' in draws.why


def test_no_draw_has_an_inertia_that_no_body_has():
    flat = replace(BARE, inertia=(0.004, 0.004, 0.0079))    # nearly a disc
    names = ('inertia_x', 'inertia_y', 'inertia_z')
    flat = replace(flat, covariance=covariance_of_matrix(names, np.diag([4e-4, 4e-4, 8e-4]) ** 2))
    draws = draw(flat, 200, seed=1)
    assert draws.cut > 20
    for made in draws.vehicles:
        check_body('', Body(made.mass, np.zeros(3), made.inertia_matrix))


def test_what_cannot_be_a_vehicle_at_all_is_refused():
    vehicle = known(shares=(0.05, 1e4, 1e4), correlation=-0.9999)
    with pytest.raises(InputError, match='draws can be vehicles; the first that cannot: '):
        draw(vehicle, 50)


@pytest.mark.slow
def test_constants_apart_from_the_covariance_are_drawn_by_their_own_deviation():
    places = {'rotors[0].position': (0.001, 0.001, None), 'speed_max': 10.0, 'mass': 0.3,
              'inertia': (1e-4, None, None)}
    draws = draw(known(uncertainty=places), 300, seed=1)
    assert draws.names[3:] == ('rotors[0].position_x', 'rotors[0].position_y', 'speed_max',
                               'inertia_x')
    assert draws.values[:, 3:].std(axis=0) == pytest.approx([0.001, 0.001, 10.0, 1e-4], rel=0.2)
    # The flights say more about the mass.
    assert draws.values[:, 1].std() == pytest.approx(0.02 * BARE.mass, rel=0.2)


def test_a_constant_that_flights_tell_by_an_effect_is_not_drawn_beside_it():
    vehicle = known(('mass_offset.mass', 'motor_lag.time_constant', 'rotor_drag.coefficient'),
                    np.array([0.05, 0.03, 0.3]), uncertainty={'mass': 0.1})
    assert draw(vehicle, 3).names == vehicle.covariance.names


def test_the_array_has_what_simulators_have_with_the_effects_in_it():
    vehicle = known(('mass_offset.mass', 'rotor_fault.loss_2', 'thrust_scale.factor'),
                    np.array([0.05, 0.1, 0.9]), correlation=0.0)
    vehicle = with_values(vehicle, {'rotor_fault.loss_both_3': 0.2})
    draws = draw(vehicle, 20, seed=1)
    names, units, values = table_of_draws(draws)
    column = dict(zip(names, values.T, strict=True))
    unit = dict(zip(names, units, strict=True))
    assert column['with_effects.mass'] == pytest.approx(BARE.mass + column['mass_offset.mass'])
    thrust = BARE.thrust_coefficient * column['thrust_scale.factor']
    assert column['with_effects.thrust_coefficient_1'] == pytest.approx(thrust)
    assert column['with_effects.thrust_coefficient_2'] == pytest.approx(
        thrust * (1.0 - column['rotor_fault.loss_2']))
    assert column['with_effects.thrust_coefficient_3'] == pytest.approx(0.8 * thrust)
    for j, share in enumerate((1.0, 1.0, 0.8, 1.0), 1):
        assert column[f'with_effects.torque_coefficient_{j}'] == pytest.approx(
            share * BARE.torque_coefficient)
    assert unit['with_effects.torque_coefficient_3'] == 'N m/(rad/s)^2'
    assert column['with_effects.rotor_2_y'] == pytest.approx(BARE.rotors[1].position[1])
    assert unit['with_effects.rotor_2_y'] == 'm'
    assert column['with_effects.inertia_zz'] == pytest.approx(BARE.inertia[2])
    assert unit['with_effects.inertia_xy'] == 'kg m^2' and unit['mass_offset.mass'] == 'kg'
    assert unit['with_effects.thrust_coefficient_4'] == 'N/(rad/s)^2'


def test_a_drawn_vehicle_of_a_long_name_can_be_read_back(tmp_path):
    made = draw(known(name='v' * 98), 2).vehicles
    assert made[0].name != made[1].name
    write_vehicle(tmp_path / 'v.yaml', made[1])
    assert load_vehicle(tmp_path / 'v.yaml') == made[1]


@pytest.fixture
def file(tmp_path):
    path = tmp_path / 'real.yaml'
    write_vehicle(path, known())
    return path


def test_the_command_writes_a_folder_of_vehicle_files(file, tmp_path, capsys):
    folder = tmp_path / 'more' / 'vehicles'
    command = ['export', str(file), '--randomise', '3', '--seed', '4', '-o', str(folder),
               '--json', str(tmp_path / 'd.json')]
    assert main(command) == 0
    said = capsys.readouterr().out
    assert '3 vehicles, hummingbird_0001.yaml to hummingbird_0003.yaml; seed 4' in said
    expected = draw(known(), 3, seed=4)
    found = [load_vehicle(path) for path in sorted(folder.iterdir())]
    assert found == list(expected.vehicles)
    data = json.loads((tmp_path / 'd.json').read_text())
    assert data['schema'] == 'quad_ident/draws/1' and data['cut'] == 0
    assert data['files'] == [f'hummingbird_000{k}.yaml' for k in (1, 2, 3)]
    assert [row['std'] for row in data['numbers']] == pytest.approx(known().covariance.stds)
    assert main(command) == 2
    assert 'this folder has files already; empty it, or name another' in capsys.readouterr().err
    assert sorted(path.name for path in folder.parent.iterdir()) == ['vehicles']


def test_the_command_writes_files_of_a_simulator(file, tmp_path, capsys):
    base = tmp_path / 'quad.sdf'
    assert main(['export', str(file), '--to', 'gazebo', '-o', str(base)]) == 0
    text = base.read_text()
    assert main(['export', str(file), '--to', 'gazebo', '--base', str(base), '--randomise', '3',
                 '-o', str(tmp_path / 'models')]) == 0
    said = capsys.readouterr().out
    assert 'carried: drag of the rotors (rotor_drag), form by_speed: as it is' in said
    assert base.read_text() == text
    for made in draw(known(), 3).vehicles:
        read = load_any_vehicle(tmp_path / 'models' / f'{made.name}.sdf')
        assert read.mass == pytest.approx(made.mass, rel=1e-9)
        assert read.effects['rotor_drag']['coefficient'] == pytest.approx(
            made.effects['rotor_drag']['coefficient'], rel=1e-6)


def test_the_command_writes_an_array_with_names_and_units(file, tmp_path):
    path = tmp_path / 'v.npz'
    assert main(['export', str(file), '--randomise', '7', '-o', str(path)]) == 0
    with np.load(path, allow_pickle=False) as data:
        assert data['values'].shape == (7, len(data['names'])) == (7, len(data['units']))
        assert tuple(data['names'][:3]) == NAMES and data['units'][1] == 'kg'
        assert np.array_equal(data['values'][:, :3], draw(known(), 7).values)


@pytest.mark.parametrize('words, said', [
    (['--randomise', '0', '-o', 'out'], '--randomise: expected a whole number of at least 1'),
    (['--randomise', '2', '--seed', '-1', '-o', 'out'], '--seed: expected a whole number'),
    (['--randomise', '2', '-o', 'out.yaml'], 'name a folder, or a file that ends in .npz'),
    (['--randomise', '2', '-o', 'taken'], 'taken: this is a file; name a folder'),
    (['--randomise', '2', '--to', 'mujoco', '-o', 'out.npz'], 'leave --to, --base and --flight'),
    (['--randomise', '2', '--to', 'px4_sih', '-o', 'out'], 'its rotors are not in the places'),
    (['-o', 'out.xml'], '--to is missing: name the simulator'),
    (['--to', 'urdf', '--seed', '1', '-o', 'out.urdf'], 'only draws have a seed')])
def test_what_cannot_be_drawn_is_said_in_one_line(words, said, file, tmp_path, monkeypatch,
                                                  capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / 'taken').write_text('mine')
    assert main(['export', str(file), *words]) == 2
    error = capsys.readouterr().err.strip()
    assert said in error and '\n' not in error
    assert (tmp_path / 'taken').read_text() == 'mine'
    assert sorted(path.name for path in tmp_path.iterdir()) == ['real.yaml', 'taken']


def test_a_vehicle_file_without_covariance_is_refused(tmp_path, capsys):
    assert main(['export', 'hummingbird', '--randomise', '2', '-o', str(tmp_path / 'out')]) == 2
    said = capsys.readouterr().err
    assert 'no covariance; `quad_ident diagnose` and `quad_ident fit` write' in said


@pytest.mark.slow
def test_the_true_vehicle_lies_among_the_draws_as_often_as_they_say():
    # Realities with other drags and lags. In every second one mass, thrust and inertia are off by
    # one factor, which no flight shows: it is as uncertain as the file states for each. Their
    # ratios are those of the file, so that a lag is better known there than the file lets it be.
    rng = np.random.default_rng(7)
    share, keys = 0.05, ('mass', 'thrust_coefficient', 'torque_coefficient')
    unsure = replace(BARE, uncertainty={
        **{key: share * getattr(BARE, key) for key in keys},
        'inertia': tuple(share * each for each in BARE.inertia)})
    distances = []
    for seed in range(12):
        nominal, factor, names = BARE, 1.0, ('motor_lag.time_constant', 'rotor_drag.coefficient')
        if seed % 2:
            nominal, names = unsure, ('rotor_drag.coefficient', 'mass')
            factor = 1.0 + share / np.sqrt(6.0) * rng.standard_normal()
        real = replace(BARE, **{key: factor * getattr(BARE, key) for key in keys},
                       inertia=tuple(factor * each for each in BARE.inertia), effects={
                           'motor_lag': {'time_constant': rng.uniform(0.02, 0.05)},
                           'rotor_drag': {'coefficient': rng.uniform(0.2, 0.4)}})
        flights = [fly_closed_loop(real, real.effects, course, duration=8.0, seed=3 * seed + k,
                                   noise=SENSORS['mocap_imu'])
                   for k, course in enumerate(('figure8', 'steps', 'lissajous'))]
        found = diagnose(flights, nominal, effects=['motor_lag', 'rotor_drag'])
        draws = draw(found.corrected(nominal), 100, seed=seed)
        places = [draws.names.index(name) for name in names]
        away = [value_of(real, name) for name in names] - draws.means[places]
        distances.append(away @ np.linalg.inv(np.cov(draws.values[:, places].T)) @ away)
    low, high = binom.ppf([0.01, 0.99], len(distances), 0.9)
    assert low <= np.sum(np.array(distances) < chi2.ppf(0.9, 2)) <= high
    # Neither too wide: their sum is that of a chi-square distribution.
    low, high = chi2.ppf([0.005, 0.995], 2 * len(distances))
    assert low < np.sum(distances) < high, distances


@pytest.mark.parametrize(('name', 'more'), [('vehicles', []), ('vehicles', ['--to', 'rotorpy']),
                                            ('vehicles.npz', [])])
def test_a_full_disk_is_said_with_the_place_that_was_asked_for(tmp_path, capsys, name, more):
    write_vehicle(tmp_path / 'v.yaml', known())
    with file_size_limit(64):
        code = main(['export', str(tmp_path / 'v.yaml'), '--randomise', '3', *more,
                     '-o', str(tmp_path / name)])
    assert code == 2
    assert capsys.readouterr().err == (f'quad_ident export: error: {tmp_path / name}: cannot be '
                                       'written: File too large\n')
    assert [path.name for path in tmp_path.iterdir()] == ['v.yaml']
