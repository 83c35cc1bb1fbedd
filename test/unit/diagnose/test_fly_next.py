# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What flights leave open, and whether the proposed manoeuvre then settles it."""

import io
import json
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.evidence import Quadratic
from quad_ident_ros.diagnose.fly_next import fly_next, separation, visibility
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU, Sensors
from quad_ident_ros.flight.trajectories import TRAJECTORIES
from quad_ident_ros.greybox.flights import flight_of, track_of
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report.diagnosis import show

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('fly_next')]   # they share diagnoses
VEHICLE = load_vehicle('hummingbird')
WHITE = Sensors(white=MOCAP_IMU.white)
# Weaker thrust gives weaker moments, too: above this size they show in a hover which it is.
PAYLOAD = {'mass_offset': {'mass': 0.012 * VEHICLE.mass}}
WEAKER = {'thrust_scale': {'factor': 0.988}}
# Half of it beside a tilt: the flights of the test would settle the whole.
TILTED = {'attitude_misalignment': {'roll': 0.03, 'pitch': -0.02},
          'mass_offset': {'mass': 0.006 * VEHICLE.mass}}
ALIKE = ['mass_offset', 'thrust_scale']


def fly(truth, trajectory, seed, duration=20.0):
    return fly_closed_loop(VEHICLE, truth, trajectory, duration=duration, seed=seed, noise=WHITE)


def hovers(truth):
    return [fly(truth, 'hover', seed, 10.0) for seed in (1, 2)]


def probabilities(found):
    return {row.effect: row.probability for row in found.ranking}


@pytest.fixture(scope='module', params=['mass_offset', 'thrust_scale'])
def doubtful(request):
    """Return the truth, hovers of it and what a diagnosis finds in them."""
    truth = {'mass_offset': PAYLOAD, 'thrust_scale': WEAKER}[request.param]
    flights = hovers(truth)
    return truth, flights, diagnose(flights, VEHICLE)


def proposal(found):
    [one] = [one for one in found.fly_next if one['purpose'] == 'separate']
    return one


def flown_as(doubtful, trajectory):
    """Return what is found once a manoeuvre of the proposal was flown, too."""
    truth, flights, found = doubtful
    one = proposal(found)
    more = fly(truth, trajectory, one['seed'], one['duration'])
    return diagnose([flights[0], more], VEHICLE, hold_out=flights[1])


def test_a_hover_does_not_tell_a_payload_from_weaker_thrust(doubtful):
    found = doubtful[2]
    assert found.verdict == ('undetermined',) and found.undetermined == tuple(ALIKE)
    # Exactly one of them is present.
    assert 0.9 < sum(probabilities(found)[name] for name in ALIKE) < 1.05
    one = proposal(doubtful[2])
    assert one['effects'] == ALIKE
    assert one['now'] < 1.0 < 5.0 < one['after'] == one['manoeuvres'][one['trajectory']]
    assert set(one['manoeuvres']) == set(TRAJECTORIES)
    assert list(one['manoeuvres'].values()) == sorted(one['manoeuvres'].values(), reverse=True)


def test_the_manoeuvre_proposed_tells_them_apart(doubtful):
    found = flown_as(doubtful, proposal(doubtful[2])['trajectory'])
    assert found.verdict == tuple(doubtful[0])
    [rival] = set(ALIKE) - set(doubtful[0])
    assert probabilities(found)[rival] < 0.01


@pytest.mark.parametrize('doubtful', ['mass_offset'], indirect=True)
def test_the_manoeuvre_ranked_last_does_not(doubtful):
    last = list(proposal(doubtful[2])['manoeuvres'])[-1]
    found = flown_as(doubtful, last)
    assert set(ALIKE) <= set(found.undetermined)
    assert all(probabilities(found)[name] > 0.1 for name in ALIKE)


def test_more_hovering_is_worth_nothing(doubtful):
    one = proposal(doubtful[2])
    assert one['manoeuvres']['hover'] == pytest.approx(one['now'], rel=0.05)


def test_a_sure_effect_is_named_beside_those_that_are_not():
    found = diagnose(hovers(TILTED), VEHICLE)
    assert found.verdict == found.sure == ('attitude_misalignment',)
    assert found.undetermined == tuple(ALIKE)
    text = io.StringIO()
    show(found, text)
    first = text.getvalue().splitlines()[0]
    assert first.startswith('verdict: misaligned attitude or gyro (attitude_misalignment), ')
    assert first.endswith('; beside it, the flights cannot distinguish between error in mass '
                          '(mass_offset) and error in thrust (thrust_scale)')
    assert 'what to fly next' in text.getvalue()
    proposals = found.fly_next
    assert json.loads(json.dumps(proposals)) == proposals


