# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is known of flights, their groups, and the groups that new ones take the place of."""

from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path

import pytest
from reader_checks import SMALL

from quad_ident_ros.data.export import write_bag
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.manifest import Listed
from quad_ident_ros.model.vehicle import load_vehicle

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
from quad_ident_ros.fleet import look as look_module  # noqa: E402, I100
from quad_ident_ros.fleet.grouping import groups_of, taken_together  # noqa: E402, I100
from quad_ident_ros.fleet.look import has_to_be_read, look, Looks  # noqa: E402, I100
from quad_ident_ros.fleet.store import keys_of, write_rows  # noqa: E402, I100
from quad_ident_ros.fleet.superseded import remove_group, superseded_by  # noqa: E402, I100

QUAD = load_vehicle('hummingbird')


def flight(folder, name, text='t,px\n0,1\n0.1,2\n', **known):
    path = folder / name
    path.write_text(text, encoding='utf-8')
    return Listed(str(path), **{'vehicle': 'seven', 'day': '2026-05-14', **known})


def grouped(flights, vehicle=QUAD, rules=RULES):
    return groups_of([(one, look(one)) for one in flights], lambda one: vehicle, None, rules)


def test_vehicle_configuration_and_day_make_a_group(tmp_path):
    flights = [flight(tmp_path, f'{number}.csv', f'{number}', **known) for number, known in
               enumerate([{}, {}, {'vehicle': 'eight'}, {'configuration': 'long'},
                          {'day': '2026-05-15'}, {'group': 'gusts'}])]
    groups, again = grouped(flights)
    assert again == []
    assert sorted(len(group.flights) for group in groups) == [1, 1, 1, 1, 2]
    assert len({group.key for group in groups}) == 5


def test_the_earliest_flight_comes_first_and_dates_the_group(tmp_path):
    day = datetime(2026, 5, 14, tzinfo=timezone.utc)
    flights = [flight(tmp_path, f'{hour}.csv', f'{hour}', date=day.replace(hour=hour))
               for hour in (17, 9, 12)]
    [group], _ = grouped(flights)
    assert [one.date.hour for one in group.flights] == [9, 12, 17] and group.date.hour == 9


def test_flights_of_a_day_without_a_time_are_in_the_order_of_their_names(tmp_path):
    names = [f'log_{number}.csv' for number in range(1, 13)]
    [group], _ = grouped([flight(tmp_path, name, name) for name in reversed(names)])
    assert [Path(one.path).name for one in group.flights] == names


def test_a_log_is_asked_for_the_time_that_a_day_does_not_say(tmp_path):
    log = tmp_path / 'bag_1'
    start = datetime(2026, 5, 14, 8, 30, 12, tzinfo=timezone.utc)
    write_bag(log, replace(SMALL, info={'start_ns': int(start.timestamp()) * 10 ** 9}))
    for known in ({'day': '2026-05-14'}, {'group': 'gusts'}):
        [group], _ = grouped([Listed(str(log), vehicle='seven', **known)])
        assert group.date == start
    assert not has_to_be_read(Listed('2026-05-14/08_30_12.ulg', vehicle='seven'))
    assert not has_to_be_read(Listed('a.ulg', vehicle='seven', date=start))


def test_a_key_is_of_all_that_a_result_depends_on_and_of_nothing_else(tmp_path):
    one = flight(tmp_path, 'a.csv', 'a')

    def key(*flights, **more):
        return grouped(flights or (one,), **more)[0][0].key

    same = key()
    moved = flight(tmp_path, 'b.csv', 'a')
    assert key(moved) == same       # the same content at another place
    others = [key(flight(tmp_path, 'c.csv', 'c')), key(one, flight(tmp_path, 'c.csv', 'c')),
              key(vehicle=replace(QUAD, mass=2.0 * QUAD.mass)),
              key(rules=replace(RULES, present=0.6)),
              key(replace(one, covariates={'temperature_c': 20.0}))]
    assert len({same, *others}) == 1 + len(others)


def test_the_same_content_is_one_flight(tmp_path):
    flights = [flight(tmp_path, name, 'a') for name in ('a.csv', 'b.csv')]
    [group], again = grouped(flights)
    assert len(group.flights) == 1 and again == flights[1:]


