# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Causes between which flights cannot decide."""

from collections.abc import Callable, Sequence

import numpy as np

from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.fitted import Fitted
from quad_ident_ros.diagnose.probability import by_effect
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.selection import Selection


def doubts_of(selection: Selection, named: Sequence[Candidate], rules: Rules,
              replaces: Callable[[Candidate, Candidate, Fitted], bool]
              ) -> dict[Candidate, Fitted]:
    """
    Return the causes between which the flights of a Selection cannot decide, or none.

    Those of the named ones whose effects are not sure, and those that may be there in their place,
    each with the Fitted set that speaks for it: {cause: Fitted}. replaces: whether a rival, with
    its set, does as much as a cause among those that are named; one that needs further effects for
    that explains the flights less simply, and is no rival.
    """
    total = by_effect(selection.posterior)
    present = {cause.effect for cause in named}
    others = [cause for cause in selection.posterior
              if cause.effect not in present and total[cause.effect] > rules.doubt]
    found: dict[Candidate, Fitted] = {}
    for cause in named:
        rivals = ({} if total[cause.effect] >= 1.0 - rules.doubt else
                  rivals_of(selection, cause, others, rules))
        rivals = {rival: one for rival, one in rivals.items() if replaces(cause, rival, one)}
        if rivals:
            found |= {cause: selection.best, **rivals}
    return found


def rivals_of(selection: Selection, cause: Candidate, others: Sequence[Candidate], rules: Rules
              ) -> dict[Candidate, Fitted]:
    """Return {rival: Fitted} of other causes that are likelier without a cause."""
    top = max(one.evidence for one in selection.fitted)
    weights = [np.exp(max(one.evidence - top, -700.0)) for one in selection.fitted]

    def odds(other: Candidate, there: bool) -> float:
        """Return the odds of another cause, given whether the cause is present."""
        given = [(weight, other in one.causes) for weight, one in
                 zip(weights, selection.fitted, strict=True) if (cause in one.causes) == there]
        having, lacking = (sum(weight for weight, has in given if has == which)
                           for which in (True, False))
        return float(having / max(lacking, 1e-300))

    found = {}
    for other in others:
        sets = [one for one in selection.fitted if other in one.causes and cause not in one.causes]
        if sets and odds(other, False) > rules.instead * odds(other, True):
            found[other] = max(sets, key=lambda one: one.evidence)
    return found
