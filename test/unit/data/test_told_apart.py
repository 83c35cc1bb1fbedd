# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights of several files that have one name."""

from flightmaker import flight
import pytest

from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.told_apart import Apart


@pytest.mark.parametrize('paths, names', [
    (('run_1/log.csv', 'run_2/log.csv', 'run_2/other.csv'), ['run_1/log', 'run_2/log', 'other']),
    (('log.csv', 'log.csv.gz'), ['log.csv', 'log.gz']),
    (('a/one.csv', 'b/two.csv'), ['one', 'two']),
    (('seven/day/log.csv', 'eight/day/log.csv'), ['seven/day/log', 'eight/day/log'])])
def test_folders_or_endings_tell_equal_names_apart(tmp_path, paths, names):
    whole = [tmp_path / path for path in paths]
    for path in whole:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_csv(path, flight(seconds=1.0))
    apart = Apart(whole)
    assert [one.info['name'] for path in whole
            for one in apart.named(path, load_all(path))] == names


def test_parts_of_a_recording_stay_together(tmp_path):
    """They name the whole that they are joined to, which is renamed alike."""
    paths = [tmp_path / name / 'log.csv' for name in ('a', 'b')]
    part = flight(seconds=1.0)
    part.info.update(name='log_1', whole=['log', 'source'])
    [named] = Apart(paths).named(paths[0], [part])
    assert (named.info['name'], named.info['whole']) == ('a/log_1', ['a/log', 'source'])
