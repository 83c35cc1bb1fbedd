# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Changes in flight by their equation of motion: what is found, what is not, and how often."""

from dataclasses import replace

import numpy as np
from payload import climb, MASS, PAYLOAD, PICKED_UP, START_NS
import pytest

from quad_ident_ros.data.commands import with_inputs
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.gravity import GRAVITY
from quad_ident_ros.identify import change
from quad_ident_ros.identify.blocks import Blocks, blocks_of
from quad_ident_ros.identify.change import find_change, Watch
from quad_ident_ros.identify.identify import collect, identify, Settings
from quad_ident_ros.identify.online import Changes
from quad_ident_ros.identify.signals import signals, vertical_share
from quad_ident_ros.identify.validity import validity
from quad_ident_ros.vehicle_files.load import load_any_vehicle

HOP = 250_000_000       # ns
WEIGHT = MASS * GRAVITY
FREE = Settings(methods=('vp',), initial_state='free', compare_orders=False)
TILT = np.radians(20.0)


def level(count, noise=0.05, gains=1 / MASS, neglected=0.0, seed=0, alike=0.0):
    """Return Blocks of z at constant height, with noise of y'' (m/s^2) whose neighbours agree."""
    random = np.random.default_rng(seed)
    errors = random.normal(size=count) * noise
    for k in range(1, count):
        errors[k] = alike * errors[k - 1] + np.sqrt(1 - alike ** 2) * errors[k]
    thrust = (GRAVITY - errors) / np.broadcast_to(gains, count)
    return Blocks(START_NS + HOP * np.arange(1, count + 1), np.full(count, GRAVITY),
                  np.column_stack([thrust, np.zeros(count)]),
                  np.broadcast_to(GRAVITY * np.asarray(neglected, float), count),
                  np.zeros(count))


def heavier(count, by, last):
    """Return gains (count,) of which the last ones are those of a mass that is so much more."""
    return np.where(np.arange(count) < count - last, 1.0, 1 / (1 + by)) / MASS


def test_a_payload_is_a_smaller_gain_without_any_excitation():
    found = find_change(level(60, gains=heavier(60, 0.3, 4)), 'z')
    before, after = found.moved['K']
    assert before == pytest.approx(1 / MASS, rel=0.01)
    assert after == pytest.approx(1 / 1.3 / MASS, rel=0.02)
    assert abs((found.stamp_ns - START_NS) * 1e-9 - 56 * 0.25) < 0.5


@pytest.mark.parametrize(('by', 'found'), [(0.08, False), (0.3, True)])
def test_what_drag_may_be_at_a_tilt_that_was_not_flown_before_is_no_change(by, found):
    """A tilt of 17 deg: drag is up to 9 % of the thrust; the noise alone would show 8 %."""
    neglected = np.where(np.arange(60) < 52, 0.0, 0.09)
    blocks = level(60, 0.02, heavier(60, by, 8), neglected)
    assert (find_change(blocks, 'z') is not None) == found
    assert find_change(level(60, 0.02, heavier(60, by, 8)), 'z') is not None


def test_nothing_is_told_from_blocks_in_which_the_linear_model_does_not_hold():
    neglected = np.where(np.arange(60) < 52, 0.0, 0.3)
    assert find_change(level(60, gains=heavier(60, 1.0, 8), neglected=neglected), 'z') is None
    # Nor is what was before made of them.
    neglected = np.where(np.arange(60) < 52, 0.3, 0.0)
    assert find_change(level(60, gains=heavier(60, 1.0, 8), neglected=neglected), 'z') is None


def test_a_knock_is_no_change():
    flight = climb(0.0, seed=3)
    height = flight.columns['pz'] + 0.1 * np.exp(-((flight.t - 15.0) / 0.05) ** 2)
    assert alarms(FlightRecord(flight.t, {**flight.columns, 'pz': height}, flight.info)) == []


