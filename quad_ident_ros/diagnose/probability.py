# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How probable it is that an effect is present: the one definition."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.diagnose.rules import Rules


@dataclass(frozen=True)
class Support:
    """
    How well flights support an effect: what is lost without it, everything else refitted.

    contribution: the share of the closable gap that is lost; stability: how steadily it helps,
    see judgement.stability; explained: the share of its contribution that its form explains;
    gap {group: ...}: without it; distance: by how many standard errors its parameters together
    differ from no effect, see bench.standard_errors_from_none; relative: its size over that of the
    greatest effect beside it, 0 to 1; companions: how many other effects clearly contribute.
    """

    contribution: float
    stability: float
    explained: float
    gap: dict
    distance: float
    relative: float = 1.0
    companions: int = 0


def beside_others(supports: dict, rules: Rules) -> dict:
    """
    Return {candidate: Support} of the effects of one model, each with what the others contribute.

    How likely an effect is before looking at it shows in the number of others present (Scott and
    Berger, Annals of Statistics 38, 2010).
    """
    contribution, steadiness = rules.companion
    clear = {cause for cause, one in supports.items()
             if one.contribution >= contribution and one.stability >= steadiness}
    most = max((one.contribution for one in supports.values()), default=0.0)
    return {cause: replace(one, companions=len(clear - {cause}),
                           relative=relative_size(one.contribution, most))
            for cause, one in supports.items()}


def relative_size(contribution: float, most: float) -> float:
    """
    Return the size of an effect over that of the greatest, 0 to 1, by their contributions.

    A contribution is as the square of a size: a gap grows with the square of what is small beside
    the rest of it.
    """
    return 1.0 if contribution >= most else float(np.sqrt(max(contribution, 0.0) / most))


def probabilities(posterior: dict, supports: dict, rules: Rules) -> dict[str, float]:
    """
    Return {effect: probability of being present}.

    Of those of the best set by a logistic regression on how well their form explains them, on how
    many standard errors they are from no effect, on their size beside the greatest and on their
    companions; of the others by the posterior of all sets that have them, in whichever form.
    Args: posterior {candidate: ...} of the Selection; supports {candidate: Support}.
    """
    there = {cause.effect: presence(support, rules, rules.shift(cause.effect))
             for cause, support in supports.items()}
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


def presence(support: Support, rules: Rules, shift: float = 0.0) -> float:
    """
    Return the probability that an effect of the best set is present.

    shift: prior knowledge of the effect, see Rules.shift.

    Of standard errors the logarithm counts: ten more tell little where there are thirty, for what
    formulas are wrong by is not known well. They tell less of an effect that is small beside the
    greatest one: it may stand for what the formula of that one is wrong by.
    """
    base, form, far, lesser, beside = rules.calibration
    value = (base + form * support.explained
             + (far + lesser * (1.0 - support.relative)) * np.log1p(support.distance)
             + beside * support.companions + shift)
    return float(1.0 / (1.0 + np.exp(-value)))
