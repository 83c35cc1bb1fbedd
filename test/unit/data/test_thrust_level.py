# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The scale of commands that no file has: by the weight, and what then is not named."""

from dataclasses import replace
import math

from flightmaker import flight, VEHICLE
import numpy as np
import pytest
from standing import brisk, standing_first
from standing import VEHICLE as STANDING

from quad_ident_ros.data.outputs import commanded
from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.thrust_level import FULL_SPEED, on_one_level
from quad_ident_ros.diagnose.candidates import candidates, nuisance_candidates
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.fit import fit
from quad_ident_ros.greybox.flights import flight_of, track_of
from quad_ident_ros.greybox.parameters import NAMES
from quad_ident_ros.model.motors import motors_from

FLIGHT = flight(seconds=10.0, noise=0.0)
CMD, FORCE = ('cmd1', 'cmd2', 'cmd3', 'cmd4'), ('ax', 'ay', 'az')
SPEEDS = FLIGHT.stack(*CMD)
FULL = 1650.0       # rad/s at full signal, which no file has
UNLIMITED = replace(VEHICLE, speed_min=0.0, speed_max=math.inf)


def told(outputs, leave_out=(), **columns):
    """Return FLIGHT with outputs in place of its commands, and without some columns."""
    kept = {name: values for name, values in FLIGHT.columns.items()
            if name not in (*CMD, *leave_out)}
    outputs = {f'output{k}': column for k, column in enumerate(outputs.T, 1)}
    return FlightRecord(FLIGHT.t, {**kept, **outputs, **columns}, FLIGHT.info)


@pytest.mark.parametrize(('leave_out', 'by', 'error'), [
    ((), 'the accelerometer', 1e-3), (FORCE, 'velocity and tilt', 1e-2),
    ((*FORCE, 'vx', 'vy', 'vz'), 'the tilt', 2e-2),
    ((*FORCE, 'vx', 'vy', 'vz', 'qw', 'qx', 'qy', 'qz'), 'hover on average', 5e-2)])
def test_the_speed_at_full_signal_is_that_by_which_thrust_carries_the_weight(leave_out, by,
                                                                             error):
    [read] = commanded([told(np.round(65535 * SPEEDS / FULL), leave_out)], UNLIMITED)
    assert read.info[FULL_SPEED] == pytest.approx(FULL, rel=error)
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=1.1 * error)
    assert by in read.info['notes'][-1]
    assert [one.severity for one in findings(read, UNLIMITED) if one.code == 'thrust_level'] == [
        'warning']


def test_the_gain_of_a_thrust_curve_of_known_power_is_found_as_well():
    vehicle = replace(UNLIMITED, motors=motors_from('v', {
        'kind': 'percent', 'thrust': {'exponent': 1.4}}))
    share = (SPEEDS / FULL) ** (2 / 1.4)
    [read] = commanded([told(100 * share)], vehicle)
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=1e-3)


ROTORS = ('rotor1', 'rotor2', 'rotor3', 'rotor4')


def moving(low=0.15, high=0.9):
    """Return shares of full speed (N, 4) over a range that shows the shape of a map."""
    turn = np.stack([np.sin(2.1 * FLIGHT.t + k) for k in range(4)], axis=-1)
    return 0.5 * (low + high) + 0.5 * (high - low) * turn


@pytest.mark.parametrize('offset, power', [(0.0, 1.0), (120.0, 1.0), (0.0, 2.0)])
def test_speeds_that_were_measured_beside_the_signal_tell_the_map(offset, power):
    """Not the weight: whether thrust and mass fit each other can then be seen."""
    share = moving()
    signal = ((share * FULL - offset) / (FULL - offset)) ** power
    measured = dict(zip(ROTORS, (share * FULL).T, strict=True))
    [read] = commanded([told(signal, **measured)], UNLIMITED)
    np.testing.assert_allclose(read.stack(*CMD), share * FULL, rtol=1e-6)
    assert FULL_SPEED not in read.info
    assert 'of the measured rotor speeds' in read.info['notes'][-1]
    assert not [one for one in findings(read, UNLIMITED) if one.code == 'thrust_level']


def test_measured_speeds_tell_the_gain_of_a_curve_of_known_power():
    vehicle = replace(UNLIMITED, motors=motors_from('v', {
        'kind': 'percent', 'thrust': {'exponent': 1.4}}))
    share = moving()
    measured = dict(zip(ROTORS, (share * FULL).T, strict=True))
    [read] = commanded([told(100 * share ** (2 / 1.4), **measured)], vehicle)
    np.testing.assert_allclose(read.stack(*CMD), share * FULL, rtol=1e-6)


def test_measured_speeds_tell_the_level_where_the_signal_hardly_changes():
    """As about hover, with motors that lag: the shape is not to be seen then."""
    measured = SPEEDS.copy()
    for k in range(1, len(measured)):       # a lag of three samples
        measured[k] = measured[k - 1] + (SPEEDS[k] - measured[k - 1]) / 3
    assert np.ptp(SPEEDS) < 0.2 * FULL
    [read] = commanded([told(SPEEDS / FULL, **dict(zip(ROTORS, measured.T, strict=True)))],
                       replace(UNLIMITED, thrust_coefficient=2 * VEHICLE.thrust_coefficient))
    np.testing.assert_allclose(read.stack(*CMD), SPEEDS, rtol=5e-3)
    assert FULL_SPEED not in read.info


