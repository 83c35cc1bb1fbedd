# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Models of sets of effects, refitted with some of them taken out, and the gap that they leave."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
import scipy

from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose import input_errors
from quad_ident_ros.diagnose.candidates import Candidate, usual_forms
from quad_ident_ros.diagnose.evidence import key_of
from quad_ident_ros.diagnose.file_errors import errors_by_file
from quad_ident_ros.diagnose.fitted import (
    columns_at_bounds,
    effects_in,
    refitted,
    within_bounds,
)
from quad_ident_ros.diagnose.gap import Noise
from quad_ident_ros.diagnose.noise import noise_in, noise_of
from quad_ident_ros.diagnose.nuisances import nuisances_of
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.selection import Selection
from quad_ident_ros.effects.registry import EFFECTS, GUSTS, PLACES, SLICES
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.linear import Slopes, slopes_at, WRENCH
from quad_ident_ros.greybox.parameters import NAMES, nominal, SPLIT
from quad_ident_ros.model.vehicle import Vehicle

# Of a correlation, as the inverse of an information keeps it.
ROUNDING = float(np.sqrt(np.finfo(float).eps))
GUSTY = [SPLIT + place for place in range(SLICES[GUSTS.name].start, SLICES[GUSTS.name].stop)]


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
    noise of all flights.
    """

    flights: list
    tracks: tuple
    vehicle: Vehicle
    selection: Selection
    noise: Noise
    rules: Rules

    @classmethod
    def of(cls, flights: list, tracks: tuple, vehicle: Vehicle, selection: Selection,
           rules: Rules) -> 'Bench':
        """Return the Bench of a Selection, whose best set says what the noise is."""
        return cls(flights, tracks, vehicle, selection,
                   noise_of(selection.best.estimate, flights, vehicle, rules), rules)

    def with_selection(self, selection: Selection) -> 'Bench':
        """Return the Bench of another Selection for the same flights."""
        return Bench.of(self.flights, self.tracks, self.vehicle, selection, self.rules)

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

    def without_gusts(self, model: Model) -> Model:
        """Return a Model whose predictions know nothing of gusts, as no simulation does."""
        vectors = tuple(vector.copy() for vector in model.vectors)
        if all((vector[GUSTY] == model.z[GUSTY]).all() for vector in vectors):
            return model
        for vector in vectors:
            vector[GUSTY] = model.z[GUSTY]
        return replace(model, vectors=vectors, ends=self.ends(vectors))

    def ends(self, vectors: tuple) -> tuple:
        """Return the Ends of all flights with a vector (Z,) each."""
        return tuple(gaps.ends(track, self.vehicle, z, self.horizon)
                     for track, z in zip(self.tracks, vectors, strict=True))

    def noises(self, model: Model) -> tuple[Noise, ...]:
        """Return the Noise of each flight, with its vector of a Model."""
        return tuple(noise_in(track, z, self.noise)
                     for track, z in zip(self.tracks, model.vectors, strict=True))

    def noise_gaps(self, model: Model, noises: Sequence[Noise]) -> list:
        """Return {group: the gap that its Noise makes} of each flight."""
        return [gaps.noise_gap(track, self.vehicle, z, noise, self.horizon)
                for track, z, noise in zip(self.tracks, model.vectors, noises, strict=True)]

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

        slopes: those at the model, with which fits that only serve for comparison begin.

        What is alike in all flights must not hide in nuisances: those that do what an effect does
        that is taken out may only differ between flights, as they do beside it.
        """
        less = self._changed(model, model.z, removed, (), slopes)
        # A lag is nearly a delay: an offset of the clocks, by which all flights alike answer
        # later than their commands, does its work.
        there = {column for cause in model.chosen if cause.nuisance
                 for column in cause.nuisance.columns}
        late = {column: max(0.0, common(model, column))
                for cause in removed for column in _columns_late(cause.effect)
                if column in there.difference(_columns_alike(cause.effect))}
        if all(common(less, column) <= most for column, most in late.items()):
            return less
        return self._changed(model, model.z, removed, (), slopes, late)

    def absent(self, model: Model, removed: tuple) -> Model:
        """
        Return a Model without effects that are not there, everything else refitted.

        What each flight has of them is then its own, however alike the flights are by chance.
        """
        return self._changed(model, model.z, removed, (), None, own=frozenset(
            cause for cause in model.chosen if cause.nuisance is not None
            and cause.nuisance.shared in {one.effect for one in removed}))

    def instead(self, model: Model, cause: Candidate, rival: Candidate, z: np.ndarray) -> Model:
        """Return a Model with a rival in the place of one of its effects; z (Z,) has the rival."""
        near = model.z.copy()
        near[list(rival.columns)] = z[list(rival.columns)]
        return self._changed(model, near, (cause,), (rival,), None)

    def beside(self, model: Model, causes: tuple, z: np.ndarray) -> Model:
        """Return a Model with effects beside its own, everything refitted; z (Z,) has them."""
        near = model.z.copy()
        columns = [column for cause in causes for column in cause.columns]
        near[columns] = z[columns]
        return self._changed(model, near, (), causes, None)

    def _changed(self, model: Model, z: np.ndarray, removed: tuple, added: tuple,
                 slopes: Slopes | None, kept: Mapping[int, float] = MappingProxyType({}),
                 own: frozenset[Candidate] = frozenset()) -> Model:
        """
        Return a Model with effects taken out and added, everything refitted from z (Z,) on.

        kept {column: mean}: nuisances that stay as they are, but with this mean over the flights;
        own: nuisances that are free in what flights share, too.
        """
        fit, z = model.estimate, z.copy()
        columns = [column for cause in removed for column in cause.columns]
        z[columns] = nominal(self.vehicle)[columns]
        fixed = np.stack(model.vectors) - model.z
        alike = {column for cause in removed for column in _columns_alike(cause.effect)}
        alike -= {column for cause in own if cause.nuisance for column in cause.nuisance.columns}
        shared = [column for column in sorted(alike) if fixed[:, column].any()]
        # Thrust, wind and moment of a flight do what many effects do: they stay as they are.
        held = {cause for cause in model.chosen
                if cause.nuisance is not None and cause not in own and (
                    cause.nuisance.of_effect or cause.nuisance.mean_shares
                    or {*cause.nuisance.columns} & {*shared, *kept})}
        free = [column for cause in model.chosen
                if cause.nuisance is not None and cause not in held
                for column in cause.nuisance.columns]
        fixed[:, free] = 0.0
        fixed[:, shared] -= fixed[:-1, shared].mean(axis=0)
        for column, mean in kept.items():
            fixed[:, column] += mean - fixed[:-1, column].mean()
        chosen = key_of((*added, *(cause for cause in model.chosen
                                   if cause not in {*removed, *held})))
        noise, scatter = self.selection.noise, self.selection.quadratic.scatter
        slow = self.selection.slow
        estimate = refitted(self.flights, self.vehicle, z, chosen, noise, fit.nuisances,
                            fit.starts, slopes, scatter, fixed[:-1], slow)
        chosen, estimate = within_bounds(chosen, estimate, usual_forms(self.selection.posterior),
                                         self.flights, self.vehicle, noise, self.rules, scatter,
                                         fixed[:-1], slow)
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

    def by_commands(self, model: Model) -> dict[int, tuple[float, float]]:
        """Return {column: (least, most)} of what errors of the commands alone may have made."""
        if not input_errors.gains(model.estimate.columns):
            return {}
        found = input_errors.ranges(model.estimate, self.slopes(model), self.noise)
        null = nominal(self.vehicle)
        clear = {column for cause in model.effects for column in self.clear_columns(model, cause)}
        return {column: (least, most) for column, (least, most) in found.items()
                if column in clear and least <= null[column] <= most}

    def stands_in(self, model: Model, cause: Candidate, by_commands: Collection[int]) -> bool:
        """Return whether errors of the commands or bounds made most of what an effect changes."""
        clear = self.clear_columns(model, cause)
        held = columns_at_bounds(cause, model.z, self.vehicle, self.rules)
        return len(clear & {*by_commands, *held}) > self.rules.stand_in * len(clear)

    def clear_columns(self, model: Model, cause: Candidate) -> set[int]:
        """Return the columns of an effect that clearly differ from none."""
        return {column for column, distance in self.distances(model, cause).items()
                if distance >= self.rules.shown}

    def distance(self, model: Model, causes: tuple) -> float:
        """
        Return by how many standard errors the parameters of effects together differ from none.

        In the best set where that has them: where others are taken out, they do their work. But
        what is tied to one that is taken out is known as well as without it.
        """
        best = self.selection.best.estimate
        columns = [column for cause in causes for column in cause.columns]
        if set(columns) <= set(best.columns):
            known, off, covariance = best.columns, *self._known(model)
        else:
            known, covariance = model.estimate.columns, model.estimate.covariance
            off = (model.z - nominal(self.vehicle))[known]
        places = [known.index(column) for column in columns]
        return standard_errors_from_none(off[places], covariance[np.ix_(places, places)])

    def distances(self, model: Model, cause: Candidate) -> dict[int, float]:
        """
        Return {column: standard errors from none} of an effect, each parameter by itself.

        In the best set where that has the column, as the distance.
        """
        off, errors = model.z - nominal(self.vehicle), self.errors(model)
        off[self.selection.best.estimate.columns] = self._known(model)[0]
        return {column: float(abs(off[column]) / max(errors[column], 1e-300))
                for column in cause.columns}

    def errors(self, model: Model) -> dict[int, float]:
        """Return {column: standard error}: of the best set where it has the column."""
        best, out = self.selection.best.estimate, {*self.taken_out(model)}
        errors = np.sqrt(np.maximum(np.diag(self._known(model)[1]), 0.0))
        # What is taken out is given for the others, but not for itself.
        return (dict(zip(model.estimate.columns, model.estimate.errors, strict=True))
                | {column: float(whole if column in out else error) for column, error, whole
                   in zip(best.columns, errors, self.selection.errors, strict=True)})

    def errors_by_file(self, model: Model) -> dict[int, float]:
        """
        Return {column: standard error} that constants of the file add: a Model's, and others'.

        Those of the best set only where the model has not the column: a constant that is free
        there is that of the file in a model without that effect. What differs from a constant
        itself, as a factor on the inertia, counts from the file.
        """
        best, found = self.selection.best, dict[int, float]()
        for chosen, fit in {best.chosen: best.estimate, model.chosen: model.estimate}.items():
            errors = errors_by_file(chosen, fit, self.flights, self.vehicle, self.selection.sizes,
                                    self.selection.joint.form_error, self.rules)
            found |= dict(zip(fit.columns, errors.tolist(), strict=True))
        return {column: error for column, error in found.items()
                if not EFFECTS[NAMES[column].split('.')[0]].scale_group}

    def shift_by_absent(self, model: Model, probability: Mapping[str, float]) -> np.ndarray:
        """
        Return the error (C,) of a Model's columns because effects taken out may be there.

        Beside these the columns have the values of the best set, with the probability of the most
        probable of them: the root mean square of what either model is off by (Draper, J. R. Stat.
        Soc. B 57, 1995). Signs are those of the shifts, which come together. probability
        {effect: of being present}.
        """
        best, there = self.selection.best, {cause.effect for cause in model.effects}
        most = max((probability.get(cause.effect, 0.0) for cause in best.causes
                    if cause.effect not in there), default=0.0)
        known = {*best.estimate.columns}
        return np.array([np.sqrt(most) * (best.estimate.z[column] - model.z[column])
                         if column in known else 0.0 for column in model.estimate.columns])

    def taken_out(self, model: Model) -> list[int]:
        """Return the columns of the best set's effects to which some effect in a Model is tied."""
        # Of those that the Model itself does not have.
        best, there = self.selection.best, {*model.effects}
        return sorted(column for cause in best.causes if cause not in there
                      and any(tie(best.estimate, cause, other) > self.rules.tied
                              for other in best.causes if other in there)
                      for column in cause.columns)

    def _known(self, model: Model) -> tuple[np.ndarray, np.ndarray]:
        """
        Return how far the best set's columns are from none, (C,), and their covariance, (C, C).

        Given that what is tied to an effect of a Model, and taken out, is none.
        """
        best = self.selection.best.estimate
        off = (best.z - nominal(self.vehicle))[best.columns]
        places = [best.columns.index(column) for column in self.taken_out(model)]
        if not places:
            return off, self.selection.covariance
        moved, covariance = given(self.selection.covariance, places)
        return off - moved @ off[places], covariance

    def _nuisances(self, flight: int, z: np.ndarray, chosen: tuple,
                   fixed: np.ndarray | None = None) -> np.ndarray:
        """Return the nuisances (Z,) of a flight beside a vector that it took no part in."""
        return nuisances_of(self.tracks[flight], self.vehicle, z,
                            tuple(cause.nuisance for cause in chosen if cause.nuisance),
                            self.noise.deviation, self.flights[0].segment, fixed,
                            self.selection.slow)


