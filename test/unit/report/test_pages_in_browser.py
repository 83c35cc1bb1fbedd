# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The pages of `diagnose --report`, `fleet --report` and `paper` in a real browser."""

import json
import re

from browser import chromium, cut_in_print, opened, printed, violations, WIDTHS
from fleets import data_set
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.fleet.insight import insight
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report import fleet_page, gap_page

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


@pytest.fixture(scope='module')
def fleet(browser, tmp_path_factory):
    """Return the page of a fleet with a change and an odd vehicle."""
    folder = tmp_path_factory.mktemp('fleet')
    data_set(folder, vehicles=12, steps=[('uav3', 'com_offset', 'x', 11, 4e-3)],
             odd=[('uav7', 'rotor_drag', 'coefficient', 0.08)])
    fleet_page.write(folder / 'fleet.html', insight(folder))
    return folder / 'fleet.html'


@pytest.fixture(params=['gap', 'paper', 'fleet'])
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


def test_prose_in_a_table_is_read_on_a_telephone_without_scrolling(browser, path):
    """It was beyond the right edge, beside rows that it made high and empty."""
    with opened(browser, path, 390) as (page, *_):
        page.evaluate("""() => document.querySelectorAll('details')
            .forEach(one => { one.open = true; })""")
        assert page.evaluate("""() => [...document.querySelectorAll('td.prose')]
            .filter(one => one.getBoundingClientRect().right > innerWidth)
            .map(one => one.textContent)""") == []


def test_the_effects_fit_a_desk_with_the_longest_title(browser, gap):
    """Their intervals were cut, and had to be scrolled to."""
    with opened(browser, gap) as (page, *_):
        [cut] = page.evaluate("""() => [...document.querySelectorAll('.dense')]
            .filter(one => one.caption.textContent.startsWith('Effects'))
            .map(one => { const row = one.tBodies[0].rows[0], around = one.parentElement;
              row.cells[0].textContent = 'misaligned attitude or gyro (attitude_misalignment)';
              row.cells[5].textContent = 'thrust_coefficient';
              row.cells[7].textContent = '-0.005089 to -0.001169';
              return around.scrollWidth - around.clientWidth; })""")
        assert cut <= 0


def test_the_verdict_fits_a_telephone_with_the_longest_title(browser, gap):
    """Its title was on one line, beyond the right edge."""
    with opened(browser, gap, 390) as (page, *_):
        page.evaluate("""() => { document.querySelector('.tag').textContent =
            'misaligned attitude or gyro (attitude_misalignment)'; }""")
        assert page.evaluate('document.documentElement.scrollWidth') == 390


FIELDS = '.field'
PICTURES = "() => [...document.querySelectorAll('.live canvas')].map(one => one.toDataURL())"


@pytest.fixture(params=WIDTHS)
def shown(request, browser, gap):
    """Give the open page of a diagnosis and the values beside its picture over time."""
    with opened(browser, gap, request.param) as (page, said, _):
        yield page, json.loads(page.locator('figure:has(.field) > script').nth(1).inner_text())
        assert said == []


@pytest.fixture
def over_time(shown):
    """Return the charts over time, a locator."""
    return shown[0].locator('figure:has-text("vx, m/s")').locator(FIELDS)


def drag(page, field, begin, end):
    """Drag over a chart, from a share of its width to another."""
    field.scroll_into_view_if_needed()
    box = field.locator('.u-over').bounding_box()
    page.mouse.move(box['x'] + begin * box['width'], box['y'] + 20)
    page.mouse.down()
    page.mouse.move(box['x'] + end * box['width'], box['y'] + 30, steps=4)
    page.mouse.up()


def span(field):
    """Return the first and the last time that a chart shows, as its keys reach them."""
    times = []
    for key in ('Home', 'End'):
        field.press(key)
        times.append(float(field.get_attribute('aria-valuetext').split()[0]))
    return times


def at_rest(page):
    """Return the pictures of all charts, the cursor in none."""
    page.mouse.move(1, 1)
    page.wait_for_timeout(100)      # a frame of the browser, in which it draws
    return page.evaluate(PICTURES)


