# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The gap in closed loop: paths, bandwidths, controllers of users, and known truths."""

from dataclasses import replace
from functools import cache
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import chirp, lfilter

from quad_ident_ros.cli.main import main
from quad_ident_ros.closed_loop.bandwidth import (
    bandwidth_of_flight,
    bandwidth_of_multisine,
    crossing,
    multisine,
)
from quad_ident_ros.closed_loop.compare import compare
from quad_ident_ros.closed_loop.controller import controller_of
from quad_ident_ros.closed_loop.reference import ASKED, reference_of, with_asked
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.split import joined, split
from quad_ident_ros.effects.registry import titled, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.flight.trajectories import plan
from quad_ident_ros.model.attitude import euler_from_quaternion
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report.closed_loop import cost_rows, loop_rows

# One flight for all tests.
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('closed_loop')]
BARE = load_vehicle('hummingbird')
TRUTH = {'rotor_drag': {'coefficient': 0.3}, 'motor_lag': {'time_constant': 0.05}}
NONE = vector({}, BARE)
FILE = Path(__file__).parents[2] / 'helpers' / 'plain_controllers.py'
RATE = 100.0


def flight(course='figure8', noise='clean', seed=1, effects=TRUTH, duration=15.0):
    """Return the record of a flight, with what it was asked for."""
    return flown(course, noise, seed, json.dumps(effects), duration)


@cache
def flown(course, noise, seed, effects, duration):
    """Fly each flight once, of effects in JSON."""
    record = fly_closed_loop(BARE, json.loads(effects), course, duration=duration, seed=seed,
                             noise=SENSORS[noise])
    return with_asked(record, plan(course, BARE, duration, seed))


def along(record, effects=TRUTH, name='ours', without=True):
    """
    Return the ClosedLoop along a record of the nominal vehicle and of one with effects.

    Args: without: whether the vehicle without each effect flies too.
    """
    others = {each: vector({key: values for key, values in effects.items() if key != each}, BARE)
              for each in effects if without}
    return compare(name, controller_of(name, BARE).controller, reference_of(record), BARE, NONE,
                   vector(effects, BARE), others)


@pytest.fixture(scope='module')
def both():
    """Return the ClosedLoop of both effects along a clean flight."""
    return along(flight())


@pytest.fixture(scope='module')
def alone():
    """Return those of each effect alone, along the same flight, {effect: ClosedLoop}."""
    return {effect: along(flight(), {effect: values}) for effect, values in TRUTH.items()}


def lagged(path, pace):
    """Return a path (N, K) after a lag of the first order of 1 / pace s, exactly sampled."""
    keep = np.exp(-pace / RATE)
    return lfilter([0.0, 1.0 - keep], [1.0, -keep], path, axis=0)


def test_the_corrected_vehicle_tracks_as_the_real_one_and_the_nominal_one_does_not(both):
    found = both
    for group, value in found.tracking['real'].items():
        assert found.tracking['corrected'][group] == pytest.approx(value, rel=0.01)
    assert found.tracking['nominal']['position'] < 0.3 * found.tracking['real']['position']
    # Of noise there is more in the real flight alone.
    noisy = along(flight(noise='mocap_imu'), without=False)
    for group, value in noisy.tracking['real'].items():
        assert noisy.tracking['corrected'][group] == pytest.approx(value, rel=0.05)


def test_a_real_vehicle_that_is_the_nominal_one_costs_nothing():
    found = along(flight(effects={}), effects={})
    assert found.tracking['corrected'] == found.tracking['nominal']
    assert found.bandwidth['corrected'] == found.bandwidth['nominal']
    assert found.without == found.bandwidth_without == {}


