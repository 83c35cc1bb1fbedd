# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line: what it writes, and how it takes bad input."""

from dataclasses import replace
import json
import subprocess
import sys

import numpy as np
import pytest

from quad_ident_ros.cli.main import COMMANDS, main, parser
from quad_ident_ros.data.commands import with_inputs
from quad_ident_ros.data.csv import read_csv, write_csv
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.model.mixing import squared_speeds
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle


@pytest.fixture(scope='module')
def flights(tmp_path_factory):
    """Return the CSV files that `simulate` wrote, by run."""
    folder = tmp_path_factory.mktemp('flights')
    assert main(['simulate', 'small_angle', '--noise', 'attitude=1e-6', '--seed', '3',
                 '-o', str(folder)]) == 0
    return {name: folder / f'small_angle_{name}.csv' for name in ('phi', 'theta', 'psi', 'z')}


@pytest.mark.slow
def test_an_exact_record_of_one_axis_is_diagnosed_as_the_nominal_vehicle(tmp_path, capsys):
    """The flights of the paper move along one axis: nothing changes at all along the others."""
    assert main(['simulate', 'small_angle', '-o', str(tmp_path)]) == 0
    capsys.readouterr()
    assert main(['diagnose', str(tmp_path / 'small_angle_psi.csv'), '--vehicle',
                 'paper_quadrotor', '--quiet']) == 0
    assert capsys.readouterr().out.startswith('verdict: none')


@pytest.mark.slow
def test_help_of_every_command_names_it(capsys):
    assert main([]) == 0
    assert 'identify' in capsys.readouterr().out
    for command in ('demo', 'simulate', 'fly', 'identify', 'fit', 'diagnose', 'vehicle', 'export',
                    'info', 'convert', 'paper', 'node'):
        with pytest.raises(SystemExit) as end:
            main([command, '--help'])
        assert end.value.code == 0
        assert command in capsys.readouterr().out


def test_a_node_that_is_taken_for_a_command_is_told_how_to_start(capsys):
    with pytest.raises(SystemExit) as end:
        main(['simulator', '--ros-args'])
    assert end.value.code == 2
    assert 'did you mean: node simulator' in capsys.readouterr().err


@pytest.mark.slow
def test_simulate_writes_what_the_library_flies(flights):
    experiment = load_experiment('small_angle')
    for run in experiment.runs:
        flown = fly(experiment, run, noise={'attitude': 1e-6}, seed=3).record
        written = read_csv(flights[run.name])
        np.testing.assert_array_equal(written.t, flown.t)
        for name, values in flown.columns.items():
            np.testing.assert_array_equal(written.columns[name], values)


@pytest.mark.slow
def test_identify_gives_what_the_library_gives(flights, tmp_path):
    out, picture = tmp_path / 'out.json', tmp_path / 'deep' / 'fit.png'
    arguments = [*map(str, flights.values()), '--trim', 'hover', '--initial-state', 'rest']
    assert main(['identify', *arguments, '--seed', '5', '--json', str(out),
                 '--picture', str(picture)]) == 0
    data = json.loads(out.read_text())
    trim = (0.65 * 9.806, 0.0, 0.0, 0.0)
    direct = identify([read_csv(path) for path in flights.values()],
                      Settings(seed=5, trim=trim, initial_state='rest'))
    for name, method in direct.methods.items():
        for output, fit in method.outputs.items():
            assert data['methods'][name]['outputs'][output]['K'] == fit.model.gain
    assert picture.read_bytes().startswith(b'\x89PNG')


def test_json_on_standard_output_is_all_there_is(flights, capsys):
    assert main(['identify', str(flights['z']), '--trim', 'hover', '--initial-state', 'rest',
                 '--method', 'ls', '--json', '-']) == 0
    data = json.loads(capsys.readouterr().out)
    assert data['methods']['ls']['outputs']['z']['K'] == pytest.approx(1 / 0.65, rel=1e-3)


@pytest.mark.slow
def test_the_table_shows_all_methods_and_units(flights, capsys):
    assert main(['identify', str(flights['z']), '--trim', 'hover', '--initial-state',
                 'rest']) == 0
    shown = capsys.readouterr().out
    for text in ('PSO', 'CS', 'PSO-CS', 'LS', 'IAE', 'ITSE', 'm/s^2/N', 'fit %'):
        assert text in shown


