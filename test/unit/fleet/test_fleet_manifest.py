# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which flights there are, whose they are, and which are diagnosed together."""

from datetime import datetime, timezone
import hashlib
import os
from pathlib import Path

import pytest

from quad_ident_ros.data.content import sha256_of
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.dates import date_in, date_in_path, date_of, is_day
from quad_ident_ros.fleet.manifest import is_manifest, listed

RECORD = 't,px\n0,1\n0.1,2\n'


def write(path, text=RECORD):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding='utf-8')
    return path


def utc(*numbers):
    return datetime(*numbers, tzinfo=timezone.utc)


@pytest.mark.parametrize('text, date', [
    ('2026-05-14', utc(2026, 5, 14)), ('2026-05-14T08:30:00Z', utc(2026, 5, 14, 8, 30)),
    ('2026-05-14 08:30:00', utc(2026, 5, 14, 8, 30)),
    ('2026-05-14T08:30:00+02:00', utc(2026, 5, 14, 6, 30)), ('yesterday', None), ('', None),
    ('0001-01-01T00:00:00+14:00', None), ('1712121400123', None), ('0026-05-14', None),
    ('2226-05-14', None)])
def test_dates_of_text(text, date):
    assert date_of(text) == date


@pytest.mark.parametrize('name, date', [
    ('log_2026-05-14_08-30-12.ulg', utc(2026, 5, 14, 8, 30, 12)),
    ('20260514T083012.csv', utc(2026, 5, 14, 8, 30, 12)), ('2026_05_14.csv', utc(2026, 5, 14)),
    ('2026-02-30.csv', None), ('log_12.csv', None), ('123420260514.csv', None)])
def test_dates_in_names(name, date):
    assert date_in(name) == date


def test_the_time_of_a_log_goes_with_the_day_of_its_folder():
    assert date_in_path('logs/2026-05-14/08_30_12.ulg') == utc(2026, 5, 14, 8, 30, 12)
    assert date_in_path('logs/2026-05-14/99_30_12.ulg') == utc(2026, 5, 14)
    assert date_in_path('logs/seven/a.ulg') is None
    assert is_day('2026-05-14') and not is_day('2026-05-14_b') and not is_day('seven')


def test_folders_name_vehicle_configuration_and_day(tmp_path):
    for name in ('seven/2026-05-14/a.csv', 'eight/long_arms/2026-05-14/b.csv', 'c.csv',
                 '2026-05-15/d.csv'):
        write(tmp_path / name)
    found = {os.path.basename(one.path): one for one in listed([str(tmp_path)])}
    assert {name: (one.vehicle, one.configuration, one.day) for name, one in found.items()} == {
        'a.csv': ('seven', '', '2026-05-14'), 'b.csv': ('eight', 'long_arms', '2026-05-14'),
        'c.csv': ('', '', ''), 'd.csv': ('', '', '2026-05-15')}
    assert {one.folder for one in found.values()} == {tmp_path.name}


def test_flights_that_are_named_one_by_one_are_of_the_vehicle_of_their_folder(tmp_path):
    """As a shell names them (flights/*/*/*.csv); a day is no vehicle, also if it is named."""
    paths = [write(tmp_path / vehicle / '2026-05-14' / 'a.csv') for vehicle in ('seven', 'eight')]
    assert [one.folder for one in listed(map(str, paths))] == ['seven', 'eight']
    assert [one.folder for one in listed(str(path.parent) for path in paths)] == ['seven', 'eight']
    manifest = write(tmp_path / 'm.csv', 'path\nseven/2026-05-14/a.csv\n../b.csv\n')
    assert [one.folder for one in listed([str(manifest)])] == ['seven', tmp_path.parent.name]


def test_the_folder_of_a_bag_that_is_still_recorded_to_is_no_vehicle(tmp_path):
    bag = write(tmp_path / 'seven' / '2026-05-14' / 'noon' / 'noon_0.mcap')
    manifest = write(tmp_path / 'm.csv', f'path\n{bag}\n')
    for name in (bag, bag.parents[1], manifest):
        assert [one.folder for one in listed([str(name)])] == ['seven']


def test_the_nearest_vehicle_file_above_a_flight_is_its_nominal_one(tmp_path):
    fleets, own = write(tmp_path / 'vehicle.yaml', 'a: 1'), write(
        tmp_path / 'seven' / 'vehicle.yaml', 'a: 1')
    for name in ('seven/2026-05-14/a.csv', 'eight/b.csv'):
        write(tmp_path / name)
    assert [one.vehicle_file for one in listed([str(tmp_path)])] == [str(fleets), str(own)]


