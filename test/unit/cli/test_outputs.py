# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where commands may write, said before any work."""

from argparse import Namespace
from pathlib import Path

import pytest
from reader_checks import SMALL

from quad_ident_ros.cli.main import main
from quad_ident_ros.cli.outputs import check_outputs
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.errors import InputError


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


def test_a_folder_without_permission_is_told_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr('os.access', lambda place, mode: Path(place) != tmp_path)
    with pytest.raises(InputError, match=f'nothing can be written into {tmp_path};'):
        check_outputs(Namespace(report=str(tmp_path / 'new' / 'a.html')))
    check_outputs(Namespace(report=str(tmp_path.parent / 'a.html')))