@pytest.mark.slow
def test_inputs_come_from_rotor_commands_with_the_vehicle_named(flights, tmp_path, capsys):
    record = read_csv(flights['z'])
    vehicle = load_vehicle('paper_quadrotor')
    speeds = np.sqrt(squared_speeds(vehicle, record.inputs()))
    columns = {name: values for name, values in record.columns.items()
               if name not in ('u1', 'u2', 'u3', 'u4')}
    columns.update({f'cmd{i}': speeds[:, i - 1] for i in range(1, 5)})
    path = tmp_path / 'commands.csv'
    write_csv(path, FlightRecord(record.t, columns, record.info))
    arguments = ['--trim', 'hover', '--initial-state', 'rest', '--method', 'vp', '--json']
    gains = []
    for flight, more in ((flights['z'], []), (path, ['--vehicle', 'paper_quadrotor'])):
        out = tmp_path / 'out.json'
        assert main(['identify', str(flight), *arguments, str(out), *more]) == 0
        gains.append(json.loads(out.read_text())['methods']['vp']['outputs']['z']['K'])
    assert gains[1] == pytest.approx(gains[0], rel=1e-6)
    assert main(['identify', str(path), *arguments, str(out)]) == 2
    assert f'{path} has rotor commands and no inputs' in capsys.readouterr().err
    with pytest.raises(InputError, match='commands.csv has 4 rotor commands .* 8 rotors'):
        with_inputs(read_csv(path), replace(vehicle, rotors=2 * vehicle.rotors))


OVERWRITING = {
    'fit': 'fit FLIGHT --vehicle VEHICLE --free mass --out-vehicle FLIGHT',
    'fit, its vehicle': 'fit FLIGHT --vehicle VEHICLE --free mass --out-vehicle VEHICLE',
    'fit, data': 'fit FLIGHT --vehicle VEHICLE --free mass --json FLIGHT',
    'diagnose': 'diagnose FLIGHT --vehicle VEHICLE --out-vehicle FLIGHT',
    'diagnose, held out': 'diagnose x --hold-out FLIGHT --vehicle VEHICLE --report FLIGHT',
    'convert': 'convert FLIGHT FLIGHT',
    'convert, by another name': 'convert FLIGHT FOLDER/sub/../flight.csv',
    'convert, into the bag': 'convert FOLDER/sub FOLDER/sub/flight.csv',
    'fly': 'fly hover --vehicle VEHICLE -o VEHICLE',
    'info': 'info FLIGHT --json FLIGHT',
    'identify': 'identify FLIGHT --picture FLIGHT',
}


@pytest.mark.parametrize('call', OVERWRITING.values(), ids=OVERWRITING)
def test_no_command_writes_over_what_it_reads(call, flights, tmp_path, capsys):
    flight, vehicle = tmp_path / 'flight.csv', tmp_path / 'vehicle.yaml'
    flight.write_bytes(flights['z'].read_bytes())
    write_vehicle(vehicle, load_vehicle('paper_quadrotor'))
    (tmp_path / 'sub').mkdir()
    before = {path: path.read_bytes() for path in (flight, vehicle)}
    words = [word.replace('FLIGHT', str(flight)).replace('VEHICLE', str(vehicle))
             .replace('FOLDER', str(tmp_path)) for word in call.split()]
    assert main(words) == 2
    into = call == OVERWRITING['convert, into the bag']
    assert ('a folder that is read; name one outside of it' if into
            else 'which is read; give another name') in capsys.readouterr().err
    assert before == {path: path.read_bytes() for path in (flight, vehicle)}
    assert list((tmp_path / 'sub').iterdir()) == []


def test_a_file_in_the_place_of_a_folder_is_named(flights, tmp_path, capsys):
    (tmp_path / 'b.csv').write_text('mine')
    assert main(['convert', str(flights['z']), str(tmp_path / 'b.csv' / 'x.csv')]) == 2
    assert f'{tmp_path / "b.csv"} is a file, not a folder' in capsys.readouterr().err


@pytest.mark.parametrize('call', ['simulate small_angle', 'demo', 'paper'])
def test_a_file_that_should_be_a_folder_is_named(call, flights, capsys):
    assert main([*call.split(), '-o', str(flights['z'])]) == 2
    assert f'{flights["z"]}: this is a file; name a folder' in capsys.readouterr().err


@pytest.mark.parametrize('call, said', [
    ('fly circle --seed 1.5', "--seed: expected a whole number, got '1.5'"),
    ('fly circle --duration long', "--duration: expected a number, got 'long'"),
    ('info a.csv --from start', "--from: expected a number, got 'start'")])
def test_what_is_no_number_is_named_with_what_is_expected(call, said, capsys):
    with pytest.raises(SystemExit) as end:
        main(call.split())
    assert end.value.code == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize('call', ['fit FLIGHT --vehicle paper_quadrotor --free mass',
                                  'diagnose FLIGHT --vehicle paper_quadrotor'])
