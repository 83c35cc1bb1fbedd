# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How probable it is that an effect is present: the one definition."""

import numpy as np

from quad_ident_ros.diagnose.rules import Rules

STEADIEST = 10.0    # standard errors beyond which more say nothing more
LEAST = 1e-3        # contribution below which there is hardly any


def probabilities(posterior: dict, weights: dict, rules: Rules) -> dict:
    """
    Return {candidate: probability of being present}.

    Of those of the best set by a logistic regression on how steadily they help and on what they
    contribute; of the others by the posterior of the sets, to which these are no party.
    Args: posterior {candidate: ...} of the Selection; weights {candidate: Weight}.
    """
    return {cause: presence(weights[cause].stability, weights[cause].contribution, rules)
            if cause in weights else value for cause, value in posterior.items()}


def presence(stability: float, contribution: float, rules: Rules) -> float:
    """Return the probability that an effect of the best set is present."""
    base, steady, share = rules.calibration
    value = (base + steady * np.clip(stability, -STEADIEST, STEADIEST)
             + share * np.log10(np.clip(contribution, LEAST, 1.0)))
    return float(1.0 / (1.0 + np.exp(-value)))
