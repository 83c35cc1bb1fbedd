# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What each effect contributes, which effects matter, and whether something unknown remains."""

from collections.abc import Collection
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy.special import chdtrc, ndtri

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose import input_errors
from quad_ident_ros.diagnose.candidates import Candidate
from quad_ident_ros.diagnose.fitted import (
    columns_at_bounds,
    effects_in,
    refitted,
    within_bounds,
)
from quad_ident_ros.diagnose.gap import Noise
from quad_ident_ros.diagnose.nuisances import nuisances_of
from quad_ident_ros.diagnose.probability import presence, probabilities, Weight, with_companions
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.selection import Selection
from quad_ident_ros.effects.registry import EFFECTS, PLACES
from quad_ident_ros.greybox.errors import ERRORS, GROUPS
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.linear import Slopes, slopes_at, WRENCH
from quad_ident_ros.greybox.parameters import nominal, SPLIT
from quad_ident_ros.model.vehicle import Vehicle


@dataclass(frozen=True, eq=False)
class Model:
    """
    A set of effects fitted to all flights but the one held out, and the gap that it leaves.

    z (Z,): with the effects; vectors: z with each flight's nuisances, that of the flight held out
    last; ends: the Ends of predictions along each, position and velocity given the recorded
    attitude.
    """

    chosen: tuple
    estimate: Estimate
    vectors: tuple
    ends: tuple

    @property
    def gap(self) -> dict:
        """Return {group: gap} of all flights."""
        return gaps.gap(self.ends)

    @property
    def z(self) -> np.ndarray:
        """Return the vector (Z,) that the flights share."""
        return self.estimate.z

    @property
    def effects(self) -> tuple:
        """Return the candidates that are effects."""
        return effects_in(self.chosen)