@pytest.mark.slow
@pytest.mark.parametrize('alike', [0.0, 0.5, 0.9])
def test_false_alarms_are_no_more_than_stated(monkeypatch, alike):
    """At a rate so high that it can be counted: of 80 per hour, one in four is of z."""
    monkeypatch.setattr(change, 'FALSE_PER_HOUR', 80.0)
    hours, count = 0.25, 0
    blocks, last = level(round(hours * 14400), 0.1, alike=alike), 300
    while last < len(blocks):
        if find_change(blocks.part(slice(last - 257, last)), 'z') is None:
            last += 1
        else:
            count, last = count + 1, last + 257
    # Of five that are expected at most, ten or more come by chance once in thirty times.
    assert count < 10


def alarms(flight, stride=25, window=500):
    """Return the Changes found in windows of a flight, with the end of each window, s."""
    watch, found = Changes(), []
    for end in range(window, len(flight), stride):
        pairs, _ = collect([flight.starting(end - window).slice(0, window)], FREE)
        found += [(flight.t[end - 1], each) for each in watch.update(pairs)[0]]
    return found


@pytest.mark.slow
@pytest.mark.parametrize('tilt', [0.0, TILT])
@pytest.mark.parametrize('seed', range(3))
def test_a_payload_of_30_percent_is_found_within_2_s_also_in_lateral_flight(seed, tilt):
    [(end, found)] = alarms(climb(0.3 * MASS, seed=seed, tilt=tilt))
    assert 0 < end - PICKED_UP < 2.0 and found.output == 'z'
    assert abs((found.stamp_ns - START_NS) * 1e-9 - PICKED_UP) < 0.5
    assert found.moved['K'][1] == pytest.approx(1 / 1.3 / MASS, rel=0.15)
    assert alarms(climb(0.0, seed=seed, tilt=tilt)) == []


def test_windows_of_any_step_give_the_same_blocks():
    flight = climb(PAYLOAD)
    ends = []
    for stride in (5, 40):
        watch = Watch('z')
        for end in range(500, 1100, stride):
            pairs, _ = collect([flight.starting(end - 500).slice(0, 500)], FREE)
            watch.update(pairs['z'])
        ends.append(watch._blocks.target[:20])
    np.testing.assert_allclose(ends[0], ends[1], atol=1e-9)


def test_a_block_is_the_mean_of_the_equation_of_motion():
    """The means of a parabola's and a sine's second derivative and of the held thrust."""
    flight = climb(0.0, noise=0.0)
    [pair] = [pair for pair in signals(flight)[0] if pair.output == 'z']
    blocks = blocks_of(pair, 0)
    gain, damping = np.linalg.lstsq(blocks.features, blocks.target, rcond=None)[0]
    assert gain == pytest.approx(GRAVITY / (MASS * 9.806), rel=1e-3) and abs(damping) < 0.02


def test_the_altitude_has_the_vertical_part_of_the_thrust_as_its_input():
    flight = climb(0.0, tilt=TILT)
    share = vertical_share(flight.columns['phi'], flight.columns['theta'])
    assert 19.0 < np.degrees(np.arccos(share.min())) < 21.0
    [pair] = [pair for pair in signals(flight)[0] if pair.output == 'z']
    np.testing.assert_allclose(pair.u + pair.trim, share * flight.columns['u1'])
    # Without a trim it counts from the first sample, whatever the tilt there.
    late = FlightRecord(flight.t, flight.columns, {}).slice(300)
    [pair] = [pair for pair in signals(late)[0] if pair.output == 'z']
    assert pair.u[0] == 0.0
    # One from rest is the paper's experiment.
    rest = FlightRecord(flight.t, flight.columns, {**flight.info, 'starts_at_rest': True})
    [pair] = [pair for pair in signals(rest)[0] if pair.output == 'z']
    np.testing.assert_allclose(pair.u + pair.trim, flight.columns['u1'])