def test_measured_speeds_that_do_not_follow_the_signal_leave_the_level_to_the_weight():
    noise = 900 + 100 * np.random.default_rng(1).normal(size=(len(FLIGHT), 4))
    measured = dict(zip(ROTORS, noise.T, strict=True))
    [read] = commanded([told(SPEEDS / FULL, **measured)], UNLIMITED)
    assert read.info[FULL_SPEED] == pytest.approx(FULL, rel=1e-3)


def test_ground_time_and_an_emptying_battery_do_not_move_the_level():
    """Idle motors on the ground carry nothing: those windows are left out."""
    ground = np.arange(len(FLIGHT)) < len(FLIGHT) // 4
    outputs = np.where(ground[:, None], 0.1, SPEEDS / FULL)
    columns = {name: np.where(ground, 9.81 if name == 'az' else 0.0, FLIGHT.columns[name])
               for name in FORCE}
    [read] = commanded([told(outputs, FORCE, **columns)], UNLIMITED)
    assert read.info[FULL_SPEED] == pytest.approx(FULL, rel=5e-3)


def test_motors_that_never_carry_are_refused_with_the_way_out():
    falling = {name: np.zeros(len(FLIGHT)) for name in FORCE}
    with pytest.raises(InputError, match='speed_max .rad/s., or motors: with a gain'):
        commanded([told(SPEEDS / FULL, FORCE, **falling)], UNLIMITED)


def test_flights_of_the_same_motors_get_one_scale():
    one, other = (commanded([told(SPEEDS / full)], UNLIMITED)[0] for full in (1600.0, 1700.0))
    same = on_one_level([one, FLIGHT, other])
    assert same[1] is FLIGHT
    assert same[0].info[FULL_SPEED] == same[2].info[FULL_SPEED] == pytest.approx(1650, rel=1e-3)
    np.testing.assert_allclose(same[0].columns['cmd1'], SPEEDS[:, 0] * 1650 / 1600, rtol=1e-3)


def test_what_scales_thrust_over_mass_is_not_among_the_candidates():
    [read] = commanded([told(SPEEDS / FULL)], UNLIMITED)
    for record, known in ((FLIGHT, True), (read, False)):
        flights = [flight_of(track_of(record, VEHICLE)) for _ in range(2)]
        found = candidates(flights, VEHICLE, RULES)
        names = {NAMES[column] for one in found for column in one.columns}
        assert ('mass_offset.mass' in names) == ('thrust_scale.factor' in names) == known
        assert ('thrust_scale.at_hover' in names) == known
        assert {'thrust_scale.offset', 'thrust_scale.exponent', 'battery_sag.per_second'} <= names
        kinds = [one.label for one in nuisance_candidates(VEHICLE, flights)]
        assert ('thrust_level' in kinds) == (not known)
        assert ('thrust_scale_by_flight' in kinds) == known


@pytest.mark.parametrize('name', ['mass', 'thrust_coefficient', 'mass_offset', 'thrust_scale',
                                  'thrust_scale.factor'])
def test_a_fit_does_not_give_back_the_weight_that_scaled_the_commands(name):
    [read] = commanded([told(SPEEDS / FULL)], UNLIMITED)
    with pytest.raises(InputError, match='determines .*leave that out of --free') as caught:
        fit([FLIGHT, read], UNLIMITED, ['inertia', name])
    assert len(str(caught.value).splitlines()) == 1


def test_a_fit_takes_flights_of_the_same_motors_on_one_scale():
    """Accelerometers off by as much up and down: the mean scale is right, and the inertia."""
    records = [commanded([told(SPEEDS / FULL, az=FLIGHT.columns['az'] * off ** 2)], UNLIMITED)[0]
               for off in (0.9, 1.1)]
    records[1] = replace(records[1], t=records[1].t + 100.0)
    assert np.ptp([record.info[FULL_SPEED] for record in records]) > 0.15 * FULL
    [inertia] = fit(records, UNLIMITED, ['inertia_x']).parameters
    assert inertia.value == pytest.approx(VEHICLE.inertia[0], rel=5e-3)


@pytest.mark.parametrize('idle', [0.2, 0.5])
@pytest.mark.parametrize('spin_up', [0.0, 3.0])
@pytest.mark.parametrize('leave_out', [(), FORCE])
def test_idling_on_the_ground_does_not_change_the_level(idle, spin_up, leave_out):
    record = standing_first(brisk(), spin_up=spin_up, idle=idle, lag=1.0)
    columns = {name: values for name, values in record.columns.items()
               if not name.startswith(('cmd', 'rotor')) and name not in leave_out}
    columns |= {f'output{k}': record.columns[f'cmd{k}'] / FULL for k in range(1, 5)}
    vehicle = replace(STANDING, speed_min=0.0, speed_max=math.inf,
                      motors=motors_from('motors', {'kind': 'normalised'}))
    [read] = commanded([FlightRecord(record.t, columns, {})], vehicle)
    assert read.info[FULL_SPEED] == pytest.approx(FULL, rel=0.005)