@dataclass(frozen=True, eq=False)
class Bench:
    """
    Flights on which models are refitted and measured.

    flights: those learnt from, cut into rollouts; tracks: these and, last, the one held out;
    noise of the measurement.
    """

    flights: list
    tracks: tuple
    vehicle: Vehicle
    selection: Selection
    noise: Noise
    rules: Rules

    @property
    def horizon(self) -> float:
        """Return the time (s) ahead at which effects are judged."""
        return gaps.horizon_of(self.flights, self.rules)

    def model(self, chosen: tuple, estimate: Estimate, fixed: np.ndarray | None = None) -> Model:
        """
        Return the Model of a set and its Estimate.

        fixed (Z,): nuisances that are not free in the flight that was held out.
        """
        held_out = self._nuisances(-1, estimate.z, chosen, fixed)
        vectors = (*estimate.vectors, estimate.z + held_out)
        return Model(chosen, estimate, vectors, self.ends(vectors))

    def ends(self, vectors: tuple) -> tuple:
        """Return the Ends of all flights with a vector (Z,) each."""
        return tuple(gaps.ends(track, self.vehicle, z, self.horizon)
                     for track, z in zip(self.tracks, vectors, strict=True))

    def noise_gaps(self, model: Model) -> list:
        """Return {group: the gap that the noise makes} of each flight."""
        return [gaps.noise_gap(track, self.vehicle, z, self.noise, self.horizon)
                for track, z in zip(self.tracks, model.vectors, strict=True)]

    def slopes(self, model: Model) -> Slopes:
        """Return the Slopes of the flights learnt from at a Model, in all that it has free."""
        fit = model.estimate
        wanted = {*fit.columns, *fit.nuisances.columns,
                  *(WRENCH if self.selection.slow is not None else ())}
        return slopes_at(self.flights, self.vehicle, fit.z, fit.vectors, fit.starts,
                         sorted(wanted))

    def without(self, model: Model, removed: tuple, slopes: Slopes | None = None) -> Model:
        """
        Return a Model with some of its effects taken out and everything else refitted.

        slopes: those at the model, by which fits begin that are only for comparison.

        What is alike in all flights must not hide in nuisances: those that do what an effect does
        that is taken out may only differ between flights, as they do beside it.
        """
        fit, z = model.estimate, model.z.copy()
        columns = [column for cause in removed for column in cause.columns]
        z[columns] = nominal(self.vehicle)[columns]
        fixed = np.stack(model.vectors) - model.z
        alike = {column for cause in removed for column in _columns_alike(cause.effect)}
        shared = [column for column in sorted(alike) if fixed[:, column].any()]
        # Thrust, wind and moment of a flight do what many effects do: they stay as they are.
        held = {cause for cause in model.chosen
                if cause.nuisance is not None and (cause.nuisance.of_effect
                                                   or any(cause.nuisance.sum_to_zero)
                                                   or set(cause.nuisance.columns) & set(shared))}
        free = [column for cause in model.chosen
                if cause.nuisance is not None and cause not in held
                for column in cause.nuisance.columns]
        fixed[:, free] = 0.0
        fixed[:, shared] -= fixed[:-1, shared].mean(axis=0)
        chosen = tuple(cause for cause in model.chosen if cause not in {*removed, *held})
        noise, scatter = self.selection.noise, self.selection.quadratic.scatter
        slow = self.selection.slow
        estimate = refitted(self.flights, self.vehicle, z, chosen, noise, fit.nuisances,
                            fit.starts, slopes, scatter, fixed[:-1], slow)
        usual = {cause.effect: cause for cause in self.selection.posterior if cause.usual}
        chosen, estimate = within_bounds(chosen, estimate, usual, self.flights, self.vehicle,
                                         noise, self.rules, scatter, fixed[:-1], slow)
        return self.model(chosen, estimate, fixed[-1])

    def left_out(self, model: Model) -> tuple:
        """
        Return the Ends of each flight by a Model's set refitted to the others, held-out one last.

        A flight that is the only one to learn from is predicted by the model as it is.
        """
        count, found = len(self.flights), []
        if count == 1 or not model.chosen:
            return model.ends
        slopes = self.slopes(model)
        for k in range(count):
            kept = [n for n in range(count) if n != k]
            fit, flights = model.estimate, [self.flights[n] for n in kept]
            nuisances = replace(fit.nuisances, values=fit.nuisances.values[kept])
            fixed = fit.nuisances.fixed
            refit = refitted(flights, self.vehicle, fit.z, model.chosen,
                             [self.selection.noise[n] for n in kept], nuisances,
                             [fit.starts[n] for n in kept], slopes.of_flights(kept),
                             self.selection.quadratic.scatter,
                             None if fixed is None else fixed[kept], self.selection.slow)
            here = self._nuisances(k, refit.z, model.chosen, None if fixed is None else fixed[k])
            found.append(gaps.ends(self.tracks[k], self.vehicle, refit.z + here, self.horizon))
        return (*found, model.ends[-1])

    def untold(self, model: Model) -> dict[int, tuple[float, float]]:
        """Return {column: (least, most)} of what errors of the commands alone may have made."""
        if not input_errors.gains(model.estimate.columns):
            return {}
        found = input_errors.ranges(model.estimate, self.slopes(model), self.noise)
        null = nominal(self.vehicle)
        clear = {column for cause in model.effects for column in self.clear_columns(model, cause)}
        return {column: (least, most) for column, (least, most) in found.items()
                if column in clear and least <= null[column] <= most}

    def stands_in(self, model: Model, cause: Candidate, untold: Collection[int]) -> bool:
        """Return whether most of what an effect clearly changes is at bounds or untold."""
        clear = self.clear_columns(model, cause)
        held = columns_at_bounds(cause, model.z, self.vehicle, self.rules)
        return len(clear & {*untold, *held}) > self.rules.stand_in * len(clear)

    def clear_columns(self, model: Model, cause: Candidate) -> set[int]:
        """Return the columns of an effect that clearly differ from none."""
        return {column for column, distance in self.distances(model, cause).items()
                if distance >= self.rules.shown}

    def distance(self, model: Model, cause: Candidate) -> float:
        """
        Return by how many standard errors an effect's parameters together differ from none.

        In the best set where that has the effect: where others are taken out, it does their work.
        """
        best, columns = self.selection.best.estimate, list(cause.columns)
        kept = set(columns) <= set(best.columns)
        fit, covariance = ((best, self.selection.covariance) if kept
                           else (model.estimate, model.estimate.covariance))
        places = [fit.columns.index(column) for column in columns]
        return standard_errors_from_none((fit.z - nominal(self.vehicle))[columns],
                                         covariance[np.ix_(places, places)])

    def distances(self, model: Model, cause: Candidate) -> dict[int, float]:
        """
        Return {column: standard errors from none} of an effect, each parameter by itself.

        In the best set where that has the column, as the distance.
        """
        best, null = self.selection.best.estimate, nominal(self.vehicle)
        errors = self.errors(model)
        z = np.where(np.isin(np.arange(len(null)), best.columns), best.z, model.z)
        return {column: float(abs(z[column] - null[column]) / max(errors[column], 1e-300))
                for column in cause.columns}

    def errors(self, model: Model) -> dict[int, float]:
        """Return {column: standard error}: of the best set where it has the column."""
        best = self.selection.best.estimate
        return (dict(zip(model.estimate.columns, model.estimate.errors, strict=True))
                | dict(zip(best.columns, self.selection.errors, strict=True)))

    def _nuisances(self, flight: int, z: np.ndarray, chosen: tuple,
                   fixed: np.ndarray | None = None) -> np.ndarray:
        """Return the nuisances (Z,) of a flight beside a vector that it took no part in."""
        return nuisances_of(self.tracks[flight], self.vehicle, z,
                            tuple(cause.nuisance for cause in chosen if cause.nuisance),
                            self.noise.deviation, self.flights[0].segment, fixed,
                            self.selection.slow)


