# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Errors that a slow force and moment make count less in a fit."""

import numpy as np
import pytest

from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.greybox.estimate import estimate
from quad_ident_ros.greybox.flights import flight_of, track_of
from quad_ident_ros.greybox.linear import whitening_of
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.vehicle import load_vehicle

IRIS = load_vehicle('iris')


def test_whitened_errors_have_unit_covariance():
    rng = np.random.default_rng(3)
    batch, length = 4, 24
    wrench, scale = rng.standard_normal((batch, 6, length)), rng.uniform(0.5, 2.0, (batch, length))
    slow = rng.uniform(0.1, 3.0, 6)
    white = whitening_of(wrench, scale, slow)
    directions = wrench * slow[:, None] * scale[:, None]
    covariance = np.eye(length) + directions.transpose(0, 2, 1) @ directions
    made = white.whitened(np.broadcast_to(np.eye(length), covariance.shape))
    np.testing.assert_allclose(made @ covariance @ made.transpose(0, 2, 1),
                               np.broadcast_to(np.eye(length), covariance.shape), atol=1e-9)
    # The slow part is the mean of what the force and moment make, given the errors.
    errors = rng.standard_normal((batch, 1, length))
    expected = errors @ np.linalg.inv(covariance) @ (covariance - np.eye(length))
    np.testing.assert_allclose(white.slow_part(errors), expected, atol=1e-9)


@pytest.mark.slow
def test_a_moment_that_wanders_does_not_bias_the_inertia():
    # A controller answers the moment, so that commands and what disturbs them go together.
    moment = {'rotor_fault': {'loss_1': 0.08}}
    truth = {'inertia_mismatch': {'factor_x': 1.3, 'factor_y': 1.3, 'factor_z': 1.0}}
    flight = flight_of(track_of(fly_closed_loop(IRIS, {**moment, **truth}, 'figure8',
                                                duration=20.0, rate=100.0), IRIS), 0.5)
    columns = [INDEX['inertia_mismatch.factor_x'], INDEX['inertia_mismatch.factor_y']]
    noise = [np.repeat([1e-3, 0.01, 3e-3, 0.01], 3)]
    slow = np.array([0.3, 0.3, 0.3, 0.1, 0.1, 0.1])
    plain, robust = (estimate([flight], IRIS, nominal(IRIS), columns, noise=noise, slow=kind)
                     for kind in (None, slow))
    assert np.abs(robust.z[columns] - 1.3).max() < 0.05
    assert np.abs(plain.z[columns] - 1.3).max() > 2.0 * np.abs(robust.z[columns] - 1.3).max()
