# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Hybrids of real flights change what they say, by as much as they say, and nothing else."""

import numpy as np
import pytest
from real import NANOBENCH, WHY
from scipy.spatial.transform import Rotation
import yaml

from withheld import hybrids

if NANOBENCH is None:
    pytest.skip(WHY, allow_module_level=True)
VEHICLE = yaml.safe_load((NANOBENCH / 'vehicle.yaml').read_text(encoding='utf-8'))
Y = np.array([rotor['position'][1] for rotor in VEHICLE['rotors']])
X = np.array([rotor['position'][0] for rotor in VEHICLE['rotors']])


@pytest.fixture(scope='module')
def flown():
    return hybrids.read_flight(NANOBENCH / 'oval_fast.csv.gz')


def stacked(columns, names):
    return np.stack([columns[name] for name in names], axis=1)


def thrusts(columns):
    return stacked(columns, hybrids.COMMANDS) ** 2


def differing(before, after):
    return {name for name in before if not np.array_equal(before[name], after[name])}


def test_weaker_rotors_are_told_to_turn_faster(flown):
    changed = hybrids.weaker(0.9).flight(flown, VEHICLE)
    assert 0.9 * thrusts(changed) == pytest.approx(thrusts(flown))
    assert differing(flown, changed) == set(hybrids.COMMANDS)


def test_thrust_falls_evenly_and_begins_as_it_was(flown):
    changed = hybrids.emptying(0.1).flight(flown, VEHICLE)
    share = thrusts(flown) / thrusts(changed)
    assert share[0] == pytest.approx(1.0)
    assert share[-1] == pytest.approx(0.9)
    assert share[:, 2] == pytest.approx(np.linspace(1.0, 0.9, len(share)), abs=1e-6)


def test_commands_act_later_than_they_are_told(flown):
    change = hybrids.later(3)
    changed = change.flight(flown, VEHICLE)
    assert change.effects == {'actuation_delay': {'delay': pytest.approx(0.03)}}
    # What acts at row k was commanded at row k - 3.
    assert np.array_equal(changed['cmd2'][:-3], flown['cmd2'][3:-3])
    assert np.array_equal(changed['vx'], flown['vx'][:-3])
    assert len({len(values) for values in changed.values()}) == 1


def test_one_rotor_loses_thrust_and_with_it_torque(flown):
    change = hybrids.broken(3, 0.08)
    assert change.effects == {'rotor_fault': {'loss_both_3': 0.08}}
    changed = change.flight(flown, VEHICLE)
    assert differing(flown, changed) == {'cmd3'}
    assert 0.92 * changed['cmd3'] ** 2 == pytest.approx(flown['cmd3'] ** 2)


def test_the_moment_about_another_centre_is_that_of_the_flight(flown):
    x, y = 8e-4, -6e-4
    told, real = thrusts(hybrids.off_centre(x, y).flight(flown, VEHICLE)), thrusts(flown)
    assert told.sum(axis=1) == pytest.approx(real.sum(axis=1))
    assert told @ (Y - y) == pytest.approx(real @ Y, abs=1e-3)
    assert told @ (X - x) == pytest.approx(real @ X, abs=1e-3)


def test_attitude_is_tilted_in_the_body(flown):
    changed = hybrids.tilted(0.05, -0.03).flight(flown, VEHICLE)
    before, after = (Rotation.from_quat(stacked(columns, hybrids.QUATERNION))
                     for columns in (flown, changed))
    tilt = (before.inv() * after).as_euler('ZYX')
    assert tilt == pytest.approx(np.tile([0.0, -0.03, 0.05], (len(tilt), 1)), abs=1e-9)
    assert differing(flown, changed) == set(hybrids.QUATERNION)


def test_the_gyro_reads_too_much(flown):
    changed = hybrids.biased(0.05, -0.03, 0.04).flight(flown, VEHICLE)
    assert changed['wy'] - flown['wy'] == pytest.approx(np.full(len(flown['t']), -0.03))


