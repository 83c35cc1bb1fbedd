# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A run over a fleet beside another one, and on workers elsewhere, with short diagnoses."""


import os

import pytest

from quad_ident_ros.cluster import Done
from quad_ident_ros.errors import InputError

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
from quad_ident_ros.fleet import run  # noqa: E402, I100
from quad_ident_ros.fleet.grouping import Group  # noqa: E402, I100
from quad_ident_ros.fleet.plan import planned  # noqa: E402, I100
from quad_ident_ros.fleet.store import read_table  # noqa: E402, I100
from quad_ident_ros.fleet.work import Outcome, write  # noqa: E402, I100


def test_two_runs_of_which_one_has_more_flights_leave_each_flight_once(tmp_path, monkeypatch):
    """The narrower one ends while the wider one works; what it wrote gives way."""
    folder = tmp_path / 'flights' / 'seven' / '2026-05-14'
    folder.mkdir(parents=True)
    for name in 'ab':
        (folder / f'{name}.csv').write_text(f't,px\n0,{ord(name)}\n0.1,2\n', encoding='utf-8')

    def results(_, function, items, *__, other=None):
        for item in items:
            if isinstance(item, Group):
                if other:
                    other()
                outcome = Outcome('diagnosed', '', 1.0)
                write(item, tmp_path, outcome)
                yield Done(item, outcome)
            else:
                yield Done(item, function(item))

    def narrow():
        monkeypatch.setattr(run, 'results', results)
        run.run_fleet(None, planned([str(folder / 'a.csv')], vehicle='hummingbird'), tmp_path)

    monkeypatch.setattr(run, 'results', lambda *some: results(*some, other=narrow))
    run.run_fleet(None, planned([str(tmp_path / 'flights')], vehicle='hummingbird'), tmp_path)
    assert sorted(path[-5:] for path in read_table(tmp_path, 'flights')['path'].to_pylist()) == [
        'a.csv', 'b.csv']


@pytest.fixture
def flight(tmp_path, monkeypatch):
    """Write a flight that is refused at once, and go to the folder that it is in."""
    path = tmp_path / 'here' / 'flights' / 'seven' / '2026-05-14' / 'a.csv'
    path.parent.mkdir(parents=True)
    path.write_text('t,px\n0,1\n0.1,2\n', encoding='utf-8')
    (tmp_path / 'elsewhere').mkdir()
    monkeypatch.chdir(tmp_path / 'here')
    return path


def elsewhere(monkeypatch, folder, function):
    """Have the work done as by workers that are started in another folder."""
    def results(_, given, items, *__):
        for item in items:
            with monkeypatch.context() as there:
                there.chdir(folder)
                value = function(given, item)
            yield Done(item, value)

    monkeypatch.setattr(run, 'results', results)


def test_workers_in_another_folder_use_the_flights_and_data_set_that_are_meant(
        flight, tmp_path, monkeypatch):
    elsewhere(monkeypatch, tmp_path / 'elsewhere', lambda given, item: given(item))
    summary = run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')
    assert summary.groups['refused'] == 1
    assert read_table('fleet', 'flights')['path'].to_pylist() == [str(flight)]
    assert 'are too short' in read_table('fleet', 'groups')['reason'].to_pylist()[0]


def test_a_name_that_is_no_text_stops_nothing(flight, tmp_path, monkeypatch):
    """As of files from a disk with names in another encoding."""
    os.rename(flight, os.fsencode(flight.parent) + b'/bad\xff.csv')
    elsewhere(monkeypatch, tmp_path, lambda given, item: given(item))
    for _ in range(2):
        summary = run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')
        assert summary.groups['refused'] == 1
        assert read_table('fleet', 'flights')['path'].to_pylist() == [
            str(flight.parent / 'bad\\udcff.csv')]


def test_results_that_are_written_somewhere_else_are_missed(flight, tmp_path, monkeypatch):
    """As by workers in containers that have a folder of their own under this path."""
    elsewhere(monkeypatch, tmp_path, lambda given, item: (
        Outcome('diagnosed', '', 1.0) if isinstance(item, Group) else given(item)))
    monkeypatch.setattr(run, 'SHOWN_AFTER', 0.0)
    with pytest.raises(InputError, match='results of 1 group are not in it'):
        run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')
