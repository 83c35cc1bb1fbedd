# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of the flight record in memory."""

import copy
import pickle

import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord, unit
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import quaternion_from_euler


def record(count=5, **columns):
    """Return a record at 10 Hz from t = 3 s with the given columns."""
    return FlightRecord(3 + 0.1 * np.arange(count), columns)


def one_line(caught, *parts):
    """Return whether an error is one line that has all of the parts."""
    text = str(caught.value)
    assert '\n' not in text
    assert all(part in text for part in parts), text


def test_columns_and_length():
    """Columns come back as float64, by name and side by side, in the order asked for."""
    flight = record(3, pz=[1, 2, 3], extra=np.array([4.0, np.nan, 6.0]))
    assert len(flight) == 3
    assert flight.has('t', 'pz', 'extra')
    assert not flight.has('pz', 'px')
    assert flight.columns['pz'].dtype == np.float64
    np.testing.assert_array_equal(flight.stack('pz', 't'), np.stack([[1, 2, 3], flight.t], -1))


def test_arrays_are_read_only_and_the_callers_stay_writable():
    """A record cannot be changed through its arrays, nor does it lock the ones it was given."""
    t, height = np.arange(4.0), np.zeros(4)
    flight = FlightRecord(t, {'pz': height})
    with pytest.raises(ValueError):
        flight.columns['pz'][0] = 1
    with pytest.raises(ValueError):
        flight.t[0] = 1
    t[0] = -1
    height[0] = 1


def test_columns_and_info_are_those_at_construction():
    """Changes of the mappings that were given do not reach the record."""
    columns, info = {'pz': np.zeros(2)}, {'name': 'a'}
    flight = FlightRecord(np.arange(2.0), columns, info)
    columns['px'] = np.zeros(2)
    info['name'] = 'b'
    assert not flight.has('px')
    assert flight.info == {'name': 'a'}


def test_records_can_be_copied_and_sent_to_other_processes():
    """A record survives pickle and deepcopy."""
    flight = FlightRecord(np.arange(3.0), {'pz': np.arange(3.0)}, {'name': 'a'})
    for other in pickle.loads(pickle.dumps(flight)), copy.deepcopy(flight):
        np.testing.assert_array_equal(other.stack('t', 'pz'), flight.stack('t', 'pz'))
        assert other.info == flight.info


@pytest.mark.parametrize('times, parts', [
    ([0, 1, 1, 2], ['sample 2', "'t'", 'does not come after']),
    ([0, 2, 1, 3], ['sample 2', "'t'"]),
    ([0, 1e-3, 1e-3 + 1e-13, 1], ['sample 2', "'t'", 'less than a picosecond after']),
    (np.arange(4) * 1e-310, ['sample 1', "'t'", 'less than a picosecond after']),
    ([0, np.nan, 1, 2], ['sample 1', "'t'", 'nan']),
    ([0, 1, 2, np.inf], ['sample 3', "'t'", 'inf']),
    ([0], ['1 sample']),
    ([], ['0 samples']),
    ([[0, 1]], ["'t'", 'shape']),
    (['a', 'b'], ["'t'", 'not numbers']),
])
def test_bad_times(times, parts):
    """Times that do not increase strictly are refused, with their place."""
    with pytest.raises(InputError) as caught:
        FlightRecord(times, {}, {'name': 'flight7'})
    one_line(caught, 'flight7', *parts)


@pytest.mark.parametrize('name, values, parts', [
    ('cmd3', [0, 1, np.nan], ['sample 2', "'cmd3'", 'nan']),
    ('qw', [0, -np.inf, 1], ['sample 1', "'qw'", 'inf']),
    ('pz', [0, 1], ["'pz'", 'shape', '3']),
    ('pz', np.zeros((3, 1)), ["'pz'", 'shape']),
    ('extra', ['a', 'b', 'c'], ["'extra'", 'not numbers']),
    ('t', [0, 1, 2], ['repeat t']),
    ('', [0, 1, 2], ['column name']),
    (' a', [0, 1, 2], ['column name']),
    ('a\nb', [0, 1, 2], ['column name']),
    (7, [0, 1, 2], ['column name']),
])
def test_bad_columns(name, values, parts):
    """Columns that do not fit are refused, with their place."""
    with pytest.raises(InputError) as caught:
        FlightRecord([0, 1, 2], {name: values}, {'name': 'flight7'})
    one_line(caught, 'flight7', *parts)


