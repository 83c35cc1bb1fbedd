# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bad input is read or refused in one line that names the file."""

from flightmaker import copy_bag, flight, px4_samples, ulog, VEHICLE
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from reader_checks import ALL_TOPICS, FAST, refused, SMALL
from rosbags.rosbag2 import StoragePlugin

from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.export import save, write_bag
from quad_ident_ros.data.load import load, load_all
from quad_ident_ros.data.mapping import mapping_from
from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError

BYTES = st.binary(max_size=400)


@pytest.mark.slow
@FAST
@given(st.sampled_from(['f.csv', 'f.csv.gz', 'f.mcap', 'f.db3', 'f.ulg']), BYTES,
       st.sampled_from([b'', b't,pz\n', b'\x89MCAP0\r\n', b'SQLite format 3\0',
                        b'ULog\x01\x125\x01', b'\x1f\x8b\x08\0']))
def test_any_bytes_are_refused_in_a_line_that_names_the_file(tmp_path_factory, name, data, head):
    path = tmp_path_factory.mktemp('any') / name
    path.write_bytes(head + data)
    try:
        load(path)
    except InputError as error:
        assert len(str(error).splitlines()) == 1 and str(path) in str(error)


VALID = {}


def valid(folder, name):
    """Return the bytes of a small valid file, made once."""
    if name not in VALID:
        if name == 'f.ulg':
            VALID[name] = ulog(px4_samples(SMALL.slice(0, 8)))
        elif name == 'f.db3':
            write_bag(folder / 'bag', SMALL.slice(0, 8))
            copy_bag(folder / 'bag', folder / 'sql', StoragePlugin.SQLITE3, {'flight_record'})
            VALID[name] = next((folder / 'sql').glob('*.db3')).read_bytes()
        else:
            save(folder / name, SMALL.slice(0, 8))
            VALID[name] = (folder / name).read_bytes()
    return VALID[name]


@pytest.mark.slow
@FAST
@given(st.sampled_from(['f.csv', 'f.csv.gz', 'f.mcap', 'f.db3', 'f.ulg']),
       st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.binary(min_size=1, max_size=8)),
                min_size=1, max_size=4), st.none() | st.floats(0, 1))
def test_any_damage_is_read_or_refused_in_a_line(tmp_path_factory, name, changes, cut):
    folder = tmp_path_factory.mktemp('damaged')
    data = bytearray(valid(folder, name))
    for place, value in changes:
        at = int(place * len(data))
        data[at:at + len(value)] = value
    path = folder / f'damaged_{name}'
    path.write_bytes(data if cut is None else data[:int(cut * len(data))])
    try:
        flights = load_all(path)
    except InputError as error:
        assert len(str(error).splitlines()) == 1 and str(path) in str(error)
        assert len(str(error)) < 1000
    else:
        assert all(np.isfinite(record.t).all() for record in flights)


def test_a_bad_csv_names_row_and_column(tmp_path):
    path = tmp_path / 'f.csv'
    path.write_text('t,pz\n0,1\n0.1,high\n')
    refused(path, 'line 3', "'pz'", 'high')


def test_topics_are_not_for_csv(tmp_path):
    write_csv(tmp_path / 'f.csv', SMALL)
    refused(tmp_path / 'f.csv', 'columns', mapping=mapping_from(ALL_TOPICS, 'm'))


@pytest.mark.slow
@FAST
@given(st.data())
def test_any_numbers_have_findings_but_no_traceback(data):
    count = 200
    t = 0.01 * np.arange(count)
    names = [n for n in flight().columns if n != 'vbat'] + ['phi', 'theta', 'psi', 'stale']
    random = np.random.default_rng(data.draw(st.integers(0, 1000)))
    columns = {name: random.normal(size=count) * 10.0 ** data.draw(
        st.sampled_from([-320, -200, -3, 0, 3, 154, 200, 307])) for name in data.draw(
            st.lists(st.sampled_from(names), unique=True, max_size=len(names)))}
    for finding in findings(FlightRecord(t, columns), VEHICLE):
        assert '\n' not in finding.message
