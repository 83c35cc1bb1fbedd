# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables of several vehicles, by row or by column, are read as a flight of each."""

from flightmaker import flight
import numpy as np
import pyarrow
from pyarrow import parquet
import pytest
from reader_checks import refused
from table_files import motive, PLACE, Q

from quad_ident_ros.data.load import contents_of, load, load_all
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.data.quality.fleet import vehicles

FLIGHTS = {'cf1': flight(seconds=8.0, rate=50.0),
           'cf2': flight(seconds=8.0, rate=50.0, seed=1, start=3.0)}
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


@pytest.mark.parametrize('named', ['id', 'name'])
def test_a_column_that_numbers_waypoints_cuts_no_flight(tmp_path, named):
    head, lines = rows(named)
    of_one = lines[::len(FLIGHTS)]
    read = load(written(tmp_path, head, [[t, 1 + 4 * k // len(of_one), *values]
                                         for k, (t, _, *values) in enumerate(of_one)]))
    np.testing.assert_allclose(read.stack(*PLACE), FLIGHTS['cf1'].stack(*PLACE), atol=1e-9)


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


def side_by_side(folder, spelling, names, who=tuple(FLIGHTS)):
    """Return the path of a table with the columns of each vehicle beside those of the other."""
    values = [record.stack(*PLACE, *Q) for record in FLIGHTS.values()]
    head = ['t', *(spelling.format(label, name) for label in who for name in names), 'm_1']
    return written(folder, head, [[0.02 * k, *np.hstack([one[k] for one in values]).tolist(), k]
                                  for k in range(len(values[0]))])


@pytest.mark.parametrize('spelling, names, who', [
    ('{}.{}', NAMES, ('cf1', 'cf2')), ('/{}/{}', NAMES, ('uav_1', 'uav_2')),
    ('{} {}', ('Position X', 'Position Y', 'Position Z', 'Rotation W', 'Rotation X', 'Rotation Y',
               'Rotation Z'), ('RigidBody 1', 'RigidBody 2'))])
def test_columns_of_several_vehicles_are_a_flight_of_each(tmp_path, spelling, names, who):
    path = side_by_side(tmp_path, spelling, names, who)
    found = load_all(path)
    check(found)
    assert [record.info['name'] for record in found] == [f'swarm_{label}' for label in who]
    assert f'columns of vehicle {who[1]} of {", ".join(who)}' in found[1].info['notes'][0]
    assert any('of no vehicle by their names: m_1' in note for note in found[0].info['notes'])
    columns = {'t': 't', **{role: spelling.format(who[1], name)
                            for role, name in zip((*PLACE, *Q), names, strict=True)}}
    one = load(path, mapping_from({'columns': columns}, 'm'))
    np.testing.assert_allclose(one.stack(*PLACE), FLIGHTS['cf2'].stack(*PLACE), atol=1e-9)


def test_two_objects_of_vicon_are_a_flight_of_each(tmp_path):
    """Their names stand above the first of the columns of each."""
    values = [record.stack('qx', 'qy', 'qz', 'qw', *PLACE) * ([1.0] * 4 + [1e3] * 3)
              for record in FLIGHTS.values()]
    axes = ['RX', 'RY', 'RZ', 'RW', 'TX', 'TY', 'TZ']
    path = tmp_path / 'swarm.csv'
    path.write_text('Objects\n50\n,,cf1,,,,,,,cf2,,,,,,\nFrame,Sub Frame,'
                    + ','.join(axes * 2) + '\n,,,,,,mm,mm,mm,,,,,mm,mm,mm\n' + ''.join(
                        f'{k},0,{",".join(map(str, np.hstack([one[k] for one in values])))}\n'
                        for k in range(len(values[0]))))
    found = load_all(path)
    check(found)
    assert [record.info['name'] for record in found] == ['swarm_cf1', 'swarm_cf2']


@pytest.mark.parametrize('names', [('Alice', 'Bob'), ('cf1', 'cf2'), ('cf', 'cf 2')])
def test_two_bodies_of_motive_are_a_flight_of_each(tmp_path, names):
    """Their markers are no vehicles."""
    bodies = {name: (record.stack('qx', 'qy', 'qz', 'qw'), record.stack(*PLACE))
              for name, record in zip(names, FLIGHTS.values(), strict=True)}
    path = motive(tmp_path, 0.02 * np.arange(400), bodies, markers=2)
    found = load_all(path)
    check(found)
    assert [record.info['name'] for record in found] == [f'take_{name}' for name in names]
    assert [stream.name for stream in contents_of(path)[1]] == [f'rows of {name}'
                                                                for name in names]


def test_of_two_in_formation_none_is_taken_without_a_word(tmp_path):
    """They move alike, as raw and filtered positions of one do."""
    one = FLIGHTS['cf1'].stack(*PLACE)
    other = one + [1.0, 0.0, 0.0]
    head = ['t', *(f'{name}_pos_{axis}' for name in ('bob', 'alice') for axis in 'xyz')]
    path = written(tmp_path, head, [[0.02 * k, *one[k].tolist(), *other[k].tolist()]
                                    for k in range(len(one))])
    refused(path, 'bob_pos_x', 'or alice_pos_x')
