# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the data set of a fleet shows, in values, in words and on the page."""

from datetime import timedelta
import io
import json
import os
import re
import subprocess
import sys

from fleets import data_set, series, START
import numpy as np
import pytest

from quad_ident_ros.report.data import finite

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
from quad_ident_ros.fleet.events import events  # noqa: E402, I100
from quad_ident_ros.fleet.history import histories  # noqa: E402, I100
from quad_ident_ros.fleet.insight import insight  # noqa: E402, I100
from quad_ident_ros.fleet.store import keys_of, read_rows, write_rows  # noqa: E402, I100
from quad_ident_ros.report.fleet import show_insight  # noqa: E402, I100
from quad_ident_ros.report.fleet_charts import small_multiple  # noqa: E402, I100
from quad_ident_ros.report.fleet_page import write  # noqa: E402, I100
from quad_ident_ros.report.fleet_words import (  # noqa: E402, I100
    nothing_line,
    points,
    summary_line,
)

STEP = ('uav3', 'com_offset', 'x', 11, 4e-3)
SLOPE = ('uav5', 'thrust_scale', 'factor', -0.01)
WRONG = ('uav2', 'com_offset', 'x', 13, 0.05)
ODD = ('uav7', 'rotor_drag', 'coefficient', 0.08)


@pytest.fixture(scope='module')
def found(tmp_path_factory):
    """Return the insight of a fleet with a change, a drift, an odd vehicle and a bad log."""
    out = tmp_path_factory.mktemp('fleet')
    data_set(out, steps=[STEP], slopes=[SLOPE], odd=[ODD], wrong=[WRONG])
    return insight(out)


def test_what_happened_is_found_and_dated(found):
    """One change, one drift, one odd vehicle, one shared effect, and nothing else."""
    change, = (event for event in found.events if event.kind == 'change')
    drift, = (event for event in found.events if event.kind == 'drift')
    assert change.vehicle == 'uav3' and change.flight == 'uav3/11'
    assert change.date == START + timedelta(days=33)
    assert change.parts[0].change.size == pytest.approx(4e-3, rel=0.1)
    assert drift.vehicle == 'uav5'
    assert drift.parts[0].change.per_week == pytest.approx(-0.01, rel=0.1)
    assert 'uav7' in {one.sister.vehicle for one in found.odd if one.effect == 'rotor_drag'}
    assert {one.sister.vehicle for one in found.odd} <= {'uav3', 'uav5', 'uav7'}
    assert {one.effect for one in found.present if one.shared} == {'rotor_drag', 'com_offset'}


def test_an_effect_that_few_vehicles_have_is_listed(tmp_path):
    """It is followed in these alone, so that no sister's value is beside theirs."""
    for number in range(6):
        dated = {'group': f'{number}', 'vehicle': f'uav{number}', 'configuration': '',
                 'date': START}
        having = number == 2
        write_rows(tmp_path, 'groups', f'{number}', [dated | {
            'flights': 1, 'status': 'diagnosed',
            'verdict': ['thrust_scale'] if having else ['none']}])
        write_rows(tmp_path, 'effects', f'{number}', [dated | {
            'effect': 'thrust_scale', 'probability': float(having), 'contribution': 1.0,
            'form': 'scale', 'named': having, 'minor': False}])
        write_rows(tmp_path, 'flights', f'{number}', [dated | {
            'flight': f'{number}', 'path': f'{number}.csv', 'status': 'diagnosed'}])
    write_rows(tmp_path, 'parameters', '2', [{
        'flight': '2', 'group': '2', 'vehicle': 'uav2', 'configuration': '', 'date': START,
        'effect': 'thrust_scale', 'parameter': 'factor', 'unit': '1', 'value': 0.93,
        'std': 0.001}])
    one, = points(insight(tmp_path))
    assert (one.why, one.where) == ('differs from its sisters', 'uav2')
    assert one.text.startswith('1 of 6 vehicles has ')
    assert 'uav2 factor 0.930' in one.text