@pytest.fixture(scope='module')
def nothing():
    """Return hovers of the nominal vehicle and what a diagnosis finds in them."""
    flights = hovers({})
    return flights, diagnose(flights, VEHICLE)


def test_what_a_hover_could_not_show_is_said_and_what_would(nothing):
    found = nothing[1]
    assert found.verdict == ('none',)
    assert {'rotor_drag', 'ground_effect'} <= set(found.not_shown)
    assert not {'mass_offset', 'com_offset', 'gyro_bias'} & set(found.not_shown)
    [low] = [one for one in found.fly_next if 'ground_effect' in one['effects']]
    assert low['trajectory'] == 'low_passes' and low['height'][0] < 3 * VEHICLE.rotor_radius
    # Without drag nothing feels the wind, and no manoeuvre is proposed to see it.
    assert 'wind' in found.not_shown
    assert all('wind' not in one['effects'] for one in found.fly_next)


def test_what_is_flown_then_is_seen_then(nothing):
    flights, found = nothing
    more = [fly({}, one['trajectory'], one['seed'], one['duration'])
            for one in found.fly_next]
    again = diagnose([flights[0], *more], VEHICLE, hold_out=flights[1])
    asked = {name for one in found.fly_next for name in one['effects']}
    assert asked and not asked & set(again.not_shown)


def test_a_sure_verdict_asks_for_no_flight():
    truth = {'rotor_drag': {'coefficient': 0.2}}
    found = diagnose([fly(truth, name, 1) for name in ('lissajous', 'figure8')], VEHICLE,
                     effects=['rotor_drag', 'wind', 'mass_offset', 'thrust_scale'])
    assert found.verdict == ('rotor_drag',)
    assert found.fly_next is None and not found.undetermined


def test_a_vehicle_that_cannot_fly_is_asked_for_nothing():
    """Three times as heavy it leaves every course."""
    flights = [flight_of(track_of(flight, VEHICLE)) for flight in hovers({})[:1]]
    z = nominal(VEHICLE)
    z[INDEX['mass_offset.mass']] = 3.0 * VEHICLE.mass
    selection = pair(0.9)
    assert fly_next(selection, flights, VEHICLE, z, (), {}, ['rotor_drag'], RULES) == []


def pair(correlation, third=None):
    """Return a selection between two causes a of a distance of 1, b, of an information of 100."""
    causes = [Candidate(name, name, (INDEX[f'{name}.{parameter}'],)) for name, parameter in (
        ('mass_offset', 'mass'), ('thrust_scale', 'factor'), ('gyro_bias', 'x'))]
    information = np.full((3, 3), 0.0)
    information[:2, :2] = 100 * np.array([[1.0, correlation], [correlation, 1.0]])
    information[2, 2] = 100.0
    if third is not None:
        information[:2, 2] = information[2, :2] = third
    quadratic = Quadratic(information, np.zeros(3), 0.0, np.array([1.0, 0.0, 0.0]),
                          np.eye(3) * (RULES.prior_width * 100.0) ** -2, np.full(3, -1e3),
                          np.full(3, 1e3), 1.0)
    rows = {cause: [k] for k, cause in enumerate(causes)}
    return SimpleNamespace(quadratic=quadratic, rows=rows, noise=[np.full(12, 1e-2)],
                           best=SimpleNamespace(chosen=(), nuisances=()))


def test_the_distance_of_two_causes_is_what_the_other_cannot_take_up():
    selection = pair(0.8)
    a, b, _ = selection.rows
    sets = {(a,): np.array([1.0, 0.0, 0.0]), (b,): np.array([0.0, 2.0, 0.0])}
    away = separation(selection.quadratic.information, selection, sets, RULES)
    assert away == pytest.approx(10.0 * np.sqrt(1.0 - 0.8 ** 2), rel=1e-4)
    assert separation(selection.quadratic.information, selection, {(a,): sets[(a,)]},
                      RULES) == np.inf


def test_a_further_cause_that_helps_the_rival_brings_them_closer():
    """With b and c together all that a does is explained; c costs what it does in the choice."""
    selection = pair(0.0, third=70.0)
    a, b, _ = selection.rows
    sets = {(a,): np.array([10.0, 0.0, 0.0]), (b,): np.array([0.0, 10.0, 0.0])}
    away = separation(selection.quadratic.information, selection, sets, RULES)
    assert 10.0 < away < 100.0 * 0.75


def test_an_effect_beside_another_that_looks_alike_is_less_visible():
    selection = pair(0.99)
    a, b, _ = selection.rows
    information = selection.quadratic.information
    alone = visibility(information, selection, [b], [], RULES)['thrust_scale']
    assert alone == pytest.approx(1000.0)
    beside = visibility(information, selection, [b], [a], RULES)['thrust_scale']
    assert beside == pytest.approx(1000.0 * np.sqrt(1.0 - 0.99 ** 2), rel=1e-3)
