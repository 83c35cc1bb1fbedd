# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which effects explain flights: sets of candidates compared jointly, each refitted."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from quad_ident_ros.diagnose.candidates import Candidate, nuisance_candidates, usual_forms
from quad_ident_ros.diagnose.cross_validation import left_out_cost
from quad_ident_ros.diagnose.discrepancy import AXES, log_likelihood, scales
from quad_ident_ros.diagnose.evidence import beam, excludes, key_of, Quadratic
from quad_ident_ros.diagnose.fitted import (
    distances_of,
    effects_in,
    Fitted,
    fitted_of,
    out_of_bounds,
    prior_distance,
    refitted,
    size_grids,
    within_bounds,
)
from quad_ident_ros.diagnose.frame import (
    blocks_at,
    form_errors_of,
    Frame,
    frame_at,
)
from quad_ident_ros.diagnose.linear_model import fitted_around, quadratic_at, rows_of
from quad_ident_ros.diagnose.promising import other_actuators, other_ratios, promising, REFITS
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.selection import posteriors, Selection
from quad_ident_ros.diagnose.standard_errors import joint_of
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.greybox.estimate import Estimate, estimate
from quad_ident_ros.greybox.flights import Flight, inertial
from quad_ident_ros.greybox.linear import errors_along
from quad_ident_ros.greybox.noise import quick_noise, whole_noise
from quad_ident_ros.greybox.nuisances import are_alike, Layout, NuisanceValues, trim_wrench
from quad_ident_ros.greybox.parameters import limits, nominal
from quad_ident_ros.memory import give_back
from quad_ident_ros.model.vehicle import Vehicle

# How long and how far the search goes; the thresholds of a verdict are those of Rules.
ROUNDS = 6
KEPT = 10           # fitted sets that are judged again around each new best one
FAR = 30.0          # log evidence behind the best one up to which a set that has other delays or
                    # lags is judged around itself: three times what slopes around a delay of 20 ms
                    # are wrong by for a lag (9: test_selection.py, -k linearised), and `alike`
TURNS = 2           # times that flights are linearised again for delays and lags of the best set
REFITTED = 2        # times that the largest set is fitted, each by the noise of the fit before
PASSES = 3          # times, at most, in each stage, that the noise is estimated again
ONCE = 0.8          # share of the progress for a first search: a second one is seldom needed
LOST = 4.0          # times the scatter that a fit may cost more than a subset does


def select(flights: list[Flight], vehicle: Vehicle, causes: tuple[Candidate, ...],
           rules: Rules, on_progress: Callable[[float], None] = lambda share: None,
           gusty: bool = False) -> Selection:
    """
    Return the Selection among candidate effects for flights of a vehicle.

    The errors are weighed by the noise from sample to sample. Where the residuals are much larger,
    by autocorrelated noise or by what no effect explains, their own size is the weight, until
    the two agree; where that is much more than the largest set leaves, the search is repeated with
    what that leaves. A moment that the best set has by flight although all flights have it alike
    is the vehicle's: the search is repeated with moments that only differ.
    """
    search = _final_search(flights, vehicle, causes, rules, (), gusty,
                           lambda share: on_progress(ONCE * share))
    alike = search.alike_in_nuisances()
    if alike:
        search = _final_search(flights, vehicle, causes, rules, alike, gusty,
                               lambda share: on_progress(ONCE + (1.0 - ONCE) * share))
    on_progress(1.0)
    return search.selection()


def _final_search(flights: list[Flight], vehicle: Vehicle, causes: tuple[Candidate, ...],
                  rules: Rules, differ: Collection[str], gusty: bool,
                  on_progress: Callable[[float], None]) -> '_Search':
    """Return a search at its end: a second one where the first took effects for noise."""
    search = _searched(_Search(flights, vehicle, causes, rules, differ, gusty),
                       lambda share: on_progress(ONCE * share))
    if search.by_residuals and search.too_wide((largest := search.largest())[1]):
        # What the search had not found yet hid the rest as noise: on from where it ended, or from
        # the largest set, whichever has more evidence with the noise of that.
        assert search.best is not None
        starts = {search.best.chosen: search.best.estimate, largest[0]: largest[1]}
        noise = search.whole_noise(largest[1])
        del search      # two frames at once would be most of a diagnosis' memory
        search = _searched(_Search(flights, vehicle, causes, rules, differ, gusty, starts, noise),
                           lambda share: on_progress(ONCE + (1.0 - ONCE) * share))
    on_progress(1.0)
    return search