def test_a_zoom_over_time_is_that_of_every_picture_over_time(shown, over_time):
    page, data = shown
    before = at_rest(page)
    whole = span(over_time.last)
    assert whole == [data['x'][0], data['x'][-1]]
    drag(page, over_time.first, 0.25, 0.5)
    width = whole[1] - whole[0]
    for field in (over_time.first, over_time.last):
        assert span(field) == pytest.approx([whole[0] + 0.25 * width, whole[0] + 0.5 * width],
                                            abs=0.2)
    changed = [one != other for one, other in zip(at_rest(page), before, strict=True)]
    spectra = page.locator('figure:has-text("Amplitude density")').locator(FIELDS).count()
    # Those over the frequency come first, those of the path last; they stay, and follow.
    assert changed == [False] * spectra + [True] * (over_time.count() + 2)
    over_time.nth(3).locator('.u-over').dblclick()
    at_rest(page)
    assert span(over_time.first) == whole
    over_time.first.press('Escape')
    assert at_rest(page) == before


def test_the_value_under_the_pointer_is_the_datum(shown, over_time):
    page, data = shown
    for number in (0, 1):
        field, panel = over_time.nth(number), data['panels'][number]
        field.scroll_into_view_if_needed()
        box = field.locator('.u-over').bounding_box()
        page.mouse.move(box['x'] + 0.4 * box['width'], box['y'] + box['height'] / 2)
        head = field.locator('xpath=preceding-sibling::p')
        page.wait_for_function('one => one.innerText.includes(" s")', arg=head.element_handle())
        time = float(re.search(r'at (\S+) s', head.inner_text())[1])
        place = data['x'].index(time)
        assert time == pytest.approx(data['x'][0] + 0.4 * (data['x'][-1] - data['x'][0]), abs=0.1)
        for line in panel['lines']:
            assert f'{line["style"]} {line["values"][place]:g}' in head.inner_text()
        assert field.get_attribute('aria-valuenow') == str(place)


def test_keys_do_what_the_pointer_does(shown, over_time):
    page, data = shown
    field = over_time.first
    field.press('Home')
    field.press('ArrowRight')
    field.press('ArrowRight')
    assert field.get_attribute('aria-valuetext').startswith(f'{data["x"][2]} s, measured ')
    assert over_time.last.get_attribute('aria-valuenow') == '2'     # one cursor in all
    for _ in range(30):
        field.press('ArrowRight')
    field.press('+')
    field.press('+')
    begin, end = span(field)
    assert begin < data['x'][32] < end
    assert end - begin == pytest.approx((data['x'][-1] - data['x'][0]) / 1.5 ** 2, abs=0.3)
    for _ in range(2):      # beyond what is shown, which follows
        field.press('ArrowRight')
    assert span(field)[1] == pytest.approx(end + 0.2, abs=1e-6)
    field.press('-')
    field.press('Escape')
    assert span(field) == [data['x'][0], data['x'][-1]]
    # What has the keys can be seen.
    assert field.evaluate('one => getComputedStyle(one).outlineStyle') == 'solid'


def test_a_page_that_scrolls_below_the_pointer_takes_no_value_away(shown, over_time):
    page, data = shown
    over_time.first.locator('.u-over').hover()
    over_time.first.press('Home')
    before = page.evaluate('scrollY')
    page.mouse.wheel(0, 700)
    page.wait_for_function('before => scrollY > before + 600', arg=before)
    page.wait_for_timeout(200)      # frames in which the browser sees what is below it
    assert over_time.first.get_attribute('aria-valuetext').startswith(f'{data["x"][0]} s, ')


def test_a_screen_reader_gets_names_and_numbers_of_every_picture(shown):
    """The lines of a chart are behind its slider; a path says the largest error of its stage."""
    page, _ = shown
    hidden = page.locator('.field canvas').evaluate_all(
        'all => all.map(one => one.closest("[aria-hidden=true]") !== null)')
    assert len(hidden) == 18 and all(hidden)
    path = json.loads(page.locator('figure:has(.space) > script').inner_text())
    for canvas, (stage, errors) in zip(page.locator('canvas.space').all(),
                                       path['errors'].items(), strict=True):
        assert f'{stage}, velocity errors to {max(errors):g} m/s' in canvas.get_attribute(
            'aria-label')
    rows = page.get_by_role('table', name='Velocity error by horizon').get_by_role('rowheader')
    assert rows.all_inner_texts() == ['0.1', '0.5', '1']


def test_a_screen_reader_hears_what_a_picture_shows_and_not_its_marks(browser, path):
    with opened(browser, path) as (page, *_):
        assert page.locator('svg text').evaluate_all(
            "all => all.filter(one => !one.closest('[aria-hidden=true]')).length") == 0
        names = [one.get_attribute('aria-label') for one in page.get_by_role('img').all()]
        assert all(names)


