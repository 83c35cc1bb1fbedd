# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How the benchmarks call the library that they measure: the only place that knows."""

import numpy as np

from benchmarks.problems import GAIN_BOUNDS, POLE_BOUNDS
from quad_ident_ros.identify.objective import Objective
from quad_ident_ros.identify.order import alternatives
from quad_ident_ros.identify.pso_cs import pso_cs
from quad_ident_ros.identify.residuals import examine
from quad_ident_ros.identify.search import Search, SwarmSettings
from quad_ident_ros.identify.space import no_space, SIZE, Space
from quad_ident_ros.identify.uncertainty import uncertainty
from quad_ident_ros.identify.vp import best_poles, COMPLEX_PENALTY, residual_of, vp, vp_fit

BUDGET = 8200    # evaluations of CS and PSO-CS with the paper's settings
SPACE = Space(POLE_BOUNDS, GAIN_BOUNDS, np.inf)


def fit_vp(signals, seed, poles='auto'):
    """Return K, c1, c0 (outputs, 3) by vp, and the evaluations of F that an output took."""
    found = [best_poles(signal, COMPLEX_PENALTY[poles]) for signal in signals]
    return (np.array([_coefficients(fitted) for fitted, _ in found]),
            sum(spent for _, spent in found) / len(found))


def fit_whole(signals, seed, orders=False):
    """Return the same as fit_vp, of all that an identification does: errors and tests too."""
    models, spent = [], 0
    for signal in signals:
        fitted, more, _ = vp_fit(Objective(signal), no_space('auto'))
        uncertainty(signal, fitted)
        examine(signal, residual_of(signal, fitted), fitted.noise)
        if orders:
            alternatives(signal, fitted.model)
        models.append(_coefficients(fitted))
        spent += more
    return np.array(models), spent / len(signals)


def fit_with_orders(signals, seed):
    """Return the same, with the comparison of other orders."""
    return fit_whole(signals, seed, True)


def fit_vp_real(signals, seed):
    """Return the same for real poles, the class of models that P1 asks for."""
    return fit_vp(signals, seed, 'real')


def fit_vp_any(signal):
    """Return the model of vp with poles of any kind, and its standard errors."""
    fitted = vp(signal, poles='any')
    return fitted.model, uncertainty(signal, fitted).errors


def fit_pso_cs(signals, seed):
    """Return K, c1, c0 (outputs, 3) by PSO-CS on each output, its gain projected out."""
    random = np.random.default_rng(seed)
    models, spent = [], 0
    for signal in signals:
        objective = Objective(signal, GAIN_BOUNDS)
        search = Search(lambda points, objective=objective: SPACE.cost(objective, points), 2,
                        SwarmSettings(), random)
        pso_cs(search)
        mean, half = SPACE.mean_and_half(search.best[None])
        models.append(_coefficients(objective.fit(mean[0], half[0])))
        spent = search.spent
    return np.array(models), spent


def joint_pso_cs(tracker, seed):
    """Search by PSO-CS in the paper's literal 12 dimensions, like the peers (see peers.py)."""
    search = Search(lambda points: tracker.many(points / SIZE), tracker.joint.dimension,
                    SwarmSettings(evaluations=tracker.budget), np.random.default_rng(seed))
    pso_cs(search)


def _coefficients(fitted):
    return fitted.model.gain, fitted.model.c1, fitted.model.c0
