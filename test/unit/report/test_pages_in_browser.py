# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The pages of `diagnose --report` and `paper` in a real browser."""

from browser import chromium, cut_in_print, opened, printed, violations, WIDTHS
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report import gap_page

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('browser')]


@pytest.fixture(scope='module')
def browser():
    with chromium() as started:
        yield started


@pytest.fixture(scope='module')
def gap(browser, tmp_path_factory):
    """Return the page of a diagnosis."""
    vehicle = load_vehicle('hummingbird')
    flights = [fly_closed_loop(vehicle, {'rotor_drag': {'coefficient': 0.3}}, name, duration=10.0,
                               seed=seed, noise=MOCAP_IMU)
               for seed, name in enumerate(('figure8', 'circle'))]
    path = tmp_path_factory.mktemp('gap') / 'gap.html'
    gap_page.write(path, diagnose(flights, vehicle, effects=['rotor_drag', 'body_drag', 'wind']))
    return path


@pytest.fixture(scope='module')
def paper(browser, tmp_path_factory):
    """Return the page of a reproduction of the paper."""
    folder = tmp_path_factory.mktemp('paper')
    assert main(['paper', '--seeds', '2', '--preset', 'paper_table3', '-o', str(folder)]) == 0
    return folder / 'paper.html'


@pytest.fixture(params=['gap', 'paper'])
def path(request):
    return request.getfixturevalue(request.param)


@pytest.mark.parametrize('scheme', ['light', 'dark'])
@pytest.mark.parametrize('width', WIDTHS)
def test_everybody_can_read_the_page(browser, path, width, scheme):
    with opened(browser, path, width, color_scheme=scheme) as (page, said, asked):
        assert violations(page) == []
        assert page.evaluate('document.documentElement.scrollWidth') == width
        assert said == [] and asked == []


def test_nothing_is_cut_in_print(browser, path, tmp_path):
    with opened(browser, path) as (page, *_):
        assert cut_in_print(page) == []
        assert printed(page, tmp_path / 'page.pdf') > 1


def test_a_wide_table_is_reached_and_scrolled_by_keys(browser, path):
    with opened(browser, path, 390) as (page, *_):
        page.evaluate("""() => [...document.querySelectorAll('.wide')]
            .find(one => one.scrollWidth > one.clientWidth && one.checkVisibility()).focus()""")
        page.keyboard.press('ArrowRight')
        page.wait_for_function('document.activeElement.scrollLeft > 0')