def test_refused_flights_take_no_part(found):
    """The first flight of the first vehicle is listed with its reason and is in no series."""
    assert found.refused == (('uav1', '0.csv', 'this is not text'),)
    assert all('uav1/0' not in one.series.flights for one in found.histories)
    assert found.flights == 160 and found.status == {'diagnosed': 32}


def test_a_flight_that_is_off_by_itself_is_to_be_checked(found):
    """A wrong log is no change of the vehicle; it is named with what is off."""
    assert ('uav2', '13.csv', 'off by itself: com_offset x') in found.suspect
    assert all(event.vehicle != 'uav2' for event in found.events)


def test_the_list_begins_with_what_gets_worse(found):
    """Drifts come before changes, these before odd vehicles, then the model and the logs."""
    some = points(found)
    assert [one.why for one in some][:4] == ['gets worse', 'changed', 'differs from its sisters',
                                             'the model is wrong']
    assert [one.where for one in some][:3] == ['uav5', 'uav3', 'uav7']
    # No verdict names thrust here, and none would: they let it differ by flight.
    assert 'falls by' in some[0].text and '% a week' in some[0].text
    assert 'matters little' not in some[0].text
    assert some[1].text.startswith('from 3 June 2026 on, offset of the centre of mass')
    assert 'mm' in some[1].text and '; 11.csv, flight 12 of 20, is the first' in some[1].text
    shared = {one.text.partition('(')[2].partition(')')[0]: one.text for one in some
              if one.why == 'the model is wrong'}
    assert shared['rotor_drag'].endswith('add it to the vehicle file')
    assert 'each with values of its own' in shared['com_offset']


@pytest.mark.slow
def test_a_drift_that_most_vehicles_have_alike_is_one_entry(tmp_path):
    """In spring the thrust of all falls with the density of the air; of one it falls faster."""
    data_set(tmp_path, slopes=[(f'uav{number}', 'thrust_scale', 'factor',
                                -0.02 if number == 5 else -0.005) for number in range(1, 8)])
    found = insight(tmp_path)
    assert len(found.events) == 7
    one, shared = (point for point in points(found) if point.why == 'gets worse')
    assert one.where == 'uav5' and shared.where == 'all'
    assert 'falls in 6 of 8 vehicles alike, by 0.5' in shared.text and '%' in shared.text
    assert 'temperature' in shared.text


@pytest.mark.slow
def test_a_drift_of_a_few_vehicles_is_theirs(tmp_path):
    data_set(tmp_path, slopes=[(f'uav{number}', 'thrust_scale', 'factor', -0.005)
                               for number in range(1, 5)])
    assert [one.where for one in points(insight(tmp_path)) if one.why == 'gets worse'] == [
        'uav1', 'uav2', 'uav3', 'uav4']


@pytest.mark.slow
@pytest.mark.parametrize(('odd', 'last'), [((), True), (
    [('uav4', 'com_offset', 'x', 0.02)], False)])
def test_what_verdicts_may_take_for_an_effect_of_most_vehicles_comes_last(tmp_path, odd, last):
    """An offset towards one rotor looks like a weak one; where it is large, it is worth a look."""
    data_set(tmp_path, odd=odd)
    for key in keys_of(tmp_path, 'effects'):
        drag, offset = read_rows(tmp_path, 'effects', key)
        fault = offset | {'effect': 'rotor_fault', 'form': 'thrust'}
        mistaken = [offset, fault][::1 if key.startswith('uav4') else -1]
        write_rows(tmp_path, 'effects', key, [
            drag, mistaken[0] | {'probability': 0.0, 'named': False}, mistaken[1]])
    some = points(insight(tmp_path))
    one, = (one for one in some if 'rotor_fault' in one.text)
    assert one.where == 'uav4' and (one == some[-1]) == last
    assert ('does not differ from its sisters' in one.text) == last


