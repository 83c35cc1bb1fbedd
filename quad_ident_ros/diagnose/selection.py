# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What flights say of candidates, once the search among sets of them is over."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.evidence import Quadratic
from quad_ident_ros.diagnose.fitted import effects_in, Fitted
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.standard_errors import Joint


@dataclass(frozen=True, eq=False)
class Selection:
    """
    What the flights say of the candidates.

    best: the simplest Fitted of those with about the most evidence; fitted: it and the others
    that were refitted; posterior: probability of each candidate effect; quadratic, rows: the cost
    around the best, with all candidates free; noise: per flight (12,); joint: the Joint of the
    columns of the best; sizes: force (N) and moment (N m) of its discrepancy; slow (6,): the force
    and moment that nothing explains, by which autocorrelated errors counted less in the fits, or
    None; twin: the Selection with thrust in place of mass, or mass in place of thrust, beside
    other effects that scale the motion, where flights fit both alike, or None; its quadratic is
    around the same point.
    """

    best: Fitted
    fitted: tuple
    posterior: dict
    quadratic: Quadratic
    rows: dict
    noise: list
    joint: Joint
    sizes: tuple[float, float]
    slow: np.ndarray | None = None
    twin: 'Selection | None' = None

    @property
    def errors(self) -> np.ndarray:
        """
        Return the standard errors, (C,), of the best set's columns.

        How far flights usually differ is not known either: of all sets with the same effects, by
        their evidence. Formulas may be wrong: at least the errors of the Joint.
        """
        same = [one for one in self.fitted if one.causes == self.best.causes]
        evidences = np.array([one.evidence for one in same])
        shares = np.exp(evidences - evidences.max())
        squares = [one.estimate.errors ** 2
                   + (one.estimate.z - self.best.estimate.z)[one.estimate.columns] ** 2
                   for one in same]
        return np.maximum(np.sqrt(np.average(squares, axis=0, weights=shares)), self.joint.errors)

    @property
    def covariance(self) -> np.ndarray:
        """Return how the columns of the best set covary, (C, C), tied as by the Joint."""
        wider = np.where(self.joint.errors > 0.0,
                         self.errors / np.maximum(self.joint.errors, 1e-300), 1.0)
        return self.joint.covariance * np.outer(wider, wider)

    @property
    def covariance_by_noise(self) -> np.ndarray:
        """Return the covariance (C, C) without what errors of the sensors make of it."""
        wider = np.sqrt(np.diag(self.covariance) / np.maximum(np.diag(self.joint.covariance),
                                                              1e-300))
        return self.covariance - self.joint.sensors * np.outer(wider, wider)


def posteriors(fitted: Sequence[Fitted], ranked: list, causes: Sequence[Candidate],
               tried: Collection[tuple], rules: Rules) -> dict:
    """
    Return {effect candidate: probability of being present}: the evidence of sets that have it.

    Sets that were not refitted count by the linear model, beside the best one, for little. The
    best one is the simplest of those that are about as good: sets that only add effects to it
    say no more about these than their prior.
    """
    top = fitted[0]
    best = set(top.causes)
    base = next((value for value, chosen, _ in ranked if chosen == top.chosen), None)
    weights = {one.chosen: one.evidence - top.evidence for one in fitted}
    if base is not None and np.isfinite(base):
        for value, chosen, _ in ranked:
            # With one candidate more, less, or in place of another: of others slopes say little.
            if chosen not in tried and len(set(chosen) ^ set(top.chosen)) <= 2:
                weights[chosen] = min(value - base, rules.untried)
    values = np.array(list(weights.values()))
    shares = np.exp(np.clip(values - values.max(), -700, 0))
    shares /= shares.sum()
    found = dict.fromkeys(causes, 0.0)
    for share, chosen in zip(shares, weights, strict=True):
        for cause in effects_in(chosen):
            adds = cause not in best and best <= set(chosen)
            found[cause] += float(share) * (rules.prior_of(cause.effect) if adds else 1.0)
    return found
