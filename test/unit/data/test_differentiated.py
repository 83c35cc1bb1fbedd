# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Velocity and rate of records that have position and attitude alone."""

from dataclasses import replace

from flightmaker import changed, flight, VEHICLE
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from quad_ident_ros.data.differentiated import DIFFERENTIATED, missing_motion, with_motion
from quad_ident_ros.data.quality import cautions, findings, refuse_unfit
from quad_ident_ros.data.summary import summarise
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.attitude import product

P, Q = ('px', 'py', 'pz'), ('qw', 'qx', 'qy', 'qz')
V, W = ('vx', 'vy', 'vz'), ('wx', 'wy', 'wz')
NONE = dict.fromkeys((*V, *W, 'ax', 'ay', 'az'))


@pytest.mark.parametrize('rate', [50.0, 100.0, 400.0])
def test_slopes_are_those_of_the_flight(rate):
    """The flight has tones up to 0.6 Hz, of which a cubic over 0.1 s keeps nearly all."""
    record = flight(seconds=6.0, rate=rate, noise=0.0)
    made = with_motion(changed(record, **NONE))
    assert made.info[DIFFERENTIATED] == ('velocity', 'rate')
    np.testing.assert_allclose(made.stack(*V), record.stack(*V), atol=3e-3)
    np.testing.assert_allclose(made.stack(*W)[1:-1], record.stack(*W)[1:-1], atol=1e-2)


def test_slopes_do_not_reach_across_a_gap():
    record = flight(seconds=6.0, noise=0.0)
    use = (record.t < 2.0) | (record.t > 3.0)
    cut = changed(record, t=record.t[use], **{name: values[use] for name, values in
                                              record.columns.items()})
    made = with_motion(changed(cut, **NONE))
    np.testing.assert_allclose(made.stack(*V), cut.stack(*V), atol=1e-2)


def test_what_was_recorded_stays():
    record = flight(seconds=4.0)
    assert with_motion(record) is record and not missing_motion(record)
    made = with_motion(changed(record, **dict.fromkeys(V)))
    assert made.info[DIFFERENTIATED] == ('velocity',)
    np.testing.assert_array_equal(made.stack(*W), record.stack(*W))


def test_it_is_said_before_and_after():
    record = changed(flight(seconds=6.0), **NONE)
    for one in (record, with_motion(record)):
        said = [found for found in findings(one) if found.code == 'differentiated']
        assert [found.where for found in said] == ['vx, vy, vz', 'wx, wy, wz']
    told = [one['code'] for one in cautions(with_motion(record), VEHICLE)]
    assert told.count('differentiated') == 2


@pytest.mark.slow
def test_motion_capture_and_commands_are_enough_for_a_verdict():
    record = changed(flight(seconds=20.0), **NONE)
    assert diagnose([record], VEHICLE).verdict == ('none',)
    assert diagnose([record], replace(VEHICLE, mass=0.6)).verdict[0] == 'mass_offset'


def differences(record, kind):
    """Return velocity and rate as people make them of the pose, by the rows around each."""
    rows = np.clip(np.arange(len(record)), 1, len(record) - 2)
    first, last = rows - (kind != 'next'), rows + (kind != 'last')
    steps = (record.t[last] - record.t[first])[:, None]
    turns = Rotation.from_quat(np.roll(record.stack(*Q), -1, axis=1))
    place = record.stack(*P)
    return ((place[last] - place[first]) / steps,
            (turns[first].inv() * turns[last]).as_rotvec() / steps)


def with_slopes(record, velocity, rate):
    """Return a record with other velocities and rates."""
    return changed(record, **dict(zip(V, velocity.T, strict=True)),
                   **dict(zip(W, rate.T, strict=True)))


@pytest.mark.slow
def test_info_finds_what_a_diagnosis_refuses_in_place_of_differences():
    """The noise of the differences hides it, and info had no error."""
    record = changed(flight(seconds=12.0, noise=10.0), ax=None, ay=None, az=None)
    record = with_slopes(record, *differences(record, 'last'))
    q = product(np.array([np.cos(1.1), 0.0, 0.0, np.sin(1.1)]), record.stack(*Q))
    turned = changed(record, **dict(zip(Q, q.T, strict=True)))
    told = [found['code'] for found in summarise(turned, VEHICLE)['findings']
            if found['severity'] == 'error']
    with pytest.raises(InputError, match='velocity and thrust agree only if'):
        refuse_unfit(with_motion(turned), VEHICLE)
    assert told == ['heading']


@pytest.mark.parametrize('kind', ['next', 'last', 'both'])
@pytest.mark.parametrize('lost', [0.0, 0.05])
def test_differences_of_rows_give_way_to_cubics(kind, lost):
    record, truth = flight(seconds=6.0), flight(seconds=6.0, noise=0.0)
    velocity, rate = differences(record, kind)
    rough = with_slopes(record, velocity, rate)
    kept = np.random.default_rng(0).uniform(size=len(record)) >= lost
    rough, truth = (changed(one, t=one.t[kept], **{name: values[kept] for name, values in
                                                   one.columns.items()}) for one in (rough, truth))
    made = with_motion(rough)
    assert made.info[DIFFERENTIATED] == ('velocity', 'rate')
    for names in (V, W):
        error, before = (np.std(one.stack(*names) - truth.stack(*names)) for one in (made, rough))
        # Of 11 points a cubic's slope has 0.25 of the noise over a period, a difference 0.71.
        assert error < 0.4 * before
    for one in (rough, made):
        said = [found for found in findings(one) if found.code == 'differentiated']
        assert len(said) == 2 and all('differences' in found.message for found in said)


def test_slopes_of_roll_pitch_and_yaw_are_no_rates_of_the_body():
    record, truth = flight(seconds=6.0), flight(seconds=6.0, noise=0.0)
    turns = Rotation.from_quat(np.roll(record.stack(*Q), -1, axis=1))
    angles = np.unwrap(turns.as_euler('ZYX')[:, ::-1], axis=0)
    rough = with_slopes(record, record.stack(*V), np.gradient(angles, record.t, axis=0))
    made = with_motion(rough)
    assert made.info[DIFFERENTIATED] == ('rate',)
    error, before = (np.std(one.stack(*W) - truth.stack(*W)) for one in (made, rough))
    assert error < 0.4 * before


def test_slopes_with_a_noise_of_their_own_stay():
    record = flight(seconds=6.0)
    velocity, rate = differences(record, 'both')
    noise = np.random.default_rng(1).normal(size=(2, *velocity.shape))
    own = with_slopes(record, velocity + 0.05 * noise[0], rate + 0.2 * noise[1])
    assert with_motion(own) is own


@pytest.mark.parametrize('kind', ['next', 'last', 'both'])
def test_differences_without_noise_stay_for_no_cubic_is_better(kind):
    """A simulation by Euler's method moves by just the velocity that it records."""
    record = flight(seconds=6.0, noise=0.0)
    exact = with_slopes(record, *differences(record, kind))
    assert with_motion(exact) is exact
    assert 'differentiated' not in [found.code for found in findings(exact)]


@pytest.mark.slow
def test_velocities_that_are_differences_of_what_repeats_lead_to_no_unknown():
    flights = [fly_closed_loop(VEHICLE, {}, name, duration=15.0, seed=seed,
                               noise=SENSORS['faulty'])
               for seed, name in enumerate(('lissajous', 'figure8', 'circle'))]
    assert diagnose(flights, VEHICLE).verdict == ('none',)