def test_a_bag_is_one_flight_and_what_is_no_flight_is_not_listed(tmp_path):
    write(tmp_path / 'seven' / 'bag_1' / 'metadata.yaml', 'rosbag2_bagfile_information:')
    write(tmp_path / 'seven' / 'bag_1' / 'bag_1_0.mcap', 'x')
    write(tmp_path / 'seven' / 'recording_1' / 'bag' / 'metadata.yaml', 'x')
    write(tmp_path / 'seven' / 'recording_1' / 'flight_1.csv')
    write(tmp_path / 'seven' / 'notes.txt', 'windy')
    write(tmp_path / 'seven' / '.hidden.csv')
    write(tmp_path / 'fleet.csv', 'path,vehicle\nseven/bag_1,seven\n')
    write(tmp_path / 'seven' / 'damaged.ulg', 'nothing of PX4')
    assert [os.path.relpath(one.path, tmp_path) for one in listed([str(tmp_path)])] == [
        'seven/bag_1', 'seven/damaged.ulg', 'seven/recording_1']


def test_a_bag_that_is_still_recorded_to_is_no_configuration(tmp_path):
    write(tmp_path / 'seven' / '2026-05-14' / 'bag_1' / 'bag_1_0.mcap', 'x')
    one, = listed([str(tmp_path)])
    assert (one.vehicle, one.configuration, one.day) == ('seven', '', '2026-05-14')


def test_the_results_of_a_fleet_among_its_flights_are_no_flights(tmp_path):
    flight = write(tmp_path / 'seven' / 'a.csv')
    write(tmp_path / 'seven' / 'results' / 'fleet.json', '{}')
    write(tmp_path / 'seven' / 'results' / 'groups' / 'a.csv')
    assert [one.path for one in listed([str(tmp_path)])] == [str(flight)]


def test_links_that_lead_back_or_nowhere_end_nothing(tmp_path):
    flight = write(tmp_path / 'seven' / 'a.csv')
    (tmp_path / 'seven' / 'all').symlink_to(tmp_path)
    (tmp_path / 'seven' / 'itself').symlink_to(tmp_path / 'seven' / 'itself')
    (tmp_path / 'seven' / 'gone.csv').symlink_to(tmp_path / 'nowhere.csv')
    (tmp_path / 'eight').symlink_to(tmp_path / 'seven')
    assert [os.path.realpath(one.path) for one in listed([str(tmp_path)])] == [str(flight)]


def test_a_manifest_says_all_of_a_flight(tmp_path):
    write(tmp_path / 'quad.yaml', 'a: 1')
    manifest = write(tmp_path / 'm.csv', 'path,vehicle,date,group,vehicle_file,temperature_c\n'
                     'a.csv,seven,2026-05-14T08:30:00Z,gusts,quad.yaml,21.5\n'
                     'b.csv,eight,,,iris,\n')
    assert is_manifest(manifest) and not is_manifest(write(tmp_path / 'a.csv'))
    one, other = listed([str(manifest)])
    assert one.path == str(tmp_path / 'a.csv') and one.covariates == {'temperature_c': 21.5}
    assert (one.vehicle, one.group, one.date) == ('seven', 'gusts', utc(2026, 5, 14, 8, 30))
    assert one.vehicle_file == str(tmp_path / 'quad.yaml')
    assert (other.vehicle_file, other.date, other.covariates) == ('iris', None, {})


@pytest.mark.parametrize('text, said', [
    ('path,date\na.csv,soon\n', 'line 2, column date: .soon. is not a date'),
    ('path,date\na.csv,2226-05-14\n', '.2226-05-14. is not a date from 2000 to 2100; write'),
    ('path,temperature_c\na.csv,warm\n', 'line 2, column temperature_c: expected a number'),
    ('path,vehicle\n,seven\n', 'line 2, column path: it is empty'),
    ('path,vehicle\na.csv\n', 'line 2: 1 cells, but 2 columns'),
    ('path,path\na.csv,b.csv\n', 'line 1: a column is named twice'),
    ('path,notes\na.csv,windy\n', 'column notes: expected a number, got .windy.: columns other'),
    ('vehicle;path\nseven;a.csv\n', 'line 1: there is no column `path`; .* with commas'),
    ('Path,vehicle\na.csv,seven\n', 'line 1: there is no column `path`'),
    ('path,vehicle\na.csv,seven\na.csv,eight\n', 'line 3: .*a.csv is named above already'),
    ('path,Vehicle\na.csv,7\n', 'line 1: the column Vehicle is not known; write vehicle'),
    ('path,vehcle\na.csv,7\n', 'line 1: the column vehcle is not known; write vehicle, or'),
    ('path,grup,rate\na.csv,1,2\n', 'line 1: the column grup is not known; write group'),
    (',path\n0,a.csv\n', 'line 2, column 1: it has no name in line 1; .*index=False'),
    ('Unnamed: 0,path\n0,a.csv\n', 'line 2, column 1: it has no name in line 1; .*index=False'),
    ('path,vehicle\na\0.csv,seven\n', 'm.csv.*NUL|line 2, column path: it is empty, or no name'),
    ('path\n', 'there is no flight in it')])
