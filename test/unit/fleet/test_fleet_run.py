# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A run over a fleet beside another one, and on workers elsewhere, with short diagnoses."""


from contextlib import suppress
import os
from pathlib import Path
import re
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.cluster import Done, TimeOver
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
from quad_ident_ros.fleet import run, store, superseded, work  # noqa: E402, I100
from quad_ident_ros.fleet.grouping import Group, groups_of  # noqa: E402, I100
from quad_ident_ros.fleet.look import look  # noqa: E402, I100
from quad_ident_ros.fleet.plan import planned  # noqa: E402, I100
from quad_ident_ros.fleet.store import read_table, write_rows  # noqa: E402, I100
from quad_ident_ros.fleet.superseded import BY_TRACKING, give_way  # noqa: E402, I100
from quad_ident_ros.fleet.work import Outcome, write  # noqa: E402, I100


@pytest.fixture
def beside(tmp_path, monkeypatch):
    """
    Return what runs over some of the flights a, b, c of one day while a run over others works.

    The other run ends before the first one writes, or begins once the first one has written.
    """
    folder = tmp_path / 'flights' / 'seven' / '2026-05-14'
    folder.mkdir(parents=True)
    for name in 'abc':
        (folder / f'{name}.csv').write_text(f't,px\n0,{ord(name)}\n0.1,2\n', encoding='utf-8')

    def results(_, function, items, *__, before=None, after=None, status='diagnosed'):
        for item in items:
            if isinstance(item, Group):
                if before:
                    before()
                outcome = Outcome(status, '', 1.0)
                write(item, tmp_path, outcome)
                if after:
                    after()
                yield Done(item, outcome)
            else:
                yield Done(item, function(item))

    def fly(names, vehicle='hummingbird'):
        return run.run_fleet(None, planned([str(folder / f'{name}.csv') for name in names],
                                           vehicle=vehicle), tmp_path)

    def runs(names, others, when='before', status='diagnosed', vehicle='hummingbird',
             own='diagnosed'):
        flown = []

        def other():
            if not flown:
                flown.append(others)
                monkeypatch.setattr(run, 'results', lambda *some: results(*some, status=status))
                fly(others, vehicle)

        monkeypatch.setattr(run, 'results', lambda *some: results(
            *some, status=own, **{when: other}))
        return fly(names)

    return runs


def flights_in(out):
    """Return the letters of the flights of a data set, one for each row."""
    return ''.join(sorted(path[-5] for path in read_table(out, 'flights')['path'].to_pylist()))


def test_two_runs_of_which_one_has_more_flights_leave_each_flight_once(tmp_path, beside):
    """The narrower one ends while the wider one works; what it wrote gives way."""
    beside('ab', 'a')
    assert flights_in(tmp_path) == 'ab'


def test_of_two_runs_that_share_a_flight_the_first_to_write_stays(tmp_path, beside):
    why, = beside('ab', 'bc').gave_way
    assert 'c.csv: another run has diagnosed it meanwhile' in why
    assert flights_in(tmp_path) == 'bc'
    assert len(read_table(tmp_path, 'groups')) == 1


def test_a_flight_of_another_group_is_left_once_where_one_group_gives_way(tmp_path, beside):
    """The groups of the first run: a with b, and d on the day after."""
    other = tmp_path / 'flights' / 'seven' / '2026-05-15'
    other.mkdir()
    (other / 'd.csv').write_text('t,px\n0,9\n0.1,2\n', encoding='utf-8')
    summary = beside(['a', 'b', '../2026-05-15/d'], 'bc')
    assert summary.groups['diagnosed'] == 1 and summary.flights == 3
    assert 'c.csv: another run has diagnosed it meanwhile' in summary.gave_way[0]
    assert flights_in(tmp_path) == 'bcd'


def test_what_is_diagnosed_stays_before_what_ran_out_of_time(tmp_path, beside):
    beside('ab', 'bc', status='timeout')
    assert flights_in(tmp_path) == 'ab'


