# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Between which causes flights cannot tell."""

from quad_ident_ros.diagnose.evidence import linear_evidence

DOUBT = 0.12        # probability of another effect from which on it is not ruled out
SURE = 0.88         # probability of an effect from which on it is named without doubt
ALIKE = 0.5         # of the log-evidence lost without a cause that its rival brings back


def doubts_of(selection, named):
    """
    Return the causes between which the flights of a Selection cannot tell; none where they can.

    Those of the named ones whose effects are not sure, and those that may be there in their place.
    """
    total = {}
    for cause, value in selection.probability.items():
        total[cause.effect] = total.get(cause.effect, 0.0) + value
    present = {cause.effect for cause in named}
    others = [cause for cause in selection.probability
              if cause.effect not in present and total[cause.effect] > DOUBT]
    found = {}
    for cause in named:
        if total[cause.effect] < SURE:
            rivals = rivals_of(selection, cause, others)
            found |= dict.fromkeys((cause, *rivals)) if rivals else {}
    return tuple(found)


def rivals_of(selection, cause, others):
    """Return those of other causes that explain in place of one, in the best set, what it does."""
    def evidence(causes):
        return linear_evidence(selection.quadratic, [selection.rows[one] for one in causes])[0]

    rest = [one for one in selection.best.causes if one != cause]
    without = evidence(rest)
    lost = evidence([*rest, cause]) - without
    return [other for other in others if evidence([*rest, other]) - without > ALIKE * lost]