def test_a_screen_reader_hears_where_the_map_and_the_gap_are_largest(shown):
    page, _ = shown
    page.get_by_text('The map in numbers').click()
    label = page.get_by_role('img', name='by channel and regime').get_attribute('aria-label')
    assert label.endswith('The tables under "The map in numbers" have every cell.')
    for stage in ('before', 'after'):
        most, name, where = re.search(rf'{stage}: (\S+) m/s by (\w+) \((.*?)\)', label).groups()
        cells = page.get_by_role('table', name=f'in half a second, {stage} the diagnosis')
        numbers = cells.get_by_role('cell').all_inner_texts()
        assert max(float(one) for one in numbers) == float(most)
        place = ('Fx', 'Fy', 'Fz', 'Mx', 'My', 'Mz').index(name)
        row = cells.get_by_role('row').filter(has=page.get_by_role('rowheader', name=where))
        assert row.get_by_role('cell').nth(place).inner_text() == most
    gap = page.get_by_role('img', name='Gap by horizon').get_attribute('aria-label')
    [row] = page.get_by_role('table', name='Velocity error by horizon').get_by_role(
        'row').filter(has=page.get_by_role('rowheader', name='1', exact=True)).all()
    before, _, after, noise = row.get_by_role('cell').all_inner_texts()
    assert f'velocity {before} m/s before, {after} after, {noise} of noise' in gap


def test_a_chart_without_a_cursor_says_what_its_lines_span_in_sight(shown, over_time):
    page, data = shown
    field, panel = over_time.nth(1), data['panels'][1]

    def spans(first, last):
        return 'no value chosen, ' + ', '.join(
            f'{line["label"]} {min(line["values"][first:last + 1]):g} to '
            f'{max(line["values"][first:last + 1]):g}' for line in panel['lines'])

    assert field.get_attribute('aria-valuetext') == spans(0, len(data['x']) - 1)
    tools = page.get_by_role('group', name='Zoom over time')
    for _ in range(4):
        tools.get_by_role('button', name='Zoom in').click()
    shows = tools.get_by_role('status').inner_text()
    first, last = (data['x'].index(float(one)) for one in re.findall(r'[\d.]+', shows))
    assert field.get_attribute('aria-valuetext') == spans(first, last) != spans(
        0, len(data['x']) - 1)


def test_a_screen_reader_gets_every_cell_of_the_map(shown):
    page, _ = shown
    page.get_by_text('The map in numbers').click()
    for stage in ('before', 'after'):
        cells = page.get_by_role('table', name=f'in half a second, {stage} the diagnosis')
        assert cells.get_by_role('columnheader').all_inner_texts() == [
            'regime, third', *(f'{name}, m/s' for name in ('Fx', 'Fy', 'Fz', 'Mx', 'My', 'Mz'))]
        rows = cells.get_by_role('rowheader').all_inner_texts()
        assert 'horizontal air speed, high' in rows
        numbers = cells.get_by_role('cell').all_inner_texts()
        assert len(numbers) == 6 * len(rows) and all(float(one) >= 0.0 for one in numbers)


def test_buttons_zoom_where_there_is_no_keyboard(shown, over_time):
    page, data = shown
    tools = page.get_by_role('group', name='Zoom over time')
    tools.get_by_role('button', name='Zoom in').click()
    assert 'time ' in tools.get_by_role('status').inner_text()
    tools.get_by_role('button', name='Show all').click()
    assert 'Drag to zoom' in tools.get_by_role('status').inner_text()
    assert span(over_time.first) == [data['x'][0], data['x'][-1]]


def test_the_path_turns_by_keys_and_by_pointer_and_comes_back(shown):
    page, _ = shown
    path = page.locator('canvas.space').first
    path.scroll_into_view_if_needed()
    before = at_rest(page)
    path.focus()
    seen = [before]
    for key in ('ArrowLeft', 'ArrowUp', '+'):
        path.press(key)
        assert at_rest(page)[-2:] != seen[-1][-2:]
        seen.append(at_rest(page))
    assert seen[-1][:-2] == before[:-2]
    path.press('Escape')
    assert at_rest(page) == before
    box = path.bounding_box()
    page.mouse.move(box['x'] + 100, box['y'] + 100)
    page.mouse.down()
    page.mouse.move(box['x'] + 150, box['y'] + 100, steps=3)
    page.mouse.up()
    assert at_rest(page)[-2:] != before[-2:]


def test_without_scripts_and_in_print_the_pictures_are_those_of_the_file(browser, gap):
    with opened(browser, gap, java_script_enabled=False) as (page, *_):
        assert [one.is_visible() for one in page.locator('.picture').all()] == [True] * 5
    with opened(browser, gap) as (page, *_):
        assert page.locator('.picture:visible').count() == 2    # what nothing moves in
        page.emulate_media(media='print')
        assert page.locator('.picture:visible').count() == 5
        assert page.locator('.live:visible').count() == 0