def test_what_another_run_has_diagnosed_meanwhile_stays_where_this_fails(tmp_path, beside):
    assert beside('ab', 'ab', vehicle='iris', own='timeout').replaced == 1
    assert flights_in(tmp_path) == 'ab'
    assert read_table(tmp_path, 'groups')['status'].to_pylist() == ['diagnosed']


@pytest.mark.parametrize('when', ['before', 'after'])
def test_of_two_runs_over_the_same_flights_with_other_vehicles_the_later_one_stays(
        tmp_path, beside, when, monkeypatch):
    monkeypatch.setattr(run, 'SHOWN_AFTER', 0.0)
    beside('ab', 'ab', when, vehicle='iris')
    assert flights_in(tmp_path) == 'ab'


def test_two_runs_that_end_at_once_leave_one_group_of_the_same_flights(tmp_path):
    """Each sees the group of the other before it removes any."""
    groups = {}
    for vehicle in ('hummingbird', 'iris'):
        path = tmp_path / 'a.csv'
        path.write_text('t,px\n0,1\n0.1,2\n', encoding='utf-8')
        plan = planned([str(path)], vehicle=vehicle)
        looks = [look(one, None) for one in plan.flights]
        [group], _ = groups_of(zip(plan.flights, looks, strict=True), plan.nominal_of, None,
                               plan.rules)
        groups[vehicle] = group
        write(group, tmp_path / 'out', Outcome('diagnosed', '', 1.0))
    done = {group.key for group in groups.values()}
    for group in groups.values():
        assert give_way([group], tmp_path / 'out', done) == {}
    assert read_table(tmp_path / 'out', 'groups')['group'].to_pylist() == [groups['iris'].key]


def test_a_run_whose_results_a_wider_one_has_replaced_ends_well(tmp_path, beside, monkeypatch):
    monkeypatch.setattr(run, 'SHOWN_AFTER', 0.0)
    assert beside('a', 'ab', 'after').replaced == 1
    assert flights_in(tmp_path) == 'ab'


@pytest.fixture
def flight(tmp_path, monkeypatch):
    """Write a flight that is refused at once, and go to the folder that it is in."""
    path = tmp_path / 'here' / 'flights' / 'seven' / '2026-05-14' / 'a.csv'
    path.parent.mkdir(parents=True)
    path.write_text('t,px\n0,1\n0.1,2\n', encoding='utf-8')
    (tmp_path / 'elsewhere').mkdir()
    monkeypatch.chdir(tmp_path / 'here')
    return path


def elsewhere(monkeypatch, folder, function):
    """Have the work done as by workers that are started in another folder."""
    def results(_, given, items, *__):
        for item in items:
            with monkeypatch.context() as there:
                there.chdir(folder)
                value = function(given, item)
            yield Done(item, value)

    monkeypatch.setattr(run, 'results', results)


def test_workers_in_another_folder_use_the_flights_and_data_set_that_are_meant(
        flight, tmp_path, monkeypatch):
    elsewhere(monkeypatch, tmp_path / 'elsewhere', lambda given, item: given(item))
    summary = run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')
    assert summary.groups['refused'] == 1
    assert read_table('fleet', 'flights')['path'].to_pylist() == [str(flight)]
    assert 'are too short' in read_table('fleet', 'groups')['reason'].to_pylist()[0]


def test_each_flight_of_a_group_that_is_refused_has_its_reason(flight, tmp_path, monkeypatch):
    (flight.parent / 'b.csv').write_text(
        't,px\n' + ''.join(f'{k / 10},{k}\n' for k in range(100)), encoding='utf-8')
    elsewhere(monkeypatch, tmp_path, lambda given, item: given(item))
    run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')
    table = read_table('fleet', 'flights', ['path', 'status', 'reason', 'duration_s'])
    short, long = sorted(table.to_pylist(), key=lambda row: row['path'])
    assert short['status'] == long['status'] == 'refused'
    assert 'too short' in short['reason'] and 'a.csv' in short['reason']
    assert 'too short' not in long['reason'] and 'b.csv' in long['reason']
    assert long['duration_s'] == pytest.approx(9.9)