def test_the_gain_of_z_stays_that_of_hover():
    """And without the attitude it does not."""
    gains, flat = [], []
    for first in (0, 500):
        flight = climb(0.0, tilt=TILT).starting(first).slice(0, 500)
        bare = FlightRecord(flight.t, {name: values for name, values in flight.columns.items()
                                       if name in ('pz', 'u1')}, flight.info)
        for record, where in ((flight, gains), (bare, flat)):
            where.append(identify([record], FREE).methods['vp'].outputs['z'].model.gain)
    np.testing.assert_allclose(gains, 1 / MASS, rtol=0.05)
    assert np.abs(np.multiply(flat, MASS) - 1).max() > 0.1


@pytest.mark.parametrize(('degrees', 'holds'), [(0.0, True), (20.0, True), (27.0, False)])
def test_a_result_says_where_the_linear_model_does_not_hold(degrees, holds):
    result = identify([climb(0.0, tilt=np.radians(degrees)).slice(300, 900)], FREE)
    held = result.validity['z']
    assert held.holds == holds and held.share == pytest.approx(
        np.tan(held.tilt) * np.sin(held.tilt), rel=0.3, abs=1e-3)
    assert any('does not hold' in remark for remark in result.remarks) != holds
    assert ('does not hold' in held.why) != holds and 'tilt' in held.why


def test_coupling_with_the_other_axes_is_said():
    """A vehicle that rolls and pitches at once turns in yaw without any moment."""
    t = np.arange(500) * 0.01
    columns = {'phi': 0.5 * np.sin(6 * t), 'theta': 0.5 * np.cos(6 * t),
               'psi': 0.05 * np.sin(2 * t), 'u4': np.sin(2 * t), 'u2': np.sin(6 * t)}
    pairs = {pair.output: pair for pair in signals(FlightRecord(t, columns, {}))[0]}
    assert validity(pairs['psi']).holds is False
    alone = {**columns, 'theta': 0 * t, 'phi': 0.5 * np.sin(6 * t), 'psi': 0 * t}
    pairs = {pair.output: pair for pair in signals(FlightRecord(t, alone, {}))[0]}
    assert validity(pairs['phi']).holds is True


@pytest.mark.parametrize(('turned', 'said'), [(2.0, ' % of the angular acceleration'),
                                              (0.001, ' times the angular acceleration')])
def test_a_coupling_beyond_measure_is_said_as_a_multiple(turned, said):
    """It was a percentage of nine digits."""
    t = np.arange(500) * 0.01
    columns = {'phi': 0.5 * np.sin(6 * t), 'theta': 0.5 * np.cos(6 * t),
               'psi': turned * np.sin(2 * t), 'u4': np.sin(2 * t), 'u2': np.sin(6 * t)}
    pairs = {pair.output: pair for pair in signals(FlightRecord(t, columns, {}))[0]}
    assert said in validity(pairs['psi']).why


def test_without_an_attitude_the_tilt_is_not_known():
    flight = climb(0.0)
    bare = FlightRecord(flight.t, {name: flight.columns[name] for name in ('pz', 'u1')},
                        flight.info)
    assert identify([bare], FREE).validity['z'].holds is None


@pytest.mark.slow
def test_nothing_is_told_from_inputs_that_the_rotors_cannot_give():
    """For a second 3 N more are asked for than act: without limits, that is a heavier vehicle."""
    flight = climb(0.0, seed=2)
    asked = flight.columns['u1'] + np.where((flight.t > 15.0) & (flight.t < 16.0), 3.0, 0.0)
    record = FlightRecord(flight.t, {**flight.columns, 'u1': asked}, flight.info)
    assert 'z' in {found.output for _, found in alarms(record)}
    most = flight.columns['u1'].max() + 0.1     # N
    vehicle = load_any_vehicle('paper_quadrotor')
    limited = replace(vehicle, speed_max=np.sqrt(most / 4 / vehicle.thrust_coefficient))
    assert alarms(with_inputs(record, limited)) == []
    part = with_inputs(record, limited).slice(1400, 1700)
    held = identify([part], FREE).validity['z']
    assert held.holds is False and 'beyond speed_min or speed_max' in held.why
    assert identify([with_inputs(flight, limited)], FREE).validity['z'].holds is True
