# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of flight records as CSV."""

import gzip
import os
import tracemalloc

from full_disk import file_size_limit
from hypothesis import assume, example, given, HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
import numpy as np
import pytest
from reader_checks import SMALL

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import CsvAppender, read_csv, write_csv
from quad_ident_ros.data.record import FlightRecord, RESOLUTION, unit
from quad_ident_ros.errors import InputError

FAST = settings(deadline=None, max_examples=80,
                suppress_health_check=[HealthCheck.function_scoped_fixture])


def read(tmp_path, text, name='flight.csv'):
    """Return the record of a file with the given content, text or bytes."""
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_csv(path)


def refused(tmp_path, text, *parts, name='flight.csv'):
    """Check that a content is refused, with one line that has all of the parts."""
    with pytest.raises(InputError) as caught:
        read(tmp_path, text, name)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert all(part in message for part in (name, *parts)), message


def same(one, other):
    """Check that two records have the same columns, number for number, sign for sign."""
    assert list(one.columns) == list(other.columns)
    for name in ('t', *one.columns):
        left, right = one.stack(name), other.stack(name)
        np.testing.assert_array_equal(left, right)
        np.testing.assert_array_equal(np.signbit(left[left == 0]), np.signbit(right[left == 0]))


def test_columns_in_any_order(tmp_path):
    """Columns are found by name; the info says where they are from."""
    flight = read(tmp_path, 'pz,t, cmd2 ,foo\n1,0,5,-1\n2,0.5,6,nan\n')
    assert flight.t.tolist() == [0, 0.5]
    assert flight.stack('pz', 'cmd2').tolist() == [[1, 5], [2, 6]]
    assert list(flight.columns) == ['pz', 'cmd2', 'foo']
    assert np.isnan(flight.columns['foo'][1])
    assert flight.info == {'name': 'flight', 'source': str(tmp_path / 'flight.csv')}


@pytest.mark.parametrize('content', [
    b'\xef\xbb\xbft,pz\n0,1\n1,2\n',
    b't,pz\r\n0,1\r\n1,2\r\n',
    b't,pz\r0,1\r1,2\r',
    b'"t","pz"\n"0","1"\n1,"2"\n',
    b't,pz\n\n0,1\n   \n1,2\n\n\n',
    b't,pz\n 0 , 1\n 1,2.0e0 \n',
    b't,pz,\n0,1,\n1,2,\n',
    b',t,pz\n0,0,1\n1,1,2\n',
], ids=['bom', 'crlf', 'cr', 'quotes', 'blank', 'spaces', 'comma-at-end', 'unnamed-index'])
def test_dialects(tmp_path, content):
    """What other programs write as CSV reads the same."""
    flight = read(tmp_path, content)
    assert flight.stack('t', 'pz').tolist() == [[0, 1], [1, 2]]
    assert list(flight.columns) == ['pz']


def test_text_in_unknown_columns(tmp_path):
    """Columns of text are left out, and an empty cell of an unknown column is nan."""
    flight = read(tmp_path, 't,mode,pz,x,y\n0,"a, b",1,,1_0\n1,hover,2,7,8\n')
    assert list(flight.columns) == ['pz', 'x']
    assert flight.columns['pz'].tolist() == [1, 2]
    assert np.isnan(flight.columns['x'][0]) and flight.columns['x'][1] == 7


@pytest.mark.parametrize('last', ['0.2,3', '0.2,', '0.2', '0.2,3,4', '0.2,-', 'x'])
def test_line_cut_off_while_recording(tmp_path, last):
    """The last line is dropped where it has no line end, and the info says so."""
    flight = read(tmp_path, f't,pz\n0,1\n0.1,2\n{last}')
    assert flight.stack('t', 'pz').tolist() == [[0, 1], [0.1, 2]]
    assert flight.info['truncated'] is True