def test_results_of_flights_that_cannot_be_read_any_more_stay(flight, tmp_path, monkeypatch):
    """As of a disk that is not mounted; with a manifest, which names them still."""
    elsewhere(monkeypatch, tmp_path, lambda given, item: given(item))
    manifest = tmp_path / 'm.csv'
    manifest.write_text(f'path\n{flight}\n{tmp_path / "never.csv"}\n')
    plan = planned([str(manifest)], vehicle='hummingbird')
    run.run_fleet(None, plan, 'fleet')
    before = read_table('fleet', 'flights').to_pylist()
    flight.rename(tmp_path / 'away')
    summary = run.run_fleet(None, plan, 'fleet')
    assert read_table('fleet', 'flights').to_pylist() == before
    assert summary.kept == (str(flight),)
    assert summary.flights == summary.groups['refused'] == 1        # what was never there
    (tmp_path / 'away').rename(flight)
    summary = run.run_fleet(None, plan, 'fleet')
    assert summary.kept == () and summary.before == 2


def test_a_table_of_several_vehicles_is_no_flight_of_one(flight, tmp_path, monkeypatch):
    """They would be diagnosed together, as what they are not."""
    flight.write_text('t,drone_id,x,y,z\n' + ''.join(
        f'{k / 50},cf{number},{k},{number},{k}\n' for k in range(100) for number in (1, 2)))
    elsewhere(monkeypatch, tmp_path, lambda given, item: given(item))
    run.run_fleet(None, planned(['flights/seven'], vehicle='hummingbird'), 'fleet')
    row, = read_table('fleet', 'flights').to_pylist()
    assert (row['status'], row['vehicle']) == ('refused', 'seven')
    assert 'a.csv: they come from 2 vehicles: a_cf1 ' in row['reason']
    assert 'write a file for each' in row['reason']


def test_flights_that_leave_the_data_set_are_named(flight, tmp_path, monkeypatch):
    """A memory card whose log has the name of the one before, and a log that is moved away."""
    elsewhere(monkeypatch, tmp_path, lambda given, item: given(item))
    other = flight.with_name('b.csv')
    other.write_text('t,px\n0,2\n0.1,2\n', encoding='utf-8')

    def ran():
        return run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet').removed

    assert ran() == ()
    flight.write_text('t,px\n0,3\n0.1,2\n', encoding='utf-8')
    assert ran() == (f'{flight} has other content now',)
    other.rename(tmp_path / 'away')
    assert ran() == (f'{other} is not there any more',)
    assert ran() == ()


def test_a_flight_that_is_renamed_is_known_by_its_new_name(flight, tmp_path, monkeypatch):
    """And the next flight, which has its old name, does not take its place."""
    elsewhere(monkeypatch, tmp_path, lambda given, item: given(item))

    def ran(name):
        return run.run_fleet(None, planned([name], vehicle='hummingbird'), 'fleet')

    ran('flights')
    before, = read_table('fleet', 'flights').to_pylist()
    renamed = flight.rename(flight.with_name('first.csv'))
    summary = ran('flights')
    assert summary.before == 1 and summary.removed == ()
    assert read_table('fleet', 'flights').to_pylist() == [before | {'path': str(renamed)}]
    flight.write_text('t,px\n0,3\n0.1,2\n', encoding='utf-8')
    assert ran(str(flight)).removed == ()
    assert set(read_table('fleet', 'flights')['path'].to_pylist()) == {str(flight), str(renamed)}


def test_a_flight_that_is_not_where_a_worker_looks_is_tried_again(flight, tmp_path, monkeypatch):
    def lost(given, item):
        away = tmp_path / 'away'
        if isinstance(item, Group):
            flight.rename(away)
        value = given(item)
        if away.exists():
            away.rename(flight)
        return value

    plan = planned(['flights'], vehicle='hummingbird')
    elsewhere(monkeypatch, tmp_path, lost)
    assert run.run_fleet(None, plan, 'fleet').groups['failed'] == 1
    reason, = read_table('fleet', 'groups')['reason'].to_pylist()
    assert f'{flight}: it is not there any more' in reason
    elsewhere(monkeypatch, tmp_path, lambda given, item: given(item))
    assert run.run_fleet(None, plan, 'fleet').groups['refused'] == 1


