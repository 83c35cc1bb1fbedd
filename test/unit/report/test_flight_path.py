# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The path of a flight in space, coloured by the error of the predictions along it."""

import re

import numpy as np
import pytest

from quad_ident_ros.report.flight_path import FlightPath, save_path

LINES = re.compile(r'<path d="([^"]*)"[^>]*stroke: (#[0-9a-f]{6}); stroke-width: ([\d.]+); '
                   'stroke-linecap: round')


def drawn(path, folder):
    """Return [points, colour, width] of each line of the picture of a path."""
    save_path(path, folder / 'path.svg')
    text = (folder / 'path.svg').read_text(encoding='utf-8')
    return [(re.findall(r'[ML] ([-\d.]+ [-\d.]+)', line), colour, float(width))
            for line, colour, width in LINES.findall(text)]


@pytest.fixture
def path():
    """Return a rising turn in which the nominal vehicle is wrong at the end."""
    t = np.linspace(0.0, 10.0, 101)
    positions = np.stack([np.cos(t), np.sin(t), 0.1 * t], axis=1)
    return FlightPath(t, positions, {'before': 0.05 * t, 'after': np.full(101, 0.01)})


def test_words_tell_where_the_error_is_largest(path):
    assert path.in_words() == ('Largest error before: 0.5 m/s at 10 s, x, y, z -0.84, -0.54, '
                               '1.00 m; after: 0.01 m/s at 0 s, x, y, z 1.00, 0.00, 0.00 m.')


@pytest.mark.slow
def test_the_path_is_orange_and_thick_where_the_error_is_large(path, tmp_path):
    lines = drawn(path, tmp_path)
    *before, (after, _, thin) = lines       # the error after is the same all along
    assert len(after) == 101
    assert before[-1][1] == '#d65f04' and len({colour for _, colour, _ in before}) > 5
    widths = [width for *_, width in before]
    assert widths == sorted(widths) and thin < widths[-1] / 2
    # Each line begins where the one before ends.
    assert all(one[0][-1] == other[0][0]
               for one, other in zip(before[:-1], before[1:], strict=True))


@pytest.mark.slow
def test_nothing_is_drawn_where_nothing_is_known(path, tmp_path):
    """A single flight, of which blocks are held out."""
    known = np.r_[0:30, 60:101]
    lines = drawn(FlightPath(path.t[known], path.positions[known], {
        stage: error[known] for stage, error in path.errors.items()}), tmp_path)
    assert [len(points) for points, *_ in lines[-2:]] == [30, 41]
    assert sum(len(points) - 1 for points, *_ in lines) == 2 * (29 + 40)


@pytest.mark.slow
def test_a_vehicle_that_hovers_without_an_error_has_a_path(path, tmp_path):
    save_path(FlightPath(path.t, np.ones((101, 3)), {'before': np.zeros(101),
                                                     'after': np.zeros(101)}),
              tmp_path / 'path.svg')
    assert (tmp_path / 'path.svg').stat().st_size > 1000