def test_a_flight_cut_anywhere_gives_its_first_samples(tmp_path):
    """Whatever byte a file is cut off at, no sample changes."""
    whole = 't,pz,vz\n' + ''.join(f'{k / 7},{k / 3},{-k / 11}\n' for k in range(6))
    table = read(tmp_path, whole).stack('t', 'pz', 'vz')
    for end in range(whole.index('\n', 70) + 1, len(whole)):
        part = read(tmp_path, whole[:end]).stack('t', 'pz', 'vz')
        np.testing.assert_array_equal(part, table[:whole[:end].count('\n') - 1])


@pytest.mark.parametrize('content, parts', [
    (b'', ['empty']),
    (b'\n \n\n', ['empty']),
    (b't,pz', ['0 samples']),
    (b't,pz\n', ['0 samples', 'at least 2']),
    (b't,pz\n0,1\n', ['1 sample']),
    (b't,pz\n0,1\n1,2', ['1 sample', 'no line end']),
    (b'pz,vz\n0,1\n1,2\n', ['line 1', "'t'", 'pz,vz']),
    (b'0,1\n1,2\n', ['line 1', "'t'"]),
    (b't;pz\n0;1\n1;2\n', ['line 1', "'t'", 'comma']),
    (b't,pz,pz\n0,1,1\n1,2,2\n', ['line 1', "'pz'", 'twice']),
    (b't,t\n0,0\n1,1\n', ['line 1', "'t'", 'twice']),
    (b't,p\x07z\n0,0\n1,1\n', ['line 1', 'not a column name']),
    (b't,pz\n0,1\n\n1\n2,3\n', ['line 4', '1 cells', 'has 2']),
    (b't,pz\n0,1\n1,2,3\n', ['line 3', '3 cells', 'has 2']),
    (b't,pz\n0,1,5\n1,2,3\n', ['line 2', '3 cells', 'has 2']),
    (b't,pz\n0,1\n1,abc\n', ['line 3', "'pz'", "'abc'"]),
    (b't,pz\n0,1\n1,\n', ['line 3', "'pz'", "''"]),
    (b't,pz\n0,1\n1,1_0\n', ['line 3', "'pz'", "'1_0'"]),
    (b't,cmd1\n0,1\n1,0x10\n', ['line 3', "'cmd1'", "'0x10'"]),
    (b't,pz\n0,1\n1,' + b'9x' * 10000 + b'\n', ['line 3', "'pz'", "'9x9x"]),
    (b't,pz\n0,1\n1,"' + b'9' * 200000 + b'"\n', ['line 3', 'field']),
    (b't,pz\n0,1\n\n1,nan\n', ['line 4', "'pz'", 'nan']),
    (b't,pz,s\n0,1,a\n\n1,-inf,b\n', ['line 4', "'pz'", 'inf']),
    (b't,pz\n0,1\n1,1e999\n', ['line 3', "'pz'", 'inf']),
    (b't,pz\nnan,1\n1,1\n', ['line 2', "'t'", 'nan']),
    (b't,pz\n0,1\n1,1\n2\n3,0\n4,1\n5\n6\n', ['line 4', 'delete lines 4 and 7 to 8']),
    (b't,pz\n0,1\n1,nan\n2,1\n1,1\n2,1\n3,1\n4,1\n5,0\n', ['line 3', 'delete lines 3 and 5 to 6']),
    (b't,pz\n0,1\n1,x\n2,1\n3,1\n4,1\n', ['line 3', 'delete line 3']),
    (b't,pz\n0,1\n1,1\n1,2\n', ['line 4', "'t'", 'does not come after']),
    (b't,pz\n0,1\n1,1\n\n0.5,2\n', ['line 5', "'t'", '0.5']),
    (b't,pz\n0,"1\n1,2\n', ['line 3', 'no CSV']),
    (b'"t,pz\n0,1\n1,2\n', ['line 1', 'no header']),
    (b't,pz\n0,1\n1,\xff\n', ['line 3', 'not text']),
    (b't,pz\n0,1\n1,\x00\n', ['line 3', "'pz'"]),
    ('t,pz\n0,1\n1,2\n'.encode('utf-16'), ['line 1', 'not text']),
    (b'\x89PNG\r\n\x1a\n\x00\x00', ['line 1', 'not text']),
    (bytes(range(128)) * 4, ['line 1']),
])
def test_bad_content(tmp_path, content, parts):
    """What cannot be a flight is refused, with the line and the column where that shows."""
    refused(tmp_path, content, *parts)