@dataclass(frozen=True, eq=False)
class Judgement:
    """
    What was judged of a Selection.

    model: all effects that are there; material: those of them that matter; stand_ins: those that
    would, but have most of their parameters at bounds or untold; untold {column: (least, most)}:
    what errors of the commands may have made; weights {candidate: Weight} and
    probability {effect: of being present}; without {candidate: Model without it};
    before: the Ends of the nominal vehicle with the nuisances of each flight; left_out: those of
    each flight by the model fitted to the others; noise: {group: gap} of each flight;
    unexplained: {group: gap beyond tolerance and error of form}.
    """

    model: Model
    material: tuple
    stand_ins: tuple
    untold: dict[int, tuple[float, float]]
    weights: dict
    probability: dict
    without: dict
    before: tuple
    left_out: tuple
    noise: list
    unexplained: dict


def judge(bench: Bench) -> Judgement:
    """
    Return the Judgement of the best set of a Selection on the flights of a Bench.

    Effects without which nothing that matters is lost are taken out one group after the other;
    those of them that are there all the same stay in the model.
    """
    best, rules = bench.selection.best, bench.rules
    full = model = bench.model(best.chosen, best.estimate)
    null = nominal(bench.vehicle)
    ends = bench.ends(tuple(null + vector - full.z for vector in full.vectors))
    noises = bench.noise_gaps(full)
    before, noise = gaps.gap(ends), pooled(noises)
    weights: dict[Candidate, Weight] = {}
    without: dict[Candidate, Model] = {}
    while model.effects:
        slopes = bench.slopes(model)
        smaller = {removed: bench.without(model, removed, slopes)
                   for removed in _subsets(model, rules)}
        alone = {removed[0]: one for removed, one in smaller.items() if len(removed) == 1}
        without |= alone
        for cause, weight in with_companions(
                {cause: _weight(model, one, before, noise, bench.distance(model, cause), rules)
                 for cause, one in alone.items()}, rules).items():
            # Beside effects that do not matter it may show more clearly, or less.
            weights[cause] = max(weights.get(cause, weight), weight,
                                 key=lambda each: presence(each, rules))
        idle = [removed for removed, one in smaller.items()
                if not matters(model.gap, one.gap, before, noise, rules,
                               len(removed) == 1 and clear(weights[removed[0]], rules))]
        if not idle:
            break
        # Where either of two does and their gaps hardly differ, the likelihood tells them apart.
        first = max(idle, key=lambda removed: (len(removed), -smaller[removed].estimate.cost))
        model = smaller[first]
    # Where forms gave way to the usual ones, these stand for their effects.
    there = {cause.effect: cause for cause in (*full.effects, *model.effects)}
    weights = {cause: weight for cause, weight in weights.items()
               if there.get(cause.effect) is cause}
    present = probabilities(bench.selection.posterior, weights, rules)
    absent = tuple(cause for cause in there.values() if present[cause.effect] < rules.present)
    # What needs values that no vehicle has does the work of something else, which it stands for.
    untold = bench.untold(model)
    stand_ins = tuple(cause for cause in model.effects
                      if cause not in absent and bench.stands_in(model, cause, untold))
    present |= {cause.effect: rules.prior_odds for cause in stand_ins}
    material = tuple(cause for cause in model.effects if cause not in {*absent, *stand_ins})
    if set(model.effects) <= set(full.effects):
        final = full if not absent else bench.without(full, absent)
    else:
        improbable = tuple(cause for cause in model.effects if cause in absent)
        final = bench.without(model, improbable) if improbable else model
    return Judgement(final, material, stand_ins, untold, weights, present, without, ends,
                     bench.left_out(final), noises,
                     unexplained(final.gap, before, noise, bool(material), rules))


