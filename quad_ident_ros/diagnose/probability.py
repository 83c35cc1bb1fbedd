# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How probable it is that an effect is present: the one definition."""

import numpy as np

from quad_ident_ros.diagnose.rules import Rules


def probabilities(posterior: dict, weights: dict, rules: Rules) -> dict[str, float]:
    """
    Return {effect: probability of being present}.

    Of those of the best set by a logistic regression on how steadily they help, on what they
    contribute and on how much of what they are there for their form explains; of the others by
    the posterior of all sets that have them, in whichever form.
    Args: posterior {candidate: ...} of the Selection; weights {candidate: Weight}.
    """
    found = {cause.effect: 0.0 for cause in posterior}
    for cause, value in posterior.items():
        found[cause.effect] += value
    return found | {cause.effect: presence(weight.stability, weight.contribution,
                                             weight.explained, rules)
                    for cause, weight in weights.items()}


def presence(stability: float, contribution: float, explained: float, rules: Rules) -> float:
    """Return the probability that an effect of the best set is present."""
    base, steady, share, form = rules.calibration
    value = (base + steady * np.clip(stability, -rules.steadiest, rules.steadiest)
             + share * np.log10(np.clip(contribution, rules.faintest, 1.0)) + form * explained)
    return float(1.0 / (1.0 + np.exp(-value)))
