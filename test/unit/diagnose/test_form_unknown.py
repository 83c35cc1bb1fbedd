# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What remains beside an effect: its own law, which is none of its forms, or another cause."""

from dataclasses import replace
import json

import numpy as np
import pytest
from residual_functions import linear, times

from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.form_unknown import in_errors
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report.received import diagnosis_from
from quad_ident_ros.report.verdict import form_of, next_step, verdict_line

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('form_unknown')]
NOMINAL = load_vehicle('hummingbird')
DRAG = 0.3 * NOMINAL.mass     # kg/s
EFFECTS = ['rotor_drag', 'mass_offset', 'motor_lag']     # few: the search is no matter here
COURSES = ('figure8', 'lissajous', 'steps', 'lissajous')     # the last one is held out


def both(one, other):
    """Return the sum of two residual functions of one input each."""
    return replace(one, inputs=(*one.inputs, *other.inputs))


# A force across the velocity of the air: no law of drag has one.
ACROSS = both(linear('air_y', (DRAG, 0.0, 0.0, 0.0, 0.0, 0.0)),
              linear('air_x', (0.0, -DRAG, 0.0, 0.0, 0.0, 0.0)))
# A force to the side that grows with the height, whatever the velocity: no drag.
HIGH = linear('height', (0.4, 0.0, 0.0, 0.0, 0.0, 0.0))

# A moment of the air about the mast: nobody's law of drag has one.
TURNING = linear('air_x', (0.0, 0.0, 0.0, 0.0, 0.0, 0.01))


def found_of(residual):
    """Return the diagnosis of what flew with a drag of the rotors and a further force."""
    vehicle = replace(NOMINAL, residual=residual)
    flights = [fly_closed_loop(vehicle, {'rotor_drag': {'coefficient': DRAG}}, course,
                               duration=10.0, seed=k, noise=SENSORS['mocap_imu'])
               for k, course in enumerate(COURSES)]
    return diagnose(flights, NOMINAL, effects=EFFECTS)


@pytest.fixture(scope='module')
def across():
    return found_of(ACROSS)


def test_what_comes_and_goes_with_an_effect_is_its_form(across):
    assert across.verdict == ('rotor_drag',)
    assert across.form_unknown == ('rotor_drag',)
    assert {row.channel for row in across.unknown[:2]} == {'Fx', 'Fy'}


def test_a_form_that_fits_badly_is_told_where_nothing_would_be_unknown():
    """It explains more than half of the effect, and less than formulas usually do."""
    found = found_of(times(0.5, ACROSS))
    row = found.ranking[0]
    assert found.verdict == found.form_unknown == ('rotor_drag',)
    assert 0.5 < row.explained < 0.8
    assert {one.channel for one in found.unknown[:2]} == {'Fx', 'Fy'}


def test_a_form_that_fits_as_well_as_formulas_do_is_not_said_to_be_unknown():
    found = found_of(times(0.1, ACROSS))
    assert found.verdict == ('rotor_drag',)
    assert found.form_unknown == found.unknown == ()


def test_what_does_not_is_unknown():
    found = found_of(HIGH)
    assert found.verdict == ('rotor_drag', 'unknown')
    assert found.form_unknown == ()


def test_what_turns_and_comes_and_goes_with_what_pushes_is_its_form():
    """All of the force is explained, but nothing of the moment."""
    found = found_of(TURNING)
    row = found.ranking[0]
    assert found.verdict == found.form_unknown == ('rotor_drag',)
    assert found.unknown[0].channel == 'Mz'
    assert row.explained > 0.9
    assert f'{100 * row.explained:.0f} % of it explained' in verdict_line(found)


def test_one_block_of_time_has_no_standard_error_and_tells_nothing():
    """Half of a flight of four seconds is held out."""
    gained = np.ones(40)
    assert in_errors(gained, np.zeros(40, int)) == 0.0
    assert in_errors(gained, np.arange(40) // 15) == pytest.approx(40 / np.std([15, 15, 10])
                                                                   / np.sqrt(3))


def test_it_is_told_with_the_share_that_the_nearest_form_explains(across):
    row = across.ranking[0]
    share = f'{100 * row.explained:.0f} %'
    assert 0.2 < row.explained < 0.8
    assert f'form unknown: {share} of it explained by {row.form}' in verdict_line(across)
    assert form_of(across, row) == f'unknown; nearest: {row.form}, {share}'
    assert '--residual' in next_step(across)


def test_it_travels_as_data(across):
    data = json.loads(json.dumps(across.as_data()))
    assert data['form_unknown'] == ['rotor_drag'] and data['verdict'] == ['rotor_drag']
    assert diagnosis_from(data, NOMINAL).form_unknown == across.form_unknown


def test_of_a_force_and_a_moment_that_nothing_explains_both_are_told():
    found = found_of(both(HIGH, TURNING))
    assert found.verdict[-1] == 'unknown'
    assert {row.channel[0] for row in found.unknown} == {'F', 'M'}