def test_what_is_wrong_with_a_manifest_is_said_with_its_place(tmp_path, text, said):
    with pytest.raises(InputError, match=said) as caught:
        listed([str(write(tmp_path / 'm.csv', text))])
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize('text', ['file,vehicle\na.csv,seven\n', 'vehicle,log\nseven,"a.csv"\n'])
def test_a_manifest_without_a_column_for_the_path_is_no_flight(tmp_path, text):
    write(tmp_path / 'a.csv')
    manifest = write(tmp_path / 'm.csv', text)
    with pytest.raises(InputError, match='m.csv, line 1: there is no column `path`; write the na'):
        listed([str(manifest)])
    one, = listed([str(tmp_path)])      # nor is it among those of a folder
    assert one.path == str(tmp_path / 'a.csv')


def test_a_manifest_in_another_encoding_is_no_flight(tmp_path):
    manifest = tmp_path / 'm.csv'
    manifest.write_bytes('path,vehicle\na.csv,über\n'.encode('cp1252'))
    with pytest.raises(InputError, match=r'm\.csv: cannot be read: .*expected a table in UTF-8'):
        listed([str(manifest)])


def test_empty_columns_at_the_end_of_a_manifest_do_no_harm(tmp_path):
    one, = listed([str(write(tmp_path / 'm.csv', 'path,vehicle,,\na.csv,seven,,\n,,,\n'))])
    assert (one.vehicle, one.covariates) == ('seven', {})


def test_spaces_beside_commas_and_lines_that_repeat_do_no_harm(tmp_path):
    manifest = write(tmp_path / 'm.csv', 'vehicle, "path" \nseven, a.csv\n\nseven, a.csv\n')
    one, = listed([str(manifest)])
    assert (one.path, one.vehicle) == (str(tmp_path / 'a.csv'), 'seven')


def test_a_flight_that_is_named_twice_is_one(tmp_path):
    path = write(tmp_path / 'seven' / 'a.csv')
    assert len(listed([str(path), str(tmp_path)])) == 1


@pytest.mark.parametrize('order', [1, -1])
def test_what_a_manifest_says_goes_before_what_folders_say(tmp_path, order):
    path = write(tmp_path / 'seven' / 'long' / '2026-05-14' / 'a.csv')
    quad = write(tmp_path / 'seven' / 'vehicle.yaml', 'a: 1')
    manifest = write(tmp_path / 'm.csv', f'path,configuration,temperature_c\n{path},short,20\n')
    one, = listed([str(manifest), str(tmp_path)][::order])
    assert (one.vehicle, one.configuration, one.day) == ('seven', 'short', '2026-05-14')
    assert one.covariates == {'temperature_c': 20.0} and one.vehicle_file == str(quad)


def test_manifests_that_say_different_things_of_a_flight_are_refused(tmp_path):
    write(tmp_path / 'a.csv')
    names = [str(write(tmp_path / f'{name}.csv', f'path,vehicle\n{path},{vehicle}\n'))
             for name, path, vehicle in (('m', 'a.csv', 'seven'), ('n', './a.csv', 'eight'),
                                         ('same', '../' + tmp_path.name + '/a.csv', 'seven'))]
    with pytest.raises(InputError, match=r'n\.csv, line 2: .*a\.csv is named in .*m\.csv, line 2'):
        listed(names[:2])
    assert [one.vehicle for one in listed(names[::2])] == ['seven']


def test_manifests_that_say_the_same_may_stand_beside_the_folder(tmp_path):
    path = write(tmp_path / 'all' / 'seven' / 'a.csv')
    names = [str(write(tmp_path / f'{name}.csv', f'path,temperature_c\n{path},20\n'))
             for name in 'mn']
    for order in ([str(tmp_path / 'all'), *names], [*names, str(tmp_path / 'all')]):
        one, = listed(order)
        assert one.vehicle == 'seven' and one.covariates == {'temperature_c': 20.0}


@pytest.mark.parametrize(('vehicle', 'open_to_doubt'), [('', True), ('seven', False)])
def test_whose_a_flight_is_stays_in_doubt_unless_the_manifest_says_it(tmp_path, vehicle,
                                                                      open_to_doubt):
    path = write(tmp_path / 'all' / '2026' / '05' / 'seven' / 'a.csv')
    manifest = write(tmp_path / 'm.csv', f'path,vehicle,temperature_c\n{path},{vehicle},20\n')
    one, = listed([str(manifest), str(tmp_path / 'all')])
    assert one.deeper == (str(path.parent) if open_to_doubt else '')


def test_a_file_of_the_system_without_a_size_is_not_read(tmp_path):
    """A link to /proc/kmsg was waited for; here a file of its kind that anybody may read."""
    for name, file in (('flight.csv', 'environ'), ('flight.ulg', 'maps'), ('notes', 'status')):
        (tmp_path / name).symlink_to(f'/proc/self/{file}')
    assert sha256_of(tmp_path / 'flight.ulg') == hashlib.sha256().hexdigest()
    assert not is_manifest(tmp_path / 'flight.csv')
    assert {Path(one.path).name for one in listed([str(tmp_path)])} == {'flight.csv', 'flight.ulg'}


def test_what_is_not_there_is_said(tmp_path):
    with pytest.raises(InputError, match='there is no such file or folder'):
        listed([str(tmp_path / 'none')])
    with pytest.raises(InputError, match='there is no flight in it'):
        listed([str(tmp_path)])
