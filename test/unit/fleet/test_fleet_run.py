# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A run over a fleet beside another one, with diagnoses that take no time."""


import pytest

from quad_ident_ros.cluster import Done

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
from quad_ident_ros.fleet import run  # noqa: E402, I100
from quad_ident_ros.fleet.grouping import Group  # noqa: E402, I100
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
        run.run_fleet(None, [str(folder / 'a.csv')], tmp_path, vehicle='hummingbird')

    monkeypatch.setattr(run, 'results', lambda *some: results(*some, other=narrow))
    run.run_fleet(None, [str(tmp_path / 'flights')], tmp_path, vehicle='hummingbird')
    assert sorted(path[-5:] for path in read_table(tmp_path, 'flights')['path'].to_pylist()) == [
        'a.csv', 'b.csv']
