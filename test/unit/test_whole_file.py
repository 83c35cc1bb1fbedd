# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Results on a full disk, where the old file stays, and under odd names."""

import json
import os

from full_disk import file_size_limit
import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.html import write_page
from quad_ident_ros.report.picture import pyplot, save


def draw(path):
    """Write a picture."""
    plt = pyplot(path)
    save(plt, plt.figure(), path)


WRITERS = {
    'out.json': lambda path: write_json(path, list(range(1000))),
    'out.html': lambda path: write_page(path, 'title', 'x' * 1000),
    'out.yaml': lambda path: write_vehicle(path, load_vehicle('hummingbird')),
    'out.png': draw}


@pytest.mark.parametrize('name', WRITERS)
def test_a_file_is_written_whole_or_not_at_all(tmp_path, name):
    path = tmp_path / name
    path.write_text('before')
    with file_size_limit(64), pytest.raises(InputError, match=f'{name}: .*cannot be written'):
        WRITERS[name](path)
    assert path.read_text() == 'before'
    assert list(tmp_path.iterdir()) == [path]
    WRITERS[name](path)
    assert len(path.read_bytes()) > 64
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_a_link(tmp_path):
    target, link = tmp_path / 'target.json', tmp_path / 'link.json'
    target.write_text('before')
    link.symlink_to(target)
    write_json(link, [1])
    assert link.is_symlink() and target.read_text() == '[\n  1\n]\n'


def test_a_name_of_a_file_that_is_no_unicode_is_written_by_its_code(tmp_path):
    """As of a log from a disk with names in another encoding."""
    name = os.fsdecode(b'bad\xff.csv')
    write_page(tmp_path / 'out.html', name, name)
    assert 'bad\\udcff.csv' in (tmp_path / 'out.html').read_text(encoding='utf-8')
    write_json(tmp_path / 'out.json', {'name': name})
    assert json.loads((tmp_path / 'out.json').read_text(encoding='utf-8')) == {'name': name}
