# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How probable it is that an effect is present: the one definition."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.diagnose.rules import Rules


@dataclass(frozen=True)
class Weight:
    """
    What an effect weighs, by what is lost when it is taken out and everything else is refitted.

    contribution: the share of the closable gap that is lost; stability: how steadily it helps,
    see judgement.stability; explained: the share of its contribution that its form explains;
    gap {group: ...}: without it; distance: by how many standard errors its parameters together
    differ from no effect, see bench.standard_errors_from_none; lesser: whether another effect
    contributes more.
    """

    contribution: float
    stability: float
    explained: float
    gap: dict
    distance: float
    lesser: bool = False


def beside_others(weights: dict) -> dict:
    """Return {candidate: Weight} of the effects of one model, all but the greatest as lesser."""
    most = max((one.contribution for one in weights.values()), default=0.0)
    return {cause: replace(one, lesser=one.contribution < most)
            for cause, one in weights.items()}


def probabilities(posterior: dict, weights: dict, rules: Rules) -> dict[str, float]:
    """
    Return {effect: probability of being present}.

    Of those of the best set by a logistic regression on how well their form explains them, on how
    many standard errors they are from no effect and, beside a greater effect, on what they
    contribute; of the others by the posterior of all sets that have them, in whichever form.
    Args: posterior {candidate: ...} of the Selection; weights {candidate: Weight}.
    """
    there = {cause.effect: presence(weight, rules, rules.shift(cause.effect))
             for cause, weight in weights.items()}
    return by_effect(posterior) | there


def told_apart(probability: dict[str, float], posterior: dict, doubtful: Iterable
               ) -> dict[str, float]:
    """
    Return {effect: probability of being present} for effects that flights cannot separate.

    What an effect contributes says that it, or its rival, is present; which of them, the posterior
    says. Args: posterior {candidate: ...}; doubtful: candidates of the best set that have a rival.
    """
    which = by_effect(posterior)
    return probability | {cause.effect: probability[cause.effect] * which[cause.effect]
                          for cause in doubtful}


def by_effect(posterior: dict) -> dict[str, float]:
    """Return {effect: sum over its candidates} of a posterior {candidate: probability}."""
    found = {cause.effect: 0.0 for cause in posterior}
    for cause, value in posterior.items():
        found[cause.effect] += value
    return found


def presence(weight: Weight, rules: Rules, shift: float = 0.0) -> float:
    """
    Return the probability that an effect of the best set is present.

    shift: prior knowledge of the effect, see Rules.shift.

    Of standard errors the logarithm counts: ten more tell little where there are thirty, for what
    formulas are wrong by is not known well. A lesser effect may stand for what the formula of a
    greater one is wrong by: of it they tell less, and its size tells more.
    """
    base, form, far, lesser_far, lesser_size = rules.calibration
    value = base + form * weight.explained + far * np.log1p(weight.distance) + shift
    if weight.lesser:
        value += (lesser_far * np.log1p(weight.distance)
                  + lesser_size * size_shown(weight.contribution, weight.distance))
    return float(1.0 / (1.0 + np.exp(-value)))


def size_shown(contribution: float, distance: float) -> float:
    """
    Return the relative size of an effect, 0 to 1, by its contribution.

    That is as its square: a gap grows with the square of what is small beside the rest of it. Of
    the square of what is D standard errors from none, 1 / D^2 is expected by chance (James and
    Stein, Fourth Berkeley Symposium, 1961); the rest counts.
    """
    by_chance = 1.0 / max(distance, 1.0) ** 2
    return float(np.sqrt(np.clip(contribution, 0.0, 1.0) * (1.0 - by_chance)))