def test_what_an_effect_costs_is_lost_without_it(both, alone):
    found, drag = both, alone['rotor_drag']
    whole = found.tracking['corrected']['position']
    # The drag is a disturbance that the controller does not know; the lag is in its margins.
    assert found.without['rotor_drag']['position'] < 0.3 * whole
    assert found.without['motor_lag']['position'] == pytest.approx(whole, rel=0.1)
    assert drag.without['rotor_drag'] == drag.tracking['nominal']
    assert drag.bandwidth_without['rotor_drag'] == drag.bandwidth['nominal']


def test_a_lag_costs_bandwidth_and_a_drag_costs_tracking(both, alone):
    found = both
    corrected, rows = found.bandwidth['corrected'], cost_rows(found)
    # Each without the other is the vehicle that has the other alone.
    for effect, other in (('motor_lag', 'rotor_drag'), ('rotor_drag', 'motor_lag')):
        assert found.bandwidth_without[effect] == alone[other].bandwidth['corrected']
        assert found.without[effect] == alone[other].tracking['corrected']
    # The lag makes the loop of height slow, and its drag along z is none.
    fast = found.bandwidth_without['motor_lag']['z']
    assert fast is None or fast > 1.5 * corrected['z']
    assert found.bandwidth_without['rotor_drag']['z'] == pytest.approx(corrected['z'], rel=0.02)
    cells = {tuple(row[:2]): row[2:] for row in rows}
    assert set(cells) == {(titled(effect), of) for effect in TRUTH for of in (
        'position error', 'velocity error', 'yaw error', 'bandwidth x', 'bandwidth y',
        'bandwidth z', 'bandwidth yaw')}
    whole, less = found.tracking['corrected']['position'], found.without['rotor_drag']['position']
    assert cells[titled('rotor_drag'), 'position error'] == [
        f'{less:.3g}', f'{whole:.3g}', f'{whole - less:+.3g}', 'm']
    slow, less = corrected['x'], found.bandwidth_without['motor_lag']['x']
    assert cells[titled('motor_lag'), 'bandwidth x'] == [
        f'{less:.3g}', f'{slow:.3g}', f'{less - slow:+.3g}', 'Hz']


def test_a_cost_in_bandwidth_beyond_what_is_shown_is_told_as_a_bound():
    band = {'x': 3.0, 'y': None, 'z': 4.0, 'yaw': None}
    less = {'x': None, 'y': 6.0, 'z': 5.0, 'yaw': None}
    found = along(flight('hover', effects={}), {})
    found = replace(found, bandwidth={**found.bandwidth, 'corrected': band},
                    without={'motor_lag': found.tracking['nominal']},
                    bandwidth_without={'motor_lag': less})
    assert [row[2:5] for row in cost_rows(found)[3:]] == [
        ['over 8', '3', 'over +5'], ['6', 'over 8', 'under -2'], ['5', '4', '+1'],
        ['over 8', 'over 8', '?']]
    left = replace(found, bandwidth_without={'motor_lag': None})
    assert [row[2:5:2] for row in cost_rows(left)[3:]] == [['leaves the path', '?']] * 4


def test_progress_is_told_up_to_the_end():
    told = []
    compare('ours', controller_of('ours', BARE).controller, reference_of(flight()), BARE, NONE,
            NONE, {'rotor_drag': NONE}, told.append)
    assert told == pytest.approx(np.arange(1, 7) / 6.0)


def test_without_what_was_asked_the_path_is_that_of_the_flight_and_reality_is_not_told():
    record = flight('lissajous', noise='mocap_imu')
    bare = replace(record, columns={name: values for name, values in record.columns.items()
                                    if name not in ASKED})
    reference = reference_of(bare)
    found = along(bare, without=False)
    assert not reference.asked and set(found.tracking) == {'nominal', 'corrected'}
    # The smooth path is the one flown but for the noise, and what belongs to it its derivatives.
    away = np.linalg.norm(reference.wanted[:, :3] - record.stack('px', 'py', 'pz')[:-1], axis=1)
    assert np.sqrt(np.mean(away ** 2)) < 0.002
    for order in range(3):
        part = reference.wanted[:, 3 * order:3 * order + 3]
        slope = np.gradient(part, 1.0 / reference.rate, axis=0)[1:-1]
        rest = reference.wanted[1:-1, 3 * order + 3:3 * order + 6] - slope
        assert np.sqrt(np.mean(rest ** 2)) < 0.02 * np.sqrt(np.mean(slope ** 2))


