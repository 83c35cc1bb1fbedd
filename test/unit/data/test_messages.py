# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the messages that carry tables."""

from array import array
import json
import math

import numpy as np
import pytest
from std_msgs.msg import Float64MultiArray, MultiArrayDimension

from quad_ident_ros.data.info import CHECKS
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.table import record_from_table
from quad_ident_ros.data.topics import FLIGHT_TOPICS, raw_columns, record_columns, RunNotice
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.messages import parameter_message, record_message

INFO = {'name': 'flight', 'run_index': 2, 'trim': [6.4, 0.0, 0.0, 0.0], 'infeasible': None}


def flight(count=5):
    t = 0.01 * np.arange(count)
    return FlightRecord(t, {'u1': np.sin(t), 'pz': 1e300 * t, 'extra': -t / 3}, INFO)


def message(*, label='t,pz', sizes=(3, 2, 1), data=(0.0, 1.0, 0.1, 2.0, 0.2, 3.0), info='{}',
            dimensions=3):
    """Return a record message of parts that need not fit."""
    result = Float64MultiArray()
    labels = ('samples', label, info)
    for k in range(dimensions):
        result.layout.dim.append(MultiArrayDimension(label=labels[k], size=sizes[k]))
    result.data = array('d', data)
    return result


@pytest.mark.parametrize('name', sorted(CHECKS))
def test_an_entry_of_the_info_that_nobody_can_use_is_refused(name):
    """Such as one of a damaged bag, or of a program that calls something else so."""
    for odd in ({'z': ['y']}, None, 'x', 1e308, math.nan, 10 ** 400, [[]], [None] * 4,
                [1e308] * 4):
        info = {name: odd}
        notice = {'start_ns': 0, 'stop_ns': 9, 'samples': 10, 'info': info}
        if CHECKS[name](odd):
            record_from_table(message(info=json.dumps(info)))
            continue
        with pytest.raises(InputError, match=f'the info {name} of the record is not'):
            record_from_table(message(info=json.dumps(info)))
        with pytest.raises(InputError, match='announces no run'):
            RunNotice.from_json(json.dumps(notice))
    assert not CHECKS[name](math.inf)


def test_parameters_are_labelled_and_strided():
    sent = parameter_message(np.arange(12.0).reshape(4, 3))
    rows, columns = sent.layout.dim
    assert (rows.label, rows.size, rows.stride) == ('phi,theta,psi,z', 4, 12)
    assert (columns.label, columns.size, columns.stride) == ('K,a,b', 3, 3)
    assert sent.layout.data_offset == 0
    assert list(sent.data) == list(range(12))


def test_parameters_keep_what_is_no_number():
    table = np.full((4, 3), np.nan)
    table[2] = 1.0, 2.0, 3.0
    np.testing.assert_array_equal(np.reshape(parameter_message(table).data, (4, 3)), table)


def test_a_record_reads_back_as_it_was():
    sent = record_message(flight())
    assert [(d.label, d.size, d.stride) for d in sent.layout.dim[:2]] == [
        ('samples', 5, 20), ('t,u1,pz,extra', 4, 4)]
    assert (sent.layout.dim[2].size, sent.layout.dim[2].stride) == (1, 1)
    read = record_from_table(sent)
    np.testing.assert_array_equal(read.t, flight().t)
    assert list(read.columns) == ['u1', 'pz', 'extra']
    for name, values in flight().columns.items():
        np.testing.assert_array_equal(read.columns[name], values)
    assert read.info == INFO


def test_the_parts_of_the_helper_fit():
    read = record_from_table(message())
    np.testing.assert_array_equal(read.columns['pz'], [1.0, 2.0, 3.0])
    assert read.info == {}


@pytest.mark.parametrize('parts, said', [
    ({'dimensions': 2}, 'samples x columns x 1'),
    ({'dimensions': 0, 'data': ()}, 'samples x columns x 1'),
    ({'data': (0.0, 1.0)}, 'samples x columns x 1'),
    ({'sizes': (0, 2, 1), 'data': ()}, '0 samples'),
    ({'sizes': (1, 2, 1), 'data': (0.0, 1.0)}, '1 sample'),
    ({'label': 't,pz,px'}, '2 columns but 3 names'),
    ({'label': 'a,b'}, 'no column t'),
    ({'label': 't,'}, 'not a column name'),
    ({'label': 't,t'}, 'twice'),
    ({'info': 'no JSON'}, 'not a JSON object'),
    ({'info': '[1, 2]'}, 'not a JSON object'),
    ({'info': '"text"'}, 'not a JSON object'),
    ({'info': '[' * 100_000}, 'not a JSON object'),
    ({'data': (0.0, 1.0, 0.0, 2.0, 0.2, 3.0)}, 'does not come after'),
    ({'data': (0.0, 1.0, float('nan'), 2.0, 0.2, 3.0)}, 'not a finite number'),
    ({'data': (0.0, 1.0, 0.1, float('inf'), 0.2, 3.0)}, 'not a finite number'),
    ({'info': json.dumps({'run_index': [1]})}, 'run_index'),
    ({'info': json.dumps({'run_count': 'two'})}, 'run_count'),
    ({'info': json.dumps({'dropped': 'many'})}, 'dropped'),
])
def test_what_holds_no_record_is_refused(parts, said):
    with pytest.raises(InputError, match=said) as caught:
        record_from_table(message(**parts))
    assert len(str(caught.value).splitlines()) == 1


def test_all_topics_make_a_whole_record():
    """The columns of the topics, the world's velocity from the body's, altitude before pose."""
    names = raw_columns(FLIGHT_TOPICS)
    assert len(names) == len(set(names)) == 3 + 1 + 7 + 6 + 4
    half = np.sqrt(0.5)   # a quarter turn about z: forward is world y
    row = {'qw': half, 'qz': half, 'body_vx': 2.0, 'body_vy': 1.0, 'body_vz': 3.0, 'pz': 4.0,
           'height': 5.0}
    columns = record_columns(names, [[row.get(name, 0.0) for name in names]] * 2)
    assert not {'height', 'body_vx', 'body_vy', 'body_vz'} & set(columns)
    np.testing.assert_allclose([columns[name][0] for name in ('vx', 'vy', 'vz', 'pz')],
                               [-1.0, 2.0, 3.0, 4.0], atol=1e-12)


def test_the_height_of_the_pose_stands_in_for_the_altitude():
    names = raw_columns(['pose'])
    columns = record_columns(names, [[1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0]] * 2)
    assert [columns[name][0] for name in ('px', 'py', 'pz')] == [1.0, 2.0, 3.0]


def test_a_velocity_without_attitude_is_left_out():
    columns = record_columns(raw_columns(['twist']), [[1.0] * 6] * 2)
    assert list(columns) == ['wx', 'wy', 'wz']