@pytest.mark.slow
def test_what_is_sure_and_in_no_verdict_comes_last(tmp_path):
    """Other than of thrust, a drift that no verdict names hardly moves the vehicle."""
    data_set(tmp_path, slopes=[('uav5', 'com_offset', 'x', 2e-3)], wrong=[WRONG])
    for key in (key for key in keys_of(tmp_path, 'groups') if key.startswith('uav5')):
        rows = read_rows(tmp_path, 'groups', key)
        write_rows(tmp_path, 'groups', key, [row | {'verdict': ['rotor_drag']} for row in rows])
    last = points(insight(tmp_path))[-1]
    assert (last.where, last.why) == ('uav5', 'gets worse')
    assert last.text.endswith('; no verdict names it, so it matters little')


@pytest.mark.slow
def test_the_data_is_json_of_its_schema(found):
    """as_data() has plain values alone, and the same events."""
    data = json.loads(json.dumps(finite(found.as_data()), allow_nan=False))
    assert data['schema'] == 'quad_ident/insight/1'
    assert [event['vehicle'] for event in data['events']] == [
        event.vehicle for event in found.events]
    assert data['gap']['groups'] == sum(one['groups'] for one in data['gaps']) == 32


def test_the_terminal_shows_the_list_first(found):
    """The list stands above the tables, and no line of it is cut."""
    stream = io.StringIO()
    show_insight(found, stream)
    text = stream.getvalue()
    assert text.index('what to look at first') < text.index('uav3') < text.index('effects in')
    assert '160 flights of 8 vehicles' in text
    assert 'over 32 groups of the whole fleet: 0.4 m/s before, 0.05 m/s after' in text


def test_the_page_has_every_vehicle_and_loads_nothing(found, tmp_path):
    """Each vehicle has its row, each series its picture; there is no address of a network."""
    page = tmp_path / 'fleet.html'
    write(page, found)
    text = page.read_text(encoding='utf-8')
    assert text.count('<figure data-vehicle=') == len(found.histories) == 24
    assert text.count('<svg class="small"') == 24
    assert 'Median over 32 groups of the whole fleet: 0.4 m/s before' in text
    assert 'http://' not in text and 'https://' not in text


def test_a_fleet_without_a_flight_that_was_fitted_has_a_page(tmp_path):
    """All groups refused: the page says so and has no empty tables."""
    write_rows(tmp_path, 'groups', 'a', [{
        'group': 'a', 'vehicle': 'uav1', 'configuration': '', 'date': START, 'flights': 1,
        'status': 'refused', 'reason': 'too short'}])
    write_rows(tmp_path, 'flights', 'a', [{
        'flight': 'f', 'path': 'f.csv', 'group': 'a', 'vehicle': 'uav1', 'configuration': '',
        'date': START, 'status': 'refused', 'reason': 'too short'}])
    found = insight(tmp_path)
    write(tmp_path / 'fleet.html', found)
    show_insight(found, io.StringIO())
    assert found.events == () and found.status == {'refused': 1}
    assert points(found)[0].text.startswith('1 of 1 flights is refused')


def test_names_are_text_on_the_page(tmp_path):
    """A vehicle may be called as it likes: its name is no markup."""
    data_set(tmp_path / 'set', vehicles=2, flights=5)
    write_rows(tmp_path / 'set', 'flights', 'x', [{
        'flight': 'x', 'path': 'x.csv', 'group': 'x', 'vehicle': '<b>"x', 'configuration': '',
        'date': START, 'status': 'refused', 'reason': '<script>'}])
    write(tmp_path / 'fleet.html', insight(tmp_path / 'set'))
    text = (tmp_path / 'fleet.html').read_text(encoding='utf-8')
    assert '<b>"x' not in text and '<td class="prose"><script>' not in text


