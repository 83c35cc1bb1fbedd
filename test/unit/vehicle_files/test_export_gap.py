# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What of the gap on a flight the file of a simulator closes."""

from dataclasses import replace
import json

import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.model.vehicle import load_vehicle, vehicle_to_mapping, write_vehicle
from quad_ident_ros.vehicle_files.load import load_any_vehicle

EFFECTS = {'motor_lag': {'time_constant': 0.03}, 'rotor_drag': {'coefficient': 0.15},
           'body_drag': {'horizontal': 0.03, 'vertical': 0.03}, 'mass_offset': {'mass': 0.05}}


@pytest.fixture(scope='module')
def flown(tmp_path_factory):
    """Return a folder with a flight of a vehicle with effects, and with its vehicle file."""
    folder = tmp_path_factory.mktemp('flown')
    entries = [f'{name}:{key}={value}' for name, values in EFFECTS.items()
               for key, value in values.items()]
    assert main(['fly', 'figure8', '--vehicle', 'hummingbird', '--duration', '12', '-o',
                 str(folder / 'a.csv')] + [word for entry in entries
                                           for word in ('--effect', entry)]) == 0
    write_vehicle(folder / 'real.yaml', replace(load_vehicle('hummingbird'), effects=EFFECTS))
    return folder


def exported(folder, to, out, *more):
    path = folder / f'{to}.json'
    assert main(['export', str(folder / 'real.yaml'), '--to', to, '-o', str(folder / out),
                 '--flight', str(folder / 'a.csv'), '--json', str(path), *more]) == 0
    return json.loads(path.read_text())


@pytest.mark.slow
def test_a_file_with_all_effects_closes_all_of_the_gap(flown, capsys):
    data = exported(flown, 'rotorpy', 'real_params.py')
    gaps = data['gap']['gaps']
    assert gaps['vehicle']['velocity'] < 1e-3 * gaps['nominal']['velocity']
    assert data['gap']['shares']['file'] == pytest.approx(1.0, abs=1e-3)
    said = capsys.readouterr().out
    assert 'the written file closes 100 % of what the vehicle file closes' in said


@pytest.mark.slow
def test_what_a_format_does_not_have_is_what_its_file_leaves(flown):
    shares = {to: exported(flown, to, out)['gap']['shares']['file']
              for to, out in (('gazebo', 'a.sdf'), ('mujoco', 'a.xml'))}
    # Gazebo has no drag of the body, MuJoCo none of the rotors either.
    assert 0.3 < shares['mujoco'] < shares['gazebo'] < 0.999


@pytest.mark.slow
def test_code_beside_the_file_closes_what_its_numbers_leave(flown):
    shares = exported(flown, 'mujoco', 'b.xml')['gap']['shares']
    assert shares['file'] < 0.9 < 0.999 < shares['file_and_code'] <= 1.0 + 1e-9


@pytest.mark.slow
def test_the_base_is_the_nominal_vehicle(flown):
    nominal = flown / 'nominal_params.py'
    write_vehicle(flown / 'nominal.yaml', load_vehicle('hummingbird'))
    assert main(['export', str(flown / 'nominal.yaml'), '--to', 'rotorpy', '-o',
                 str(nominal)]) == 0
    with_base = exported(flown, 'rotorpy', 'b_params.py', '--base', str(nominal))
    alone = exported(flown, 'rotorpy', 'c_params.py')
    assert with_base['gap'] == alone['gap']
    one, other = (vehicle_to_mapping(load_any_vehicle(flown / name))
                  for name in ('b_params.py', 'c_params.py'))
    assert one['effects'] == other['effects']


def test_a_flight_that_is_too_short_is_refused_in_one_line(flown, capsys):
    lines = (flown / 'a.csv').read_text().splitlines()[:100]
    (flown / 'short.csv').write_text('\n'.join(lines) + '\n')
    assert main(['export', str(flown / 'real.yaml'), '--to', 'rotorpy', '-o',
                 str(flown / 'd_params.py'), '--flight', str(flown / 'short.csv')]) == 2
    said = capsys.readouterr().err.strip()
    assert 'too short' in said and '\n' not in said
    assert not (flown / 'd_params.py').exists()
