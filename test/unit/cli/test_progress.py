# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Commands that may work for seconds say what they do, and write nothing of it into a pipe."""

from contextlib import contextmanager
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.cli import export, export_draws, simulate, vehicle
from quad_ident_ros.cli.main import main
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.covariance import covariance_of_matrix
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.vehicle_files.draws import draw, table_of_draws


class Bar:
    """What a progress bar is told."""

    def __init__(self):
        self.said, self.shares = [], []

    def add_task(self, description, total=None):
        """Begin something."""
        self.update(0, description=description, total=total)
        return 0

    def remove_task(self, task):
        """End it."""

    def update(self, task, description='', completed=None, total=None):
        """Say how far it is."""
        if description and description not in self.said:
            self.said.append(description)
        if completed is not None:
            self.shares.append(completed)


@pytest.fixture
def told(monkeypatch):
    """Return the Bar that the commands here get."""
    bar = Bar()

    @contextmanager
    def shown(quiet=False):
        yield bar

    for command in (export, export_draws, simulate, vehicle):
        monkeypatch.setattr(command, 'progress_bar', shown)
    return bar


def test_a_simulation_says_which_run_is_flown_and_how_far_it_is(told, tmp_path, monkeypatch):
    def fly(experiment, run, on_progress, **_):
        on_progress(0.5)
        t = np.linspace(0.0, 1.0, 11)
        columns = dict.fromkeys(('phi', 'theta', 'psi', 'pz'), 0.0 * t)
        return SimpleNamespace(record=FlightRecord(t, columns, {'infeasible': None}),
                               status='complete', end_time=1.0)

    monkeypatch.setattr(simulate, 'fly', fly)
    assert main(['simulate', 'paper_unit_steps_newton_euler', '-o', str(tmp_path)]) == 0
    [path] = tmp_path.iterdir()
    assert told.said[0].startswith('flying ') and told.said[1] == f'writing {path}'
    assert told.shares == [0.5]


def test_a_vehicle_file_that_is_read_is_named(told, capsys):
    assert main(['vehicle', 'hummingbird']) == 0
    assert told.said == ['reading hummingbird']


def test_an_export_names_its_steps_and_flights(told, tmp_path, monkeypatch):
    written = tmp_path / 'quad.sdf'
    assert main(['export', 'hummingbird', '--to', 'gazebo', '-o', str(written)]) == 0
    assert told.said == ['changing a new file']
    monkeypatch.setattr('quad_ident_ros.cli.options.flights_from', lambda path, *_: [path])

    def cost_of(found, vehicle, records, on_progress):
        assert records == ['a.csv', 'b.csv']
        on_progress(0.75)

    monkeypatch.setattr(export, 'cost_of', cost_of)
    assert main(['export', 'hummingbird', '--to', 'gazebo', '--base', str(written), '--flight',
                 'a.csv', 'b.csv', '-o', str(tmp_path / 'other.sdf'), '--json',
                 str(tmp_path / 'e.json')]) == 0
    assert told.said[1:] == ['reading a.csv', 'reading b.csv', f'changing {written}',
                             'measuring the gap']
    assert told.shares == [0.0, 0.5, 0.0, 0.75]


@pytest.fixture
def known(tmp_path):
    """Return a vehicle file with a covariance."""
    path = tmp_path / 'known.yaml'
    write_vehicle(path, replace(load_vehicle('hummingbird'), covariance=covariance_of_matrix(
        ('mass',), np.array([[1e-4]]))))
    return path


def test_drawn_vehicles_say_what_is_drawn_and_written(told, known, tmp_path):
    array = tmp_path / 'vehicles.npz'
    assert main(['export', str(known), '--randomise', '200', '-o', str(array)]) == 0
    assert told.said == ['drawing vehicles', f'writing {array}']
    assert told.shares[-5:] == [0.0, 0.0, 0.32, 0.64, 0.96]


def test_a_table_of_draws_tells_how_far_it_is(known):
    shares = []
    names, _, values = table_of_draws(draw(load_vehicle(known), 130), shares.append)
    assert shares == [0.0, 64 / 130, 128 / 130] and values.shape == (130, len(names))


@pytest.mark.parametrize('words', [['vehicle', 'hummingbird'],
                                   ['export', 'hummingbird', '--to', 'gazebo', '-o', 'q.sdf']])
def test_where_standard_error_is_no_terminal_it_stays_empty(words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 0
    assert capsys.readouterr().err == ''
