# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether what remains is an effect that is named, by a law that is none of its forms."""

from collections.abc import Mapping, Sequence

import numpy as np

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.bench import Bench
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.judgement import (
    explained_share,
    in_standard_errors,
    Judgement,
    lost_shares,
    pooled,
)
from quad_ident_ros.diagnose.measure import residual_wrenches
from quad_ident_ros.diagnose.residual_wrench import CHANNELS, ResidualWrench, weights
from quad_ident_ros.diagnose.result import Unexplained
from quad_ident_ros.greybox.parameters import nominal

SIZES = np.geomspace(0.02, 5.0, 80)
"""Of what remains that are tried, over its root mean square: 7 % apart."""


def effects_of_unknown_form(bench: Bench, judged: Judgement, remains: Sequence[Unexplained],
                            wrenches: Sequence[ResidualWrench], noise: np.ndarray
                            ) -> Mapping[str, float]:
    """
    Return {effect: share of it explained} of one with whose action what remains comes and goes.

    An error of form is a share of what the effect does: large where that is large, and zero where
    the effect does not act. Another cause knows nothing of it. Each makes a variance of the
    residual force or moment beside that of the noise: in proportion to the square of what the
    effect does, or the same throughout. The former has to be likelier by more than `shown`
    standard errors over blocks of time (Vuong, Econometrica 57, 1989), for an effect that is
    explained less well than formulas usually do (`form_error`), where something remains. It need
    not matter there if what remains is unexplained: air near the ground pushes and turns, but most
    of its laws only push. Of several effects the one that it is most clearly so for, before all of
    those that matter there; none where it is for none. The share is the least of the groups where
    it does, or else that of the group in which the effect does most.
    Args: remains: the channels in which something does, of which forces count, if any are among
    them, or else moments; wrenches: what the model does not
    explain of each flight learnt from, and noise (12,): that of their states.
    """
    forces = [row for row in remains if row.channel[0] == 'F']
    columns = [CHANNELS.index(row.channel) for row in forces or remains]
    if not columns or judged.stand_ins:
        return {}
    values, errors = (np.concatenate([getattr(one, name)[:, columns] for one in wrenches])
                      for name in ('values', 'errors'))
    block = _blocks([one.t for one in wrenches], bench.rules.steady_block)
    throughout = _likeliest(values, errors, np.ones(len(values)))
    likelier, acts_there = {}, {}
    for cause in judged.material:
        explained = _explained_there(bench, judged, cause)
        if (min(explained) >= 1.0 - bench.rules.form_error if explained
                else not judged.unexplained):
            continue
        acts_there[cause] = bool(explained)
        acts = _action(bench, judged, cause, wrenches, noise)
        likelier[cause] = in_errors(_likeliest(values, errors, acts) - throughout, block)
    clear = [cause for cause, value in likelier.items() if value > bench.rules.shown]
    if not clear:
        return {}
    best = max(clear, key=lambda cause: (acts_there[cause], likelier[cause]))
    share = min(_explained_there(bench, judged, best), default=judged.supports[best].explained)
    return {best.effect: share}


def _explained_there(bench: Bench, judged: Judgement, cause: Candidate) -> list[float]:
    """Return the share of an effect that its form explains, in each group where it matters."""
    noise, after, without = pooled(judged.noise), judged.model.gap, judged.without[cause].gap
    shares = lost_shares(after, without, gaps.gap(judged.before), noise, bench.rules)
    return [explained_share(after[name], without[name], noise[name],
                            bench.rules.least(name, noise[name]))
            for name in judged.open_groups if shares[name] >= bench.rules.material]


def _action(bench: Bench, judged: Judgement, cause: Candidate,
            wrenches: Sequence[ResidualWrench], noise: np.ndarray) -> np.ndarray:
    """Return what an effect does in each window, (B,), m/s of velocity in half a second."""
    columns, null = list(cause.columns), nominal(bench.vehicle)
    vectors = [z.copy() for z in judged.model.vectors]
    for z in vectors:
        z[columns] = null[columns]
    without = residual_wrenches(bench, vectors, noise)
    change = np.concatenate([one.values - other.values
                             for one, other in zip(without, wrenches, strict=True)])
    return np.linalg.norm(change * weights(bench.vehicle), axis=1)


def in_errors(gained: np.ndarray, block: np.ndarray) -> float:
    """Return a sum over windows (B,) in standard errors by blocks (B,); 0 where one is all."""
    return in_standard_errors(np.bincount(block, gained))


def _likeliest(values: np.ndarray, errors: np.ndarray, size: np.ndarray) -> np.ndarray:
    """
    Return the log-likelihood of each window, (B,), if channels vary by the best multiple of size.

    values, errors (B, C): residual and the standard deviation of its noise; size (B,).
    """
    total = np.zeros(len(values))
    for value, error in zip(values.T, errors.T, strict=True):
        unit = np.sqrt(np.mean(value ** 2) / max(np.mean(size ** 2), 1e-300))
        variance = error ** 2 + (SIZES[:, None] * unit * size) ** 2
        each = -0.5 * (value ** 2 / variance + np.log(variance))
        total += each[np.argmax(each.sum(axis=1))]
    return total


def _blocks(times: Sequence[np.ndarray], length: float) -> np.ndarray:
    """Return the number of the block of so many seconds that each window of flights is in."""
    place = np.concatenate([np.stack([np.full(len(t), k), t // length], axis=1)
                            for k, t in enumerate(times)])
    return np.unique(place, axis=0, return_inverse=True)[1].ravel()
