# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A TwistStamped in the axes of the world, the usual mistake with motion capture."""

from flightmaker import VEHICLE
import numpy as np
import pytest

from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.model.attitude import conjugate, quaternion_from_euler, rotate

V, W, Q = ('vx', 'vy', 'vz'), ('wx', 'wy', 'wz'), ('qw', 'qx', 'qy', 'qz')
TOLD = {'velocity_in_world', 'rate_in_world'}


def taken_for_body(record, *groups):
    """Return a record whose twist was published in the world: the recorder turned its velocity."""
    turned = {}
    for names in groups:
        turned.update(zip(names, rotate(record.stack(*Q), record.stack(*names)).T, strict=True))
    return FlightRecord(record.t, {**record.columns, **turned}, {})


def flown(run, seed=0, **effects):
    experiment = load_experiment('closed_loop').with_effects(effects)
    return fly(experiment, experiment.runs[run], seed=seed).record


def hovering(tilt, yaw, noise=0.0):
    """Return 20 s of gentle motion with tilts of so many rad about a heading."""
    t = 0.01 * np.arange(2000)
    size, turns = 9.81 * tilt, (1.1, 1.7)
    x, y = (-size / w ** 2 * np.sin(w * t) for w in turns)
    vx, vy = (-size / w * np.cos(w * t) for w in turns)
    lean = [tilt * np.sin(w * t) for w in turns]
    c, s = np.cos(yaw), np.sin(yaw)
    pitch, roll = c * lean[0] + s * lean[1], s * lean[0] - c * lean[1]
    q = quaternion_from_euler(np.stack([roll, pitch, np.full_like(t, yaw)], axis=-1))
    turn = np.gradient(np.stack([roll, pitch, 0 * t], axis=-1), t, axis=0)
    random = np.random.default_rng(1)
    columns = {'px': x, 'py': y, 'pz': 2 + 0 * t, 'vx': vx, 'vy': vy, 'vz': 0 * t,
               **dict(zip(Q, q.T, strict=True)), **dict(zip(W, turn.T, strict=True))}
    return FlightRecord(t, {name: values + (noise * random.standard_normal(len(t))
                                            if name in (*V, *W) else 0.0)
                            for name, values in columns.items()}, {})


def codes(record):
    return {one.code for one in findings(record, None)} & TOLD


@pytest.mark.slow
@pytest.mark.parametrize('run', range(4))
def test_a_twist_in_the_world_is_told(run):
    record = flown(run)
    assert codes(record) == set()
    assert 'velocity_in_world' in codes(taken_for_body(record, V))
    assert 'velocity_in_world' in codes(taken_for_body(record, V, W))


@pytest.mark.slow
@pytest.mark.parametrize('run', [0, 1])     # the others hardly yaw, and their rates differ little
def test_rates_alone_are_told_where_the_vehicle_yaws(run):
    assert codes(taken_for_body(flown(run), W)) == {'rate_in_world'}


@pytest.mark.parametrize('yaw', [0.0, 0.5, 1.6, -2.5])
@pytest.mark.parametrize('tilt', [0.02, 0.04])
def test_gentle_motion_tells_it(tilt, yaw):
    record = hovering(tilt, yaw, noise=0.003)
    assert codes(record) == set()
    assert 'velocity_in_world' in codes(taken_for_body(record, V, W))


@pytest.mark.parametrize('effects', [
    {'wind': {'x': 4.0, 'y': -2.0}}, {'attitude_misalignment': {'roll': 0.05, 'pitch': -0.04}},
    {'rotor_drag': {'coefficient': 0.3}}, {'gyro_bias': {'x': 0.05, 'y': -0.05, 'z': 0.1}},
    {'com_offset': {'x': 0.01, 'y': -0.01}}])
@pytest.mark.parametrize('run', range(4))
def test_no_effect_is_taken_for_it(effects, run):
    assert set(effects) <= set(EFFECTS)
    assert codes(flown(run, seed=run, **effects)) == set()


def test_the_inverse_of_the_mistake_is_not_it():
    record = flown(0)
    back = rotate(conjugate(record.stack(*Q)), record.stack(*V)).T
    found = {one.code for one in findings(FlightRecord(
        record.t, {**record.columns, **dict(zip(V, back, strict=True))}, {}), VEHICLE)}
    assert 'velocity_in_body' in found and not found & TOLD