@pytest.mark.parametrize('content', [
    gzip.compress(b't,pz\n0,1\n1,2\n')[:-9],
    gzip.compress(b't,pz\n0,1\n1,2\n')[:5],
    gzip.compress(b't,pz\n0,1\n1,2\n')[:12] + b'\xff\xff\xff' + bytes(30),
    b't,pz\n0,1\n1,2\n',
], ids=['cut', 'cut-header', 'damaged', 'plain'])
def test_bad_gzip(tmp_path, content):
    """A gzip file that is not whole is refused."""
    refused(tmp_path, content, 'gzip', name='flight.csv.gz')


def test_no_file(tmp_path):
    """Paths of nothing, of a folder, or of a device are refused."""
    for path, part in [(tmp_path / 'none.csv', 'no such file'), (tmp_path, 'not a file'),
                       (tmp_path / 'none' / 'a.csv.gz', 'no such file'),
                       ('/dev/null', 'not a file'), (tmp_path / ('x' * 300), 'x')]:
        with pytest.raises(InputError, match=part) as caught:
            read_csv(path)
        assert str(path) in str(caught.value)


def test_what_cannot_be_written_is_named_as_it_was_asked_for(tmp_path):
    (tmp_path / 'file').touch()
    path = tmp_path / 'file' / 'f.csv'
    with pytest.raises(OSError) as caught:
        write_csv(path, read_csv(_written(tmp_path)))
    assert caught.value.filename == str(path)


def _written(folder):
    (folder / 'f.csv').write_text('t,pz\n0,1\n1,2\n')
    return folder / 'f.csv'


def test_a_table_that_is_only_named_as_a_gzip_file_is_told(tmp_path):
    path = tmp_path / 'f.csv.gz'
    path.write_text('t,pz\n0,1\n1,2\n')
    with pytest.raises(InputError, match='not packed; name it without .gz'):
        read_csv(path)


def test_no_permission(tmp_path, monkeypatch):
    """A file that may not be read is refused."""
    path = tmp_path / 'flight.csv'
    path.write_text('t,pz\n0,1\n1,2\n')
    path.chmod(0)
    if os.access(path, os.R_OK):  # root reads everything
        def deny(*_):
            raise PermissionError(13, 'Permission denied', str(path))
        monkeypatch.setattr('builtins.open', deny)
    with pytest.raises(InputError, match='Permission denied') as caught:
        read_csv(path)
    assert str(path) in str(caught.value)


names = st.text(st.characters(min_codepoint=32, codec='utf-8'), min_size=1, max_size=8).filter(
    lambda name: name.isprintable() and name == name.strip() and unit(name) is None)
finite = st.floats(allow_nan=False, allow_infinity=False)


@st.composite
def flights(draw):
    """Draw flight records: any times that differ, known and unknown columns, any numbers."""
    t = sorted(draw(st.lists(finite, min_size=2, max_size=12, unique=True)))
    with np.errstate(over='ignore'):
        assume((np.diff(t) > RESOLUTION).all())
    known = draw(st.sets(st.sampled_from(['pz', 'qw', 'cmd1', 'cmd12', 'u4'])))
    unknown = draw(st.sets(names, max_size=4))
    return FlightRecord(t, {
        name: draw(arrays.arrays(float, len(t), elements=finite if name in known else st.floats()))
        for name in [*known, *unknown]})


