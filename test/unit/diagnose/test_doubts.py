# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Between which causes flights cannot tell, by the evidence of sets."""

from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose.candidates import Candidate, candidates
from quad_ident_ros.diagnose.doubts import doubts_of
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
PERIOD = 0.01
MASS, THRUST, BIAS = (Candidate(name, name, (INDEX[f'{name}.{parameter}'],))
                      for name, parameter in (('mass_offset', 'mass'), ('thrust_scale', 'factor'),
                                              ('gyro_bias', 'x')))
DELAY, LAG, SLEW = (next(one for one in candidates([], VEHICLE, RULES) if one.form == form)
                    for form in ('pure_delay', 'first_order', 'slew'))


def selected(*sets, posterior, z=None):
    """Return a selection of sets of causes by their log-evidence, the best first."""
    vector = nominal(VEHICLE) if z is None else z
    fitted = [SimpleNamespace(causes=causes, evidence=evidence,
                              estimate=SimpleNamespace(z=vector)) for causes, evidence in sets]
    return SimpleNamespace(best=fitted[0], fitted=fitted, posterior=posterior)


def test_only_what_stands_in_its_place_is_a_rival():
    """The rate's bias is there or not with either of the two, and so is no rival."""
    sets = [((MASS,), 0.0), ((THRUST,), -0.4), ((MASS, BIAS), -0.1), ((THRUST, BIAS), -0.5),
            ((), -90.0)]
    unsure = selected(*sets, posterior={MASS: 0.6, THRUST: 0.4, BIAS: 0.5})
    doubts = doubts_of(unsure, (MASS,), RULES, PERIOD)
    assert list(doubts) == [MASS, THRUST]
    assert [fit.causes for fit in doubts.values()] == [(MASS,), (THRUST,)]
    sure = selected(*sets, posterior={MASS: 0.95, THRUST: 0.2, BIAS: 0.5})
    assert not doubts_of(sure, (MASS,), RULES, PERIOD)


def test_which_rotor_is_weak_is_no_doubt_between_effects():
    one, other = (Candidate('rotor_fault', f'rotor_fault {j}', (INDEX[f'rotor_fault.loss_{j}'],))
                  for j in (1, 2))
    found = selected(((one,), 0.0), ((other,), -0.1), posterior={one: 0.5, other: 0.5})
    assert not doubts_of(found, (one,), RULES, PERIOD)


def test_a_set_with_both_speaks_for_neither():
    """One of the two is needed; that both are a little better does not say which one it is."""
    found = selected(((MASS,), 0.0), ((MASS, THRUST), 1.0), ((THRUST,), -0.4), ((), -90.0),
                     posterior={MASS: 0.8, THRUST: 0.3})
    assert list(doubts_of(found, (MASS,), RULES, PERIOD)) == [MASS, THRUST]


def rivals(odds, delay, lag, other=LAG):
    """Return the doubts between a delay and a lag (s) that is less likely by odds."""
    z = nominal(VEHICLE)
    z[list(DELAY.columns)], z[list(other.columns)] = delay, lag
    share = 1.0 / (1.0 + odds)
    found = selected(((DELAY,), 0.0), ((other,), -np.log(odds)), ((), -90.0), z=z,
                     posterior={DELAY: 1.0 - share, other: share})
    return list(doubts_of(found, (DELAY,), RULES, PERIOD))


@pytest.mark.parametrize('delay, lag, told', [
    (0.004, 0.004, False),      # both are over before the next sample
    (0.012, 0.004, True), (0.009, 0.009, True)])
def test_a_delay_and_a_lag_within_a_period_take_very_strong_evidence(delay, lag, told):
    assert rivals(100.0, delay, lag) == ([] if told else [DELAY, LAG])
    assert not rivals(200.0, delay, lag)
    assert rivals(5.0, delay, lag) == [DELAY, LAG]


def test_a_slew_that_is_limited_is_of_no_one_length():
    assert not rivals(100.0, 0.004, 0.004, SLEW)
