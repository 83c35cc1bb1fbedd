# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The step from where a fit ended to the parameters that are likeliest with the discrepancy."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from quad_ident_ros.diagnose.likeliest import Around
from quad_ident_ros.greybox.linear import WRENCH
from quad_ident_ros.greybox.normal import Normal
from quad_ident_ros.greybox.nuisances import Nuisance, NuisanceValues
from quad_ident_ros.greybox.parameters import INDEX, limits, nominal
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
DRAG, MASS = INDEX['rotor_drag.coefficient'], INDEX['mass_offset.mass']
FLIGHTS = 2


@pytest.fixture
def problem(monkeypatch):
    """Return an Around of a drag, a constant and trims of two flights, and its Normal."""
    rng = np.random.default_rng(4)
    moment = tuple(WRENCH[3:])
    nuisances = NuisanceValues.of([Nuisance('trim', 'moment', 'N m', moment, (1e-3,) * 3, 0.5)],
                                  FLIGHTS)
    nuisances = replace(nuisances, values=rng.normal(size=nuisances.values.shape)
                        * nuisances.spreads)
    fit = SimpleNamespace(z=nominal(VEHICLE), columns=[DRAG], nuisances=nuisances)
    size = np.concatenate([limits(VEHICLE)[2, [DRAG, MASS]],
                           np.tile(nuisances.spreads, FLIGHTS)])
    root = rng.normal(size=(20, len(size))) / size
    normal = Normal(root.T @ root, root.T @ rng.normal(size=20), 0.0, np.zeros((0, len(size))))
    monkeypatch.setattr('quad_ident_ros.diagnose.likeliest.normal_at', lambda *given: normal)
    return Around(None, fit, [DRAG, MASS], {}, (0.0, 0.0), 0.0), normal, size


def test_no_other_values_of_parameters_and_nuisances_are_likelier(problem):
    around, normal, size = problem
    values = around.fit.nuisances.values.ravel()
    spreads = np.tile(around.fit.nuisances.spreads, FLIGHTS)

    def cost(step):
        """Return that of the flights and of what nuisances usually are, none."""
        return (step @ normal.information @ step - 2.0 * normal.gradient @ step
                + np.sum(((values + step[2:]) / spreads) ** 2))

    step = around.step(VEHICLE)
    assert step[1] == 0.0       # the constant of the vehicle file
    rng = np.random.default_rng(5)
    for _ in range(50):
        other = 0.01 * rng.normal(size=len(size)) * size
        other[1] = 0.0
        assert cost(step + other) > cost(step)
