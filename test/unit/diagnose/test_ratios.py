# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Of thrust and mass, the one beside which fewer effects are needed."""

from dataclasses import replace

import pytest

from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.candidates import candidates
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.judgement import judge
from quad_ident_ros.diagnose.ratios import in_fewest
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.select import _Search
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.parameters import nominal
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
COURSES = ('lissajous', 'figure8', 'lissajous')


def found_beside(effects, ratio, vehicle=VEHICLE):
    """Return Bench and Judgement of flights with effects, by a set of this ratio and moments."""
    records = [fly_closed_loop(VEHICLE, effects, course, duration=12.0, seed=seed,
                               noise=SENSORS['mocap_imu']) for seed, course in enumerate(COURSES)]
    intake = take_in(records, vehicle, None, RULES)
    causes = candidates(intake.flights, vehicle, RULES,
                        ['thrust_scale', 'mass_offset', 'inertia_mismatch'])
    search = _Search(intake.flights, vehicle, causes, RULES)
    search.look_among(causes, lambda share: None)
    search.settle()
    chosen = tuple(one for one in causes if one.form == 'moments' or one.effect == ratio
                   and one.usual)
    best = search.tried[search.best.chosen]
    search.fit(chosen, nominal(vehicle), best.nuisances, best.starts)
    search.try_other_ratios(chosen)
    search.best = search.judge(chosen)
    selection = search.selection()
    bench = Bench.of(intake.flights, (*intake.tracks, intake.held_out), vehicle, selection, RULES)
    return bench, judge(bench)


def names(judged):
    return {cause.effect for cause in judged.material}


@pytest.mark.slow
def test_a_thrust_is_no_mass_with_other_moments():
    bench, judged = found_beside({'thrust_scale': {'factor': 1.05}}, 'mass_offset')
    assert names(judged) == {'mass_offset', 'inertia_mismatch'}
    bench, fewest = in_fewest(bench, judged)
    assert names(fewest) == {'thrust_scale'}
    assert bench.selection.twin is None
    assert max((chance for cause, chance in bench.selection.posterior.items()
                if cause.effect == 'mass_offset'), default=0.0) < 0.05


@pytest.mark.slow
def test_what_takes_as_many_effects_stays():
    moments = {'arms_x': 1.15, 'arms_y': 1.2, 'torque': 1.1}
    bench, judged = found_beside({'mass_offset': {'mass': 0.05}, 'inertia_mismatch': moments},
                                 'mass_offset')
    assert bench.selection.twin is not None
    assert in_fewest(bench, judged) == (bench, judged)
    assert names(judged) == {'mass_offset', 'inertia_mismatch'}


@pytest.mark.slow
def test_a_thrust_by_itself_stays():
    bench, judged = found_beside({'thrust_scale': {'factor': 1.05}}, 'thrust_scale')
    assert bench.selection.twin is not None
    assert names(judged) == {'thrust_scale'}
    assert in_fewest(bench, judged) == (bench, judged)


@pytest.mark.slow
def test_a_mass_that_the_file_knows_takes_the_place_of_no_thrust():
    weighed = replace(VEHICLE, uncertainty={'mass': 0.002 * VEHICLE.mass})
    mass = {'mass_offset': {'mass': 0.05 * VEHICLE.mass}}
    assert found_beside(mass, 'thrust_scale')[0].selection.twin is not None
    assert found_beside(mass, 'thrust_scale', weighed)[0].selection.twin is None
