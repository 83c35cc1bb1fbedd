# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of tables of nothing but numbers, which are read line by line."""

import gzip
import tracemalloc

import numpy as np
import pytest

from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.plain_numbers import plain_numbers
from quad_ident_ros.data.tabular import read_text

ROWS, COLUMNS = 20_000, 25


def table(separator=',', columns=COLUMNS):
    values = np.random.default_rng(3).normal(size=(ROWS, columns))
    values[:, 0] = 0.01 * np.arange(ROWS)
    lines = [separator.join(map(repr, row)) for row in values.tolist()]
    names = separator.join(['t', *(f'c{k}' for k in range(1, columns))])
    return values, '\n'.join([names, *lines, ''])


@pytest.mark.slow
@pytest.mark.parametrize(('name', 'read', 'separator'), [
    ('flight.csv', read_csv, ','), ('flight.csv.gz', read_csv, ','),
    ('table.txt', read_text, ';')])
def test_memory_is_that_of_the_numbers_not_of_the_text(tmp_path, name, read, separator):
    values, text = table(separator)
    data = text.encode()
    path = tmp_path / name
    path.write_bytes(gzip.compress(data, 1) if path.suffix == '.gz' else data)
    read(path)      # what is loaded at the first call
    tracemalloc.start()
    record = read(path)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert np.array_equal(record.columns['c7'], values[:, 7])
    # The text is more than twice the numbers, which exist twice while they become columns.
    assert len(data) > 2.3 * values.nbytes
    assert peak < 3.0 * values.nbytes


def test_lines_are_counted_as_editors_do(tmp_path):
    path = tmp_path / 'a.csv'
    path.write_bytes(b'\xef\xbb\xbft,a\r\n\r\n1,2\r\n   \r\n3,4\r\n5,')
    read = plain_numbers(path, skip=1)
    assert (read.head, read.lines.tolist(), read.truncated) == (['t,a'], [3, 5], True)
    assert read.values.tolist() == [[1, 2], [3, 4]]


@pytest.mark.parametrize('content', [
    b't,a\n', b't,a\n\n', b't,a\n1,x\n', b't,a\n1,2,3\n1,2\n', b't,a\n1,\xff\n', b'', b't,a\n1,2'])
def test_anything_else_is_none(tmp_path, content):
    path = tmp_path / 'a.csv'
    path.write_bytes(content)
    assert plain_numbers(path, skip=1) is None


def test_decimal_commas_are_read_where_no_point_is_beside_them(tmp_path):
    path = tmp_path / 'a.csv'
    path.write_text('t;a\n0,5;1\n1,5;2\n')
    assert plain_numbers(path, 1, ';', comma=True).values.tolist() == [[0.5, 1], [1.5, 2]]
    path.write_text('t;a\n0,5;1\n1.000,5;2\n')
    assert plain_numbers(path, 1, ';', comma=True) is None