def standard_errors_from_none(off: np.ndarray, covariance: np.ndarray) -> float:
    """
    Return how far K parameters together are from none, in standard errors of a single one.

    As many as have the probability of Wald's statistic, a chi-square with K degrees of freedom.
    Args: off (K,): distance from none; covariance (K, K).
    """
    errors = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    values, vectors = np.linalg.eigh(covariance / np.outer(errors, errors))
    along = vectors.T @ (off / errors)
    square = float(np.sum(along ** 2 / np.maximum(values, 1e-12)))
    chance = float(chdtrc(len(off), square))
    # Of what is less probable than a float can tell, the root is as good.
    return float(-ndtri(0.5 * chance)) if chance > 1e-300 else float(np.sqrt(square))


def _columns_alike(name: str) -> list[int]:
    """Return the columns of an effect in all its forms, and of those with the same ratio."""
    ratio = EFFECTS[name].ratio
    names = {name, *(other for other, effect in EFFECTS.items()
                     if ratio is not None and effect.ratio == ratio)}
    return [SPLIT + place for (effect, _), part in PLACES.items() if effect in names
            for place in range(part.start, part.stop)]


def _weight(model: Model, without: Model, before: dict, noise: dict, distance: float,
            rules: Rules) -> Weight:
    """Return the Weight of what a Model has more than another, so far from no effect."""
    shares = lost_shares(model.gap, without.gap, before, noise, rules)
    explained = {name: _explained(model.gap[name], without.gap[name], noise[name],
                                  rules.least(name, noise[name])) for name in shares}
    # Where it does most: a small share of one group may be all that is explained in another.
    name = max(shares, key=lambda group: shares[group] * explained[group])
    return Weight(max(shares.values()), stability(model.ends, without.ends, noise, rules),
                  explained[name], without.gap, distance)


def _explained(after: float, without: float, noise: float, least: float) -> float:
    """Return the share that an effect explains of what is there without it, by gaps of a group."""
    there = beyond(without, noise)
    return float(np.clip((there - beyond(after, noise)) / max(there, least), 0.0, 1.0))


def pooled(gap: list) -> dict:
    """Return {group: root mean square} of the gaps {group: ...} of flights."""
    return {name: float(np.sqrt(np.mean([one[name] ** 2 for one in gap]))) for name in gap[0]}