@pytest.mark.parametrize('asked', [True, False])
def test_tracking_is_the_same_in_a_world_that_is_turned(asked):
    # Euler angles within half a turn of zero: near pi, the recorded heading jumps by a turn.
    record = flight()
    yaw = euler_from_quaternion(record.stack('qw', 'qx', 'qy', 'qz'))[:, 2]
    kept = {name: values for name, values in record.columns.items()
            if name not in ('qw', 'qx', 'qy', 'qz') and (asked or name not in ASKED)}
    found = []
    for turn in (0.0, np.pi):
        columns = dict(kept)
        cos, sin = np.cos(turn), np.sin(turn)
        for x, y in (('px', 'py'), ('vx', 'vy'), ASKED[:2]):
            if x in kept:
                columns |= {x: cos * kept[x] - sin * kept[y], y: sin * kept[x] + cos * kept[y]}
        columns['psi'] = np.mod(yaw + turn + np.pi, 2.0 * np.pi) - np.pi
        if asked:
            columns['yaw_ref'] = np.mod(kept['yaw_ref'] + turn + np.pi, 2.0 * np.pi) - np.pi
        turned = replace(record, columns=columns)
        found.append(along(turned, without=False).tracking)
    assert np.ptp(np.unwrap(columns['psi'])) < np.pi < np.ptp(columns['psi'])
    for who, errors in found[0].items():
        assert found[1][who] == pytest.approx(errors, rel=1e-3, abs=1e-6)


def test_the_bandwidth_of_a_lag_of_the_first_order_is_its_corner():
    asked = multisine(RATE)
    paces = 2.0 * np.pi * np.array([0.5, 1.0, 2.0, 4.0])
    flown = np.stack([lagged(asked[:, k], pace) for k, pace in enumerate(paces)], axis=1)
    # The first period settles: the slowest lag takes 0.3 s.
    found = list(bandwidth_of_multisine(asked, flown).values())
    assert found == pytest.approx([0.5, 1.0, 2.0, 4.0], rel=0.03)
    assert set(bandwidth_of_multisine(asked, asked).values()) == {None}


def test_the_bandwidth_of_a_flight_shows_where_it_was_asked_for_enough():
    rng = np.random.default_rng(1)
    slow = lfilter([0.01], [1.0, -0.99], rng.standard_normal((20000, 4)), axis=0)
    flown = lagged(slow, 2.0 * np.pi) + 1e-4 * rng.standard_normal(slow.shape)
    asked = slow.copy()
    asked[:, 3] = 0.0       # a heading that never changes shows nothing
    found = bandwidth_of_flight(asked, flown, RATE)
    assert [found[axis] for axis in 'xyz'] == pytest.approx([1.0] * 3, rel=0.15)
    assert found['yaw'] is None
    noisy = flown + 0.1 * rng.standard_normal(flown.shape)
    assert bandwidth_of_flight(asked, noisy, RATE)['x'] is None


def test_the_bandwidth_of_a_flight_shows_above_the_frequencies_of_a_smooth_path():
    t = np.arange(int(60.0 * RATE)) / RATE
    corners = np.array([2.0, 3.0, 4.0, 2.5])
    asked = 0.3 * np.stack([chirp(t, 0.05, t[-1], 8.0, phi=90 * k) for k in range(4)], axis=1)
    went = np.stack([lagged(asked[:, k], 2.0 * np.pi * corner)
                     for k, corner in enumerate(corners)], axis=1)
    speed = np.gradient(went[:, :3], t, axis=0)
    columns = dict(zip(('px', 'py', 'pz', 'psi', *ASKED, 'vx', 'vy', 'vz'),
                       (*went.T, *asked.T, *speed.T), strict=True))
    reference = reference_of(FlightRecord(t, columns, {'name': 'chirps'}))
    found = compare('idle', controller_of(f'{FILE}:Idle', BARE).controller, reference, BARE, NONE,
                    NONE, {}).bandwidth['real']
    # The spectra have a line every 0.1 Hz and a leakage that makes them less sharp.
    assert list(found.values()) == pytest.approx(corners, rel=0.1)


