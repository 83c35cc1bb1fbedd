# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which effects are followed from flight to flight, and what becomes of flights that cannot be."""

from dataclasses import replace
from pathlib import Path

import pytest

from quad_ident_ros.cluster import Done, TimeOver
from quad_ident_ros.data.commands import BY_SPEEDS
from quad_ident_ros.data.inertial import POSITION, VELOCITY
from quad_ident_ros.data.thrust_level import FULL_SPEED
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.fleet.manifest import listed
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
import pyarrow  # noqa: E402, I100

from quad_ident_ros.fleet import run, track  # noqa: E402, I100
from quad_ident_ros.fleet.grouping import groups_of  # noqa: E402, I100
from quad_ident_ros.fleet.insight import insight  # noqa: E402, I100
from quad_ident_ros.fleet.look import look  # noqa: E402, I100
from quad_ident_ros.fleet.plan import planned  # noqa: E402, I100
from quad_ident_ros.fleet.store import keys_of, read_rows, write_rows  # noqa: E402, I100
from quad_ident_ros.fleet.track import tracked_effects, Tracking  # noqa: E402, I100


def tracked(**named):
    """Return the effects tracked, by {vehicle: effects of its verdicts, with + between them}."""
    rows = [{'group': f'{vehicle} {number}', 'vehicle': vehicle, 'effect': name, 'form': 'any',
             'named': True} for vehicle, verdicts in named.items()
            for number, verdict in enumerate(verdicts.split()) for name in verdict.split('+')]
    found = tracked_effects(pyarrow.Table.from_pylist(rows))
    return {vehicle: set(effects) for vehicle, effects in found.items()}


@pytest.mark.parametrize(('own', 'kept'), [
    ('rotor_fault rotor_fault', set()), ('mass_offset', set()), ('motor_lag', {'motor_lag'})])
def test_what_looks_like_an_effect_of_the_fleet_is_tracked_as_that(own, kept):
    """A weak rotor moves a vehicle as an offset of the centre of mass, a mass as less thrust."""
    usual = 'com_offset thrust_scale'
    found = tracked(a=usual, b=usual, c=usual, d=f'com_offset {own}')
    assert found['d'] == {'com_offset', 'thrust_scale'} | kept
    assert found['a'] == {'com_offset', 'thrust_scale'}


def test_of_two_alike_the_one_that_is_named_more_often_is_tracked():
    """Where no other vehicle has either, the verdicts decide."""
    found = tracked(a='com_offset rotor_fault rotor_fault', b='motor_lag', c='motor_lag')
    assert found['a'] == {'rotor_fault', 'motor_lag', 'thrust_scale'}


def test_of_two_alike_that_many_vehicles_have_in_turn_one_is_tracked():
    """Verdicts take one for the other: fitted together to one flight, neither would be known."""
    found = tracked(a='thrust_scale', b='mass_offset')
    assert found == {'a': {'thrust_scale'}, 'b': {'thrust_scale'}}
    turns = tracked(a='thrust_scale mass_offset mass_offset')
    assert turns == {'a': {'mass_offset'}}


def test_two_alike_that_verdicts_name_together_are_both_tracked():
    both = 'motor_lag+actuation_delay'
    assert tracked(a=both, b=both, c=both)['a'] >= {'motor_lag', 'actuation_delay'}


def test_thrust_which_verdicts_let_differ_by_flight_is_tracked_without_being_named():
    """A thrust that falls by 3 % in a year is in no verdict of a day: its drift would not show."""
    found = tracked(a='motor_lag', b='rotor_drag', c='mass_offset')
    assert 'thrust_scale' in found['a'] & found['b']
    assert found['c'] == {'mass_offset'}


def test_thrust_that_a_vehicle_does_not_name_has_the_form_of_the_fleet():
    rows = [{'group': vehicle, 'vehicle': vehicle, 'effect': effect, 'form': form, 'named': True}
            for vehicle, effect, form in (('a', 'thrust_scale', 'exponent'),
                                          ('b', 'thrust_scale', 'exponent'),
                                          ('c', 'motor_lag', 'first_order'))]
    found = tracked_effects(pyarrow.Table.from_pylist(rows))
    assert found['c'] == {'thrust_scale': 'exponent', 'motor_lag': 'first_order'}


