# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Verdicts on simulated flights whose truth is known: each effect, none, several, unknown ones."""

from dataclasses import replace
import io

import numpy as np
import pytest

from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import Noise, Sensors
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report.diagnosis import show

pytestmark = pytest.mark.slow
# With a drag that is known: without any no wind is felt.
VEHICLE = replace(load_vehicle('hummingbird'), linear_drag=(0.15, 0.15, 0.15))
HALF = Noise(position=7e-4, velocity=7e-3, attitude=1.4e-3, rate=7e-3, voltage=0.01)
WHITE, COLOURED = Sensors(white=HALF), Sensors(white=HALF, coloured=HALF, correlation_time=0.1)
COURSES = ('figure8', 'low_passes', 'steps', 'lissajous')     # the last one is held out
HOVER = np.sqrt(VEHICLE.mass * VEHICLE.gravity
                / (len(VEHICLE.rotors) * VEHICLE.thrust_coefficient))
DRAG = {'rotor_drag': {'coefficient': 0.15}}
PAYLOAD = {'mass_offset': {'mass': 0.03}}
SAG = {'battery_sag': {'per_volt': 0.05}}


def flown(truth, noise=WHITE, seed=0):
    return [fly_closed_loop(VEHICLE, truth, course, duration=12.0, seed=seed + k, noise=noise)
            for k, course in enumerate(COURSES)]


def as_if(record, told):
    """Return a record whose commands are a function of what the rotors were given."""
    columns = {f'cmd{j}': told(record.columns[f'cmd{j}']) for j in range(1, 5)}
    return replace(record, columns=record.columns | columns)


def without_voltage(record):
    columns = {name: values for name, values in record.columns.items() if name != 'vbat'}
    return replace(record, columns=columns)


def with_play(commands, width=0.03 * HOVER):
    """Return commands that the rotors followed through a play of some width."""
    told = [commands[0]]
    for command in commands[1:]:
        told.append(np.clip(told[-1], command - width, command + width))
    return np.array(told)


def check(data, truth):
    """
    Check verdict, parameters and what is closed against the truth.

    Beside others an effect may be too small to matter; one alone may not.
    """
    minor = {row['effect'] for row in data['minor']} if len(truth) > 1 else set()
    assert set(data['verdict']) <= set(truth) <= set(data['verdict']) | minor
    rows = {row['effect']: row for row in data['ranking']}
    for effect, parameters in truth.items():
        # Of what closes little, less is certain.
        small = effect in minor or rows[effect]['contribution'] < 0.2
        assert rows[effect]['probability'] > (0.5 if small else 0.9)
        for name, value in parameters.items():
            found = rows[effect]['parameters'][name]
            assert abs(found['value'] - value) < 4.5 * found['std'], (effect, name)
    before, after, noise = (data['gap'][when] for when in ('before', 'after', 'noise'))
    most = max(before, key=lambda group: before[group] / noise[group])
    assert before[most] - after[most] > 0.9 * (before[most] - noise[most]) > 0.0


@pytest.mark.parametrize('loss, factor', [(0.01, 1.02), (0.05, 1.05), (0.1, 1.1)])
def test_a_weak_rotor_is_not_the_opposite_one_that_is_strong(loss, factor):
    """With other thrust of all rotors both do nearly the same."""
    truth = {'rotor_fault': {'loss_1': loss}, 'thrust_scale': {'factor': factor}}
    check(diagnose(flown(truth), VEHICLE).as_data(), truth)


@pytest.mark.parametrize('parameter, form, rotor', [
    ('loss', 'thrust', 3), ('loss_both', 'thrust_and_torque', 2),
    ('loss_both', 'thrust_and_torque', 3)])     # rotors 2 and 3 turn opposite ways
def test_a_weak_rotor_is_named_with_what_it_loses(parameter, form, rotor):
    """Where its torque is taken for the nominal one, the gap of the rate stays open."""
    loss, name = 0.06, f'{parameter}_{rotor}'
    truth = {'rotor_fault': {name: loss}}
    data = diagnose(flown(truth), VEHICLE).as_data()
    check(data, truth)
    row = data['ranking'][0]
    assert (row['effect'], row['form'], list(row['parameters'])) == ('rotor_fault', form, [name])
    found = row['parameters'][name]
    assert abs(found['value'] - loss) < 3.0 * found['std']
    for group, gap in data['gap']['after'].items():
        assert gap < 1.3 * data['gap']['noise'][group], group