def test_bandwidths_of_all_axes_at_once_are_those_of_each_alone(both, monkeypatch):
    # Tilts about two axes make a yaw, which was many times that of the yaw that is asked for.
    record, found = flight(), both.bandwidth['corrected']
    assert found['x'] == pytest.approx(found['y'], rel=0.01)
    for axis, (name, value) in enumerate(found.items()):
        monkeypatch.setattr('quad_ident_ros.closed_loop.compare.multisine', lambda rate, axis=axis:
                            multisine(rate) * np.where(np.arange(4) == axis, 1.0, 1e-3))
        one = along(record, without=False).bandwidth['corrected'][name]
        assert one == pytest.approx(value, rel=0.01)


def test_where_gains_cross_is_found_between_lines():
    f = np.array([0.5, 1.0, 2.0, 4.0])
    assert crossing(f, 1.0 / f) == pytest.approx(2.0 ** 0.5)
    assert crossing(f, np.ones(4)) is None and crossing(f, 0.1 / f) == 0.5


def test_a_lag_of_the_motors_costs_bandwidth_in_height():
    # About hover a first-order lag of the rotors is one of the thrust: slower loops in height.
    bands = [along(flight(), {'motor_lag': {'time_constant': lag}}, without=False)
             .bandwidth['corrected']['z'] for lag in (0.03, 0.06, 0.12)]
    assert bands[0] > bands[1] > bands[2]


def test_a_controller_of_a_user_flies_the_vehicle():
    # It has no integrals: a payload pulls it down until the thrust that the error of the height
    # asks for, mass times 4 / s^2 times that, carries the payload.
    heavier = {'mass_offset': {'mass': 0.05}}
    found = along(flight('hover', effects=heavier), heavier, f'{FILE}:Cascade')
    assert found.tracking['corrected']['position'] == pytest.approx(
        0.05 * 9.81 / (0.5 * 4.0), rel=0.01)
    assert found.tracking['nominal']['position'] < 1e-3
    assert found.tracking['real']['position'] < 1e-3       # ours flew it, which has integrals
    assert found.without['mass_offset'] == found.tracking['nominal']
    assert 0.3 < found.bandwidth['nominal']['yaw'] < 3.0


def test_a_vehicle_that_leaves_its_path_is_told():
    found = along(flight(), name=f'{FILE}:Idle', without=False)
    assert set(found.tracking['corrected'].values()) == {None}
    assert found.tracking['real']['position'] > 0.0
    assert [row[1:3] for row in loop_rows(found)] == [['leaves the path'] * 2] * 7


def test_a_vehicle_that_stays_near_its_path_and_not_near_that_of_bandwidth_is_told():
    # It falls at 0.05 m/s^2: 5 m in the flight, 39 m in the time of the multisine.
    found = along(flight('hover', effects={}), {}, f'{FILE}:Blind')
    assert found.tracking['nominal']['position'] > 1.0
    assert found.bandwidth['nominal'] is None and found.bandwidth['real'] is not None
    rows = {row[0]: row for row in loop_rows(found)}
    assert rows['bandwidth x'][1:] == ['leaves the path', 'leaves the path', '?', 'Hz']


