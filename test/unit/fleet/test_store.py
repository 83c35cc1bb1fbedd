# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is written into the data set of a fleet comes back, whole or not at all."""

from datetime import datetime, timezone
import pickle

from full_disk import file_size_limit
import pytest

pytest.importorskip('pyarrow', reason='the extra `fleet` is not installed')

from quad_ident_ros.errors import InputError  # noqa: E402, I100
from quad_ident_ros.fleet import store  # noqa: E402, I100
from quad_ident_ros.fleet.store import keys_of, read_table, TABLES, write_rows  # noqa: E402, I100

DAY = datetime(2026, 5, 14, 8, 30, tzinfo=timezone.utc)
FLIGHT = {'flight': 'f', 'path': 'a.csv', 'group': 'g', 'vehicle': 'seven', 'date': DAY,
          'findings': ['one', 'two'], 'covariates': {'temperature_c': 21.5}, 'held_out': True}


def test_rows_come_back_and_what_a_row_does_not_have_is_null(tmp_path):
    write_rows(tmp_path, 'flights', 'g', [FLIGHT])
    [row] = read_table(tmp_path, 'flights').to_pylist()
    assert {**row, 'covariates': dict(row['covariates'])} == {
        **dict.fromkeys(TABLES['flights'].names), **FLIGHT}


def by_pandas(library, folder):
    return library.read_parquet(folder).to_dict('records')


def by_polars(library, folder):
    return library.read_parquet(f'{folder}/*.parquet').to_dicts()


def by_duckdb(library, folder):
    table = library.sql(f"select * from '{folder}/*.parquet'")
    return [dict(zip(table.columns, row, strict=True)) for row in table.fetchall()]


@pytest.mark.parametrize(('name', 'rows'), [('pandas', by_pandas), ('polars', by_polars),
                                            ('duckdb', by_duckdb)])
def test_tables_open_in_the_libraries_that_people_use(tmp_path, name, rows):
    library = pytest.importorskip(name)
    for key in 'gh':
        write_rows(tmp_path, 'flights', key, [FLIGHT | {'group': key}])
    found = sorted(rows(library, tmp_path / 'flights'), key=lambda row: row['group'])
    assert [row['group'] for row in found] == ['g', 'h']
    assert {row['path'] for row in found} == {'a.csv'}
    assert [list(row['findings']) for row in found] == [FLIGHT['findings']] * 2
    assert [dict(row['covariates']) for row in found] == [FLIGHT['covariates']] * 2
    assert all(row['date'].timestamp() == DAY.timestamp() for row in found)


def test_a_file_is_no_data_set(tmp_path):
    (tmp_path / 'a.csv').write_text('t', encoding='utf-8')
    with pytest.raises(InputError, match='this is a file'):
        store.prepare(tmp_path / 'a.csv')


def test_the_same_key_is_the_same_file(tmp_path):
    for name in ('before', 'after'):
        write_rows(tmp_path, 'flights', 'g', [FLIGHT | {'path': name}])
    write_rows(tmp_path, 'flights', 'h', [FLIGHT])
    assert keys_of(tmp_path, 'flights') == {'g', 'h'}
    assert sorted(read_table(tmp_path, 'flights', ['path'])['path'].to_pylist()) == [
        'a.csv', 'after']


@pytest.mark.parametrize('together', [1, 2, 5, 6])
def test_all_files_are_read_however_many_at_once(tmp_path, monkeypatch, together):
    monkeypatch.setattr(store, 'TOGETHER', together)
    for number in range(5):
        write_rows(tmp_path, 'flights', f'{number}', [FLIGHT | {'path': f'{number}'}])
    assert sorted(read_table(tmp_path, 'flights')['path'].to_pylist()) == list('01234')


@pytest.mark.parametrize('table', TABLES)
def test_a_table_without_files_has_its_columns_and_no_rows(tmp_path, table):
    found = read_table(tmp_path, table)
    assert found.num_rows == 0 and found.schema == TABLES[table]


def test_a_damaged_file_is_named_in_one_line(tmp_path):
    write_rows(tmp_path, 'flights', 'g', [FLIGHT])
    (tmp_path / 'flights' / 'g.parquet').write_bytes(b'PAR1')
    with pytest.raises(InputError, match=r'flights/g\.parquet.*remove the file') as caught:
        read_table(tmp_path, 'flights')
    assert '\n' not in str(caught.value)


def test_nothing_appears_where_it_cannot_be_written_whole(tmp_path):
    with pytest.raises(Exception, match='temperature|convert|expected|bytes'):
        write_rows(tmp_path, 'flights', 'g', [FLIGHT | {'date': 'yesterday'}])
    assert keys_of(tmp_path, 'flights') == set()
    assert read_table(tmp_path, 'flights').num_rows == 0


def test_a_full_disk_is_said_with_the_file_and_leaves_nothing(tmp_path):
    with file_size_limit(500), pytest.raises(OSError, match='File too large') as caught:
        write_rows(tmp_path, 'flights', 'g', [FLIGHT | {'path': 'long' * 1000}])
    # As it comes from a worker:
    error = pickle.loads(pickle.dumps(caught.value))
    assert (error.filename, error.strerror) == (str(tmp_path / 'flights' / 'g.parquet'),
                                                'File too large')
    assert not [path for path in tmp_path.rglob('*') if path.is_file()]


def test_columns_can_be_chosen(tmp_path):
    write_rows(tmp_path, 'groups', 'g', [{'group': 'g', 'status': 'refused', 'reason': 'short'}])
    assert read_table(tmp_path, 'groups', ['status', 'reason']).to_pylist() == [
        {'status': 'refused', 'reason': 'short'}]