def test_the_colours_of_the_charts_follow_those_of_the_page(browser, gap):
    with opened(browser, gap, color_scheme='light') as (page, *_):
        light = at_rest(page)
        page.emulate_media(color_scheme='dark')
        assert all(one != other for one, other in zip(at_rest(page), light, strict=True))


VEHICLES = """() => [...[...document.querySelectorAll('table')].find(
  one => one.caption.textContent.startsWith('Parameters')).tBodies[0].rows]
  .filter(row => row.checkVisibility()).map(row => row.cells[0].textContent)"""
SHOWN = """() => [...document.querySelectorAll('.multiples figure')]
  .filter(one => one.checkVisibility()).length"""


def test_a_fleet_is_filtered_by_vehicle_effect_and_what_happened(browser, fleet):
    """Rows, pictures and the list show what is asked for, and all again once nothing is."""
    with opened(browser, fleet) as (page, *_):
        assert len(page.evaluate(VEHICLES)) == 12 and page.evaluate(SHOWN) == 36
        page.get_by_role('searchbox').fill('uav3')
        assert page.evaluate(VEHICLES) == ['uav3'] and page.evaluate(SHOWN) == 3
        assert page.locator('.first > li:visible').all_inner_texts()[0].startswith('uav3 changed')
        page.get_by_role('combobox').select_option('offset of the centre of mass (com_offset)')
        assert page.evaluate(SHOWN) == 1
        page.get_by_role('searchbox').fill('')
        page.get_by_role('combobox').select_option('')
        page.get_by_label('only changes and drifts').check()
        assert page.evaluate(SHOWN) == 1
        assert page.get_by_role('status').inner_text() == '1 of 36 pictures'
        page.get_by_label('only changes and drifts').uncheck()
        assert page.evaluate(SHOWN) == 36


def test_a_table_of_a_fleet_is_sorted_by_keys(browser, fleet):
    """A title is reached by keys; Enter sorts by numbers, and once more the other way round."""
    with opened(browser, fleet) as (page, *_):
        title = page.get_by_role('button', name=re.compile('rotor_drag'))
        title.focus()
        page.keyboard.press('Enter')
        assert page.evaluate(VEHICLES)[-1] == 'uav7'
        page.keyboard.press('Enter')
        assert page.evaluate(VEHICLES)[0] == 'uav7'
        head = page.get_by_role('columnheader', name=re.compile('rotor_drag'))
        assert head.get_attribute('aria-sort') == 'descending'


def test_a_fleet_is_heard_without_its_colours_and_arrows(browser, fleet):
    with opened(browser, fleet) as (page, *_):
        odd = page.locator('td.no').filter(has_text='*')
        for cell in odd.all():
            assert cell.inner_text().endswith(f', {cell.get_attribute("title")}')
        assert odd.count() == 2
        assert page.locator('.first > li').first.inner_text().startswith('uav3 changed: from ')
        # The arrows are not a part of the names, and aria-sort says what they show.
        tree = page.context.new_cdp_session(page)
        tree.send('Accessibility.enable')
        names = [one['name']['value'] for one in tree.send('Accessibility.getFullAXTree')['nodes']
                 if one.get('role', {}).get('value') == 'button']
        assert 'vehicle' in names and not re.search('[↑↓↕]', ' '.join(names))
        labels = [one.get_attribute('aria-label') for one in page.get_by_role('img').all()]
        assert any('(thrust_scale) factor over ' in one for one in labels)


def test_names_are_sorted_as_people_count_and_what_is_not_known_comes_last(browser, fleet):
    """Vehicle 9 comes before vehicle 10; a cell without a value is neither large nor small."""
    with opened(browser, fleet) as (page, *_):
        page.evaluate("document.querySelector('.sortable tbody tr:nth-child(3) > td').remove()")
        page.evaluate("document.querySelector('.sortable tbody tr:nth-child(3)').insertCell(1)")
        empty = page.evaluate(VEHICLES)[2]
        title = page.get_by_role('button', name=re.compile('^vehicle')).first
        title.click()
        assert page.evaluate(VEHICLES) == [f'uav{number}' for number in range(1, 13)]
        title.click()
        assert page.evaluate(VEHICLES)[0] == 'uav12'
        first = page.locator('.sortable thead button').nth(1)
        for _ in range(2):
            first.click()
            assert page.evaluate(VEHICLES)[-1] == empty