def test_unknown_columns_may_hold_anything_numeric():
    """Only known columns need to be finite."""
    flight = record(2, extra=[np.nan, np.inf], cmd0=[np.nan, 0], flag=[True, False])
    assert np.isnan(flight.columns['extra'][0])
    assert flight.columns['flag'].tolist() == [1, 0]


def test_units():
    """Each column of the format has its unit, whatever the number of rotors; no other has one."""
    assert unit('t') == 's'
    assert unit('az') == 'm/s^2'
    assert unit('u4') == 'N m'
    assert unit('cmd1') == unit('rotor12') == 'rad/s'
    assert all(unit(name) is None for name in ('cmd', 'cmd0', 'cmd1x', 'rotor-1', 'u5', 'T', ''))


def test_missing_columns_are_named():
    """The error for missing columns says which are missing and which exist."""
    with pytest.raises(InputError) as caught:
        record(3, px=np.zeros(3)).stack('px', 'vx', 'vy')
    one_line(caught, 'vx, vy', 't, px')
    with pytest.raises(InputError) as caught:
        record(3, u1=np.zeros(3)).inputs()
    one_line(caught, 'u2, u3, u4')


def test_inputs():
    """The inputs are u1..u4 in this order."""
    flight = record(2, u4=[4, 4], u2=[2, 2], u1=[1, 1], u3=[3, 3])
    assert flight.inputs().tolist() == [[1, 2, 3, 4]] * 2


def test_euler_columns_come_first():
    """Angles that the record has are taken as they are."""
    flight = record(2, phi=[7, 8], theta=[0, 0], psi=[9, 9],
                    qw=[1, 1], qx=[0, 0], qy=[0, 0], qz=[0, 0])
    assert flight.euler().tolist() == [[7, 0, 9], [8, 0, 9]]


@pytest.mark.parametrize('scale', [1.0, 0.998])
def test_euler_from_quaternions_with_jumping_sign(scale):
    """Neither a turn past pi nor a flip of the sign makes the angles jump."""
    count = 200
    angles = np.stack([0.3 * np.sin(np.arange(count) / 9), 0.2 * np.cos(np.arange(count) / 7),
                       2.5 + 0.05 * np.arange(count)], -1)
    quaternion = scale * quaternion_from_euler(angles)
    quaternion[::3] *= -1
    flight = record(count, **dict(zip(('qw', 'qx', 'qy', 'qz'), quaternion.T, strict=True)))
    np.testing.assert_allclose(flight.euler(), angles, atol=1e-9)


def test_euler_without_attitude():
    """Without a valid attitude there are no angles."""
    with pytest.raises(InputError) as caught:
        record(2, phi=[0, 0], theta=[0, 0], qw=[1, 1]).euler()
    one_line(caught, 'no attitude', 'qw, qx, qy, qz', 'phi, theta, psi')
    with pytest.raises(InputError) as caught:
        record(3, qw=[1, 0, 1], qx=[0, 0, 0], qy=[0, 0, 0], qz=[0, 0, 0]).euler()
    one_line(caught, 'sample 1', 'zero')


def test_parts():
    """A part has the samples of its range and keeps where it is from."""
    flight = FlightRecord(np.arange(10.0), {'pz': np.arange(10.0) ** 2}, {'name': 'a'})
    part = flight.slice(2, 5)
    assert part.t.tolist() == [2, 3, 4]
    assert part.columns['pz'].tolist() == [4, 9, 16]
    assert part.info == {'name': 'a'}
    assert flight.slice(-3).t.tolist() == [7, 8, 9]
    assert flight.last(2.5).t.tolist() == [7, 8, 9]
    assert len(flight.last(1e9)) == 10
    with pytest.raises(InputError):
        flight.slice(4, 5)
    with pytest.raises(InputError):
        flight.last(0)


def test_period_is_that_of_most_samples():
    """Gaps do not change the period."""
    assert FlightRecord([0, 0.25, 0.5, 0.75, 9], {}).period() == 0.25