def stability(with_it: tuple, without: tuple, noise: dict, rules: Rules) -> float:
    """
    Return how steadily an effect helps: what it saves per block of time over its standard error.

    The statistic of Vuong (Econometrica 57, 1989) for two models, over blocks of all flights,
    the one held out among them. Squared errors count in units of what remains.
    Args: the Ends of all flights with and without the effect; noise {group: gap}.
    """
    scale = np.empty(ERRORS)
    for name, gap in gaps.gap(with_it).items():
        scale[GROUPS[name]] = max(gap, noise[name])
    blocks = []
    for one, other in zip(with_it, without, strict=True):
        change = np.sum((other.errors ** 2 - one.errors ** 2) / scale ** 2, axis=1)
        block = np.unique((one.t // rules.steady_block).astype(int), return_inverse=True)[1]
        blocks.append(np.bincount(block, change))
    saved = np.concatenate(blocks)
    error = np.std(saved) * np.sqrt(len(saved))
    return float(np.sum(saved) / max(error, 1e-300))


def lost_shares(after: dict, without: dict, before: dict, noise: dict, rules: Rules) -> dict:
    """
    Return {group: share of the closable gap that is lost}.

    Args: {group: gap} with all effects, without some, of the nominal vehicle, of the noise.
    """
    return {name: float(without[name] - after[name]) / max(
        before[name] - min(noise[name], after[name]), rules.least(name, noise[name]))
        for name in after}


def matters(after: dict, without: dict, before: dict, noise: dict, rules: Rules,
            apart: bool = False) -> bool:
    """
    Return whether effects matter, by the gap with and without them.

    In some group of outputs the share that is lost without them is material, beside the floors of
    the tolerance, too, and more than the error of form of the other effects may be, unless it is
    known apart from these.
    """
    shares = lost_shares(after, without, before, noise, rules)
    return any(share >= rules.material
               and without[name] - after[name] >= rules.lost * rules.floors[name]
               and (apart or beyond(without[name], after[name])
                    >= rules.form_error * beyond(before[name], without[name]))
               for name, share in shares.items())


def clear(weight: Weight, rules: Rules) -> bool:
    """
    Return whether an effect is probable and clearly differs from none.

    How much of the gap the errors of form of others may be is then no matter: its standard errors
    have these in them.
    """
    return weight.distance >= rules.shown and presence(weight, rules) >= rules.present


def unexplained(gap: dict, before: dict, noise: dict, named: bool, rules: Rules) -> dict:
    """
    Return {group: gap} of what remains beyond the noise, where that matters.

    It matters where it is more than the tolerance, and more than the error of form of the effects
    that are named, if any, may be.
    """
    found = {}
    for name in gap:
        remains = beyond(gap[name], noise[name])
        closed = beyond(before[name], gap[name]) if named else 0.0
        if remains > max(rules.tolerance(name, noise[name]), rules.unexplained * closed):
            found[name] = remains
    return found


def beyond(gap: float, noise: float) -> float:
    """Return what makes a gap together with an independent other one."""
    return float(np.sqrt(max(0.0, gap ** 2 - noise ** 2)))


def _subsets(model: Model, rules: Rules) -> list:
    """Return the effects that are taken out: each one, and those together that may cancel."""
    effects = model.effects
    scaling = [cause for cause in effects if EFFECTS[cause.effect].scale_group]
    groups = [tuple(group) for size in range(2, len(scaling) + 1)
              for group in combinations(scaling, size)]
    pairs = [pair for pair in combinations(effects, 2)
             if pair not in groups and _tie(model.estimate, *pair) > rules.tied]
    return [*((cause,) for cause in effects), *groups, *pairs]


def _tie(fit: Estimate, one: Candidate, other: Candidate) -> float:
    """Return the largest correlation between the parameters of two effects."""
    errors = np.sqrt(np.maximum(np.diag(fit.covariance), 1e-300))
    table = np.abs(fit.covariance / np.outer(errors, errors))
    places = [[fit.columns.index(column) for column in cause.columns] for cause in (one, other)]
    return float(table[np.ix_(*places)].max())