@pytest.mark.slow
@FAST
@given(flights(), st.sampled_from(['flight.csv', 'flight.csv.gz']))
def test_round_trip(tmp_path, flight, name):
    """What was written reads back as it was, to the last bit."""
    write_csv(tmp_path / name, flight)
    again = read_csv(tmp_path / name)
    same(flight, again)
    assert 'truncated' not in again.info


@pytest.mark.slow
@FAST
@given(st.one_of(
    st.binary(max_size=200),
    st.text(st.sampled_from(list('tpz,,,\n\n\r0123456789.eE+-_" ;#\0\x1c\u00a0\u0661nainf')),
            max_size=60).map(lambda text: ('t,pz\n' + text).encode())))
@example(b't,pz\n0,1\n1,\x1c2\n')
def test_rubbish_only_ever_raises_input_error(tmp_path, content):
    """Any bytes either are a flight or are refused by an InputError of one line."""
    for name, data in (('a.csv', content), ('a.csv.gz', content),
                       ('a.csv.gz', gzip.compress(content))):
        try:
            flight = read(tmp_path, data, name)
        except InputError as error:
            assert len(str(error).splitlines()) == 1
        else:
            assert len(flight) >= 2


@pytest.mark.slow
@FAST
@given(st.lists(st.lists(st.text(st.sampled_from(list('0123456789.e-+ naif_x\u0661')), max_size=5),
                         min_size=2, max_size=2), min_size=2, max_size=4))
def test_the_fast_way_takes_what_the_thorough_way_takes(tmp_path, cells):
    """A table of numbers reads the same with a column of text beside it."""
    results = []
    for text in ('', ',note'):
        lines = ['t,pz' + text, *(','.join(row) + text for row in cells)]
        try:
            results.append(read(tmp_path, ''.join(f'{line}\n' for line in lines)))
        except InputError as error:
            results.append(str(error))
    if isinstance(results[0], FlightRecord):
        same(*results)
    elif any(''.join(row).strip() for row in cells):
        assert results[0].replace('has 3', 'has 2') == results[1].replace('has 3', 'has 2')


def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch):
    """A file is replaced whole or not at all, and nothing is left beside it."""
    path = tmp_path / 'flight.csv'
    old = FlightRecord([0, 1], {'pz': [1, 2]})
    write_csv(path, old)

    def fail(*_):
        raise OSError(28, 'No space left on device')
    with monkeypatch.context() as patch:
        patch.setattr('pathlib.Path.replace', fail)
        with pytest.raises(OSError, match='No space'):
            write_csv(path, FlightRecord([0, 1], {'pz': [3, 4]}))
    same(read_csv(path), old)
    assert os.listdir(tmp_path) == ['flight.csv']
    with pytest.raises(OSError):
        write_csv(path / 'flight.csv', old)
    same(read_csv(path), old)


def test_appender(tmp_path):
    """What was flushed can be read while the recording goes on, and all of it after."""
    path = tmp_path / 'live.csv'
    with CsvAppender(path, ['t', 'pz', 'a,b']) as live:
        live.append([[0, 1, 0.1], [0.1, 2, np.nan]])
        live.flush()
        assert read_csv(path).t.tolist() == [0, 0.1]
        live.append(np.array([[0.2, 1 / 3, -0.0]]))
    flight = read_csv(path)
    assert flight.stack('t', 'pz').tolist() == [[0, 1], [0.1, 2], [0.2, 1 / 3]]
    assert flight.has('a,b')
    live.close()


def test_appender_bounds_what_it_holds_back(tmp_path):
    """A recording that nobody flushes reaches the disk all the same."""
    live = CsvAppender(tmp_path / 'live.csv', ['t', 'pz'])
    for k in range(200):
        live.append(k * 100 + np.arange(200.).reshape(100, 2))
    held_back = 200 * 100 - read_csv_lines(tmp_path / 'live.csv')
    live.close()
    assert held_back < 10_000
    assert read_csv_lines(tmp_path / 'live.csv') == 200 * 100


def read_csv_lines(path):
    """Return the number of samples that have their line end."""
    return path.read_bytes().count(b'\n') - 1