def test_a_vehicle_is_written_to_no_other_kind_of_file(call, flights, tmp_path, capsys):
    other = tmp_path / 'other.csv'
    other.write_text('mine')
    words = call.replace('FLIGHT', str(flights['z'])).split()
    assert main([*words, '--out-vehicle', str(other)]) == 2
    assert 'to a .yaml file' in capsys.readouterr().err and other.read_text() == 'mine'


# FLIGHT stands for a flight, FOLDER for an empty folder.
BAD_CALLS = {
    'no such file': 'identify FOLDER/none.csv',
    'a folder that is not a bag': 'identify FOLDER',
    'no flight to look at': 'info FOLDER/none.csv',
    'a mapping that is not there': 'info FLIGHT --mapping FOLDER/none.yaml',
    'a format that is not written': 'convert FLIGHT FOLDER/out.txt',
    'no such experiment': 'simulate smal_angle',
    'no such vehicle': 'simulate small_angle --vehicle none',
    'unknown noise channel': 'simulate small_angle --noise atitude=1',
    'noise that is not a number': 'simulate small_angle --noise attitude=x',
    'noise below zero': 'simulate small_angle --noise attitude=-1',
    'noise without a value': 'simulate small_angle --noise attitude',
    'negative seed': 'identify FLIGHT --seed -1',
    'no evaluations': 'identify FLIGHT --evaluations 0',
    'empty bounds': 'identify FLIGHT --trim hover --pole-bounds 1 -1',
    'nothing excited': 'identify FLIGHT',
    'unknown kind of picture': 'identify FLIGHT --trim hover --method ls --picture FOLDER/x.none',
    'output below a file': 'simulate small_angle -o FLIGHT/x',
    'json below a file': 'identify FLIGHT --trim hover --method ls --json FLIGHT/x.json',
}


@pytest.mark.parametrize('call', BAD_CALLS.values(), ids=BAD_CALLS)
def test_bad_input_gets_one_line_and_exit_code_2(call, flights, tmp_path, capsys):
    words = [word.replace('FLIGHT', str(flights['z'])).replace('FOLDER', str(tmp_path))
             for word in call.split()]
    assert main(words) == 2
    said = capsys.readouterr().err.strip()
    assert said.startswith('quad_ident ')
    assert ': error: ' in said
    assert '\n' not in said


@pytest.mark.parametrize(('call', 'meant'), [
    ('diagnos a.csv', 'diagnose'), ('identify a.csv --metod ls', '--method'),
    ('diagnose a.csv --vehicle iris --out-priors p.yaml', '--priors'),
    ('diagnose a.csv --vehicle hummingbrd', 'hummingbird'),
    ('diagnose a.csv --vehicle iris --effects rotor_drga', 'rotor_drag'),
    ('fly figur8 --vehicle iris -o a.csv', 'figure8'),
    ('export iris --to gazeboo -o a.sdf', 'gazebo'),
    ('identify a.csv --trim recrd', 'record')])
def test_a_wrong_name_is_told_with_the_one_that_may_be_meant(call, meant, capsys):
    try:
        code = main(call.split())
    except SystemExit as end:
        code = end.code
    assert code == 2
    *_, last = capsys.readouterr().err.splitlines()
    assert ': error: ' in last and last.endswith(f'did you mean {meant!r}?')


def test_a_name_with_an_ending_is_that_of_a_file(capsys):
    for call in ('vehicle quad.sdf', 'diagnose a.csv --vehicle quad.xml'):
        assert main(call.split()) == 2
        assert 'there is no such file' in capsys.readouterr().err


@pytest.mark.parametrize('call', ['--nonsense', 'identify a.csv --trim zzz', 'info a.csv --zzz',
                                  'xyz'])
def test_a_name_like_no_other_is_refused_without_a_guess(call, capsys):
    with pytest.raises(SystemExit) as end:
        main(call.split())
    said = capsys.readouterr().err
    assert end.value.code == 2 and 'did you mean' not in said and call.split()[-1] in said


def test_help_loads_no_library():
    """It took a second and a half."""
    code = """if True:
        import sys
        from quad_ident_ros.cli.main import COMMANDS, main
        try:
            main(['--help'])
        except SystemExit as end:
            assert end.code == 0
        assert not {'numpy', 'numba', 'scipy', 'rich', 'yaml'} & set(sys.modules)
        """
    done = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert all(f'\n    {name} ' in done.stdout for name in COMMANDS)


@pytest.mark.parametrize('name', list(COMMANDS))
def test_every_command_has_a_parser_in_the_module_of_its_name(name):
    parsed = parser([name])[1][name]
    assert name == 'withheld' or parsed.get_default('run') or parsed._actions[1:]
