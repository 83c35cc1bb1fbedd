# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The page of a diagnosis and its pictures."""

from dataclasses import replace
import re

import matplotlib.image
import numpy as np
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.where import CHANNELS, Lacking
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report import gap_page
from quad_ident_ros.report.gap_pictures import _by_third, save_map, save_probabilities

VEHICLE = load_vehicle('hummingbird')


@pytest.fixture(scope='module')
def flights():
    return [fly_closed_loop(VEHICLE, {'rotor_drag': {'coefficient': 0.3}}, name, duration=10.0,
                            seed=seed, noise=MOCAP_IMU)
            for seed, name in enumerate(('figure8', 'circle'))]


@pytest.fixture(scope='module')
def found(flights):
    return diagnose(flights, VEHICLE, effects=['rotor_drag', 'body_drag', 'wind'])


@pytest.fixture
def page(found, flights, tmp_path):
    """Return a function that writes the page of the diagnosis with other data and reads it."""
    def write(**changes):
        other = replace(found, data={**found.data, **changes})
        gap_page.write(tmp_path / 'page.html', other)
        return (tmp_path / 'page.html').read_text(encoding='utf-8')
    return write


def test_the_verdict_comes_first_then_where_which_and_how_far(page, found):
    text = page()
    places = [text.index(part) for part in ('<strong>Verdict: </strong>', '>rotor_drag</span>',
                                            '<h2>Where</h2>', '<h2>Which</h2>',
                                            '<h2>How far</h2>', '<h2>From what</h2>')]
    assert places == sorted(places)
    assert text.count('<img src="data:image/png;base64,') == 4
    assert not re.search(r'(src|href)="(?!data:)', text)     # one file holds it all
    assert f'{100 * found.data["gap"]["closed"]:.0f} % of the velocity gap' in text
    assert 'What cannot be told' not in text


def test_the_interval_is_that_of_the_estimate(page, found):
    one = found.data['ranking'][0]['parameters']['coefficient']
    low, high = one['value'] - 1.96 * one['std'], one['value'] + 1.96 * one['std']
    assert f'<td>{low:.4g} to {high:.4g}</td>' in page()
    assert low < 0.3 < high


def test_what_cannot_be_told_is_said(page):
    text = page(verdict=['undetermined'], undetermined=['wind', 'body_drag'],
                unknown=[{'channel': 'Fz', 'depends_on': 'height <5 m', 'share': 0.4}],
                not_shown=['ground_effect'], fly_next=[proposal('circle'), proposal('chirp_x')])
    assert '<h2>What cannot be told</h2>' in text
    assert 'The flights cannot tell between wind, body_drag.' in text
    assert 'Fz depends on height &lt;5 m: 40 % of what is left there' in text
    assert 'Would not show at their usual size: ground_effect.' in text
    assert text.index('<td class="text">circle, 20 s</td>') < text.index('chirp_x, 20 s')
    assert '<td class="text">tell apart wind, body_drag</td><td>0.5</td><td>12</td>' in text


def proposal(trajectory):
    return {'purpose': 'separate', 'effects': ['wind', 'body_drag'], 'trajectory': trajectory,
            'duration': 20.0, 'seed': 0, 'span': [2.0, 2.0, 0.0], 'height': [1.0, 3.0],
            'speed': 2.0, 'now': 0.5, 'after': 12.0, 'manoeuvres': {trajectory: 12.0}}


def test_none_and_unknown_have_their_colours(page):
    assert 'tag yes">none<' in page(verdict=['none'])
    assert 'tag no">unknown<' in page(verdict=['rotor_drag', 'unknown'])


def test_a_place_that_cannot_be_written_is_said_in_one_line(found, flights, tmp_path):
    (tmp_path / 'file').write_text('')
    with pytest.raises(InputError, match='cannot be written'):
        gap_page.write(tmp_path / 'file' / 'page.html', found)


def test_the_command_writes_it(flights, tmp_path, capsys):
    paths = []
    for k, flight in enumerate(flights):
        paths.append(str(tmp_path / f'{k}.csv'))
        write_csv(paths[-1], flight)
    out = tmp_path / 'new' / 'report.html'
    assert main(['diagnose', *paths, '--vehicle', 'hummingbird', '--effects',
                 'rotor_drag,body_drag', '--report', str(out)]) == 0
    assert capsys.readouterr().out.startswith('verdict: rotor_drag')
    assert '<h1>What hummingbird lacks</h1>' in out.read_text(encoding='utf-8')


def lacking(force):
    """Return a flight that lacks a force along x (N) at speeds from 0 to 3 m/s."""
    speed = np.linspace(0.0, 3.0, 300)
    values = np.zeros((300, 6))
    values[:, 0] = force(speed)
    return Lacking(values, np.full((300, 6), 1e-3), speed,
                   {'speed': ('m/s', speed), 'height': ('m', np.tile([1.0, 2.0, 3.0], 100))})


def test_the_map_shows_where_the_force_lacks():
    flight = lacking(lambda speed: np.where(speed > 2.0, 1.0, 0.0))
    table = _by_third([flight], ['speed', 'height'], VEHICLE)
    assert table.shape == (len(CHANNELS), 6)
    push = 0.5 / VEHICLE.mass       # m/s that 1 N makes in half a second
    assert table[0, 2] == pytest.approx(push, rel=1e-3) and (table[0, :2] < 0.1 * push).all()
    np.testing.assert_allclose(table[0, 3:], push / np.sqrt(3.0), rtol=0.1)
    assert not table[1:].any()      # what noise alone gives is taken off


def test_pictures_have_ink(found, tmp_path):
    flight = lacking(lambda speed: speed)
    save_map([flight], [lacking(lambda speed: 0.0 * speed)], VEHICLE, tmp_path / 'map.png')
    save_probabilities(found.data['ranking'], tmp_path / 'bars.png')
    for name in ('map.png', 'bars.png'):
        picture = matplotlib.image.imread(tmp_path / name)
        assert picture.shape[1] > 500 and np.std(picture[..., :3]) > 0.05