@pytest.mark.slow
def test_a_drift_towards_no_effect_does_not_get_worse(tmp_path):
    """A drag that falls does; it is no less sure, and no more urgent than a change."""
    data_set(tmp_path, slopes=[('uav5', 'rotor_drag', 'coefficient', -0.004)],
             steps=[('uav5', 'rotor_drag', 'coefficient', 0, 0.1)])
    why, = {one.why for one in points(insight(tmp_path)) if one.where == 'uav5'
            and 'a week' in one.text}
    assert why == 'drifts'


@pytest.mark.parametrize(('effect', 'material'), [
    ('thrust_scale', True), ('mass_offset', True), ('rotor_drag', False)])
def test_what_verdicts_let_differ_by_flight_matters_without_being_named(effect, material):
    """A mass stands for thrust: single flights show the ratio alone."""
    falls = 1.0 - 0.01 * np.arange(20) + 1e-3 * np.sin(np.arange(20.0) ** 2)
    one, = events(histories([series(falls, 1e-3, effect=effect)]), set())
    assert one.kind == 'drift' and one.material == material


@pytest.mark.slow
def test_thrust_that_its_sisters_do_not_have_matters_though_no_verdict_names_it(tmp_path):
    data_set(tmp_path, odd=[('uav7', 'thrust_scale', 'factor', -0.2)])
    one, = (one for one in points(insight(tmp_path)) if one.where == 'uav7')
    assert one.why == 'differs from its sisters' and 'matters little' not in one.text


def test_a_fleet_of_one_vehicle_has_its_values_on_the_page(tmp_path):
    """There is nobody to compare it with, and it is no less there."""
    data_set(tmp_path, vehicles=1, flights=6)
    found = insight(tmp_path)
    assert not found.odd and len(found.sisters) == 3
    write(tmp_path / 'fleet.html', found)
    text = (tmp_path / 'fleet.html').read_text(encoding='utf-8')
    assert text.count('<td data-value=') == 3 and 'from its sisters"' not in text
    assert 'Mean and spread' not in text


def test_flights_of_one_date_stand_beside_one_another(tmp_path):
    """As of logs whose folder says the day and nothing else the time."""
    one = series(np.arange(5.0), 0.1, days=np.zeros(5))
    found, = histories([one])
    dots = re.search('class="dots" d="([^"]*)"', small_multiple(found, '', 1.0))[1]
    places = [float(place) for place in re.findall(r'M([\d.]+) ', dots)]
    assert len(places) == 5 and np.all(np.diff(places) > 30.0)


def test_the_ends_of_a_scale_differ():
    """As of a factor that is known to a thousandth."""
    found, = histories([series(1.02 + 1e-4 * np.arange(5.0), 1e-4)])
    high, low = re.findall('text-anchor="end">([0-9.]+)<', small_multiple(found, '', 1.0))
    assert float(high) - float(low) == pytest.approx(8.8e-4, abs=1e-4)


def test_what_failed_is_not_called_refused(tmp_path):
    """The next run tries it again, and its log may be right."""
    row = {'vehicle': 'uav1', 'configuration': '', 'date': START}
    for name, status in (('a', 'failed'), ('b', 'timeout'), ('c', 'refused')):
        write_rows(tmp_path, 'groups', name, [row | {'group': name, 'status': status}])
        write_rows(tmp_path, 'flights', name, [row | {
            'flight': name, 'path': f'{name}.csv', 'status': status, 'reason': f'{name} it is'}])
    found = insight(tmp_path)
    assert found.refused == (('uav1', 'c.csv', 'c it is'),)
    assert [one[1] for one in found.failed] == ['a.csv', 'b.csv']
    assert [one.text for one in points(found)] == [
        '2 of 3 flights are not diagnosed, which the next run tries again: uav1 2; the first: '
        'a it is', '1 of 3 flights is refused: uav1 1; the first: c it is']
    assert '1 flight refused, 2 not diagnosed' in summary_line(found)


