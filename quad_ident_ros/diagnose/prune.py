# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Sets of causes without those that their own standard errors do not support."""

from quad_ident_ros.diagnose.fitted import fitted_of, refitted, support_of
from quad_ident_ros.greybox.parameters import nominal

MISSED = 50.0       # times the scatter of more cost by which a cause is missed, weak or not


def best_pruned(flights, vehicle, best, tried, noise, scatter):
    """
    Return the Fitted set of the most evidence that is left when weak causes are pruned.

    And {cause: its support} of what was pruned from it, the causes that are missed, and the sets
    from which something was pruned. One that has more evidence than what is left of another has a
    say, too.
    """
    found, seen, gone = None, set(), set()
    while best is not None:
        seen.add(best)
        key, pruned, missed = _pruned(flights, vehicle, best, tried, noise, scatter)
        one = fitted_of(key, tried[key], vehicle, scatter)
        if found is None or one.evidence > found[0].evidence:
            found = one, pruned, missed
        if key != best:
            gone.add(best)
        seen.add(key)
        rivals = [fitted_of(key, tried[key], vehicle, scatter) for key in tried if key not in seen]
        rivals = [one for one in rivals if one.evidence > found[0].evidence
                  and not found[0].within(one)]
        best = max(rivals, key=lambda one: one.evidence).chosen if rivals else None
    return *found, gone


def _pruned(flights, vehicle, best, tried, noise, scatter):
    """
    Return the causes of a set that its own standard errors support, refitted into tried.

    And {cause: its support} of those that are left out; and those that are kept without any, for
    much is missed without them, as where several could stand for one another.
    """
    pruned, missed = {}, set()
    while True:
        fit = tried[best]
        weak = {cause: support for cause in best if cause.own is None and cause not in missed
                if (support := support_of(fit, cause, vehicle)) <= 0.0}
        if not weak:
            return best, pruned, missed
        weakest = min(weak, key=weak.get)
        without = tuple(cause for cause in best if cause != weakest)
        if without not in tried:
            z = fit.z.copy()
            z[list(weakest.columns)] = nominal(vehicle)[list(weakest.columns)]
            tried[without] = refitted(flights, vehicle, z, without, noise, fit.own, fit.starts)
        if tried[without].cost > fit.cost + MISSED * scatter:
            missed.add(weakest)
        else:
            pruned[weakest] = weak[weakest]
            best, missed = without, set()