def _searched(search: '_Search', on_progress: Callable[[float], None]) -> '_Search':
    """Return a search that has come to its end."""
    # First the usual form of each effect, then all forms, around what the usual ones led to.
    causes = search.all_causes
    usual = tuple(cause for cause in causes if cause.usual)
    for stage, group in enumerate((usual, causes)):
        for turn in range(1 + PASSES):
            done, rest = 0.5 * stage + 0.5 * (1.0 - 0.5 ** turn), 0.5 ** (turn + 2)
            search.look_among(group, lambda share, done=done, rest=rest:  # type: ignore[misc]
                              on_progress(done + rest * share))
            if turn == PASSES or not search.weigh_anew():
                break
    search.settle()
    # A simpler set, or one within its bounds, may leave other errors than those it was weighed by.
    for _ in range(PASSES):
        if not search.weigh_anew():
            break
        search.look_among(causes, lambda share: None)
        search.settle()
    on_progress(1.0)
    return search


class _Search:
    """Sets of candidates that were fitted, and the best of them."""

    slow: np.ndarray | None
    by_residuals: bool          # whether the noise is what a set leaves, not that of samples
    tried: dict[tuple, Estimate]
    best: Fitted | None
    judged: dict[tuple, Fitted]
    ranked: list
    frame: Frame
    quadratic: Quadratic
    grids: tuple

    def __init__(self, flights: list[Flight], vehicle: Vehicle, causes: tuple[Candidate, ...],
                 rules: Rules, differ: Collection[str] = (), gusty: bool = False,
                 starts: Mapping[tuple, Estimate] = MappingProxyType({}),
                 noise: list[np.ndarray] | None = None) -> None:
        self.flights, self.vehicle, self.rules = flights, vehicle, rules
        self.all_causes = causes
        self.nuisances = nuisance_candidates(vehicle, flights, differ, gusty)
        self.noise = [quick_noise(errors_along(flight, vehicle, nominal(vehicle),
                                               flight.states[flight.first]))
                      for flight in flights]
        # Integrals change little from sample to sample, whatever their errors are.
        self.slow = trim_wrench(vehicle) if inertial(flights) else None
        self.by_residuals = inertial(flights) or noise is not None
        if self.by_residuals:
            self.noise = noise or self.whole_noise(self.nothing(self.noise))
        self.starts = tuple(starts)
        self.tried = {key: refitted(flights, vehicle, fit.z, key, self.noise, fit.nuisances,
                                    fit.starts, slow=self.slow) for key, fit in starts.items()}
        self.tried[()] = self.nothing(self.noise)
        self.best, self.judged, self.ranked = None, {}, []
        self.linearised_at: tuple = ()
        self.judged_around: dict[tuple, Fitted] = {}

    def nothing(self, noise: list[np.ndarray]) -> Estimate:
        """Return the Estimate of the empty set."""
        return estimate(self.flights, self.vehicle, nominal(self.vehicle), [], noise=noise,
                        iterations=2, slow=self.slow)

    def largest(self) -> tuple[tuple, Estimate]:
        """
        Return a set of as many usual forms as go together, and its Estimate.

        Its nuisances are those of the best set: what flights differ by is no noise.
        """
        assert self.best is not None
        chosen: tuple = ()
        usual = (cause for cause in self.all_causes if cause.usual)
        for cause in (*usual, *(one for one in self.best.chosen if one.nuisance)):
            if not any(excludes(cause, other) for other in chosen):
                chosen = key_of((*chosen, cause))
        z, size = nominal(self.vehicle), limits(self.vehicle)[2]
        # Slopes at no lag hardly show what a lag does: see other_actuators.
        late = [column for cause in _actuators(chosen) for column in cause.columns]
        z[late] += size[late]
        fit = self.best.estimate
        noise = [quick_noise(raw) for raw in fit.quiet]
        for _ in range(REFITTED):
            fit = refitted(self.flights, self.vehicle, z, chosen, noise, fit.nuisances,
                           fit.starts, slow=self.slow)
            z, noise = fit.z, self.whole_noise(fit)
        return chosen, fit

    def too_wide(self, largest: Estimate) -> bool:
        """
        Return whether the largest set, by its Estimate, leaves much less than the noise assumed.

        The noise is what the largest model leaves (Mallows, Technometrics 15, 1973).
        """
        ratio = np.median(np.array(self.noise) / self.whole_noise(largest), axis=0)
        return bool(np.max(ratio) > self.rules.coloured)

    def weigh_anew(self) -> bool:
        """
        Weigh the residuals by their own size where that is far from the noise assumed for them.

        Their autocorrelated part counts as a slow force and moment. Return whether anything
        changed. The best sets so far are where to go on from.
        """
        assert self.best is not None
        fit, slow = self.best.estimate, self.slow_wrench()
        # Sizes are known to a step of the grid that they are on, a factor of 3.
        changed = (slow is None) != (self.slow is None) or (
            slow is not None and self.slow is not None
            and not np.allclose(slow, self.slow, rtol=0.5, atol=0.0))
        if changed:
            fit = refitted(self.flights, self.vehicle, fit.z, self.best.chosen, self.noise,
                           fit.nuisances, fit.starts, self.frame.slopes, slow=slow)
        noise = self.whole_noise(fit)
        ratio = np.median(np.array(noise) / self.noise, axis=0)
        if max(np.max(ratio), np.max(1.0 / ratio)) <= self.rules.coloured and not changed:
            return False
        self.slow, self.by_residuals = slow, True
        plain = self.simplest([key for key in self.tried if _plain(key)])
        known = [self.best.chosen, *(one.chosen for one in self.order()[:REFITS]), plain.chosen,
                 ()]
        self.noise, self.judged, self.judged_around = noise, {}, {}
        self.tried = {key: self.tried[key] for key in dict.fromkeys(known)}
        self.tried = {key: refitted(self.flights, self.vehicle, fit.z, key, noise, fit.nuisances,
                                    fit.starts, self.frame.slopes, slow=slow)
                      for key, fit in self.tried.items()}
        return True

    def whole_noise(self, fit: Estimate) -> list[np.ndarray]:
        """Return the standard deviations (12,) of all that an Estimate leaves, per flight."""
        found = [whole_noise(raw, 1.0 - 1.0 / raw.shape[1]) for raw in fit.quiet]
        if inertial(self.flights):
            # Along the axes of the force that is taken from the record little seems to be wrong.
            for part in (GROUPS['position'], GROUPS['velocity'], GROUPS['attitude']):
                for noise in found:
                    noise[part] = noise[part].max()
        return found

    def slow_wrench(self) -> np.ndarray | None:
        """
        Return the likeliest size (6,) of force and moment that the best set of effects leaves.

        None where the flights are not inertial: the air is modelled there. None also where they
        are hardly likelier than none: two numbers that are chosen.
        """
        assert self.best is not None
        if not inertial(self.flights):
            return None
        fit, chosen = self.best.estimate, self.best.chosen
        force, moment = (float(grid[k]) for grid, k in zip(self.grids, self.best.sizes,
                                                           strict=True))
        distances = distances_of(chosen, fit, self.vehicle)
        blocks = blocks_at(self.frame, fit, distances)
        gain, none = (log_likelihood(blocks, scales(*sizes, form_errors_of(distances, self.rules),
                                                    blocks.gram.shape[1]), self.quadratic.scatter)
                      for sizes in ((force, moment), (0.0, 0.0)))
        return np.repeat([force, moment], AXES) if gain - none > self.rules.alike else None

    def look_among(self, causes: tuple[Candidate, ...], on_progress: Callable[[float], None]
                   ) -> None:
        """Look for better sets of some candidates around the best one until there is none."""
        self.causes = causes
        self.columns = sorted({column for cause in (*causes, *self.all_causes)
                               if cause in causes or any(cause in key for key in self.tried)
                               for column in cause.columns})
        self.rows = rows_of(self.all_causes, self.nuisances, self.columns, len(self.flights))
        best = self.best.chosen if self.best else next(iter(self.starts), ())
        stood_at = set()
        for turn in range(ROUNDS):
            self.stand_at(best)
            stood_at.add(best)
            for key in (best, *(one for one in self.starts if one in self.tried)):
                self.judge(key)
            self.ranked = beam(self.quadratic, {cause: self.rows[cause] for cause in
                                                (*self.causes, *self.nuisances)}, self.rules)
            self.try_promising()
            self.best = self.order()[0]
            on_progress((turn + 1) / ROUNDS)
            # Sets that are about alike would only take turns, each the best around the other.
            if (self.best.chosen in stood_at
                    or self.best.evidence <= self.judge(best).evidence + self.rules.alike):
                break
            best = self.best.chosen

    def stand_at(self, chosen: tuple) -> None:
        """Linearise around a fitted set; the best of those judged before are judged again."""
        fit = self.tried[chosen]
        everyone = NuisanceValues.of([one.nuisance for one in self.nuisances if one.nuisance],
                                     len(self.flights), fit.nuisances)
        layout = Layout(self.columns, everyone.columns, len(self.flights))
        vars(self).pop('frame', None)   # two at once would be most of a diagnosis' memory
        give_back()
        self.frame = frame_at(self.flights, self.vehicle, fit, layout.wanted, self.rules)
        self.linearised_at, self.judged_around = chosen, {}
        grids = size_grids(self.vehicle, self.noise, self.rules)
        before = [one.chosen for one in self.order()[:KEPT]]
        known, self.grids = self.judged.get(chosen), grids
        sizes = known.sizes if known else (0, 0)
        self.quadratic = self.quadratic_of(chosen, everyone, sizes)
        self.judged = {}
        if known is None:   # the size of the discrepancy shows around here
            self.quadratic = self.quadratic_of(chosen, everyone, self.judge(chosen).sizes)
            self.judged = {}
        for key in (chosen, *before):
            self.judge(key)

    def quadratic_of(self, chosen: tuple, nuisances: NuisanceValues, sizes: tuple) -> Quadratic:
        """Return the Quadratic around a fitted set, all candidates free."""
        force, moment = (grid[k] for grid, k in zip(self.grids, sizes, strict=True))
        return quadratic_at(self.frame, self.tried[chosen], chosen, self.columns, nuisances,
                            (force, moment), self.vehicle, self.rules)

    def judge(self, chosen: tuple) -> Fitted:
        """Find the log evidence of a set that was fitted."""
        if chosen not in self.judged:
            start = self.best.sizes if self.best else (0, 0)
            self.judged[chosen] = fitted_of(chosen, self.tried[chosen], self.vehicle, self.frame,
                                            self.quadratic, self.rows, self.grids, self.rules,
                                            start)
        return self.judged[chosen]

    def judge_around(self, chosen: tuple) -> Fitted:
        """Find the log evidence of a set by slopes around itself, its errors weighed as others."""
        if chosen not in self.judged_around:
            # Beside the frame of all candidates it takes one of a few columns for a moment.
            self.judged_around[chosen] = fitted_around(
                self.judge(chosen), self.flights, self.vehicle, self.frame.scale,
                self.quadratic.scatter, self.grids, self.rules)
            give_back()
        self.judged[chosen] = self.judged_around[chosen]
        return self.judged[chosen]

    def order(self) -> list[Fitted]:
        """Return the Fitted sets, the one with the most evidence first."""
        return sorted(self.judged.values(), key=lambda one: -one.evidence)

    def try_promising(self) -> None:
        """Fit the sets that the linear model finds promising, and judge them."""
        for chosen, distances in promising(self.ranked, self.tried):
            start = nominal(self.vehicle)
            lower, upper, _ = limits(self.vehicle)
            start[self.columns] += distances[:len(self.columns)]
            start = np.clip(start, lower, upper)
            everyone = NuisanceValues.of([one.nuisance for one in self.nuisances if one.nuisance],
                                         len(self.flights))
            everyone.values.flat[:] = distances[len(self.columns):]
            self.fit(chosen, start, everyone, self.frame.slopes.starts)
        best = self.best_key()
        for chosen, start in other_actuators(best, self.causes, self.tried[best].z, self.vehicle):
            self.try_from(best, chosen, start)
        self.try_other_ratios(self.best_key())

    def try_other_ratios(self, chosen: tuple) -> list[Fitted]:
        """Return the sets with another effect of the same ratio in place of one, fitted."""
        fit, found = self.tried[chosen], []
        for other, start in other_ratios(chosen, self.all_causes, fit.z, self.vehicle):
            if other not in self.tried:
                # First it alone, or the others would leave where they fit to make up for it.
                alone = tuple(cause for cause in other if cause.nuisance or cause not in chosen)
                start = refitted(self.flights, self.vehicle, start, alone, self.noise,
                                 fit.nuisances, fit.starts, slow=self.slow).z
            found.append(self.try_from(chosen, other, start))
        return found

    def try_from(self, known: tuple, chosen: tuple, start: np.ndarray) -> Fitted:
        """Return a set, fitted from a vector and the nuisances of a known one where it is new."""
        if chosen not in self.tried:
            self.fit(chosen, start, self.tried[known].nuisances, self.tried[known].starts)
        return self.judge(chosen)

    def best_key(self) -> tuple:
        """Return the set around which the flights are linearised."""
        return self.order()[0].chosen

    def fit(self, chosen: tuple, z: np.ndarray, nuisances: NuisanceValues,
            starts: list[np.ndarray]) -> None:
        """Fit a set from a vector, and once more from its best subset where it gets lost."""
        scatter, slopes = self.quadratic.scatter, self.frame.slopes
        fit = refitted(self.flights, self.vehicle, z, chosen, self.noise, nuisances, starts,
                       slopes, scatter, slow=self.slow)
        subsets = [one for key, one in self.tried.items() if set(key) < set(chosen)]
        near = min(subsets, key=lambda one: one.cost, default=fit)
        if fit.cost > near.cost + LOST * scatter:
            again = refitted(self.flights, self.vehicle, near.z, chosen, self.noise,
                             near.nuisances, near.starts, slopes, scatter, slow=self.slow)
            fit = min(fit, again, key=lambda one: one.cost)
        self.take_fit(chosen, fit)
        give_back()
        self.judge(chosen)

    def take_fit(self, chosen: tuple, fit: Estimate) -> None:
        """Take the Estimate of a set in place of an earlier one, which its judgements are of."""
        self.tried[chosen] = fit
        self.judged.pop(chosen, None)
        self.judged_around.pop(chosen, None)

    def simplest(self, keys: Sequence[tuple]) -> Fitted:
        """Return the simplest of those sets that are about as good as the best of them."""
        sets = [self.judge(key) for key in keys]
        least = max(one.evidence for one in sets) - FAR
        there = _actuators(self.linearised_at)
        sets = [self.judge_around(one.chosen) if one.evidence > least
                and _actuators(one.chosen) != there else one for one in sets]
        least = max(one.evidence for one in sets) - self.rules.alike
        return min((one for one in sets if one.evidence > least),
                   key=lambda one: (len(one.chosen), -one.evidence))

    def settle(self) -> None:
        """
        Take the simplest of the sets that are about as good, and forms within their bounds.

        The usual form replaces one that wants to leave its bounds.
        """
        best = self.simplest(list(self.judged))
        chosen, fit = within_bounds(best.chosen, best.estimate, usual_forms(self.all_causes),
                                    self.flights, self.vehicle, self.noise, self.rules,
                                    self.quadratic.scatter, slow=self.slow)
        self.take_fit(chosen, fit)
        self.judge(chosen)
        self.tried = {key: one for key, one in self.tried.items() if not any(
            out_of_bounds(cause, one, self.vehicle, self.rules) for cause in effects_in(key))}
        self.judged = {key: one for key, one in self.judged.items() if key in self.tried}
        # The usual forms in its place may do less than other sets that were fitted.
        self.best = self.simplest(list(self.tried))
        # More parameters are for what the fewer leave, not for a little of the noise. That is a
        # choice among forms; between effects the evidence decides where the parameters show,
        # unless left-out flights are clearly predicted better without them.
        plain = self.simplest([key for key in self.tried if _plain(key)])
        cheap = plain.estimate.cost < (1.0 + self.rules.worth) * self.best.estimate.cost
        if cheap or self.predicts_better(plain, self.best):
            told = self.simplest([key for key in self.tried if self.shows(key)])
            keeps = _plain if not cheap or _names(plain) <= _names(told) else self.shows
            self.judged = {key: one for key, one in self.judged.items() if keeps(key)}
            self.ranked = [one for one in self.ranked if keeps is not _plain or _plain(one[1])]
            self.best = plain if keeps is _plain else told
        for _ in range(TURNS):
            if _actuators(self.best.chosen) == _actuators(self.linearised_at):
                break
            self.stand_at(self.best.chosen)
            self.best = self.simplest(list(self.judged))
        self.share_alike()
        if _actuators(self.best.chosen) != _actuators(self.linearised_at):
            self.stand_at(self.best.chosen)
            self.best = self.judge(self.best.chosen)
        # Whichever of thrust and mass led here, the other one may do as well.
        for one in self.try_other_ratios(self.best.chosen):
            if any(out_of_bounds(cause, one.estimate, self.vehicle, self.rules)
                   for cause in one.causes):
                del self.tried[one.chosen], self.judged[one.chosen]
            else:
                self.best = max(self.best, one, key=lambda each: each.evidence)

    def predicts_better(self, one: Fitted, other: Fitted) -> bool:
        """
        Return whether a set predicts left-out flights clearly better than another one.

        By more than sets that are about as good differ by. False for a single flight.
        """
        if one is other or len(self.flights) == 1:
            return False
        costs = [left_out_cost(each, self.flights, self.vehicle, self.noise, self.slow)
                 for each in (one, other)]
        return costs[0] + 2.0 * self.quadratic.scatter * self.rules.alike < costs[1]

    def share_alike(self) -> None:
        """
        Add effects that the best set only has by flight although its flights have them alike.

        What is alike in all flights is the vehicle's, and must not hide in nuisances.
        """
        assert self.best is not None
        for cause in self.best.chosen:
            fit = self.best.estimate
            name = cause.nuisance.shared if cause.nuisance else ''
            # The law of a vehicle file may be another than that whose parameters these are.
            laws = [one for one in self.all_causes
                    if one.effect == name and set(cause.columns) <= set(one.columns)]
            if not laws or name in _names(self.best):
                continue
            ratio = EFFECTS[name].ratio
            if ratio and ratio in {EFFECTS[one].ratio for one in _names(self.best)}:
                continue
            places = [fit.nuisances.columns.index(column) for column in cause.columns]
            values = fit.nuisances.values[:, places]
            if are_alike(values, fit.nuisances.spreads[places], self.rules.prior_probability):
                start = fit.z.copy()
                start[list(cause.columns)] += values.mean(axis=0)
                lower, upper, _ = limits(self.vehicle)[:, list(cause.columns)]
                moved = start[list(cause.columns)]
                if np.any((moved < lower) | (moved > upper)):
                    continue    # outside its bounds: states that are stamped early are no delay
                # No step would take it out of them: only their prior tells one from the other.
                apart = fit.nuisances.values.copy()
                apart[:, places] -= values.mean(axis=0)
                whole = key_of((laws[0], *self.best.chosen))
                self.fit(whole, start, replace(fit.nuisances, values=apart), fit.starts)
                self.best = self.judge(whole)

    def alike_in_nuisances(self) -> tuple[str, ...]:
        """Return names of nuisances of the best set that its flights have alike: the vehicle's."""
        assert self.best is not None
        nuisances = self.best.estimate.nuisances
        found = []
        for cause in self.best.chosen:
            if cause.nuisance is not None and cause.nuisance.mean_shares:
                places = [nuisances.columns.index(column) for column in cause.columns]
                if are_alike(nuisances.values[:, places], nuisances.spreads[places],
                             self.rules.prior_probability):
                    found.append(cause.effect)
        return tuple(found)

    def shows(self, chosen: tuple) -> bool:
        """Return whether each parameter of the forms with more than usual differs from none."""
        fit, null = self.tried[chosen], nominal(self.vehicle)
        return all(abs(fit.z[column] - null[column])
                   > self.rules.shown * fit.errors[fit.columns.index(column)]
                   for cause in effects_in(chosen) if not cause.plain for column in cause.columns)

    def twin(self) -> Fitted | None:
        """
        Return the set with mass in place of thrust, or the other way round, that fits as well.

        Only beside another effect that scales the motion: that may make up for the difference.
        """
        assert self.best is not None
        if sum(EFFECTS[name].scale_group for name in _names(self.best)) < 2:
            return None
        best, far = self.best.estimate, self.rules.alike
        others = (self.judge(key) for key, _ in other_ratios(
            self.best.chosen, self.all_causes, best.z, self.vehicle) if key in self.tried)
        return next((
            one for one in others
            if abs(one.estimate.cost - best.cost) < 2.0 * self.quadratic.scatter * far
            and prior_distance(one.estimate, self.vehicle, self.rules)
            < prior_distance(best, self.vehicle, self.rules) + far), None)

    def selection(self) -> Selection:
        """Return the Selection, and that around its twin, if there is one."""
        assert self.best is not None
        selection, twin = self.around(self.best, self.order(), self.ranked), self.twin()
        if twin is None:
            return selection
        # What the twin does without explains the flights by more effects: it is no rival.
        gone = _names(self.best) - _names(twin)
        return replace(selection, twin=self.around(
            twin, [one for one in self.order() if not gone & _names(one)],
            [one for one in self.ranked
             if not gone & {cause.effect for cause in effects_in(one[1])}]))

    def around(self, best: Fitted, sets: Sequence[Fitted], ranked: list) -> Selection:
        """Return the Selection with this set as the best of some that are fitted, or ranked."""
        fitted = (best, *(one for one in sets if one is not best))
        joint = joint_of(best, self.flights, self.frame, self.vehicle, self.grids,
                         self.quadratic.scatter, self.rules)
        force, moment = (float(grid[k]) for grid, k in zip(self.grids, best.sizes,
                                                           strict=True))
        return Selection(fitted[0], fitted,
                         posteriors(fitted, ranked, self.all_causes, set(self.tried),
                                    self.rules),
                         self.quadratic, self.rows, self.noise, joint, (force, moment), self.slow)


def _plain(chosen: tuple) -> bool:
    """Return whether no effect of a set is in a form with more parameters than usual."""
    return all(cause.plain for cause in effects_in(chosen))


def _actuators(chosen: tuple) -> set[Candidate]:
    """Return the delays and lags of a set: how the motion answers them is not linear in them."""
    return {cause for cause in effects_in(chosen) if EFFECTS[cause.effect].actuator}


def _names(fitted: Fitted) -> set[str]:
    """Return the effects of a set, in whichever form."""
    return {cause.effect for cause in fitted.causes}
