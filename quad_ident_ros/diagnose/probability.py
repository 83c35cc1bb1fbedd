# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How probable it is that an effect is present: the one definition."""

import numpy as np

from quad_ident_ros.diagnose.rules import Rules

FARTHEST = 20.0     # log odds that the evidence of a posterior with 1e-9 of rounding can give
LEAST = 1e-3        # contribution below which there is hardly any


def probabilities(posterior: dict, weights: dict, rules: Rules) -> dict:
    """
    Return {candidate: probability of being present}.

    Of those of the best set by a logistic regression on how steadily they help and on what they
    contribute; of the others by the posterior of the sets, to which these are no party.
    Args: posterior {candidate: ...} of the Selection; weights {candidate: Weight}.
    """
    return {cause: presence(value, weights[cause].stability, weights[cause].contribution, rules)
            if cause in weights else value for cause, value in posterior.items()}


def presence(posterior: float, stability: float, contribution: float, rules: Rules) -> float:
    """Return the probability that an effect of the best set is present."""
    odds = np.clip(np.log(max(posterior, 1e-300) / max(1.0 - posterior, 1e-300)),
                   -FARTHEST, FARTHEST)
    base, steady, share, evidence = rules.calibration
    value = (base + steady * np.clip(stability, -10.0, 10.0)
             + share * np.log10(np.clip(contribution, LEAST, 1.0)) + evidence * odds)
    return float(1.0 / (1.0 + np.exp(-value)))