@pytest.mark.parametrize('other', ['battery_sag', 'inertia_mismatch', 'inflow', 'ground_effect'])
def test_thrust_is_tracked_beside_what_a_single_flight_tells_from_it(other):
    """Else one verdict that names a battery which sags would hide a drift of the thrust."""
    found = tracked(a=other, b=other, c='rotor_drag')
    assert found['a'] == {other, 'thrust_scale'} and found['c'] == found['a'] | {'rotor_drag'}
    usual = tracked(a='thrust_scale', b='thrust_scale', c=other)
    assert usual['a'] == {'thrust_scale'} and usual['c'] == {other, 'thrust_scale'}


@pytest.fixture
def group(tmp_path):
    """Return a group of one flight, which is diagnosed and has drag in its verdict."""
    path = tmp_path / 'flights' / 'seven' / '2026-05-14' / 'a.csv'
    path.parent.mkdir(parents=True)
    path.write_text('t,px\n0,1\n0.1,2\n', encoding='utf-8')
    vehicle = load_vehicle('hummingbird')
    flight, = listed([str(tmp_path / 'flights')])
    [one], _ = groups_of([(flight, look(flight))], lambda _: vehicle, None, RULES)
    whose = {'group': one.key, 'vehicle': 'seven', 'configuration': '', 'date': one.date}
    write_rows(tmp_path, 'flights', one.key, [whose | {
        'flight': one.flights[0].flight, 'path': str(path), 'status': 'diagnosed'}])
    write_rows(tmp_path, 'effects', one.key, [whose | {
        'effect': 'rotor_drag', 'probability': 0.9, 'form': 'by_speed', 'named': True}])
    write_rows(tmp_path, 'groups', one.key, [whose | {'status': 'diagnosed'}])
    return one


def test_a_library_that_fails_on_a_flight_takes_no_other_with_it(group, tmp_path, monkeypatch):
    def failing(*_):
        raise IndexError('somewhere in a library')

    monkeypatch.setattr(track, 'load_all', failing)
    tracking = Tracking(group, {'rotor_drag': 'by_speed'})
    track.track(tracking, tmp_path)
    assert keys_of(tmp_path, 'covariances') == {tracking.key}


@pytest.mark.slow
def test_thrust_of_a_log_that_the_weight_scaled_takes_no_other_effect_with_it(
        group, tmp_path, monkeypatch):
    """Most logs have signals without a gain: their thrust over mass is that of the file."""
    record = fly_closed_loop(group.nominal, {'rotor_drag': {'coefficient': 0.2}},
                             'figure8', duration=6.0)
    record.info[FULL_SPEED] = 1500.0
    monkeypatch.setattr(track, 'load_all', lambda *_: [record])
    for effects in ({'rotor_drag': 'by_speed', 'thrust_scale': 'factor'},
                    {'thrust_scale': 'factor'}):
        tracking = Tracking(group, effects)
        track.track(tracking, tmp_path)
        rows = read_rows(tmp_path, 'parameters', tracking.key, ['effect', 'value'])
        assert [row['effect'] for row in rows] == [*effects][:-1]
        assert [row['value'] for row in rows] == pytest.approx([0.2] * len(rows), abs=0.02)


@pytest.mark.slow
def test_speeds_in_place_of_commands_take_no_effect_but_those_of_motors_with_them(
        group, tmp_path, monkeypatch):
    """The lag of the motors is tracked in all vehicles where most have it."""
    record = fly_closed_loop(group.nominal, {'rotor_drag': {'coefficient': 0.2}}, 'figure8',
                             duration=6.0)
    record.info[BY_SPEEDS] = True
    monkeypatch.setattr(track, 'load_all', lambda *_: [record])
    tracking = Tracking(group, {'motor_lag': 'first_order', 'rotor_drag': 'by_speed'})
    track.track(tracking, tmp_path)
    row, = read_rows(tmp_path, 'parameters', tracking.key)
    assert row['effect'] == 'rotor_drag' and row['value'] == pytest.approx(0.2, abs=0.02)