def test_a_nominal_vehicle_that_is_wrong_is_said_with_its_line(tmp_path):
    (tmp_path / 'quad.yaml').write_text('a: 1')
    manifest = tmp_path / 'm.csv'
    manifest.write_text('path,vehicle_file\na.csv,iris\nb.csv,quad.yaml\n')
    with pytest.raises(InputError, match=r'm\.csv, line 3, column vehicle_file: .*quad\.yaml'):
        planned([str(manifest)])


def test_a_name_that_is_no_text_stops_nothing(flight, tmp_path, monkeypatch):
    """As of files from a disk with names in another encoding."""
    os.rename(flight, os.fsencode(flight.parent) + b'/bad\xff.csv')
    elsewhere(monkeypatch, tmp_path, lambda given, item: given(item))
    for _ in range(2):
        summary = run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')
        assert summary.groups['refused'] == 1
        assert read_table('fleet', 'flights')['path'].to_pylist() == [
            str(flight.parent / 'bad\\udcff.csv')]


def unexpected(error):
    """Return the work of workers in which an error of a library ends the group of one vehicle."""
    def work(given, item):
        if isinstance(item, Group) and item.vehicle == 'seven':
            raise error
        return given(item)

    return work


def test_an_unexpected_error_fails_its_group_alone(flight, tmp_path, monkeypatch):
    """As of a library that ends outside the diagnosis: of a file that cannot be sent back."""
    other = flight.parents[2] / 'eight' / '2026-05-14' / 'b.csv'
    other.parent.mkdir(parents=True)
    other.write_text('t,px\n0,3\n0.1,2\n', encoding='utf-8')
    plan = planned(['flights'], vehicle='hummingbird')
    caught(monkeypatch, unexpected(RuntimeError('a library\nends')))
    summary = run.run_fleet(None, plan, 'fleet')
    assert summary.groups == {'diagnosed': 0, 'refused': 1, 'failed': 1, 'timeout': 0}
    rows = {row['vehicle']: row for row in read_table('fleet', 'groups').to_pylist()}
    assert rows['seven']['status'] == 'failed'
    assert rows['seven']['reason'] == 'RuntimeError: a library ends'
    assert rows['seven']['seconds'] is None      # not that of --time-limit
    assert rows['eight']['status'] == 'refused'
    caught(monkeypatch, lambda given, item: given(item))
    assert run.run_fleet(None, plan, 'fleet').groups['refused'] == 2


@pytest.mark.parametrize('error', [OSError(28, 'full', 'fleet/groups'), InputError('a version'),
                                   ModuleNotFoundError('pyarrow')])
def test_an_error_that_all_groups_would_have_ends_the_run(flight, monkeypatch, error):
    caught(monkeypatch, unexpected(error))
    with pytest.raises(type(error)):
        run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')


def caught(monkeypatch, function):
    """Have the work done here, and its errors come as those of workers do."""
    def results(_, given, items, *__):
        for item in items:
            try:
                yield Done(item, function(given, item))
            except Exception as error:
                yield Done(item, error=error)

    monkeypatch.setattr(run, 'results', results)


def test_results_that_are_written_somewhere_else_are_missed(flight, tmp_path, monkeypatch):
    """As by workers in containers that have a folder of their own under this path."""
    elsewhere(monkeypatch, tmp_path, lambda given, item: (
        Outcome('diagnosed', '', 1.0) if isinstance(item, Group) else given(item)))
    monkeypatch.setattr(run, 'SHOWN_AFTER', 0.0)
    with pytest.raises(InputError, match='results of 1 group are not in it'):
        run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')


def failing_in_the_worker(monkeypatch):
    """Have an error that nobody expects end each diagnosis where it is made."""
    def diagnosed(*_):
        raise RuntimeError('a library\nends')

    monkeypatch.setattr(work, '_diagnosed', diagnosed)
    caught(monkeypatch, lambda given, item: given(item))


def failing_elsewhere(monkeypatch):
    """Have workers end before they write anything, as by --time-limit."""
    caught(monkeypatch, unexpected(RuntimeError('a library\nends')))