def test_where_nothing_but_noise_is_left_the_verdict_is_none():
    data = diagnose(flown({}, COLOURED, seed=10), VEHICLE).as_data()
    assert data['verdict'] == ['none']
    # Noise with a memory is noise, too: it opens no gap.
    for group in ('velocity', 'attitude'):
        assert data['gap']['before'][group] == pytest.approx(data['gap']['noise'][group], rel=0.2)


def test_noise_with_a_memory_is_not_held_against_the_share_that_is_closed():
    check(diagnose(flown(PAYLOAD, COLOURED, seed=20), VEHICLE).as_data(), PAYLOAD)


def swinging(commands):
    """Return commands without a swing that the thrust has, at half a hertz."""
    wave = np.sin(np.pi * 0.01 * np.arange(len(commands)))
    return commands * np.sqrt(1.0 + 0.1 * wave)


def test_another_exponent_of_the_thrust_is_a_form_of_thrust_scale():
    found = diagnose([as_if(record, lambda commands: HOVER * (commands / HOVER) ** 0.7)
                      for record in flown({}, seed=30)], VEHICLE)
    [row] = [row for row in found.ranking if row.effect == 'thrust_scale']
    assert found.verdict[0] == 'thrust_scale' and row.form == 'exponent'
    assert row.parameters['exponent'].value == pytest.approx(2.0 / 0.7, rel=0.005)
    # The torque of the rotors follows the same law; the form has that of the thrust alone.
    assert set(found.verdict) <= {'thrust_scale', 'inertia_mismatch'}


@pytest.mark.parametrize('told', [swinging, with_play],
                         ids=['a swing of the thrust', 'play of the actuators'])
def test_what_no_effect_explains_is_unknown(told):
    data = diagnose([as_if(record, told) for record in flown({}, seed=30)], VEHICLE).as_data()
    assert 'unknown' in data['verdict']
    assert all(row['channel'] and row['depends_on'] for row in data['unknown'])
    assert data['gap']['after']['velocity'] > 1.1 * data['gap']['noise']['velocity']


def test_a_hover_is_no_reason_for_another_inertia():
    """What moves in hover is the noise, to which the controller replies."""
    hovers = [fly_closed_loop(VEHICLE, {}, 'hover', duration=12.0, seed=seed, noise=WHITE)
              for seed in (1, 101, 102)]
    assert diagnose(hovers, VEHICLE).as_data()['verdict'] == ['none']


def test_the_held_out_flight_takes_no_part_even_where_it_is_named_among_the_others():
    flights, effects = flown(PAYLOAD), ['mass_offset', 'rotor_drag']
    beside, alone = (diagnose(given, VEHICLE, hold_out=flights[1], effects=effects).as_data()
                     for given in (flights, [flights[0], *flights[2:]]))
    assert beside == alone


def test_what_is_learnt_does_not_depend_on_the_held_out_flight():
    *training, test = flown(SAG)
    fuller = replace(test, columns={**test.columns, 'vbat': test.columns['vbat'] + 0.3})
    one, other = (diagnose([*training, held], VEHICLE, effects=[*SAG, *PAYLOAD, *DRAG]).as_data()
                  for held in (test, fuller))
    assert one['verdict'] == ['battery_sag']
    # Its voltage says nothing of its thrust: the flight vetoes, and takes no part in the fit.
    assert 'unknown' in other['verdict']
    fitted = [{row['effect']: row['parameters'] for row in data['ranking']}['battery_sag']
              for data in (one, other)]
    assert fitted[0] == fitted[1]


def test_thrust_that_falls_with_the_voltage_is_named_alone_with_its_parameter():
    """The other effects are named alone in test_golden_verdicts."""
    check(diagnose(flown(SAG), VEHICLE).as_data(), SAG)


def test_thrust_that_falls_by_the_second_is_told_beside_a_voltage():
    flights = flown({'battery_sag': {'per_second': 0.003}})
    assert all(np.ptp(flight.columns['vbat']) > 0.1 for flight in flights)
    data = diagnose(flights, VEHICLE).as_data()
    check(data, {'battery_sag': {'per_second': 0.003}})
    assert list(data['ranking'][0]['parameters']) == ['per_second']


