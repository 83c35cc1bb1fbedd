# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The evidence of sets of causes by the linear model, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.evidence import beam, excludes, linear_evidence, occam, Quadratic
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.greybox.nuisances import LIKELY, Nuisance, RARE

RULES = Rules(prior_probability=0.03)
CAUSES = tuple(Candidate(name, name, (k,), share=share) for k, (name, share) in enumerate(
    (('motor_lag', 1.0), ('rotor_drag', 0.5), ('wind', 1.0))))
ROWS = {cause: [k] for k, cause in enumerate(CAUSES)}
WIDE = np.array([1.0, 2.0, 3.0])
FREE = np.full(3, np.inf)


def quadratic(information, best, rest=10.0, lower=-FREE, upper=FREE):
    """Return the Quadratic, from no effect on, of a cost that is `rest` at its best point."""
    information, best = np.asarray(information, float), np.asarray(best, float)
    return Quadratic(information, information @ best, rest + best @ information @ best,
                     np.zeros(3), np.diag(WIDE ** -2.0), lower, upper, 1.0)


def expected(cost, chosen):
    """Return the evidence of causes: log of the Gaussian integral over their parameters."""
    free = [k for cause in chosen for k in ROWS[cause]]
    block = cost.information[np.ix_(free, free)]
    precision = block + np.diag(WIDE[free] ** -2.0)
    least = cost.cost - cost.gradient[free] @ np.linalg.solve(precision, cost.gradient[free])
    volume = 0.5 * np.log(np.linalg.det(precision)) + np.sum(np.log(WIDE[free]))
    prior = sum(np.log(0.03 * cause.share / (1.0 - 0.03 * cause.share)) for cause in chosen)
    return -0.5 * least - volume + prior


SETS = [(), CAUSES[:1], CAUSES[1:2], CAUSES[:2], (CAUSES[0], CAUSES[2]), CAUSES]
TIED = [[50.0, 30.0, 0.0], [30.0, 40.0, 5.0], [0.0, 5.0, 20.0]]


def test_the_evidence_is_the_integral_over_the_parameters():
    cost = quadratic(TIED, [0.5, -1.0, 0.2])
    values = linear_evidence(cost, SETS, ROWS, RULES)[0]
    assert values == pytest.approx([expected(cost, chosen) for chosen in SETS], rel=1e-12)


def test_it_does_not_depend_on_where_the_cost_was_linearised():
    here, at = quadratic(TIED, [0.5, -1.0, 0.2]), np.array([0.3, 0.1, -0.4])
    there = replace(here, now=at, gradient=here.gradient - here.information @ at,
                    cost=here.cost - 2.0 * here.gradient @ at + at @ here.information @ at)
    for one, other in zip(*(linear_evidence(cost, SETS, ROWS, RULES) for cost in (here, there)),
                          strict=True):
        assert one == pytest.approx(other, rel=1e-10, abs=1e-12)


def test_a_cause_that_could_only_help_beyond_its_bound_is_none():
    cost = quadratic(TIED, [0.5, -1.0, 0.2], lower=np.zeros(3))
    values, found = linear_evidence(cost, [CAUSES[1:2], CAUSES[:2]], ROWS, RULES)
    assert np.isneginf(values).all() and (found >= 0.0).all()


def test_a_parameter_ends_at_its_bound():
    cost = quadratic(np.diag([50.0, 40.0, 20.0]), [0.5, -1.0, 0.2], upper=np.full(3, 0.25))
    _, found = linear_evidence(cost, [CAUSES[:1]], ROWS, RULES)
    assert found[0, 0] == 0.25


def test_the_beam_ranks_the_causes_that_are_there_first():
    cost = quadratic(TIED, [2.0, 0.0, -1.5])
    ranked = beam(cost, ROWS, RULES)
    assert ranked[0][1] == (CAUSES[0], CAUSES[2])
    values = [value for value, _, _ in ranked]
    assert values == sorted(values, reverse=True)
    assert {chosen for _, chosen, _ in ranked} >= {(), CAUSES}


def test_forms_of_one_effect_and_the_two_of_a_ratio_never_stand_together():
    """Thrust and mass scale a motion by their quotient alone."""
    thrust, mass, inertia, other_thrust = (
        Candidate(name, name, (k,), form) for k, (name, form) in enumerate((
            ('thrust_scale', 'factor'), ('mass_offset', ''), ('inertia_mismatch', ''),
            ('thrust_scale', 'exponent'))))
    assert excludes(thrust, mass) and excludes(mass, thrust)
    assert excludes(thrust, other_thrust)
    assert not excludes(thrust, inertia) and not excludes(CAUSES[0], CAUSES[1])
    cost = quadratic(TIED, [2.0, 1.0, -1.5])
    ranked = beam(cost, {thrust: [0], mass: [1], inertia: [2]}, RULES)
    assert not [chosen for _, chosen, _ in ranked if {thrust, mass} <= set(chosen)]


def test_an_effect_stands_beside_a_nuisance_in_its_place():
    """What flights share is the effect, what differs is the nuisance."""
    bias = Nuisance('rate_bias', 'bias', 'rad/s', (0,), (0.01,), RARE)
    nuisance = Candidate('rate_bias', 'rate_bias', (0,), nuisance=bias)
    assert not excludes(Candidate('gyro_bias', 'gyro_bias', (0,)), nuisance)
    assert excludes(nuisance, nuisance)


def test_a_thrust_of_each_flight_stands_beside_that_of_all_and_not_beside_the_mass():
    """Mass and the thrust of all flights by one factor would be an inertia by its reciprocal."""
    own = Nuisance('thrust_scale_by_flight', 'thrust', '1', (0,), (0.03,), RARE, 'thrust_scale')
    nuisance = Candidate(own.name, own.name, (0,), nuisance=own)
    assert excludes(nuisance, Candidate('mass_offset', 'mass', (1,)))
    assert not excludes(nuisance, Candidate('thrust_scale', 'thrust', (0,)))
    assert not excludes(nuisance, Candidate('inertia_mismatch', 'inertia', (2,)))


def test_a_sensor_with_one_bias_may_have_others_and_the_air_has_nothing_to_do_with_it():
    def odds(*names):
        kinds = [Nuisance(name, name, '', (k,), (0.01,), RARE,
                          name.removesuffix('_by_flight') if 'by_flight' in name else '')
                 for k, name in enumerate(names)]
        return occam(np.zeros((2, 2)), np.eye(2), 1.0,
                     [Candidate(kind.name, kind.name, kind.columns, nuisance=kind)
                      for kind in kinds], RULES)

    rare, likely = np.log(RARE / (1.0 - RARE)), np.log(LIKELY / (1.0 - LIKELY))
    assert odds('rate_bias', 'attitude_bias') == pytest.approx(rare + likely)
    assert odds('thrust_scale_by_flight', 'wind_by_flight') == pytest.approx(2.0 * rare)
    assert odds('rate_bias', 'wind_by_flight') == pytest.approx(2.0 * rare)