def test_bags_that_are_still_recorded_to_are_not_several_vehicles(tmp_path):
    flights = []
    for name in ('one', 'two'):
        path = tmp_path / name / f'{name}_0.mcap'
        path.parent.mkdir()
        path.write_bytes(b'')
        flights.append(Listed(str(path), folder=tmp_path.name))
    assert taken_together((one, look(one)) for one in flights) == ()


def test_what_was_looked_at_is_known_until_it_changes(tmp_path):
    text = 't,px\n0,1\n0.1,2\n'
    for more in ('', '0.2,3\n', '0.2,3\n0.3,4\n'):     # a log that grows
        one = flight(tmp_path, 'a.csv', text + more)
        looks = Looks(tmp_path / 'out')
        assert looks.known(one) is None
        looks.add(look(one))
        looks.flush()
        assert Looks(tmp_path / 'out').known(one) == look(one)


def test_what_another_version_looked_at_is_read_again(tmp_path, monkeypatch):
    """It may find a date or a vehicle in logs in which this one finds none."""
    one = flight(tmp_path, 'a.csv')
    looks = Looks(tmp_path / 'out')
    looks.add(look(one))
    looks.flush()
    monkeypatch.setattr(look_module, '__version__', '0')
    assert Looks(tmp_path / 'out').known(one) is None


def test_what_could_not_be_read_is_read_again(tmp_path):
    """With a mapping, say, by which its log says when it was flown."""
    one = flight(tmp_path, 'a.csv', 'nothing of a flight')
    looks = Looks(tmp_path / 'out')
    looks.add(look(one))
    looks.flush()
    assert Looks(tmp_path / 'out').known(one) is None


def test_a_file_that_cannot_be_opened_is_a_flight_with_a_reason(tmp_path):
    assert 'a.csv' in look(Listed(str(tmp_path / 'a.csv'), vehicle='seven')).reason


def stored(out, groups):
    for group in groups:
        for table in ('groups', 'flights'):
            write_rows(out, table, group.key, [
                {'group': group.key, 'flight': one.flight, 'path': one.path} if table == 'flights'
                else {'group': group.key} for one in group.flights])


def test_a_group_takes_the_place_of_those_with_its_flights(tmp_path):
    one, other = (flight(tmp_path, f'{name}.csv', name) for name in 'ab')
    before, _ = grouped([one])
    stored(tmp_path / 'out', before)
    after, _ = grouped([one, other])
    assert superseded_by(after, tmp_path / 'out') == {after[0].key: [before[0].key]}
    assert superseded_by(before, tmp_path / 'out') == {}
    remove_group(tmp_path / 'out', before[0].key)
    assert keys_of(tmp_path / 'out', 'flights') == set()


def test_a_file_that_was_written_to_takes_the_place_of_what_it_was(tmp_path):
    before, _ = grouped([flight(tmp_path, 'a.csv', 'half')])
    stored(tmp_path / 'out', before)
    after, _ = grouped([flight(tmp_path, 'a.csv', 'half and half')])
    assert superseded_by(after, tmp_path / 'out') == {after[0].key: [before[0].key]}


def test_a_bag_takes_the_place_of_the_file_in_it_that_was_read_while_it_was_recorded(tmp_path):
    bag, other = tmp_path / 'bag_1', flight(tmp_path, 'b.csv', 'b')
    bag.mkdir()
    before, _ = grouped([flight(bag, 'bag_1_0.mcap', 'half'), other])
    stored(tmp_path / 'out', before)
    flight(bag, 'bag_1_0.mcap', 'half and half')
    flight(bag, 'metadata.yaml', 'rosbag2_bagfile_information:')
    after, _ = grouped([Listed(str(bag), vehicle='seven', day='2026-05-14'), other])
    assert superseded_by(after, tmp_path / 'out') == {after[0].key: [before[0].key]}


def test_no_flight_is_lost_with_a_group_that_had_others_too(tmp_path):
    one, other = (flight(tmp_path, f'{name}.csv', name) for name in 'ab')
    both, _ = grouped([one, other])
    stored(tmp_path / 'out', both)
    some, _ = grouped([one])
    with pytest.raises(InputError, match=r'b\.csv: it was diagnosed together'):
        superseded_by(some, tmp_path / 'out')
    (tmp_path / 'b.csv').unlink()       # on purpose, then
    assert superseded_by(some, tmp_path / 'out') == {some[0].key: [both[0].key]}
