# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Effects that begin and end in flight."""

import numpy as np
import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
PAYLOAD = {'mass_offset': {'mass': 0.1}}


def flown(changes, effects=None, duration=8.0):
    return fly_closed_loop(VEHICLE, effects or {}, 'vertical', duration=duration, seed=3,
                           changes=changes)


def mass_of(flight, part):
    """Return thrust over specific force along body z: the mass that flies, kg."""
    commands = flight.stack(*(f'cmd{j}' for j in range(1, 5)))[part]
    thrust = VEHICLE.thrust_coefficient * (commands ** 2).sum(axis=1)
    return np.median(thrust / flight.columns['az'][part])


def test_a_payload_is_there_from_its_time_on_until_it_is_set_down():
    flight = flown([(3.0, PAYLOAD), (6.0, {})])
    masses = [mass_of(flight, part) for part in (slice(0, 300), slice(300, 600),
                                                 slice(600, None))]
    assert masses == pytest.approx([VEHICLE.mass, VEHICLE.mass + 0.1, VEHICLE.mass], rel=1e-3)
    # Up to the change it is the same flight, and the vehicle goes on from where it is.
    same = flown([])
    for name in ('pz', 'vz', 'cmd1', 'az'):
        np.testing.assert_array_equal(flight.columns[name][:300], same.columns[name][:300])
    assert np.abs(np.diff(flight.columns['pz'])).max() < 0.05


def test_a_change_to_the_same_changes_nothing():
    one, two = flown([], PAYLOAD), flown([(2.5, PAYLOAD)], PAYLOAD)
    for name in ('px', 'pz', 'vz', 'qx', 'wx', 'cmd1', 'az'):
        np.testing.assert_allclose(two.columns[name], one.columns[name], atol=1e-9)


@pytest.mark.parametrize('changes, effects, said', [
    ([(9.0, PAYLOAD)], {}, r'change 1: at \(s\): 9 is out of range'),
    ([(2.0, PAYLOAD), (2.0, {})], {}, r'change 2: at \(s\): 2 is out of range'),
    ([(2.0, {'battery_sag': {'drop': 0.1}})], {}, 'battery_sag cannot change in flight'),
    ([(2.0, PAYLOAD)], {'motor_lag': {'time_constant': 0.02}}, 'with motor_lag cannot change'),
    ([(2.0, {'gyro_bias': {'x': 0.1}})], {}, 'gyro_bias cannot change in flight'),
    ([(2.0, {'mass_offset': {'x': 0.1}})], {}, 'change 1: effects: mass_offset')])
def test_changes_that_cannot_be_are_refused(changes, effects, said):
    with pytest.raises(InputError, match=said):
        flown(changes, effects)


EXPERIMENT = """
name: short
model: closed_loop
vehicle: hummingbird
period: 0.01
runs:
  - {{name: up, duration: 6.0, trajectory: vertical, {more}}}
"""


def test_an_experiment_file_says_changes(tmp_path):
    path = tmp_path / 'short.yaml'
    path.write_text(EXPERIMENT.format(
        more='outputs: [z], changes: [{at: 3, effects: {mass_offset: {mass: 0.1}}}]'))
    experiment = load_experiment(str(path)).with_effects({'rotor_drag': {'coefficient': 0.1}})
    flight = fly(experiment, experiment.runs[0]).record
    assert mass_of(flight, slice(0, 300)) == pytest.approx(VEHICLE.mass, rel=1e-3)
    assert mass_of(flight, slice(300, None)) == pytest.approx(VEHICLE.mass + 0.1, rel=1e-3)
    assert flight.info['outputs'] == ['z']


@pytest.mark.parametrize('more, said', [
    ('changes: 3', 'expected a list of changes'), ('changes: [{at: 3}]', 'effects'),
    ('changes: [{at: -1, effects: {}}]', 'out of range'),
    ('changes: [{at: 1, effects: {nothing: {}}}]', 'nothing'),
    ('outputs: []', 'expected a list of phi')])
def test_changes_that_are_none_are_refused(tmp_path, more, said):
    path = tmp_path / 'short.yaml'
    path.write_text(EXPERIMENT.format(more=more))
    with pytest.raises(InputError, match=said):
        load_experiment(str(path))


def test_a_shipped_experiment_flies_for_minutes_and_changes():
    [run] = load_experiment('payload_in_flight').runs
    assert run.duration >= 120.0 and len(run.changes) == 2