@pytest.mark.parametrize('name, said', [
    ('Short', 'returns an array of shape (3,); expected (4,)'),
    ('Words', 'returns str; expected an array of 4 rotor speeds'),
    ('Endless', 'returns cmd2 = nan; expected finite speeds'),
    ('Complex', 'returns complex numbers; expected an array of 4 rotor speeds'),
    ('Huge', 'returns numbers beyond what a float holds; expected an array of'),
    ('Partial', 'control of Partial returns an array of shape (3,); expected (4,)'),
    ('Broken', 'control of Broken raises ZeroDivisionError'),
    ('Silent', 'control of Silent raises SilentError'),
    ('Property', 'control of Property raises ZeroDivisionError'),
    ('Half', 'Half has no method control; it needs reset() and control'),
    ('Missing', 'it has no class Missing; give FILE.py:NAME')])
def test_what_is_wrong_with_a_controller_is_told_at_once_in_one_line(name, said):
    with pytest.raises(InputError) as caught:
        controller_of(f'{FILE}:{name}', BARE)
    assert said in str(caught.value) and '\n' not in str(caught.value)
    assert 'plain_controllers.py' in str(caught.value)


def test_a_name_that_is_no_class_of_a_file_is_refused():
    with pytest.raises(InputError, match='--controller mine: expected FILE.py:NAME, .*, or ours'):
        controller_of('mine', BARE)


@pytest.mark.parametrize('gone, said', [(('px',), 'has no position, velocity or attitude'),
                                        (('qw', 'qx'), 'has no position, velocity or attitude')])
def test_a_flight_without_a_path_is_refused(gone, said):
    record = flight()
    columns = {name: values for name, values in record.columns.items() if name not in gone}
    with pytest.raises(InputError, match=said):
        reference_of(replace(record, columns=columns))


def test_a_flight_that_is_too_short_to_follow_is_refused():
    record = flight()
    short = replace(record, t=record.t[:300], columns={name: values[:300] for name, values in
                                                       record.columns.items()})
    with pytest.raises(InputError, match='needs 5 s of flight at least'):
        reference_of(short)


def test_of_a_flight_in_which_an_estimator_was_reset_the_longest_part_is_followed():
    record = replace(flight(), info={'name': 'one', 'source': 'one.csv'})
    moved = record.columns['px'] + 30.0 * (record.t > 9.2)
    pieces = split(replace(record, columns={**record.columns, 'px': moved}),
                   [(9.2, 9.21, 'reset')])
    assert len(pieces) == 2
    whole, alone = reference_of(joined(pieces)[-1]), reference_of(pieces[0])
    assert len(whole.wanted) / RATE == pytest.approx(9.2, abs=0.02)
    np.testing.assert_array_equal(whole.wanted, alone.wanted)


def test_the_command_tells_the_closed_loop_in_table_json_and_page(tmp_path, capsys):
    for k, course in enumerate(('steps', 'lissajous', 'figure8')):
        write_csv(tmp_path / f'{k}.csv', flight(course, 'mocap_imu', seed=k, duration=8.0))
    assert main(['diagnose', *(str(tmp_path / f'{k}.csv') for k in range(3)), '--vehicle',
                 'hummingbird', '--effects', 'rotor_drag,motor_lag', '--controller', 'ours',
                 '--json', str(tmp_path / 'd.json'), '--report', str(tmp_path / 'p.html')]) == 0
    said = capsys.readouterr().out
    assert 'closed loop with ours, 8 s along 2: bandwidth about hover, and rms error' in said
    assert 'against the reference in the record' in said
    data = json.loads((tmp_path / 'd.json').read_text())['closed_loop']
    assert data['tracking']['corrected']['position'] == pytest.approx(
        data['tracking']['real']['position'], rel=0.05)
    assert set(data['without']) == {'rotor_drag', 'motor_lag'} and data['asked'] is True
    assert set(data['bandwidth_without']) == {'rotor_drag', 'motor_lag'}
    assert set(data['bandwidth_without']['motor_lag']) == {'x', 'y', 'z', 'yaw'}
    assert 'cost of each effect in tracking and bandwidth' in said and 'bandwidth yaw' in said
    assert 'In closed loop' in (tmp_path / 'p.html').read_text()
