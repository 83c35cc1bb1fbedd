# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tables whose time counts samples, or is in minutes or hours, without a word on it."""

from flightmaker import flight
import numpy as np
import pytest
from quality_records import A, P, Q, V, W
from reader_checks import refused
from table_files import others, table

from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.attitude import conjugate, rotate

NAMES = {P: 'pos', V: 'vel', W: 'gyro', A: 'acc', Q: 'q'}


def columns(record, t, *groups, name='t'):
    """Return the columns of a table, without some groups, and with a time of any values."""
    left_out = {'timestamp', 'vbat', *(f'{NAMES[group]}_{axis}' for group in groups
                                       for axis in 'wxyz')}
    return {name: t, **{name: values for name, values in others(record).items()
                        if name not in left_out}}


HEADS = ['t', 'time', 'Time', 'timestamp', 'frame', 'sample', 'index', 'Sample Number', 'step']


@pytest.mark.parametrize('head', HEADS)
def test_a_count_of_samples_is_refused_with_its_rate_and_the_line_to_write(tmp_path, head):
    path = table(tmp_path, columns(flight(), np.arange(2000.0), name=head))
    refused(path, 'counts at a rate that the table does not say, about 100 Hz by the other '
                  'columns; write the exact one, such as t: {column: ', 'unit: 100 Hz}')


@pytest.mark.parametrize('first, left_out', [(1, ()), (7000, (3, 50, 51, 700))])
def test_a_count_may_begin_anywhere_and_lack_rows(tmp_path, first, left_out):
    record = flight()
    use = np.delete(np.arange(len(record)), left_out)
    part = FlightRecord(record.t[use], {name: values[use] for name, values in
                                        record.columns.items()})
    refused(table(tmp_path, columns(part, first + use)), 'about 100 Hz by the other columns')


@pytest.mark.parametrize('groups', [(V, W, A, Q), (P, V, Q)], ids=['a track', 'rates'])
@pytest.mark.parametrize('head', HEADS[:5])
def test_a_count_of_which_nothing_shows_the_rate_is_refused(tmp_path, groups, head):
    path = table(tmp_path, columns(flight(), np.arange(2000.0), *groups, name=head))
    refused(path, 'counts at a rate that the table does not say, or is in ms; write it, such as '
                  't: {column: ', 'unit: 100 Hz}, or unit: ms')


@pytest.mark.slow
@pytest.mark.parametrize('groups', [(), (A,), (V,), (W,), (V, A), (V, W, A), (P, W)])
@pytest.mark.parametrize('head', ['t', 'frame'])
def test_milliseconds_at_1_kHz_are_read_where_the_other_columns_show_it(tmp_path, groups, head):
    record = flight(seconds=4.0, rate=1000.0, noise=0.2)
    read = load(table(tmp_path, columns(record, np.arange(4000.0), *groups, name=head)))
    np.testing.assert_allclose(read.t, record.t, atol=1e-9)
    there = [name for group in (P, V, W, A) if group not in groups for name in group]
    np.testing.assert_allclose(read.stack(*there), record.stack(*there), atol=1e-6)


def test_a_position_that_may_be_in_cm_does_not_show_milliseconds(tmp_path):
    """A pose bends alike in cm at 1 kHz and in m at 100 Hz."""
    path = table(tmp_path, columns(flight(), np.arange(2000.0), V, W, A))
    refused(path, 'or is in ms')
    found = columns(flight(), np.arange(2000.0), V, W, A)
    for axis in 'xyz':
        found[f'pos_{axis} [m]'] = found.pop(f'pos_{axis}')
    refused(table(tmp_path, found), 'about 100 Hz by the other columns')


def test_a_count_that_a_mapping_gives_a_rate_is_read(tmp_path):
    path = table(tmp_path, columns(flight(), np.arange(2000.0), V, W, A, name='frame'))
    mapping = mapping_from({'columns': {
        't': {'column': 'frame', 'unit': '100 Hz'}, 'px': 'pos_x', 'py': 'pos_y', 'pz': 'pos_z',
        'q': [f'q_{axis}' for axis in 'wxyz']}}, 'the test')
    assert load(path, mapping).period() == pytest.approx(0.01)