@pytest.fixture(params=[failing_in_the_worker, failing_elsewhere])
def fleet(request, flight, monkeypatch):
    """Return what runs over the flights with a nominal vehicle, in which all groups may fail."""
    def ran(vehicle, fails=False):
        with monkeypatch.context() as there:
            if fails:
                request.param(there)
            else:
                caught(there, lambda given, item: given(item))
            return run.run_fleet(None, planned(['flights'], vehicle=vehicle), 'fleet')

    return ran


def test_a_group_that_fails_leaves_the_older_result_of_its_flights(fleet):
    """As with a new vehicle file, rules or version, by which it runs out of time or memory."""
    fleet('hummingbird')
    before = {name: read_table('fleet', name).to_pylist() for name in ('groups', 'flights')}
    for _ in range(2):
        summary = fleet('iris', fails=True)
        assert {name: read_table('fleet', name).to_pylist() for name in before} == before
        assert summary.groups == {'diagnosed': 0, 'refused': 0, 'failed': 1, 'timeout': 0}
        assert summary.stayed == ('seven, 2026-05-14: RuntimeError: a library ends',)
        assert summary.replaced == 0 and summary.removed == ()
    summary = fleet('iris')
    assert summary.groups['refused'] == 1 and summary.stayed == ()
    after, = read_table('fleet', 'groups')['group'].to_pylist()
    assert after != before['groups'][0]['group']


def test_a_group_that_is_done_just_after_its_time_takes_the_place_of_the_older_one(
        flight, monkeypatch):
    """Its worker has a few seconds for that."""
    caught(monkeypatch, lambda given, item: given(item))
    run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')
    flight.with_name('b.csv').write_text('t,px\n0,2\n0.1,2\n', encoding='utf-8')

    def results(_, given, items, *__):
        for item in items:
            if isinstance(item, Group):
                yield Done(item, error=TimeOver())
            value = given(item)
            if not isinstance(item, Group):
                yield Done(item, value)

    monkeypatch.setattr(run, 'results', results)
    summary = run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet')
    assert summary.groups['refused'] == 1 and summary.stayed == ()
    row, = read_table('fleet', 'groups').to_pylist()
    assert (row['status'], row['flights']) == ('refused', 2)
    assert len(read_table('fleet', 'flights')) == 2


def test_a_flight_that_is_new_in_a_group_that_fails_is_recorded_beside_the_older_result(
        fleet, flight):
    fleet('hummingbird')
    flight.with_name('b.csv').write_text('t,px\n0,2\n0.1,2\n', encoding='utf-8')
    for _ in range(2):
        summary = fleet('hummingbird', fails=True)
        assert summary.groups['failed'] == 1 and len(summary.stayed) == 1
        rows = {row['path'][-5:]: row for row in read_table('fleet', 'flights').to_pylist()}
        assert {name: row['status'] for name, row in rows.items()} == {
            'a.csv': 'refused', 'b.csv': 'failed'}
        assert len(read_table('fleet', 'flights')) == 2
        groups = read_table('fleet', 'groups').to_pylist()
        assert sorted((row['status'], row['flights']) for row in groups) == [
            ('failed', 1), ('refused', 1)]
    assert fleet('hummingbird').groups['refused'] == 1
    row, = read_table('fleet', 'groups').to_pylist()
    assert (row['status'], row['flights']) == ('refused', 2)


@pytest.mark.parametrize('fleet', [failing_elsewhere], indirect=True)
@pytest.mark.parametrize('removed', range(6))
def test_nothing_stays_of_a_group_whose_removal_was_cut_short(fleet, monkeypatch, removed):
    """As by kill -9 after so many of its files."""
    fleet('hummingbird')
    old, = read_table('fleet', 'groups')['group'].to_pylist()
    write_rows('fleet', 'effects', old, [])
    for table in BY_TRACKING:
        write_rows('fleet', table, f'{old}-some', [])
    left = iter(range(removed))

    def remove(*file):
        if next(left, None) is None:
            raise KeyboardInterrupt
        store.remove(*file)

    with monkeypatch.context() as there:
        there.setattr(superseded, 'remove', remove)
        with suppress(KeyboardInterrupt):
            fleet('iris')
    fleet('iris')
    for table in ('groups', 'flights', 'effects', *BY_TRACKING):
        assert not [key for key in store.keys_of('fleet', table) if key.startswith(old)]