def test_in_wind_the_path_is_still_the_integral_of_the_velocity(flown):
    changed = hybrids.windy(0.8, -0.5).flight(flown, VEHICLE)
    assert changed['vx'] - flown['vx'] == pytest.approx(np.full(len(flown['t']), 0.8))
    moved = np.gradient(changed['py'] - flown['py'], flown['t'])
    assert moved == pytest.approx(np.full(len(moved), -0.5))
    assert differing(flown, changed) == {'px', 'py', 'vx', 'vy'}


def test_what_the_vehicle_has_more_than_its_file():
    change = hybrids.heavier(0.15, VEHICLE['mass'])
    known = change.vehicle(VEHICLE)
    assert known['mass'] + change.effects['mass_offset']['mass'] == pytest.approx(VEHICLE['mass'])
    assert VEHICLE['mass'] / known['mass'] == pytest.approx(1.15)
    known = hybrids.slower(1.3, 1.5).vehicle(VEHICLE)
    assert np.divide(VEHICLE['inertia'], known['inertia']) == pytest.approx([1.3, 1.5, 1.0])


def diagnosis(verdict, **parameters):
    return {'verdict': verdict, 'ranking': [
        {'effect': effect, 'probability': 0.9,
         'parameters': {name: {'value': value, 'std': std} for name, (value, std) in two.items()}}
        for effect, two in parameters.items()]}


def label(change):
    return {'by': change.by, 'effects': change.effects, 'twins': list(change.twins)}


def test_an_effect_is_gained_or_it_moves():
    truth = label(hybrids.later(2))
    base = diagnosis(['rotor_drag'])
    gained = hybrids.judge(truth, base, diagnosis(['actuation_delay', 'rotor_drag'],
                                                  actuation_delay={'delay': (0.021, 0.001)}))
    assert gained == {'named': True, 'gained': True, 'moved': True, 'lost': [], 'added': [],
                      'right': True}
    base = diagnosis(['actuation_delay'], actuation_delay={'delay': (0.04, 0.001)})
    stays = diagnosis(['wind'], actuation_delay={'delay': (0.041, 0.001)})
    assert hybrids.judge(truth, base, stays) == {
        'named': False, 'gained': False, 'moved': False, 'lost': [], 'added': ['wind'],
        'right': False}


def test_factors_are_multiplied_and_twins_count():
    truth = label(hybrids.weaker(0.9))
    base = diagnosis(['thrust_scale'], thrust_scale={'factor': (0.95, 0.002)})
    found = diagnosis(['thrust_scale'], thrust_scale={'factor': (0.855, 0.002)})
    assert hybrids.judge(truth, base, found)['moved']
    assert not hybrids.judge(truth, base, found)['gained']
    other = diagnosis(['mass_offset'])
    assert hybrids.judge(truth, diagnosis(['none']), other)['gained']
    assert hybrids.judge(truth, base, other)['moved'] is None


def test_what_the_base_states_in_another_form_is_not_compared():
    truth = label(hybrids.weaker(0.9))
    base = diagnosis(['thrust_scale'], thrust_scale={'at_hover': (0.95, 0.002)})
    found = diagnosis(['thrust_scale'], thrust_scale={'factor': (0.855, 0.002)})
    told = hybrids.judge(truth, base, found)
    assert told['moved'] is None and told['right'] is None


@pytest.mark.slow
def test_all_cases_are_written_and_no_two_alike(tmp_path):
    source = tmp_path / 'source'
    source.mkdir()
    (source / 'vehicle.yaml').write_text((NANOBENCH / 'vehicle.yaml').read_text())
    [path, *_] = sorted(NANOBENCH.glob('*.csv.gz'))
    for name in hybrids.FLIGHTS['development']:
        (source / f'{name}.csv.gz').write_bytes(path.read_bytes())
    labels = hybrids.make_hybrids('development', tmp_path / 'cases', np.random.default_rng(3),
                                  source)
    texts = {name: ''.join(path.read_text() for path in sorted((tmp_path / 'cases' / name)
                                                               .iterdir())) for name in labels}
    assert len(set(texts.values())) == len(labels) > 10
    assert labels['base']['effects'] == {}


def test_without_the_flights_it_says_so(tmp_path):
    with pytest.raises(FileNotFoundError, match='real flights'):
        hybrids.make_hybrids('development', tmp_path, np.random.default_rng(1),
                             tmp_path / 'nowhere')
