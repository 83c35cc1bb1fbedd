# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Standard errors of a set whose formula is exact, and of one whose formula is not."""

from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.fitted import Fitted, size_grids
from quad_ident_ros.diagnose.frame import Frame, WRENCH
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.standard_errors import joint_of, OF_EACH
from quad_ident_ros.greybox.linear import Slopes, Tangent
from quad_ident_ros.greybox.nuisances import NuisanceValues
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
DRAG = Candidate('rotor_drag', 'by_speed', (INDEX['rotor_drag.coefficient'],))
BLOCKS, SAMPLES, NULLS = 60, 5, 12      # seconds, samples of 12 errors in each
VALUE, SLOPE = 0.5, 100.0               # of the parameter; of the velocity per it, in noises
ALL = np.ones(BLOCKS)                   # of what a second usually shows


def estimated(form_error, seed, shown=ALL, off=0.0):
    """
    Return the estimate of a parameter by least squares, and the Joint of it alone.

    From one rollout of SAMPLES per second whose velocity is noise and what a drag does that is
    wrong by a relative error of its own in each second. shown (BLOCKS,): how much of it each
    second shows; off: by how much the fit ends beside the best value.
    """
    rng = np.random.default_rng(seed)
    wanted = sorted({*DRAG.columns, *WRENCH})
    length = SAMPLES * NULLS
    table = np.zeros((BLOCKS, NULLS + len(wanted) + 1, length))
    does = np.zeros((SAMPLES, NULLS))
    does[:, 3] = SLOPE
    across = np.outer(shown, does.ravel())
    table[:, NULLS + wanted.index(DRAG.columns[0])] = across
    strength = VALUE * (1.0 + form_error * rng.normal(size=BLOCKS))
    errors = strength[:, None] * across + rng.normal(size=(BLOCKS, length))
    value = np.sum(across * errors) / np.sum(across ** 2) + off
    z = nominal(VEHICLE)
    z[DRAG.columns[0]] += value
    residuals = (errors - value * across).reshape(BLOCKS, SAMPLES, NULLS)
    fit = SimpleNamespace(z=z, vectors=[z], columns=list(DRAG.columns), residuals=[residuals],
                          nuisances=NuisanceValues.of((), 1))
    frame = Frame(wanted, [np.ones((BLOCKS, length))], [np.zeros((BLOCKS, length, NULLS))],
                  [np.arange(BLOCKS)], Slopes(z, wanted, [], [Tangent(table)]))
    grids = size_grids(VEHICLE, [np.ones(NULLS)], RULES)
    return value, joint_of(Fitted((DRAG,), fit, 0.0, (0, 0)), [], frame, VEHICLE, grids, 1.0,
                           RULES)


@pytest.mark.slow
@pytest.mark.parametrize('form_error', [0.0, 0.1, 0.3])
def test_estimates_scatter_about_the_truth_as_their_standard_errors_say(form_error):
    values, joints = zip(*(estimated(form_error, seed) for seed in range(200)), strict=True)
    values, errors = np.array(values), np.array([joint.errors[0] for joint in joints])
    # By least squares: noise over the slope, and the mean of the relative errors.
    expected = np.hypot(1.0 / (SLOPE * np.sqrt(BLOCKS * SAMPLES)),
                        VALUE * form_error / np.sqrt(BLOCKS))
    assert np.std(values) == pytest.approx(expected, rel=0.15)
    assert np.median(errors) == pytest.approx(expected, rel=0.25)
    inside = np.mean(np.abs(values - VALUE) < 1.96 * errors)
    assert 0.88 < inside <= 1.0


@pytest.mark.parametrize('form_error', [0.04, 0.16])
def test_how_exact_a_formula_is_shows_over_several_flights(form_error):
    """The relative error that all flights together find likeliest is the true one."""
    curves = [estimated(form_error, seed)[1].form_errors['rotor_drag'] for seed in range(8)]
    assert OF_EACH[np.argmax(np.sum(curves, axis=0))] == pytest.approx(form_error)


def test_where_a_fit_ended_scatters_no_blocks():
    """Few blocks show it: at another value than the best one these differ from the others."""
    shown = np.where(np.arange(BLOCKS) % 12, 1.0, 10.0)
    exact = 1.0 / (SLOPE * np.sqrt(SAMPLES * np.sum(shown ** 2)))
    for off in (0.0, 6.0 * exact):
        assert estimated(0.0, 1, shown, off)[1].errors == pytest.approx([exact], rel=0.02)