def test_a_time_beside_a_count_is_the_time(tmp_path):
    found = columns(flight(), np.arange(2000.0))
    read = load(table(tmp_path, {**found, 'timestamp': flight().t}))
    assert read.period() == pytest.approx(0.01)


UNITS = {'as they are': {}, 'deg/s': {'gyro': 180 / np.pi}, 'mm': {'pos': 1e3, 'vel': 1e3},
         'cm': {'pos': 1e2, 'vel': 1e2}, 'mm and m/s': {'pos': 1e3}}


@pytest.mark.parametrize('units', UNITS.values(), ids=UNITS)
@pytest.mark.parametrize('groups', [(), (W, A), (V, W, A)], ids=['all', 'no imu', 'a pose'])
@pytest.mark.parametrize('unit, seconds', [('min', 60.0), ('h', 3600.0)])
def test_a_table_in_minutes_is_refused_in_any_unit_of_the_others(
        tmp_path, units, groups, unit, seconds):
    record = flight(rate=50.0)
    found = {name: values * units.get(name.partition('_')[0], 1.0) for name, values in
             columns(record, record.t, *groups, name='time').items()}
    load(table(tmp_path, found))
    path = table(tmp_path, {**found, 'time': record.t / seconds})
    refused(path, "t: the unit of 'time'" if unit == 'h' else f'as if it were in {unit}; write '
            f'it, such as t: {{column: time, unit: {unit}}}')


def test_a_unit_in_the_name_that_is_wrong_is_doubted(tmp_path):
    path = table(tmp_path, columns(flight(), flight().t, name='time [min]'))
    refused(path, "t: the unit of 'time [min]'", 'as if it were in s; write it, such as t: ')


def test_times_of_more_than_10_kHz_are_not_taken_for_seconds(tmp_path):
    """Without an attitude nothing but the rate tells that they are in hours."""
    path = table(tmp_path, columns(flight(), flight().t / 3600, P, V, Q, name='time'))
    refused(path, "t: the unit of 'time'")


@pytest.mark.slow
@pytest.mark.parametrize('apart', [1e-3, 1e-4, 2e-5])
@pytest.mark.parametrize('frame', ['world', 'body'])
def test_rows_of_several_streams_may_come_in_bursts(tmp_path, frame, apart):
    """As messages of MAVLink do: hardly any time passes between those of one burst."""
    record = flight()
    streams = ('pos', 'vel'), ('q', 'gyro', 'acc'), ('m',)
    every = others(record)
    if frame == 'body':
        speed = rotate(conjugate(record.stack(*Q)), record.stack(*V))
        every |= dict(zip(('vel_x', 'vel_y', 'vel_z'), speed.T, strict=True))
    rows = {'timestamp': (1.7e9 + record.t[:, None] + apart * np.arange(len(streams))).ravel()}
    for name, values in every.items():
        if name not in ('timestamp', 'vbat'):
            cells = np.full((len(record), len(streams)), np.nan)
            cells[:, [name.startswith(one) for one in streams].index(True)] = values
            rows[name] = cells.ravel()
    read = load(table(tmp_path, rows))
    np.testing.assert_allclose(np.diff(read.t), 0.01, atol=1e-6)
    for name in (*P, *V):
        np.testing.assert_allclose(
            read.columns[name], record.columns[name][1:len(read) + 1], atol=0.05)


def test_a_parquet_file_is_no_exception(tmp_path):
    pyarrow = pytest.importorskip('pyarrow')
    from pyarrow import parquet
    found = columns(flight(), np.arange(2000))
    parquet.write_table(pyarrow.table(found), tmp_path / 'flight.parquet')
    refused(tmp_path / 'flight.parquet', "'t' counts at a rate", 'about 100 Hz')
