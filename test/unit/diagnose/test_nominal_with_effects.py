# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A vehicle file with effects as the nominal one: what is named is what differs from it."""

from dataclasses import replace
import io

import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.candidates import candidates
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.fitted import columns_at_bounds
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU, Noise, Sensors
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.greybox.rotor_answer import RotorAnswer, ruled_out_by
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.report.diagnosis import show

BARE = load_vehicle('hummingbird')
TRUTH = {'motor_lag': {'time_constant': 0.04}, 'rotor_drag': {'coefficient': 0.3}}
WHITE = Sensors(white=Noise(position=7e-4, velocity=7e-3, attitude=1.4e-3, rate=7e-3))
COURSES = ('figure8', 'steps', 'lissajous')


def simulator(**effects):
    """Return the vehicle of the file: the truth but for some effects."""
    return replace(BARE, effects={name: values for name, values in {**TRUTH, **effects}.items()
                                  if values})


@pytest.fixture(scope='module')
def flights():
    return [fly_closed_loop(BARE, TRUTH, course, duration=10.0, seed=k, noise=WHITE)
            for k, course in enumerate(COURSES)]


def without_speeds(records):
    """Return records without measured rotor speeds: motors show only in the motion."""
    return [FlightRecord(record.t, {name: values for name, values in record.columns.items()
                                    if not name.startswith('rotor')}, record.info)
            for record in records]


def row_of(found, effect):
    [row] = [row for row in found.ranking if row.effect == effect]
    return row


@pytest.mark.slow
def test_where_the_file_has_what_the_vehicle_has_the_verdict_is_none(flights):
    found = diagnose(flights, simulator())
    assert found.verdict == ('none',)
    for group in ('velocity', 'attitude'):
        assert found.gap.before[group] == pytest.approx(found.gap.noise[group], rel=0.2)
    assert found.corrected(simulator()).effects == TRUTH


@pytest.mark.slow
def test_a_file_with_half_the_drag_has_the_other_half_to_gain(flights, tmp_path):
    file = simulator(rotor_drag={'coefficient': 0.15})
    found = diagnose(flights, file)
    assert found.verdict == ('rotor_drag',)
    drag = row_of(found, 'rotor_drag').parameters['coefficient']
    assert abs(drag.value - 0.3) < 4.5 * drag.std
    assert drag.change == pytest.approx(drag.value - 0.15)
    assert found.gap.before['velocity'] > 3.0 * found.gap.noise['velocity']
    out = io.StringIO()
    show(found, out)
    assert 'against the file)' in ' '.join(out.getvalue().split())
    write_vehicle(tmp_path / 'v.yaml', found.corrected(file))
    assert load_vehicle(tmp_path / 'v.yaml').effects == {
        **TRUTH, 'rotor_drag': {'coefficient': drag.value}}
    # What was corrected has nothing more to gain.
    assert diagnose(flights, load_vehicle(tmp_path / 'v.yaml'),
                    effects=['rotor_drag', 'body_drag', 'motor_lag']).verdict == ('none',)


@pytest.mark.slow
@pytest.mark.parametrize('lag', [0.02, 0.06])
def test_a_lag_that_is_off_is_named_with_its_total(flights, lag):
    found = diagnose(without_speeds(flights), simulator(motor_lag={'time_constant': lag}))
    assert found.verdict == ('motor_lag',)
    told = row_of(found, 'motor_lag').parameters['time_constant']
    assert abs(told.value - 0.04) < 4.5 * told.std
    assert told.change == pytest.approx(told.value - lag)


@pytest.mark.slow
def test_an_effect_that_the_vehicle_has_not_ends_at_none(flights):
    """A file may have too much: the bound of no effect is no sign of another one."""
    file = simulator(body_drag={'horizontal': 0.1, 'vertical': 0.1})
    found = diagnose(flights, file)
    assert found.verdict == ('body_drag',)
    for one in row_of(found, 'body_drag').parameters.values():
        assert one.value == pytest.approx(0.0, abs=0.01) and one.change < -0.09
    assert not {one['code'] for one in found.findings} & {'at_bound'}