def test_a_held_out_flight_of_another_vehicle_is_told():
    other = replace(VEHICLE, mass=1.6 * VEHICLE.mass, inertia=tuple(1.5 * np.array(
        VEHICLE.inertia)), thrust_coefficient=1.3 * VEHICLE.thrust_coefficient)
    foreign = fly_closed_loop(other, {}, 'lissajous', duration=12.0, seed=9, noise=WHITE)
    *training, own = flown({'thrust_scale': {'factor': 1.15}})
    said = []
    for held_out in (own, foreign):
        stream = io.StringIO()
        show(diagnose([*training, held_out], VEHICLE, effects=['thrust_scale', *DRAG]), stream)
        said.append('by another vehicle' in stream.getvalue())
    assert said == [False, True]


@pytest.mark.parametrize('odd', [0, 2])
def test_each_flight_is_left_out_in_turn_and_the_one_that_differs_is_named(odd):
    flights = flown(DRAG)
    loaded = replace(VEHICLE, mass=1.3 * VEHICLE.mass)
    flights[odd] = fly_closed_loop(loaded, DRAG, 'lissajous', duration=12.0, seed=9, noise=WHITE)
    checks = diagnose(flights, VEHICLE).flight_checks
    assert [one.differs for one in checks] == [k == odd for k in range(len(flights))]


def test_a_vehicle_that_is_lost_within_half_a_second_is_found():
    """The model without effects turns over: no slope at it leads to the truth."""
    truth = {'com_offset': {'x': 0.006, 'y': -0.008, 'z': 0.004},
             'inertia_mismatch': {'factor_x': 1.6, 'factor_y': 1.5, 'factor_z': 1.4},
             'thrust_scale': {'factor': 0.9}}
    data = diagnose(flown(truth), VEHICLE).as_data()
    assert data['gap']['before']['attitude'] > 1.0
    check(data, truth)


def test_a_flight_that_is_given_twice_is_refused():
    flights = flown({})
    with pytest.raises(InputError, match='given twice'):
        diagnose([*flights, flights[0]], VEHICLE)
    with pytest.raises(InputError, match='in addition to the one that is held out'):
        diagnose(flights[:1], VEHICLE, hold_out=flights[0])


def test_a_battery_that_empties_is_found_in_a_single_flight():
    truth = {'battery_sag': {'per_second': 0.003}}
    record = fly_closed_loop(VEHICLE, truth, 'lissajous', duration=40.0, seed=3, noise=WHITE)
    check(diagnose([without_voltage(record)], VEHICLE).as_data(), truth)


def test_a_battery_that_was_not_full_is_one_cause_where_nobody_saw_its_voltage():
    """A thrust that is less and a battery that empties move a vehicle just so."""
    flights = flown({'thrust_scale': {'factor': 0.95}, 'battery_sag': {'per_second': 0.003}})
    seen, unseen = (diagnose(some, VEHICLE) for some in (
        flights, [without_voltage(record) for record in flights]))
    assert set(seen.verdict) == {'thrust_scale', 'battery_sag'}
    assert unseen.verdict == ('battery_sag',)
    row = unseen.ranking[0]
    assert row.form == 'spent'
    # How much of it the battery had lost before is not said without saying what would tell.
    assert 'a recorded voltage' in unseen.one_finding[0]['tells']
    for name, value in (('spent', 0.05), ('fall', 0.95 * 0.003)):
        assert abs(row.parameters[name].value - value) < 4.0 * row.parameters[name].std


def test_what_is_taken_out_as_improbable_is_in_the_standard_errors_of_the_others():
    flights = flown({'rotor_drag': {'coefficient': 0.15},
                     'body_drag': {'horizontal': 0.03, 'vertical': 0.03}})
    # The second drag is there; who asks for more probability than it has gets the first alone.
    names = ['rotor_drag', 'body_drag']
    more, less = sorted((row.probability for row in diagnose(
        flights, VEHICLE, effects=names).ranking), reverse=True)
    found = diagnose(flights, VEHICLE, effects=names,
                     rules=replace(RULES, present=0.5 * (more + less)))
    rows = {row.effect: row for row in found.ranking}
    assert found.verdict[0] == 'rotor_drag' and 'body_drag' not in found.verdict
    assert 0.5 < rows['body_drag'].probability == less < more
    drag = rows['rotor_drag'].parameters['coefficient']
    assert drag.value - 0.15 > 0.02     # it does the other one's work
    assert abs(drag.value - 0.15) < 1.25 * drag.std
    whole = found.covariance
    place = whole.names.index('rotor_drag.coefficient')
    assert np.sqrt(whole.matrix[place, place]) == pytest.approx(drag.std, rel=0.2)
