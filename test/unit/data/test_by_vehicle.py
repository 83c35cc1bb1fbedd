# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables with rows of several vehicles are read as a flight of each."""

from flightmaker import flight
import numpy as np
import pyarrow
from pyarrow import parquet
import pytest
from table_files import PLACE, Q

from quad_ident_ros.data.load import contents_of, load, load_all
from quad_ident_ros.data.quality.fleet import vehicles

FLIGHTS = {'cf1': flight(seconds=8.0, rate=50.0), 'cf2': flight(seconds=8.0, rate=50.0, seed=1,
                                                              start=3.0)}
NAMES = ('x', 'y', 'z', 'qw', 'qx', 'qy', 'qz')


def rows(named, names=NAMES):
    """Return the head and the rows of all flights, in turn, as a program of a swarm logs them."""
    values = [record.stack(*PLACE, *Q) for record in FLIGHTS.values()]
    return ['t', named, *names], [[0.02 * k, label, *one[k].tolist()]
                                  for k in range(len(values[0]))
                                  for label, one in zip(FLIGHTS, values, strict=True)]


def written(folder, head, lines):
    path = folder / 'swarm.csv'
    path.write_text('\n'.join(','.join(map(str, line)) for line in [head, *lines]) + '\n')
    return path


def check(found):
    """Check that records are FLIGHTS; their rows alternated, and the second was left out."""
    assert len(found) == len(FLIGHTS)
    for one, record in zip(found, FLIGHTS.values(), strict=True):
        np.testing.assert_allclose(one.stack(*PLACE), record.stack(*PLACE), atol=1e-9)
        np.testing.assert_allclose(one.stack(*Q), record.stack(*Q), atol=1e-9)


@pytest.mark.parametrize('named', ['name', 'drone_id', 'Vehicle'])
def test_rows_of_several_vehicles_are_a_flight_of_each(tmp_path, named):
    path = written(tmp_path, *rows(named))
    found = load_all(path)
    check(found)
    assert [record.info['name'] for record in found] == ['swarm_cf1', 'swarm_cf2']
    assert any(f"rows of vehicle cf2 of cf1, cf2, by column '{named}'" in note
               for note in found[1].info['notes'])
    assert 'they come from 2 vehicles' in vehicles(found)[0]['message']
    assert [stream.name for stream in contents_of(path)[1]] == ['rows of cf1', 'rows of cf2']


@pytest.mark.parametrize('names', [NAMES, (*PLACE, *Q)])
def test_vehicles_may_have_numbers(tmp_path, names):
    head, lines = rows('id', names)
    check(load_all(written(tmp_path, head, [[line[0], line[1][2:], *line[2:]] for line in lines])))


def test_vehicles_in_parquet(tmp_path):
    head, lines = rows('name')
    path = tmp_path / 'swarm.parquet'
    parquet.write_table(pyarrow.table(dict(zip(head, zip(*lines, strict=True), strict=True))),
                        path)
    check(load_all(path))


def test_rows_of_several_streams_are_one_flight(tmp_path):
    """A column may name what a row is of; only together they are a flight."""
    head, lines = rows('name')
    lines = [[t, *([label, *values[:3], '', '', '', ''] if label == 'cf1' else
                   [label, '', '', '', *values[3:]])] for t, label, *values in lines]
    assert load(written(tmp_path, head, lines)).has('px', 'qw')