def test_appender_refuses(tmp_path):
    """It does not overwrite a flight, and takes no columns or rows that do not fit."""
    path = tmp_path / 'live.csv'
    for columns in (['pz'], ['t', 'pz', 'pz']):
        with pytest.raises(InputError, match='live.csv'):
            CsvAppender(path, columns)
    assert not path.exists()
    with CsvAppender(path, ['t', 'pz']) as live:
        for rows in ([0, 1], [[0, 1, 2]], 5):
            with pytest.raises(InputError, match='shape'):
                live.append(rows)
    with pytest.raises(OSError):
        CsvAppender(path, ['t', 'pz'])


def test_appender_on_a_full_disk(tmp_path):
    """A full disk is an OSError at the flush; once there is room again nothing is missing."""
    path = tmp_path / 'live.csv'
    live = CsvAppender(path, ['t', 'pz'])
    rows = np.arange(200.).reshape(100, 2)
    live.append(rows)
    with file_size_limit(500):
        with pytest.raises(OSError):
            live.flush()
        assert 0 < len(read_csv(path)) < 100
    live.append(200 + rows)
    live.close()
    assert len(read_csv(path)) < 100
    live = CsvAppender(tmp_path / 'live2.csv', ['t', 'pz'])
    live.append(rows)
    with file_size_limit(500), pytest.raises(OSError):
        live.flush()
    live.append(200 + rows)
    live.flush()
    live.close()
    assert read_csv(tmp_path / 'live2.csv').t.tolist() == list(range(0, 400, 2))


def test_columns_without_any_number_are_named_together(tmp_path):
    path = tmp_path / 'f.csv'
    write_csv(path, SMALL)
    head, *rows = path.read_text().splitlines()
    places = [head.split(',').index(name) for name in ('px', 'vz')]
    for cell in ('nan', '', 'inf'):
        cells = [[cell if k in places else one for k, one in enumerate(row.split(','))]
                 for row in rows]
        text = '\n'.join([head, *map(','.join, cells)]) + '\n'
        refused(tmp_path, text, "a finite number in columns 'px', 'vz'; leave them out")
    refused(tmp_path, f'{head}\n{rows[0]}\n', '1 sample makes no flight')


@pytest.mark.parametrize(('option', 'wanted'), [('--vehicle', 'a vehicle file'),
                                                ('--mapping', 'a YAML file')])
def test_a_picture_or_a_log_is_told_where_another_file_belongs(tmp_path, capsys, monkeypatch,
                                                               option, wanted):
    write_csv(tmp_path / 'f.csv', SMALL)
    (tmp_path / 'pic.png').write_bytes(b'\x89PNG\r\n\x1a\n' + bytes(range(256)))
    (tmp_path / 'log.ulg').write_bytes(b'ULog\x01\x12\x35\x01' + bytes(range(256)) * 2000)
    monkeypatch.chdir(tmp_path)
    for name, what in (('pic.png', 'a picture (PNG)'), ('log.ulg', 'a log of PX4 (ULog)')):
        assert main(['info', 'f.csv', option, name]) == 2
        assert f'{name}: this is {what}; expected {wanted}' in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize('rows', [5_000, 40_000])
def test_reading_takes_little_more_memory_than_the_record(tmp_path, rows):
    """So an hour at 100 Hz takes some hundred MB, not the gigabytes of a table of strings."""
    rng = np.random.default_rng(0)
    names = ('px', 'py', 'pz', 'qw', 'qx', 'qy', 'qz', 'wx', 'wy', 'wz', 'cmd1', 'cmd2')
    write_csv(tmp_path / 'a.csv', FlightRecord(
        np.arange(rows) * 0.01, {name: rng.normal(size=rows) for name in names}))
    tracemalloc.start()
    try:
        record = read_csv(tmp_path / 'a.csv')
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    held = record.t.nbytes + sum(values.nbytes for values in record.columns.values())
    assert held <= peak <= 4 * held