@pytest.mark.slow
@pytest.mark.parametrize('kind', ['scaled by the weight', 'without a pose'])
def test_a_flight_that_can_show_nothing_is_no_log_to_check(group, tmp_path, monkeypatch, kind):
    """Beside one of the same vehicle that shows thrust, such a log was called different."""
    record = fly_closed_loop(group.nominal, {}, 'figure8', duration=5.0,
                             noise=SENSORS['mocap_imu'])
    if kind == 'scaled by the weight':
        record.info[FULL_SPEED] = 1500.0
    else:
        record = replace(record, columns={name: values for name, values in record.columns.items()
                                          if name not in (*POSITION, *VELOCITY)})
    monkeypatch.setattr(track, 'load_all', lambda *_: [record])
    tracking = Tracking(group, {'thrust_scale': 'factor'})
    whose = {'group': 'other', 'vehicle': 'seven', 'configuration': '',
             'date': group.flights[0].date}
    write_rows(tmp_path, 'flights', 'other', [whose | {
        'flight': name, 'path': f'{name}.csv', 'status': 'diagnosed'} for name in 'bc'])
    write_rows(tmp_path, 'parameters', 'other', [whose | {
        'flight': 'b', 'effect': 'thrust_scale', 'parameter': 'factor', 'unit': '1',
        'value': 1.0, 'std': 0.001}])
    assert {name for _, name, _ in insight(tmp_path).suspect} == {'a.csv', 'c.csv'}
    track.track(tracking, tmp_path)
    assert {name for _, name, _ in insight(tmp_path).suspect} == {'c.csv'}


@pytest.mark.slow
def test_a_single_flight_tells_thrust_from_a_battery_that_sags(group, tmp_path, monkeypatch):
    """Without the thrust the battery would lose 0.33 per volt."""
    record = fly_closed_loop(
        group.nominal, {'battery_sag': {'per_volt': 0.05}, 'thrust_scale': {'factor': 0.97}},
        'lissajous', duration=10.0, seed=3, noise=SENSORS['mocap_imu'])
    monkeypatch.setattr(track, 'load_all', lambda *_: [record])
    tracking = Tracking(group, {'battery_sag': 'voltage', 'thrust_scale': 'factor'})
    track.track(tracking, tmp_path)
    found = {row['parameter']: row for row in read_rows(tmp_path, 'parameters', tracking.key)}
    assert found['factor']['value'] == pytest.approx(0.97, abs=0.002)
    assert found['factor']['std'] < 0.001
    assert found['per_volt']['value'] == pytest.approx(0.05, abs=0.012)


def test_flights_that_are_not_where_a_worker_looks_are_fitted_by_the_next_run(group, tmp_path):
    """The values of before would go, and none would come in their place."""
    tracking = Tracking(group, {'rotor_drag': 'by_speed'})
    path = Path(group.flights[0].path)
    path.rename(tmp_path / 'away')
    with pytest.raises(LookupError, match='a.csv: it is not there any more, or not where'):
        track.track(tracking, tmp_path)
    assert keys_of(tmp_path, 'covariances') == set()


def test_a_group_whose_values_took_too_long_is_counted_and_keeps_those_of_before(
        group, tmp_path, monkeypatch):
    def results(_, function, items, *__):
        for item in items:
            yield (Done(item, error=TimeOver()) if isinstance(item, Tracking)
                   else Done(item, function(item)))

    before = f'{group.key}-before'
    write_rows(tmp_path, 'covariances', before, [])
    monkeypatch.setattr(run, 'results', results)
    plan = planned([str(tmp_path / 'flights')], vehicle='hummingbird')
    summary = run.run_fleet(None, plan, tmp_path, time_limit=7.0)
    assert summary.groups['diagnosed'] == 1
    assert summary.untracked == ('it took more than 7 s (--time-limit)',)
    assert keys_of(tmp_path, 'covariances') == {before}