def test_flights_that_nothing_dates_but_their_files_are_named(flight, monkeypatch):
    caught(monkeypatch, lambda given, item: given(item))
    loose = flight.parents[1] / 'b.csv'
    loose.write_text('t,px\n0,2\n0.1,2\n', encoding='utf-8')
    for _ in range(2):
        assert run.run_fleet(None, planned(['flights'], vehicle='hummingbird'), 'fleet'
                             ).undated == (str(loose),)


@pytest.mark.slow
def test_findings_are_of_the_flight_whose_file_has_them(tmp_path, monkeypatch):
    """Also of two files with one name, and of one that is split where its estimator was reset."""
    nominal = load_vehicle('hummingbird')
    jumps = {1: np.inf, 2: 4.5, 3: 5.5}
    for number, at in jumps.items():
        record = fly_closed_loop(nominal, {}, 'lissajous', duration=10.0, seed=number,
                                 noise=SENSORS['mocap_imu'])
        columns = dict(record.columns)
        columns['px'] = columns['px'] + np.where(record.t > at, 20.0, 0.0)
        write_csv(tmp_path / 'seven' / f'{number}' / 'flight.csv',
                  FlightRecord(record.t, columns, {}))
    manifest = tmp_path / 'm.csv'
    manifest.write_text('path,vehicle,date\n' + ''.join(
        f'seven/{number}/flight.csv,seven,2026-05-14T0{number}:00:00Z\n' for number in jumps))
    plan = planned([str(manifest)], vehicle='hummingbird')
    [group], _ = groups_of([(one, look(one)) for one in plan.flights], plan.nominal_of, None,
                           plan.rules)

    def quick(records, nominal, rules):
        gap = SimpleNamespace(before={}, after={}, noise={}, closed=0.5)
        return SimpleNamespace(verdict=(), minor=(), ranking=(), form_errors={}, gap=gap,
                               findings=take_in(records, nominal, None, rules).findings,
                               as_data=dict)

    monkeypatch.setattr(work, 'diagnose', quick)
    assert work.work(group, tmp_path / 'out').status == 'diagnosed'
    rows = read_table(tmp_path / 'out', 'flights', ['path', 'findings']).to_pylist()
    jump = re.compile(r'jumps by 20 m at t = ([\d.]+)')
    found = {row['path'].split('/')[-2]: jump.findall(' '.join(row['findings'])) for row in rows}
    assert found == {'1': [], '2': ['4.50'], '3': ['5.50']}
    of_group, = read_table(tmp_path / 'out', 'groups')['findings'].to_pylist()
    assert any(one.startswith('2/flight (2 parts): ') for one in of_group)


@pytest.mark.slow
def test_folders_that_may_be_of_several_vehicles_are_named(tmp_path, monkeypatch):
    """As of months of vehicles, and of a folder with the same name for each vehicle."""
    caught(monkeypatch, lambda given, item: given(item))
    top = tmp_path / 'all' / '2026' / '05'
    folders = [top / vehicle / 'logs' for vehicle in ('eight', 'nine')]
    paths = [folder / day / 'a.csv' for folder in folders for day in ('2026-05-14', '2026-05-15')]
    for path in paths:
        path.parent.mkdir(parents=True)
        path.write_text(f't,px\n0,{len(path.parts)}\n0.1,2\n# {path}\n', encoding='utf-8')

    def together(*names):
        return run.run_fleet(None, planned([*map(str, names)], vehicle='hummingbird'),
                             tmp_path / f'out_{len(names)}_{Path(names[0]).name}').together

    assert together(top) == ()
    assert together(tmp_path / 'all') == (f'2026 (05): {folders[0].parent}, {folders[1].parent}',)
    assert together(*paths) == (f'logs: {folders[0]}, {folders[1]}',)
    assert together(*paths[:2]) == ()