@pytest.mark.slow
def test_vehicles_are_named_with_their_configuration(tmp_path):
    """What holds for one of several configurations is not said of all."""
    data_set(tmp_path, steps=[STEP], configuration='long')
    found = insight(tmp_path)
    texts = {one.where: one.text for one in points(found)}
    assert 'uav3 (long)' in texts and texts['all'].startswith('8 of 8 (long) vehicles have')
    stream = io.StringIO()
    show_insight(found, stream)
    assert '8 of 8 (long)' in stream.getvalue()
    write(tmp_path / 'fleet.html', found)
    assert '<strong>uav3 (long)</strong>' in (tmp_path / 'fleet.html').read_text(encoding='utf-8')


@pytest.mark.parametrize(('vehicles', 'flights', 'said'), [
    (5, 3, 'No vehicle has the 4 flights from which on a change can be seen, and no vehicle '
     'differs from its sisters'),
    (2, 8, 'Nothing drifts or has changed, and an odd vehicle can be seen among 4 or more')])
def test_what_cannot_be_seen_is_not_denied(tmp_path, vehicles, flights, said):
    data_set(tmp_path, vehicles=vehicles, flights=flights)
    assert nothing_line(insight(tmp_path)) == said


def test_where_nothing_could_be_fitted_that_is_not_laid_to_the_verdicts(tmp_path):
    """Thrust is tracked whatever they name."""
    data_set(tmp_path, vehicles=2)
    for key in keys_of(tmp_path, 'parameters'):
        write_rows(tmp_path, 'parameters', key, [])
    assert nothing_line(insight(tmp_path)).startswith(
        'No effect is followed over time, because none can be fitted to single flights: ')


@pytest.mark.slow
def test_whole_diagnoses_are_left_on_the_disk(tmp_path):
    """Those of a fleet take gigabytes, and add nothing here to the other columns."""
    size, count = 10 ** 6, 20
    for number in range(count):
        write_rows(tmp_path, 'groups', f'{number}', [{
            'group': f'{number}', 'vehicle': 'uav1', 'configuration': '', 'date': START,
            'status': 'diagnosed', 'diagnosis': 'x' * size}])
    most = subprocess.run([sys.executable, '-c', MOST, str(tmp_path)], check=True, text=True,
                          stdout=subprocess.PIPE, env={**os.environ, 'PYTHONPATH':
                                                       os.pathsep.join(sys.path)}).stdout
    assert int(most) < size * count / 4


MOST = """
import pyarrow, sys
from quad_ident_ros.fleet.insight import insight
assert insight(sys.argv[1]).status == {'diagnosed': 20}
print(pyarrow.default_memory_pool().max_memory())
"""


def test_how_far_it_is_can_be_followed(tmp_path):
    data_set(tmp_path, vehicles=2, flights=5)
    told = []
    insight(tmp_path, lambda done, total: told.append((done, total)))
    assert told == [(number, 6) for number in range(6)]


@pytest.mark.slow
def test_a_new_vehicle_file_is_no_change_of_the_vehicle(tmp_path):
    """Values are relative to the nominal vehicle: those of an older one are not compared."""
    step = ('uav3', 'thrust_scale', 'factor', 10, 0.05)
    data_set(tmp_path, steps=[step])
    changed, = insight(tmp_path).events
    assert (changed.vehicle, changed.number) == ('uav3', 11)
    for key in keys_of(tmp_path, 'groups'):
        vehicle, _, number = key.partition('-')
        newer = vehicle == 'uav3' and int(number) >= 2
        write_rows(tmp_path, 'groups', key, [
            row | {'nominal': 'new' if newer else 'old'}
            for row in read_rows(tmp_path, 'groups', key)])
    found = insight(tmp_path)
    assert found.events == () and found.apart == (('uav3', 10),)
    assert not [one for one in found.suspect if one[0] == 'uav3']
    point, = (one for one in points(found) if one.why == 'not compared')
    assert '10 flights not compared over time' in point.text and 'uav3 10;' in point.text
