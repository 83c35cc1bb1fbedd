# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is diagnosed against MuJoCo's model of a vehicle and exported closes the gap there."""

import pytest

from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle

VEHICLE = load_vehicle('hummingbird')


@pytest.fixture
def in_mujoco():
    pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    from withheld import in_mujoco
    return in_mujoco


def case_of(folder, effects):
    """Write a case as the withheld check does, of short flights, and return its folder."""
    write_vehicle(folder / 'vehicle.yaml', VEHICLE)
    for k, course in enumerate(('figure8', 'lissajous', 'circle')):
        write_csv(folder / f'flight_{k}.csv', fly_closed_loop(
            VEHICLE, effects, course, duration=8.0, seed=k, noise=MOCAP_IMU))
    return folder


@pytest.mark.slow
@pytest.mark.parametrize('late', [{'motor_lag': {'time_constant': 0.04}},
                                  {'actuation_delay': {'delay': 0.025}}])
def test_a_gap_in_mujoco_falls_as_promised(in_mujoco, tmp_path, late):
    effects = {'rotor_drag': {'coefficient': 0.3}, **late}
    one = in_mujoco.fall_of(case_of(tmp_path, effects))
    assert set(one.verdict) == set(effects)
    assert one.judged and one.before == pytest.approx(one.promised_before, rel=0.02)
    assert one.share == pytest.approx(1.0, abs=0.05)
    assert in_mujoco.summary([one])[0].startswith('1 of 1 gaps fall')


def test_a_fall_that_stays_short_of_its_promise_is_told(in_mujoco):
    whole = in_mujoco.Fall('a', ('wind',), 0.2, 0.1, 0.2, 0.1)
    half = in_mujoco.Fall('b', ('wind',), 0.2, 0.15, 0.2, 0.1)
    none = in_mujoco.Fall('c', ('none',), 0.2, 0.2, 0.2, 0.2)
    assert not none.judged and half.share == pytest.approx(0.5)
    said, fell_short = in_mujoco.summary([whole, half, none, 'd: refused: why'])
    assert fell_short and said.startswith('1 of 2 gaps fall') and '2 cases had nothing' in said
    assert not in_mujoco.summary([whole, none])[1]
    text = in_mujoco.page(['d: refused: why', none, half, whole],
                          './run withheld in-mujoco K', '2')
    assert '`./run withheld in-mujoco K`, version 2:\n\n1 of 2 gaps fall in MuJoCo' in text
    assert text.splitlines()[-4:] == [
        '| a | wind | 0.2000 | 0.1000 | 0.2000 | 0.1000 | 100.0 % |',
        '| b | wind | 0.2000 | 0.1500 | 0.2000 | 0.1000 | 50.0 % |',
        '| c | none | 0.2000 | 0.2000 | 0.2000 | 0.2000 | - |',
        '| d: refused: why | | | | | | - |']
