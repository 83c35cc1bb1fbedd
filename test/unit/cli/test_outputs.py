# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where commands may write, said before any work."""

from argparse import Namespace
import json
import os
from pathlib import Path
import subprocess
import sys

import pytest
from reader_checks import SMALL

from quad_ident_ros.cli.main import main
from quad_ident_ros.cli.outputs import check_outputs, OUTPUTS
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle


@pytest.mark.parametrize('other', ['same', './same', '../{here}/same'])
def test_two_outputs_do_not_write_over_one_another(tmp_path, monkeypatch, other):
    monkeypatch.chdir(tmp_path)
    options = Namespace(json='same', report=other.format(here=tmp_path.name))
    with pytest.raises(InputError, match='over another output'):
        check_outputs(options)


def test_outputs_of_other_names_and_standard_output_are_fine(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    check_outputs(Namespace(json='-', report='a.html', out_vehicle='a.yaml'))


@pytest.mark.parametrize('option', ['json', 'report', 'picture'])
def test_a_folder_is_no_file_to_write(tmp_path, option):
    with pytest.raises(InputError, match='this is a folder; name a file'):
        check_outputs(Namespace(**{option: str(tmp_path)}))


@pytest.mark.parametrize('name', ['a.pdf', 'a', 'a.html.gz'])
def test_a_report_is_a_page_for_a_browser(name):
    with pytest.raises(InputError, match=r'name a file that ends in \.html'):
        check_outputs(Namespace(report=name))


@pytest.mark.parametrize('option', ['base', 'mapping'])
def test_a_folder_is_no_file_to_read(tmp_path, option):
    with pytest.raises(InputError, match='this is a folder; name a file'):
        check_outputs(Namespace(**{option: str(tmp_path)}, output=str(tmp_path / 'a')))


@pytest.mark.parametrize('words', [
    ['vehicle', 'iris', '-o', 'new/v.yaml'], ['vehicle', 'iris', '--json', 'new/v.json'],
    ['export', 'iris', '--to', 'gazebo', '-o', 'new/v.sdf'],
    ['fly', 'circle', '--vehicle', 'iris', '--duration', '5', '-o', 'new/f.csv'],
    ['convert', 'f.csv', 'new/f.csv'], ['convert', 'f.csv', 'new/bag'],
    ['convert', 'f.csv', 'new/f.mcap'], ['info', 'f.csv', '--write-mapping', 'new/m.yaml']])
def test_folders_that_are_not_there_are_made(tmp_path, monkeypatch, words):
    monkeypatch.chdir(tmp_path)
    write_csv(tmp_path / 'f.csv', SMALL)
    main(words)
    place = Path(words[-1])
    assert list(Path('new').iterdir()) == [place]
    assert place.is_file() or any(place.iterdir())


@pytest.fixture
def closed():
    """Return a folder in which not even root, who has all permissions, can make a file."""
    folder = Path('/proc')
    if not folder.is_dir():
        pytest.skip('no such folder here')
    return folder


@pytest.mark.parametrize('option', OUTPUTS)
@pytest.mark.parametrize('name', ['a', 'new/a'])
def test_a_folder_that_cannot_be_written_to_is_told_before_the_work(closed, option, name):
    ending = {'report': '.html', 'out_vehicle': '.yaml'}.get(option, '')
    with pytest.raises(InputError, match=f'cannot be written into {closed}: '):
        check_outputs(Namespace(**{option: f'{closed}/{name}{ending}'}))


def test_a_folder_to_write_into_is_tried_itself(closed):
    with pytest.raises(InputError, match=f'cannot be written into {closed}: '):
        check_outputs(Namespace(output=str(closed)))


def test_a_name_too_long_for_the_disk_is_told_before_the_work(tmp_path):
    with pytest.raises(InputError, match='File name too long; give another path'):
        check_outputs(Namespace(json=str(tmp_path / ('a' * 250))))


def test_what_is_tried_leaves_nothing_behind(tmp_path):
    check_outputs(Namespace(report=str(tmp_path / 'new' / 'a.html'), output=str(tmp_path / 'b')))
    assert not list(tmp_path.iterdir())


def test_a_device_is_written_to_as_it_is():
    assert main(['vehicle', 'iris', '--json', '/dev/null']) == 0


def test_a_pipe_is_written_to_as_it_is():
    """As bash gives one: --json >(jq .name)."""
    out, into = os.pipe()
    assert main(['vehicle', 'iris', '--json', f'/dev/fd/{into}']) == 0
    os.close(into)
    with open(out, encoding='utf-8') as read:
        assert json.load(read)['vehicle']['name'] == 'iris'


@pytest.mark.parametrize(('command', 'words'), [
    ('diagnose', ['f.csv', '--vehicle', 'iris', '--out-vehicle']),
    ('fit', ['f.csv', '--vehicle', 'iris', '--free', 'mass', '--out-vehicle'])])
def test_a_vehicle_is_not_sought_where_it_cannot_be_written(closed, capsys, command, words):
    """The flight is missing as well: the error that is known first comes first."""
    assert main([command, *words, f'{closed}/real.yaml']) == 2
    assert f'real.yaml: cannot be written into {closed}: ' in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize('words, files', [
    (['info', 'f.csv', '--json', 'info.json'], ['info.json']),
    (['diagnose', 'f.csv', '--vehicle', 'hummingbird', '--effects', 'rotor_drag', '--json',
      'd.json', '--report', 'd.html', '--out-vehicle', 'd.yaml'],
     ['d.json', 'd.html', 'd.yaml'])])
def test_who_has_read_enough_has_the_files_all_the_same(tmp_path, words, files):
    """As by `| head -1`, or a pager that is left."""
    write_csv(tmp_path / 'f.csv', fly_closed_loop(
        load_vehicle('hummingbird'), {'rotor_drag': {'coefficient': 0.3}}, 'figure8',
        duration=8.0, noise=SENSORS['mocap_imu']))
    reads, writes = os.pipe()
    os.close(reads)
    with os.fdopen(writes, 'wb') as nobody:
        done = subprocess.run([sys.executable, '-m', 'quad_ident_ros', *words], cwd=tmp_path,
                              stdout=nobody, stderr=subprocess.PIPE, text=True, check=False,
                              env={**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)})
    assert done.returncode == 0 and 'Traceback' not in done.stderr
    assert all((tmp_path / name).stat().st_size for name in files)
