# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A form that does what feedback makes of wrong commands is looked for where none are wrong."""

from dataclasses import replace

import pytest

from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.candidates import candidates
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.judgement import judge
from quad_ident_ros.diagnose.like_feedback import is_like_feedback, with_like_feedback
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.select import select
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
UNLIKE = {'rotor_gyro': {'heavier_clockwise': 1e-5, 'heavier_counterclockwise': 2.5e-6}}
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('like_feedback')]


@pytest.fixture(scope='module')
def looked():
    """Return Bench, Judgement and all candidates, the search without such forms over."""
    records = [fly_closed_loop(VEHICLE, UNLIKE, course, duration=10.0, seed=seed,
                               noise=SENSORS['mocap_imu'])
               for seed, course in enumerate(('lissajous', 'figure8', 'lissajous'))]
    intake = take_in(records, VEHICLE, None, RULES)
    causes = candidates(intake.flights, VEHICLE, RULES, ['rotor_gyro', 'rotor_drag'])
    early = tuple(cause for cause in causes if not is_like_feedback(cause))
    selection = select(intake.flights, VEHICLE, early, RULES, lambda share: None)
    bench = Bench.of(intake.flights, (*intake.tracks, intake.held_out), VEHICLE, selection, RULES)
    return bench, judge(bench), causes


def forms(judged):
    return {(cause.effect, cause.form) for cause in judged.model.effects}


def test_it_is_found_where_the_commands_are_right(looked):
    bench, judged, causes = looked
    assert ('rotor_gyro', 'momentum_by_spin') not in forms(judged)
    beside, again, all_of_them = with_like_feedback(bench, judged, causes, lambda share: None)
    assert forms(again) == {('rotor_gyro', 'momentum_by_spin')}
    assert beside is not bench and all_of_them == causes


def test_where_the_commands_have_errors_all_stays(looked):
    bench, judged, causes = looked
    wrong = replace(bench, noise=replace(bench.noise, command_errors=True))
    same, still, early = with_like_feedback(wrong, judged, causes, lambda share: None)
    assert same is wrong and still is judged
    assert early == tuple(cause for cause in causes if not is_like_feedback(cause)) != causes


def test_what_the_vehicle_file_has_is_looked_for_at_once(looked):
    has_it = replace(VEHICLE, effects=UNLIKE)
    causes = candidates(looked[0].flights, has_it, RULES, ['rotor_gyro'])
    assert [cause.form for cause in causes if cause.usual] == ['momentum_by_spin']
    assert not any(is_like_feedback(cause) for cause in causes)