def given(covariance: np.ndarray, places: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """
    Return how others move with some places (K,) that become known, (C, K), and what then remains.

    The remaining covariance (C, C) is that of normal variables given these. Parameters that do the
    same are known by themselves to far less than together: what remains is not known better than
    rounding leaves of that, and never negative.
    """
    errors = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    values, vectors = np.linalg.eigh(covariance / np.outer(errors, errors))
    table = (vectors * np.maximum(values, ROUNDING * values[-1])) @ vectors.T
    moved = np.linalg.solve(table[np.ix_(places, places)], table[places]).T
    return (moved * np.outer(errors, 1.0 / errors[places]),
            (table - moved @ table[places]) * np.outer(errors, errors))


def tie(fit: Estimate, one: Candidate, other: Candidate) -> float:
    """Return the largest correlation between the parameters of two effects."""
    errors = np.sqrt(np.maximum(np.diag(fit.covariance), 1e-300))
    table = np.abs(fit.covariance / np.outer(errors, errors))
    places = [[fit.columns.index(column) for column in cause.columns] for cause in (one, other)]
    return float(table[np.ix_(*places)].max())


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
    chance = float(scipy.special.chdtrc(len(off), square))
    # Below the smallest probability of a float the root is as good.
    return float(-scipy.special.ndtri(0.5 * chance)) if chance > 1e-300 else float(np.sqrt(square))


def common(model: Model, column: int) -> float:
    """Return the mean of a nuisance (a place in z) over the flights that a Model learnt from."""
    return float(np.mean([vector[column] for vector in model.vectors[:-1]]) - model.z[column])


def _columns_alike(name: str) -> list[int]:
    """Return the columns of an effect in all its forms, and of those with the same ratio."""
    ratio = EFFECTS[name].ratio
    return _columns_of({name, *(other for other, effect in EFFECTS.items()
                                if ratio is not None and effect.ratio == ratio)})


def _columns_late(name: str) -> list[int]:
    """Return the columns of all effects of the actuators where one is of these, else none."""
    return _columns_of({other for other, effect in EFFECTS.items()
                        if EFFECTS[name].actuator and effect.actuator})


def _columns_of(names: set[str]) -> list[int]:
    """Return the columns of effects in all their forms."""
    return [SPLIT + place for (effect, _), part in PLACES.items() if effect in names
            for place in range(part.start, part.stop)]