def test_only_what_is_no_bound_of_the_file_s_own_effect_is_at_a_bound():
    file = simulator()
    [drag] = [one for one in candidates([], file, RULES, ['rotor_drag']) if one.usual]
    z = nominal(file)
    z[INDEX['rotor_drag.coefficient']] = 0.0
    assert columns_at_bounds(drag, z, file, RULES) == []
    z[INDEX['rotor_drag.coefficient']] = 5.0 * file.mass
    assert columns_at_bounds(drag, z, file, RULES) == [INDEX['rotor_drag.coefficient']]


def test_the_law_of_the_file_is_the_one_that_is_tried_first():
    file = simulator(motor_lag={'rise': 0.03, 'fall': 0.05})
    [usual] = [one for one in candidates([], file, RULES, ['motor_lag']) if one.usual]
    assert usual.form == 'rise_fall' and usual.plain
    np.testing.assert_array_equal(nominal(file)[list(usual.columns)], [0.03, 0.05])
    # Another law stands beside it, from none.
    other = next(one for one in candidates([], file, RULES, ['motor_lag'])
                 if one.form == 'first_order')
    assert nominal(file)[list(other.columns)] == 0.0


def test_measured_speeds_speak_against_another_lag_than_that_of_the_file():
    answer = RotorAnswer((0.0, 1e-4), (0.03, 1e-4), (1.0, 0.0), None, 0.99)
    assert ruled_out_by([answer], RULES.shown, {'motor_lag': {'time_constant': 0.03}}) == (
        'motor_lag', 'actuation_delay')
    assert ruled_out_by([answer], RULES.shown, {'motor_lag': {'time_constant': 0.05}}) == (
        'actuation_delay',)
    assert ruled_out_by([answer], RULES.shown, {'actuation_delay': {'delay': 0.02}}) == ()
    assert 'motor_lag' not in ruled_out_by([replace(answer, lag=(0.0, 1e-4))], RULES.shown,
                                           {'motor_lag': {'rise': 0.03}})


@pytest.mark.slow
def test_measured_speeds_have_gone_through_the_motors():
    """Where they drive the model in place of commands the file's lag would act twice."""
    records = [fly_closed_loop(BARE, TRUTH, course, duration=6.0, seed=k)
               for k, course in enumerate(COURSES)]
    driven = [FlightRecord(record.t, {name: values for name, values in record.columns.items()
                                      if not name.startswith('cmd')}, record.info)
              for record in records]
    taken = take_in(driven, simulator(), None, RULES)
    assert taken.vehicle.effects == {'rotor_drag': TRUTH['rotor_drag']}
    [said] = [one for one in taken.findings if one['code'] == 'left_out']
    assert said['message'].startswith('lag of the motors (motor_lag) of the vehicle file')
    with pytest.raises(InputError, match=r'with lag of the motors \(motor_lag\) in the'):
        take_in([records[0], *driven[1:]], simulator(), None, RULES)
    assert take_in(records, simulator(), None, RULES).vehicle.effects == TRUTH


@pytest.mark.slow
def test_the_force_of_the_air_is_in_what_an_accelerometer_measured():
    file = simulator(ground_effect={'strength': 2.0})
    records = [fly_closed_loop(BARE, file.effects, course, duration=6.0, rate=200.0, seed=k,
                               noise=MOCAP_IMU) for k, course in enumerate(COURSES[:2])]
    bare = [FlightRecord(record.t, {name: values for name, values in record.columns.items()
                                    if name[0] in 'wa' or name.startswith('cmd')}, record.info)
            for record in records]
    taken = take_in(bare, file, None, RULES)
    assert taken.vehicle.effects == {'motor_lag': TRUTH['motor_lag']}
